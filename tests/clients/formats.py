"""Outside readers on every format that gsm writes.

  formats.py STEM      reads STEM.gsm.json (the manifest) and STEM.22.msh STEM.41.msh STEM.vtu ... beside it
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile

import gmsh
import meshio
import numpy as np
import trimesh

stem = sys.argv[1]
with open(stem + ".gsm.json") as f:
    manifest = json.load(f)
VOLUME = {r["part"]: r["volume"] for r in manifest["regions"]}
AREA = {m["name"]: m["area"] for m in manifest["markers"]}
NAMES = set(VOLUME) | set(AREA)


def close(a, b, tolerance=1e-9):
    assert set(a) == set(b), (sorted(a), sorted(b))
    for name in b:
        assert abs(a[name] - b[name]) <= tolerance * abs(b[name]), (name, a[name], b[name])


def volumes(points, tets):
    p = points[tets]
    return np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) / 6


def areas(points, triangles):
    p = points[triangles]
    return np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1) / 2


def sums(values, tags, names):
    """Sum of the values by name of their tag."""
    out = {}
    for tag in np.unique(tags):
        if tag != 0:
            out[names[int(tag)]] = values[tags == tag].sum()
    return out


def blocks(mesh, kind, key):
    """All cells of a kind and their data, from however many blocks."""
    pairs = [(c.data, mesh.cell_data[key][k]) for k, c in enumerate(mesh.cells) if c.type == kind]
    return np.concatenate([p[0] for p in pairs]), np.concatenate([p[1] for p in pairs])


def check(mesh, region, marker, names3, names2):
    """Volumes and areas by name; all tetrahedra positive."""
    tets, tags = blocks(mesh, "tetra", region)
    v = volumes(mesh.points, tets)
    assert (v > 0).all()
    close(sums(v, tags, names3), VOLUME)
    triangles, tags = blocks(mesh, "triangle", marker)
    close(sums(areas(mesh.points, triangles), tags, names2), AREA)
    return len(mesh.points), len(tets), len(triangles)


def by_dimension(field_data):
    two = {int(v[0]): n for n, v in field_data.items() if int(v[1]) == 2}
    three = {int(v[0]): n for n, v in field_data.items() if int(v[1]) == 3}
    return three, two


def in_comments(path):
    """Names from lines `# region 1 iron` or `comment region 1 iron`."""
    out = {"region": {}, "marker": {}}
    with open(path) as f:
        for line in f:
            w = line.split()
            if len(w) == 4 and w[0] in ("#", "comment") and w[1] in out:
                out[w[1]][int(w[2])] = w[3]
    return out["region"], out["marker"]


def by_gmsh(path):
    """Volumes and areas by physical name, through Gmsh's own reader."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(path)
    tags, x, _ = gmsh.model.mesh.getNodes()
    points = np.zeros((int(tags.max()) + 1, 3))
    points[tags.astype(int)] = x.reshape(-1, 3)
    out = ({}, {})
    for dimension, tag in gmsh.model.getPhysicalGroups():
        name = gmsh.model.getPhysicalName(dimension, tag)
        total = 0.0
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag):
            for _, nodes in zip(*(gmsh.model.mesh.getElements(dimension, entity)[k] for k in (0, 2))):
                cells = nodes.astype(int).reshape(-1, dimension + 1)
                total += (volumes if dimension == 3 else areas)(points, cells).sum()
        out[3 - dimension][name] = total
    count = len(tags)
    gmsh.finalize()
    close(out[0], VOLUME)
    close(out[1], AREA)
    return count


counts = set()
for version in ("22", "41"):
    path = f"{stem}.{version}.msh"
    mesh = meshio.read(path)
    assert set(mesh.field_data) == NAMES
    counts.add(check(mesh, "gmsh:physical", "gmsh:physical", *by_dimension(mesh.field_data)))
    assert by_gmsh(path) == len(mesh.points)

mesh = meshio.read(stem + ".vtu")
counts.add(check(mesh, "region", "marker", *by_dimension(mesh.field_data)))

mesh = meshio.read(stem + ".mesh")
counts.add(check(mesh, "medit:ref", "medit:ref", *in_comments(stem + ".mesh")))
assert len(counts) == 1, counts
nodes, tets, triangles = counts.pop()

mesh = meshio.read(stem + ".ply")
faces, tags = blocks(mesh, "triangle", "marker")
close(sums(areas(mesh.points, faces), tags, in_comments(stem + ".ply")[1]), AREA)

for extension in ("off", "obj"):
    mesh = trimesh.load(f"{stem}.{extension}", process=False, force="mesh")
    assert len(mesh.faces) == triangles, extension
    assert abs(mesh.area / sum(AREA.values()) - 1) < 1e-9
assert in_comments(stem + ".off") == tuple({m[key]: m[name] for m in manifest[table]} for table, key, name in
                                           (("regions", "region", "part"), ("markers", "marker", "name")))

# Groups of the OBJ, by the reader that keeps them.
scene = trimesh.load(stem + ".obj", process=False, split_groups=True, split_object=True, group_material=False)
with open(stem + ".obj") as f:
    groups = {line.split()[1] for line in f if line.startswith("g ")}
assert groups == set(AREA)

scene = trimesh.load(stem + ".stl")
close({name: g.volume for name, g in scene.geometry.items()}, VOLUME)

scene = trimesh.load(stem + ".glb")
parts = {}
for node in scene.graph.nodes_geometry:
    transform, geometry = scene.graph[node]
    g = scene.geometry[geometry].copy()
    name = next(n for n in sorted(VOLUME, key=len, reverse=True) if geometry.startswith(n))
    parts[name] = parts.get(name, 0.0) + g.area * abs(np.linalg.det(transform[:3, :3])) ** (2 / 3)
unit = {"m": 1.0, "mm": 1e-3}[manifest["unit"]]
around = {r: sum(m["area"] for m in manifest["markers"] if r in m["parts"]) * unit ** 2 for r in VOLUME}
close(parts, around, 1e-5)
with open(stem + ".glb", "rb") as f:
    data = f.read()
size = int.from_bytes(data[12:16], "little")
document = json.loads(data[20:20 + size])
assert {n["name"] for n in document["nodes"] if "name" in n} == NAMES

with tempfile.TemporaryDirectory() as work:
    shutil.copy(stem + ".smesh", os.path.join(work, "m.smesh"))
    subprocess.run(["tetgen", "-pAQ", "m.smesh"], cwd=work, check=True, capture_output=True)
    with open(os.path.join(work, "m.1.node")) as f:
        points = np.array([[float(w) for w in line.split()[1:4]] for line in f.readlines()[1:] if line[0] != "#"])
    with open(os.path.join(work, "m.1.ele")) as f:
        rows = np.array([[int(w) for w in line.split()[1:6]] for line in f.readlines()[1:] if line[0] != "#"])
    v = np.abs(volumes(points, rows[:, :4] - 1))
    close(sums(v, rows[:, 4], in_comments(stem + ".smesh")[0]), VOLUME)

print(f"{len(NAMES)} names, {nodes} nodes, {tets} tetrahedra, {triangles} triangles in 10 formats")
