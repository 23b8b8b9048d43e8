#!/usr/bin/env python3
"""surfaces.py [--repeats N]: processor time of gsm's remesher beside Gmsh's and Netgen's surface meshing, in one run, as a table.

gsm remeshes all curved facets (`remesh: Full`) at the deviation that Netgen leaves with 24 elements per circle; the peers mesh with
24 elements per circle (the cone in Gmsh with a least size, without which it fails). Mean of all repeats, one thread each. The bar:
less than both peers. A benchmark, never a gate: exit code 0."""
import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "../..")
DEVIATIONS = {"cone": 0.46, "union_two_differences": 1.64, "cylinders_union_difference": 1.30, "three_cylinders": 1.00,
              "transformer3": 1.15, "machine": 1.02, "team07": 0.88}


def full_scene(name, deviation, folder):
    """A copy of a scene that is remeshed everywhere."""
    text = open(os.path.join(ROOT, "scenes", name + ".ron")).read()
    text = re.sub(r"\n\s*(remesh|max_deviation):[^\n]*", "", text)
    path = os.path.join(folder, name + ".ron")
    with open(path, "w") as file:
        file.write(text.replace("Scene(", f"Scene(\n    remesh: Full,\n    max_deviation: {deviation},", 1))
    return path


def gsm(program, path, folder):
    done = subprocess.run([program, "build", path, "--json", "--threads", "1"], cwd=folder, capture_output=True, check=True)
    result = json.loads(done.stdout)
    return next(t["cpu"] for t in result["timings"] if t["stage"] == "remesh"), (result["quality"] or {"triangles": 0})["triangles"]


def peer(python, script, scene, variant, folder):
    done = subprocess.run([python, script, scene, folder, *variant], cwd=os.path.dirname(script), capture_output=True, text=True,
                          check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith("RESULT ")]
    return json.loads(lines[-1][len("RESULT "):])["surface_cpu_s"] if lines else float("nan")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--gsm", default=os.path.join(ROOT, "target/release/gsm"))
    arguments.add_argument("--peers", default=os.path.join(ROOT, "../shared/peers"))
    arguments.add_argument("--python", default=sys.executable, help="a Python with gmsh and netgen")
    arguments.add_argument("--repeats", type=int, default=5)
    arguments.add_argument("--only", default="")
    options = arguments.parse_args()
    scripts = {name: os.path.abspath(os.path.join(options.peers, f"peer_{name}.py")) for name in ("gmsh", "netgen")}
    print("Processor time in ms.\n\n| scene | triangles | gsm | Gmsh | Netgen | bar |\n|---|--:|--:|--:|--:|---|")
    with tempfile.TemporaryDirectory() as folder:
        for scene, deviation in DEVIATIONS.items():
            if options.only not in scene:
                continue
            path = full_scene(scene, deviation, folder)
            variants = {"gmsh": ["--variant", "c24min" if scene == "cone" else "c24"], "netgen": ["--variant", "c24"]}
            own, gmsh, netgen = [], [], []
            for _ in range(options.repeats):
                own.append(gsm(os.path.abspath(options.gsm), path, folder))
                gmsh.append(peer(options.python, scripts["gmsh"], scene, variants["gmsh"], folder))
                netgen.append(peer(options.python, scripts["netgen"], scene, variants["netgen"], folder))
            # The peers' clock ticks every 10 ms: the least of some tells less than their mean.
            times = [statistics.mean(times) for times in ([t for t, _ in own], gmsh, netgen)]
            slower = [name for name, t in zip(("Gmsh", "Netgen"), times[1:]) if t <= times[0]]
            print(f"| {scene} | {own[0][1]} | " + " | ".join(f"{t * 1e3:.0f}" for t in times)
                  + f" | {'missed: ' + ', '.join(slower) if slower else 'held'} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
