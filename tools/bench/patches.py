#!/usr/bin/env python3
"""patches.py: how far remeshed surfaces are from the exact ones with fitted patches (`patches: BSpline`), beside analytic supports.

For every scene with curved surfaces: `remesh: Interfaces`, and `Full` at the deviations of surfaces.py; then with `triangulated`
primitives, as the thesis has them. Deviation in the scene's unit: distance of 15 points of each triangular facet to the exact
surface, by the peers' distance functions. Processor time of the remesher in ms,
one run. A measurement, never a gate: exit code 0. Needs numpy and ../shared/peers."""
import argparse
import json
import os
import re
import subprocess
import sys
import tempfile

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "../..")
sys.path[:0] = [HERE, os.path.join(HERE, "..")]
import plc  # noqa: E402
import surfaces  # noqa: E402

SCENES = [*surfaces.DEVIATIONS, "sphere_grid"]
# sphere_grid has radius 30; an edge of 24 to a circle is some 0.3 off its surface.
DEVIATIONS = {**surfaces.DEVIATIONS, "sphere_grid": 0.5}
# Barycentric places of the 15 points.
PLACES = np.array([(i, j, 4 - i - j) for i in range(5) for j in range(5 - i)]) / 4


def run(program, name, more, folder):
    """The complex of a scene with other options, and what gsm reports of it."""
    text = open(os.path.join(ROOT, "scenes", name + ".ron")).read()
    text = re.sub(r"\n\s*(remesh|max_deviation|patches):[^\n]*", "", text)
    with open(os.path.join(folder, name + ".ron"), "w") as out:
        out.write(text.replace("Scene(", f"Scene(\n    {more}", 1))
    done = subprocess.run([program, "build", name + ".ron", "--json", "--threads", "1"], cwd=folder, capture_output=True, check=True)
    return plc.Plc(os.path.join(folder, name + ".poly")), json.loads(done.stdout)


def deviation(file, scene, distance):
    """Largest and root mean square distance of the triangular facets from the exact surfaces; nan if there are none."""
    own = [p[0] for p, holes, _ in file.facets if len(p) == 1 and len(p[0]) == 3 and not holes]
    if not own:
        return float("nan"), float("nan")
    corners = file.V[np.array(own)]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    points = np.einsum("bk,tkd->tbd", PLACES, corners)
    far = distance(scene, points.reshape(-1, 3)).reshape(points.shape[:2])
    return far.max(), np.sqrt(((far**2).mean(1) * area).sum() / area.sum())


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--gsm", default=os.path.join(ROOT, "target/release/gsm"))
    arguments.add_argument("--peers", default=os.path.join(ROOT, "../shared/peers"))
    arguments.add_argument("--only", default="")
    options = arguments.parse_args()
    sys.path.insert(0, options.peers)
    import scenes

    print("| scene | remesh | primitives | patches | triangles | least angle | below 30 % | above 40 % | deviation | rms | ms |\n"
          "|---|---|---|---|--:|--:|--:|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as folder:
        for name in SCENES:
            if options.only not in name:
                continue
            exact = scenes.get("sphere_grid3" if name == "sphere_grid" else name)
            for mode in ("Interfaces", "Full"):
                bound = f" max_deviation: {DEVIATIONS[name]}," if mode == "Full" else ""
                for cut in ("false", "true"):
                    for patches in ("Analytic", "BSpline"):
                        more = f"remesh: {mode}, patches: {patches}, triangulated: {cut},{bound}"
                        file, report = run(os.path.abspath(options.gsm), name, more, folder)
                        most, mean = deviation(file, exact, scenes.distance)
                        quality = report["quality"] or {"triangles": 0, "min_angle": 0, "below_30": 0, "above_40": 0}
                        time = next(t["cpu"] for t in report["timings"] if t["stage"] == "remesh")
                        print(f"| {name} | {mode} | {'triangulated' if cut == 'true' else ''} | {patches} | {quality['triangles']} "
                              f"| {quality['min_angle']:.1f} | {100 * quality['below_30']:.1f} | {100 * quality['above_40']:.1f} "
                              f"| {most:.3f} | {mean:.3f} | {time * 1e3:.0f} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
