#!/usr/bin/env python3
"""Pictures of .poly files side by side: lit facets, edges drawn, sharp triangles marked.

  poly_png.py OUT.png FILE.poly [FILE.poly ...] [--view AZIMUTH ELEVATION] [--skip MARKER ...] [--size PIXELS]

Triangular facets below 30 degrees are red, below 40 orange, others blue; polygons are grey. Needs numpy alone: every facet is
filled by the even-odd rule into a depth buffer, holes included.
"""
import argparse
import struct
import zlib
import numpy as np

# Azimuth and elevation in degrees, and pixels.
VIEW = (-50.0, 28.0)
SIZE = 900


def read_poly(path):
    """Vertices and facets; a facet is (list of loops, marker)."""
    lines = (line.split("#", 1)[0].split() for line in open(path))
    lines = (words for words in lines if words)
    count = int(next(lines)[0])
    rows = [next(lines) for _ in range(count)]
    slot = {int(r[0]): k for k, r in enumerate(rows)}
    points = np.array([[float(x) for x in r[1:4]] for r in rows])
    facets = []
    for _ in range(int(next(lines)[0])):
        head = [int(x) for x in next(lines)]
        loops = []
        for _ in range(head[0]):
            row = [int(x) for x in next(lines)]
            while len(row) < row[0] + 1:
                row += [int(x) for x in next(lines)]
            loops.append([slot[i] for i in row[1:]])
        for _ in range(head[1] if len(head) > 1 else 0):
            next(lines)
        facets.append((loops, head[2] if len(head) > 2 else 0))
    return points, facets


def smallest_angle(t):
    best = 180.0
    for k in range(3):
        u, v = t[(k + 1) % 3] - t[k], t[(k + 2) % 3] - t[k]
        best = min(best, np.degrees(np.arctan2(np.linalg.norm(np.cross(u, v)), u @ v)))
    return best


def color_of(corners, loops):
    if len(loops) > 1 or len(loops[0]) != 3:
        return np.array([190.0, 190.0, 195.0])
    angle = smallest_angle(corners)
    return np.array([230.0, 50, 50] if angle < 30 else [255.0, 165, 50] if angle < 40 else [120.0, 170, 235])


class Canvas:
    def __init__(self, size):
        self.size = size
        self.color = np.full((size, size, 3), 255.0)
        self.depth = np.full((size, size), -np.inf)

    def fill(self, loops, normal, color):
        """A planar polygon with holes; corners are (x, y, depth) in pixels."""
        corners = np.concatenate(loops)
        low = np.maximum(np.floor(corners[:, :2].min(0)).astype(int), 0)
        high = np.minimum(np.ceil(corners[:, :2].max(0)).astype(int) + 1, self.size)
        if (high <= low).any() or abs(normal[2]) < 1e-9:
            return
        x, y = np.meshgrid(np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1]) + 0.5)
        inside = np.zeros(x.shape, bool)
        for loop in loops:
            for p, q in zip(loop, np.roll(loop, -1, 0)):
                if p[1] != q[1]:
                    across = (y > min(p[1], q[1])) & (y <= max(p[1], q[1]))
                    inside ^= across & (x < p[0] + (y - p[1]) * (q[0] - p[0]) / (q[1] - p[1]))
        o = corners[0]
        depth = o[2] - ((x - o[0]) * normal[0] + (y - o[1]) * normal[1]) / normal[2]
        part = np.s_[low[1]:high[1], low[0]:high[0]]
        inside &= depth > self.depth[part]
        self.depth[part][inside] = depth[inside]
        self.color[part][inside] = color

    def line(self, p, q, bias):
        n = int(np.abs(q - p)[:2].max() * 1.5) + 2
        at = p + (q - p) * np.linspace(0, 1, n)[:, None]
        x, y = at[:, 0].astype(int), at[:, 1].astype(int)
        ok = (x >= 0) & (y >= 0) & (x < self.size) & (y < self.size)
        x, y, z = x[ok], y[ok], at[ok, 2] + bias
        seen = z >= self.depth[y, x]
        self.color[y[seen], x[seen]] = 25


def draw(path, view, skip, size):
    points, facets = read_poly(path)
    facets = [f for f in facets if f[1] not in skip]
    azimuth, elevation = np.radians(view)
    eye = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    turned = points @ np.stack([right, -np.cross(eye, right), eye], 1)
    used = turned[sorted({i for loops, _ in facets for loop in loops for i in loop})]
    low, extent = used.min(0), np.ptp(used[:, :2], axis=0).max()
    turned = (turned - low) * (0.94 * size / extent) + 0.03 * size
    canvas = Canvas(size)
    for loops, _ in facets:
        shapes = [turned[loop] for loop in loops]
        normal = sum(np.cross(s - s[0], np.roll(s, -1, 0) - s[0]).sum(0) for s in shapes)
        light = abs(normal[2]) / max(np.linalg.norm(normal), 1e-300)
        canvas.fill(shapes, normal, color_of(points[loops[0]], loops) * (0.4 + 0.6 * light))
    for loops, _ in facets:
        for loop in loops:
            for i, j in zip(loop, loop[1:] + loop[:1]):
                canvas.line(turned[i], turned[j], 0.006 * size)
    return canvas.color


def write_png(path, pixels):
    height, width, _ = pixels.shape
    raw = np.zeros((height, 1 + 3 * width), np.uint8)
    raw[:, 1:] = pixels.clip(0, 255).astype(np.uint8).reshape(height, -1)

    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    with open(path, "wb") as f:
        f.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)))
        f.write(chunk(b"IDAT", zlib.compress(raw.tobytes(), 6)) + chunk(b"IEND", b""))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("files", nargs="+")
    parser.add_argument("--view", nargs=2, type=float, default=VIEW)
    parser.add_argument("--skip", nargs="*", type=int, default=[], help="markers to leave out (the air box)")
    parser.add_argument("--size", type=int, default=SIZE)
    a = parser.parse_args()
    write_png(a.out, np.concatenate([draw(f, a.view, set(a.skip), a.size) for f in a.files], axis=1))


if __name__ == "__main__":
    main()
