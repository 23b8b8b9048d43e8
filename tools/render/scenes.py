#!/usr/bin/env python3
"""scenes.py FOLDER [SCENE.ron ...]: pictures of scenes before and after remeshing: without it, at interfaces, everywhere.

Writes NAME.png with the three side by side for every scene, those of scenes/ if none is named. Where there is more than one part,
what faces the outside is left out: mostly that is a box of air. For --view and --size see poly_png.py. Needs numpy."""
import argparse
import glob
import json
import os
import subprocess
import tempfile

import numpy as np
import poly_png

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../..")
MARGIN = 20
MODES = ["off", "interfaces", "full"]


def built(program, scene, mode, folder):
    """The .poly of a scene, and the markers to leave out."""
    stem = os.path.join(folder, mode)
    subprocess.run([program, "build", "-q", "--remesh", mode, scene, "-o", stem + ".poly"], check=True)
    with open(stem + ".gsm.json") as file:
        manifest = json.load(file)
    has_air = len(manifest["regions"]) > 1
    return stem + ".poly", {m["marker"] for m in manifest["markers"] if has_air and None in m["parts"]}


def trimmed(picture):
    """A picture without the empty rows above and below."""
    rows = np.flatnonzero((picture < 255).any(axis=(1, 2)))
    return picture[max(rows[0] - MARGIN, 0):rows[-1] + MARGIN]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("folder")
    arguments.add_argument("scenes", nargs="*", default=sorted(glob.glob(os.path.join(ROOT, "scenes/*.ron"))))
    arguments.add_argument("--gsm", default=os.path.join(ROOT, "target/release/gsm"))
    arguments.add_argument("--view", nargs=2, type=float, default=poly_png.VIEW)
    arguments.add_argument("--size", type=int, default=poly_png.SIZE)
    options = arguments.parse_args()
    os.makedirs(options.folder, exist_ok=True)
    for scene in options.scenes:
        with tempfile.TemporaryDirectory() as folder:
            files = [built(os.path.abspath(options.gsm), scene, mode, folder) for mode in MODES]
            pictures = [poly_png.draw(path, options.view, skipped, options.size) for path, skipped in files]
        path = os.path.join(options.folder, os.path.splitext(os.path.basename(scene))[0] + ".png")
        poly_png.write_png(path, trimmed(np.concatenate(pictures, axis=1)))
        print(path, flush=True)


if __name__ == "__main__":
    main()
