#!/usr/bin/env python3
"""tetrahedra.py: number of tetrahedra that TetGen needs for gsm's complexes at ratio 2.0, beside the leanest peers, as a table.

Median over 7 orders of the vertices (that of gsm and 6 random ones): TetGen's result depends on the order by some per cent.
Without remeshing, or with --remesh Interfaces or Full. Exit code 1 if a bar is missed. Needs numpy and tetgen."""
import argparse
import os
import random
import statistics
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "../..")
sys.path.insert(0, os.path.join(HERE, ".."))
import plc  # noqa: E402

# The leanest peers at this chord error; the last without its air and coils on top.
BARS = {
    "prism_holes": 66,
    "union_two_differences": 7672,
    "cylinders_union_difference": 4438,
    "three_cylinders": 2465,
    "transformer3": 34600,
    "machine": 30300,
    "team07": 8650,
    "planar_transformer": 6800,
}
ORDERS = 7


def planar_transformer():
    """transformer3 without air and high-voltage coils."""
    with open(os.path.join(ROOT, "scenes/transformer3.ron")) as file:
        parts = file.read().split("        Part(")
    keep = [p for p in parts[1:] if p.lstrip().startswith(('name: "E"', 'name: "I"', 'name: "LV"'))]
    assert len(keep) == 3
    keep = [p.split("\n    ],\n)")[0].rsplit("// LV1", 1)[0] for p in keep]
    return parts[0] + "".join("        Part(" + p for p in keep) + "\n    ],\n)\n"


def reordered(file, order):
    """The .poly of a Plc with its vertices in another order."""
    new = {old: k + 1 for k, old in enumerate(order)}
    lines = [f"{len(order)} 3 0 0"] + ["%d %r %r %r" % (k + 1, *map(float, file.V[old])) for k, old in enumerate(order)]
    lines.append(f"{len(file.facets)} 1")
    for polygons, holes, marker in file.facets:
        lines.append(f"{len(polygons)} {len(holes)} {marker}")
        lines += [f"{len(p)} {' '.join(str(new[v]) for v in p)}" for p in polygons]
        lines += ["%d %r %r %r" % (k + 1, *h) for k, h in enumerate(holes)]
    lines.append(str(len(file.holes)))
    lines += ["%d %r %r %r" % (k + 1, *h) for k, h in enumerate(file.holes)]
    lines.append(str(len(file.seeds)))
    lines += ["%d %r %r %r %d" % (k + 1, *p, region) for k, (p, region) in enumerate(file.seeds)]
    return "\n".join(lines) + "\n"


def count(folder, text, limit=None):
    """The number of tetrahedra that TetGen makes of a .poly, in so many seconds at most."""
    with open(os.path.join(folder, "order.poly"), "w") as out:
        out.write(text)
    subprocess.run(["tetgen", "-pq2.0AQ", "order.poly"], cwd=folder, check=True, capture_output=True, timeout=limit)
    with open(os.path.join(folder, "order.1.ele")) as file:
        return int(file.readline().split()[0])


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--gsm", default=os.path.join(ROOT, "target/release/gsm"))
    arguments.add_argument("--remesh", choices=["Off", "Interfaces", "Full"], default="Off")
    options = arguments.parse_args()
    missed = 0
    print("| scene | median | least | most | bar | |\n|---|--:|--:|--:|--:|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name, bar in BARS.items():
            path = os.path.join(ROOT, "scenes", name + ".ron")
            text = planar_transformer() if name == "planar_transformer" else open(path).read()
            with open(os.path.join(folder, name + ".ron"), "w") as out:
                out.write(text.replace("Scene(", f"Scene(\n    remesh: {options.remesh},", 1) if "remesh" not in text else text)
            subprocess.run([os.path.abspath(options.gsm), "build", "-q", name + ".ron"], cwd=folder, check=True)
            file = plc.Plc(os.path.join(folder, name + ".poly"))
            order, rng, counts = list(range(len(file.V))), random.Random(1), []
            for _ in range(ORDERS):
                counts.append(count(folder, reordered(file, order)))
                rng.shuffle(order)
            median = int(statistics.median(counts))
            missed += median > bar
            print(f"| {name} | {median} | {min(counts)} | {max(counts)} | {bar} | {'missed' if median > bar else 'held'} |", flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
