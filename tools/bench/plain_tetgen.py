#!/usr/bin/env python3
"""plain_tetgen.py [--scenes N] [--keep FOLDER]: how often plain TetGen (-pq2.0A) dies, or does not end, on freely turned
bodies that overlap.

TetGen 1.5 aborts on some valid complexes, mostly askew ones; `gsm mesh` makes further attempts then, whoever runs TetGen does not.
Each scene has 2 to 5 bodies in a box, every one turned about an axis of its own, those later in the list taking the place of the
earlier ones. The same scenes in every run; 4 orders of the vertices in each mode. Needs numpy and tetgen."""
import argparse
import os
import random
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "../..")
sys.path[:0] = [HERE, os.path.join(HERE, "..")]
import plc  # noqa: E402
import tetrahedra  # noqa: E402

MODES = ["Off", "Interfaces", "Full"]
ORDERS = 4
# Seconds after which a run counts as dead: these take less than one.
LIMIT = 60
SOLIDS = [
    "Block(size: ({a:.1f}, {b:.1f}, {c:.1f}), center: (0, 0, 0))",
    "Cylinder(radius: {a:.1f}, height: {d:.1f})",
    "Frustum(bottom_radius: {b:.1f}, top_radius: {a:.1f}, height: {c:.1f})",
    "Tube(outer_radius: {b:.1f}, inner_radius: {a:.1f}, height: {c:.1f})",
    "Sphere(radius: {a:.1f})",
]


def scene(seed, mode):
    """A scene of freely turned bodies."""
    rng = random.Random(seed)
    parts = []
    for k in range(rng.randint(2, 5)):
        a = rng.uniform(4, 9)
        sizes = {"a": a, "b": a + rng.uniform(2, 6), "c": rng.uniform(10, 30), "d": rng.uniform(20, 50)}
        axis, place = ([rng.uniform(-1, 1) * size for _ in range(3)] for size in (1, 12))
        solid = rng.choice(SOLIDS).format(**sizes)
        turned = f"Rotate(axis: ({axis[0]:.3f}, {axis[1]:.3f}, {axis[2]:.3f}), angle: {rng.uniform(0, 180):.3f}, solid: {solid})"
        parts.append(f'Part(name: "body{k}", solid: Translate(by: ({place[0]:.2f}, {place[1]:.2f}, {place[2]:.2f}), solid: {turned}))')
    air = 'Part(name: "air", solid: Block(size: (160, 160, 160), center: (0, 0, 0)))'
    return f'Scene(\n    units: "mm",\n    remesh: {mode},\n    parts: [\n        ' + ",\n        ".join([air, *parts]) + ",\n    ],\n)\n"


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--gsm", default=os.path.join(ROOT, "target/release/gsm"))
    arguments.add_argument("--scenes", type=int, default=18)
    arguments.add_argument("--keep", help="a folder for the scenes on which TetGen dies")
    options = arguments.parse_args()
    deaths = {mode: [] for mode in MODES}
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(options.scenes):
            for mode in MODES:
                with open(os.path.join(folder, "askew.ron"), "w") as out:
                    out.write(scene(seed, mode))
                subprocess.run([os.path.abspath(options.gsm), "build", "-q", "askew.ron"], cwd=folder, check=True)
                file = plc.Plc(os.path.join(folder, "askew.poly"))
                order, rng = list(range(len(file.V))), random.Random(1)
                for _ in range(ORDERS):
                    try:
                        tetrahedra.count(folder, tetrahedra.reordered(file, order), LIMIT)
                    except (subprocess.CalledProcessError, subprocess.TimeoutExpired):
                        deaths[mode].append(seed)
                    rng.shuffle(order)
            if options.keep and any(seed in seeds for seeds in deaths.values()):
                with open(os.path.join(options.keep, f"askew{seed}.ron"), "w") as out:
                    out.write(scene(seed, MODES[0]))
    print("| remesh | runs | deaths | scenes |\n|---|--:|--:|---|")
    for mode, seeds in deaths.items():
        print(f"| {mode} | {ORDERS * options.scenes} | {len(seeds)} | {', '.join(map(str, sorted(set(seeds))))} |")


if __name__ == "__main__":
    main()
