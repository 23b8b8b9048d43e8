"""A .poly and its manifest in Python, independent of gsm: reading, exact triangulation of facets, regions' surfaces, OFF.

All signs are exact: coordinates become integers over one power of two. Needs numpy."""
import json
import os
from collections import defaultdict
from fractions import Fraction

import numpy as np


class Fault(Exception):
    """What makes the file no valid complex."""


# ------------------------------------------------------------------ reading
class Plc:
    """V (n, 3); facets [(polygons, hole points, marker)] with vertices from 0; holes; seeds [(point, region)]; manifest."""

    def __init__(self, path):
        rows = _rows(path)
        count = int(next(rows)[0])
        first = None
        self.V = np.empty((count, 3))
        for i in range(count):
            row = next(rows)
            first = int(row[0]) if first is None else first
            self.V[i] = [float(x) for x in row[1:4]]
        head = next(rows)
        self.facets = []
        for _ in range(int(head[0])):
            row = [int(x) for x in next(rows)]
            polygons = []
            for _ in range(row[0]):
                words = next(rows)
                size = int(words[0])
                while len(words) <= size:
                    words = words + next(rows)
                polygons.append([int(x) - first for x in words[1:size + 1]])
            points = [tuple(map(float, next(rows)[1:4])) for _ in range(row[1] if len(row) > 1 else 0)]
            self.facets.append((polygons, points, row[2] if len(row) > 2 else 0))
        self.holes = [tuple(map(float, next(rows)[1:4])) for _ in range(int(next(rows)[0]))]
        words = next(rows, ["0"])
        seeds = [next(rows) for _ in range(int(words[0]))]
        self.seeds = [(tuple(map(float, s[1:4])), int(float(s[4]))) for s in seeds]
        side = path[:-len(".poly")] + ".gsm.json"
        self.manifest = json.load(open(side)) if os.path.exists(side) else None

    def triangles(self):
        """All facets cut into triangles: T (m, 3), the facet of each, its normal that of the facet's outer polygon."""
        triangles, owner = [], []
        for k, (polygons, holes, _) in enumerate(self.facets):
            try:
                cut = triangulate(self.V, polygons, holes)
            except Fault as fault:
                raise Fault(f"facet {k + 1} (marker {self.facets[k][2]}): {fault}") from None
            triangles += cut
            owner += [k] * len(cut)
        return np.array(triangles, np.int64).reshape(-1, 3), np.array(owner, np.int64)

    def surfaces(self, T, owner):
        """Per part name its surface: the triangles of its interfaces, turned so that normals point outwards."""
        sides = {m["marker"]: m["parts"] for m in self.manifest["markers"]}
        marker = np.array([f[2] for f in self.facets])[owner]
        unknown = set(marker.tolist()) - set(sides)
        if unknown:
            raise Fault(f"markers without entry in the manifest: {sorted(unknown)}")
        names = [region["part"] for region in self.manifest["regions"]]
        return {name: outwards(self.V, T[np.isin(marker, [m for m, pair in sides.items() if name in pair])]) for name in names}


def _rows(path):
    with open(path) as file:
        for line in file:
            words = line.split("#", 1)[0].split()
            if words:
                yield words


# ------------------------------------------------------------------ exact arithmetic
def integers(points):
    """Float tuples to integer tuples with a common power-of-two scale."""
    ratios = [[float(x).as_integer_ratio() for x in p] for p in points]
    scale = max((q for p in ratios for _, q in p), default=1)
    return [tuple(n * (scale // q) for n, q in p) for p in ratios]


def sign(x):
    return (x > 0) - (x < 0)


def turn(a, b, c):
    return sign((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def volume(V, T):
    """Enclosed volume, as exact rational number rounded once."""
    used, inverse = np.unique(T, return_inverse=True)
    ratios = [float(x).as_integer_ratio() for x in V[used].ravel()]
    scale = max((q for _, q in ratios), default=1)
    P = np.array([n * (scale // q) for n, q in ratios], dtype=object).reshape(-1, 3)
    a, b, c = (P[inverse.reshape(-1, 3)[:, k]] for k in range(3))
    total = (a[:, 0] * (b[:, 1] * c[:, 2] - b[:, 2] * c[:, 1]) - a[:, 1] * (b[:, 0] * c[:, 2] - b[:, 2] * c[:, 0])
             + a[:, 2] * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])).sum()
    return float(Fraction(int(total), 6 * scale ** 3))


def area(V, T):
    P = V[T]
    return float(np.linalg.norm(np.cross(P[:, 1] - P[:, 0], P[:, 2] - P[:, 0]), axis=1).sum() / 2)


def det(a, b, c, d):
    u, v, w = ([p[i] - d[i] for i in range(3)] for p in (a, b, c))
    return (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]))


# ------------------------------------------------------------------ facets to triangles
def triangulate(V, polygons, hole_points):
    """Triangles of one facet over its own vertices; none is flat in the dominant projection.

    Constrained Delaunay triangulation of all polygons' edges, as TetGen makes it: a sweep makes a triangulation of the points, flips
    put the edges in and make it Delaunay; a needle would leave the polygon's plane by rounding where it is not one. The inside is what an odd number of polygon edges parts from the outside, less what holds a hole point."""
    outer = max((p for p in polygons if len(p) > 2), key=lambda p: np.linalg.norm(_vector_area(V[p])), default=None)
    if outer is None:
        raise Fault("no polygon")
    if len(polygons) == 1 and len(outer) == 3:
        return [list(outer)]
    normal = _vector_area(V[outer])
    axis = int(np.argmax(np.abs(normal)))
    keep = [(axis + 1) % 3, (axis + 2) % 3]
    vertices = sorted({v for p in polygons for v in p})
    flat = integers(V[vertices][:, keep].tolist() + [[p[k] for k in keep] for p in hole_points])
    points, holes = flat[:len(vertices)], flat[len(vertices):]
    local = {v: i for i, v in enumerate(vertices)}
    edges = defaultdict(int)
    for polygon in polygons:
        loop = [local[v] for v in polygon]
        if len(loop) == 2:
            edges[min(loop), max(loop)] += 2
        elif len(loop) > 2:
            for a, b in zip(loop, loop[1:] + loop[:1]):
                edges[min(a, b), max(a, b)] += 1
    mesh = _sweep(points)
    for a, b in edges:
        _force(mesh, points, edges, a, b)
    _make_delaunay(mesh, points, edges)
    inside = _inside(mesh, edges)
    for hole in holes:
        at = next((t for t in inside if all(turn(points[t[i]], points[t[i - 2]], hole) >= 0 for i in range(3))), None)
        if at is not None:
            inside = inside - _component(mesh, edges, at)
    flip = normal[axis] < 0
    return [[vertices[i] for i in (t[::-1] if flip else t)] for t in sorted(inside)]


def _vector_area(P):
    Q = P - P[0]
    return np.cross(Q[1:-1], Q[2:]).sum(0)


def _canonical(a, b, c):
    return min((a, b, c), (b, c, a), (c, a, b))


def _sweep(points):
    """Some triangulation of the points' hull, as {directed edge: apex to its left}."""
    order = sorted(range(len(points)), key=lambda i: points[i])
    for i, j in zip(order, order[1:]):
        if points[i] == points[j]:
            raise Fault("two vertices in one place of the projection")
    mesh = {}

    def add(a, b, c):
        mesh[a, b], mesh[b, c], mesh[c, a] = c, a, b

    k = 2
    while k < len(order) and turn(points[order[0]], points[order[1]], points[order[k]]) == 0:
        k += 1
    if k == len(order):
        raise Fault("all vertices on one line")
    line, apex = order[:k], order[k]
    if turn(points[line[0]], points[line[1]], points[apex]) < 0:
        line = line[::-1]
    for a, b in zip(line, line[1:]):
        add(a, b, apex)
    hull = line + [apex]  # counter-clockwise
    for p in order[k + 1:]:
        visible = [turn(points[a], points[b], points[p]) < 0 for a, b in zip(hull, hull[1:] + hull[:1])]
        start = next(i for i in range(len(hull)) if visible[i] and not visible[i - 1])
        hull, visible = hull[start:] + hull[:start], visible[start:] + visible[:start]
        seen = visible.index(False)
        for a, b in zip(hull[:seen + 1], hull[1:seen + 1] + hull[:1]) if seen == len(hull) else zip(hull[:seen], hull[1:seen + 1]):
            add(b, a, p)
        hull = [hull[0], p] + hull[seen:]
    return mesh


def _force(mesh, points, edges, a, b):
    """Flips until the edge a-b is there."""
    if (a, b) in mesh or (b, a) in mesh:
        return
    crossing = _crossed(mesh, points, a, b)
    patience = 8 * (len(crossing) + 2) ** 2
    while crossing:
        patience -= 1
        if patience < 0:
            raise Fault("an edge cannot be put in")
        u, v = crossing.pop(0)
        if (min(u, v), max(u, v)) in edges:
            raise Fault("polygon edges cross")
        c, d = mesh[u, v], mesh[v, u]
        if turn(points[d], points[v], points[c]) <= 0 or turn(points[c], points[u], points[d]) <= 0:
            crossing.append((u, v))
            continue
        _flip(mesh, u, v)
        if {c, d} != {a, b} and turn(points[a], points[b], points[c]) * turn(points[a], points[b], points[d]) < 0:
            crossing.append((c, d))


def _flip(mesh, u, v):
    """Replaces the edge u-v by the other diagonal of its two triangles."""
    c, d = mesh.pop((u, v)), mesh.pop((v, u))
    mesh[c, d], mesh[d, v], mesh[v, c] = v, c, d
    mesh[d, c], mesh[c, u], mesh[u, d] = u, d, c


def _make_delaunay(mesh, points, edges):
    stack = [(u, v) for u, v in mesh if u < v]
    while stack:
        u, v = stack.pop()
        if (u, v) not in mesh or (v, u) not in mesh or (min(u, v), max(u, v)) in edges:
            continue
        c, d = mesh[u, v], mesh[v, u]
        if _in_circle(points[u], points[v], points[c], points[d]):
            _flip(mesh, u, v)
            stack += [(v, c), (c, u), (u, d), (d, v)]


def _in_circle(a, b, c, d):
    """Whether d lies strictly inside the circle of a, b, c, which turn left; then the diagonals can be exchanged."""
    rows = [(p[0] - d[0], p[1] - d[1]) for p in (a, b, c)]
    (ax, ay, aw), (bx, by, bw), (cx, cy, cw) = ((x, y, x * x + y * y) for x, y in rows)
    return ax * (by * cw - bw * cy) - ay * (bx * cw - bw * cx) + aw * (bx * cy - by * cx) > 0


def _crossed(mesh, points, a, b):
    """Edges that the segment a-b crosses, in order from a."""
    for (u, v), w in mesh.items():
        if w == a and turn(points[a], points[u], points[b]) >= 0 and turn(points[a], points[v], points[b]) <= 0:
            break
    else:
        raise Fault("an edge leaves the hull")
    crossed = []
    while True:
        for c in (u, v):
            if c != b and turn(points[a], points[b], points[c]) == 0:
                raise Fault("a vertex lies on an edge that does not list it")
        crossed.append((u, v))
        w = mesh[v, u]
        if w == b:
            return crossed
        side = turn(points[a], points[b], points[w])
        if side == 0:
            raise Fault("a vertex lies on an edge that does not list it")
        u, v = (w, v) if side == turn(points[a], points[b], points[u]) else (u, w)


def _component(mesh, edges, start):
    found, stack = {start}, [start]
    while stack:
        t = stack.pop()
        for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0])):
            if (min(a, b), max(a, b)) not in edges and (b, a) in mesh:
                n = _canonical(b, a, mesh[b, a])
                if n not in found:
                    found.add(n)
                    stack.append(n)
    return found


def _inside(mesh, edges):
    """Triangles that an odd number of polygon edges parts from the outside."""
    parity, stack = {}, []
    for (a, b), c in mesh.items():
        if (b, a) not in mesh:
            t = _canonical(a, b, c)
            if t not in parity:
                parity[t] = edges.get((min(a, b), max(a, b)), 0) % 2
                stack.append(t)
    while stack:
        t = stack.pop()
        for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0])):
            if (b, a) in mesh:
                n = _canonical(b, a, mesh[b, a])
                p = (parity[t] + edges.get((min(a, b), max(a, b)), 0)) % 2
                if n not in parity:
                    parity[n] = p
                    stack.append(n)
    return {t for t, p in parity.items() if p}


# ------------------------------------------------------------------ exact contact outside shared cells
def contacts(V, T):
    """Pairs of triangles that meet anywhere but in whole shared vertices and edges."""
    lo, hi = V[T].min(1), V[T].max(1)
    order = np.argsort(lo[:, 0], kind="stable")
    found, active = [], np.empty(0, np.int64)
    for t in order:
        active = active[hi[active, 0] >= lo[t, 0]]
        near = active[((lo[active] <= hi[t]) & (lo[t] <= hi[active])).all(1)]
        found += [(int(s), int(t)) for s in near if _meet(V, T[s].tolist(), T[t].tolist())]
        active = np.append(active, t)
    return found


def _meet(V, f, g):
    shared = [v for v in f if v in g]
    P = integers(V[f].tolist() + V[g].tolist())
    A, B = P[:3], P[3:]
    if len(shared) == 3:
        return True
    if len(shared) == 2:
        c, d = (next(P[o + k] for k in range(3) if t[k] not in shared) for o, t in ((0, f), (3, g)))
        a, b = (A[f.index(v)] for v in shared)
        if det(a, b, c, d):
            return False
        n, m = (_cross(_minus(b, a), _minus(x, a)) for x in (c, d))
        return sum(x * y for x, y in zip(n, m)) > 0
    if len(shared) == 1:
        i, j = f.index(shared[0]), g.index(shared[0])
        return (_pierces(A[i - 2], A[i - 1], B) or _pierces(B[j - 2], B[j - 1], A))
    return any(_pierces(X[k - 1], X[k], Y) for X, Y in ((A, B), (B, A)) for k in range(3))


def _minus(a, b):
    return [x - y for x, y in zip(a, b)]


def _cross(u, v):
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


def _pierces(p, q, t):
    """Whether the closed segment and the closed triangle have a common point."""
    sp, sq = sign(det(*t, p)), sign(det(*t, q))
    if sp * sq > 0:
        return False
    if sp or sq:
        s = [sign(det(p, q, t[k - 1], t[k])) for k in range(3)]
        return min(s) >= 0 or max(s) <= 0
    n = _cross(_minus(t[1], t[0]), _minus(t[2], t[0]))
    k = max(range(3), key=lambda i: abs(n[i]))
    a, b, c, p, q = ([x for i, x in enumerate(v) if i != k] for v in (*t, p, q))
    tri = [a, b, c]

    def holds(x):
        s = [turn(tri[i - 1], tri[i], x) for i in range(3)]
        return min(s) >= 0 or max(s) <= 0

    def on(u, v, x):
        return turn(u, v, x) == 0 and min(u[0], v[0]) <= x[0] <= max(u[0], v[0]) and min(u[1], v[1]) <= x[1] <= max(u[1], v[1])

    def cross(u, v):
        d = [turn(u, v, p), turn(u, v, q), turn(p, q, u), turn(p, q, v)]
        return (d[0] * d[1] < 0 and d[2] * d[3] < 0) or on(u, v, p) or on(u, v, q) or on(p, q, u) or on(p, q, v)

    return holds(p) or holds(q) or any(cross(tri[i - 1], tri[i]) for i in range(3))


# ------------------------------------------------------------------ orientation, which a .poly does not tell
def outwards(V, T):
    """The triangles of a closed surface, turned outwards: alike across edges of two triangles, each such piece by one ray."""
    at = defaultdict(list)
    for t, (a, b, c) in enumerate(T.tolist()):
        for u, v in ((a, b), (b, c), (c, a)):
            at[min(u, v), max(u, v)].append((t, u < v))
    near = defaultdict(list)
    for uses in at.values():
        if len(uses) == 2:
            (s, i), (t, j) = uses
            near[s].append((t, i == j))
            near[t].append((s, i == j))
    flip = [None] * len(T)
    for start in range(len(T)):
        if flip[start] is not None:
            continue
        flip[start], piece = False, [start]
        for s in piece:
            for t, is_against in near[s]:
                turned = flip[s] != is_against
                if flip[t] is None:
                    flip[t] = turned
                    piece.append(t)
                elif flip[t] != turned:
                    raise Fault(f"a surface with one side at {V[T[t]].mean(0).tolist()}")
        if _looks_inside(V, T, max(piece, key=lambda t: area(V, T[t:t + 1])) if len(piece) < 1000 else start, flip):
            for t in piece:
                flip[t] = not flip[t]
    flip = np.array(flip, bool)
    return np.where(flip[:, None], T[:, ::-1], T)


# How near a ray may pass a triangle's edge, in barycentric coordinates, before another ray is taken.
EDGE_MARGIN = 1e-7


def _looks_inside(V, T, start, flip):
    """Whether the (turned) normal of a triangle points into what the surface encloses: an odd number of crossings ahead."""
    p = V[T[start]]
    normal = np.cross(p[1] - p[0], p[2] - p[0]) * (-1 if flip[start] else 1)
    normal /= np.linalg.norm(normal)
    rng = np.random.default_rng(1)
    others = np.delete(T, start, axis=0)
    a, u, v = V[others[:, 0]], V[others[:, 1]] - V[others[:, 0]], V[others[:, 2]] - V[others[:, 0]]
    for _ in range(100):
        direction = normal + 0.3 * rng.uniform(-1, 1, 3)
        origin = rng.dirichlet((3, 3, 3)) @ p
        with np.errstate(all="ignore"):  # Moeller and Trumbore 1997
            h = np.cross(direction, v)
            d = (u * h).sum(1)
            w = origin - a
            x = (w * h).sum(1) / d
            q = np.cross(w, u)
            y = (q @ direction) / d
            ahead = (v * q).sum(1) / d
            depth = np.nan_to_num(np.min([x, y, 1 - x - y], axis=0), nan=-1.0)
        if not (np.abs(depth[ahead > 0]) < EDGE_MARGIN).any():
            return int(((depth > 0) & (ahead > 0)).sum()) % 2 == 1
    raise Fault("no ray misses all edges")


# ------------------------------------------------------------------ closedness and writing
def open_edges(T):
    """Undirected edges whose signed incidence is not 0: where the surface is open or turned inside out."""
    count = defaultdict(int)
    for a, b in np.concatenate([T[:, [0, 1]], T[:, [1, 2]], T[:, [2, 0]]]).tolist():
        count[(a, b) if a < b else (b, a)] += 1 if a < b else -1
    return [e for e, n in count.items() if n]


def write_off(path, V, T):
    used, inverse = np.unique(T, return_inverse=True)
    with open(path, "w") as file:
        file.write(f"OFF\n{len(used)} {len(T)} 0\n")
        file.writelines("%r %r %r\n" % tuple(map(float, v)) for v in V[used])
        file.writelines("3 %d %d %d\n" % tuple(t) for t in inverse.reshape(-1, 3))
