"""Statistics of a mesh by numpy and SciPy beside those that gsm reported.

  statistics.py MESH.msh REPORT.json
"""
import json
import sys

import meshio
import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sl

mesh = meshio.read(sys.argv[1])
with open(sys.argv[2]) as f:
    report = json.load(f)
X = mesh.points
E = np.concatenate([c.data for c in mesh.cells if c.type == "tetra"])
T = np.concatenate([c.data for c in mesh.cells if c.type == "triangle"])


def same(name, ours, theirs, tolerance=1e-9):
    assert abs(ours - theirs) <= tolerance * max(abs(theirs), 1e-300), (name, ours, theirs)


P = X[T]
length = np.linalg.norm(np.roll(P, -1, 1) - P, axis=2)
angle = np.zeros((len(T), 3))
for k in range(3):
    u, v = P[:, (k + 1) % 3] - P[:, k], P[:, (k + 2) % 3] - P[:, k]
    angle[:, k] = np.degrees(np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), (u * v).sum(1)))
area = np.linalg.norm(np.cross(P[:, 1] - P[:, 0], P[:, 2] - P[:, 0]), axis=1) / 2
ours = report["triangles"]
assert ours["triangles"] == len(T)
same("min angle", ours["min_angle"]["min"], angle.min())
same("mean min angle", ours["min_angle"]["mean"], angle.min(1).mean())
same("max angle", ours["max_angle"]["max"], angle.max())
same("below 30", ours["percent_below_30"], 100 * (angle.min(1) < 30 - 1e-9).mean())
same("above 40", ours["percent_above_40"], 100 * (angle.min(1) > 40).mean())
same("min edge", ours["min_edge"], length.min())
same("max edge", ours["max_edge"], length.max())
aspect = (length.prod(1) / (4 * area)) / (2 * area / length.sum(1))
same("aspect", ours["aspect"]["max"], aspect.max())
distortion = 4 * np.sqrt(3) * area / (length ** 2).sum(1)
same("distortion", ours["distortion"]["min"], distortion.min())
same("mean distortion", ours["distortion"]["mean"], distortion.mean())
assert sum(ours["aspect"]["counts"]) == len(T)

P = X[E]
a, b, c = P[:, 1] - P[:, 0], P[:, 2] - P[:, 0], P[:, 3] - P[:, 0]
six = np.abs((a * np.cross(b, c)).sum(1))
R = np.linalg.norm((a * a).sum(1)[:, None] * np.cross(b, c) + (b * b).sum(1)[:, None] * np.cross(c, a)
                   + (c * c).sum(1)[:, None] * np.cross(a, b), axis=1) / (2 * six)
pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
short = np.min([np.linalg.norm(P[:, i] - P[:, j], axis=1) for i, j in pairs], axis=0)
dihedral = []
for i, j in pairs:
    k, l = [m for m in range(4) if m not in (i, j)]
    e = P[:, j] - P[:, i]
    n1, n2 = np.cross(e, P[:, k] - P[:, i]), np.cross(e, P[:, l] - P[:, i])
    dihedral.append(np.degrees(np.arctan2(np.linalg.norm(np.cross(n1, n2), axis=1), (n1 * n2).sum(1))))
dihedral = np.array(dihedral)
surface = sum(np.linalg.norm(np.cross(P[:, j] - P[:, i], P[:, k] - P[:, i]), axis=1) / 2
              for i, j, k in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)))
ours = report["tets"]
assert ours["tets"] == len(E)
same("radius-edge", ours["radius_edge"]["max"], (R / short).max())
same("mean radius-edge", ours["radius_edge"]["mean"], (R / short).mean())
same("aspect", ours["aspect"]["max"], (R * surface / (six / 2)).max())
same("min dihedral", ours["min_dihedral"]["min"], dihedral.min())
same("max dihedral", ours["max_dihedral"]["max"], dihedral.max())
same("volume", ours["volume"], six.sum() / 6)
assert ours["above_bound"] == (R / short > ours["ratio_bound"] * (1 + 1e-9)).sum()
bounds = ours["radius_edge"]["bounds"] + [np.inf]
assert ours["radius_edge"]["counts"] == np.histogram(R / short, bounds)[0].tolist()

# Stiffness matrix, potential given on the hull (faces of one tetrahedron).
D = np.stack([a, b, c], 1)
G = np.linalg.inv(D)
G = np.concatenate([-G.sum(2, keepdims=True), G], 2)
K = np.einsum("mdi,mdj->mij", G, G) * (six / 6)[:, None, None]
A = sp.csr_matrix((K.ravel(), (np.repeat(E, 4, 1).ravel(), np.tile(E, (1, 4)).ravel())), shape=(len(X), len(X)))
faces = np.sort(np.concatenate([E[:, q] for q in ([1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2])]), 1)
unique, count = np.unique(faces, axis=0, return_counts=True)
fixed = np.zeros(len(X), bool)
fixed[unique[count == 1].ravel()] = True
free = np.where(~fixed)[0]
A = A[free][:, free].tocsc()
d = sp.diags(1 / np.sqrt(A.diagonal()))
ours = report["stiffness"]
assert ours["unknowns"] == len(free)
for name, M in (("plain", A), ("scaled", (d @ A @ d).tocsc())):
    high = sl.eigsh(M, 1, which="LM", tol=1e-10, return_eigenvectors=False)[0]
    low = sl.eigsh(M, 1, sigma=0, which="LM", tol=1e-10, return_eigenvectors=False)[0]
    print(f"{name}: SciPy {high / low:.9e}, gsm {ours[name]['condition']:.9e}")
    same(name, ours[name]["condition"], high / low, 1e-7)
print(f"{len(E)} tetrahedra, {len(T)} triangles, {len(free)} unknowns")
