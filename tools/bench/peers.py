#!/usr/bin/env python3
"""peers.py [--repeats N]: processor time of gsm beside Gmsh's fragments and Manifold's Booleans, in one run, as a table.

gsm's geometry is what `--json` says of the stages from the scene to the B-rep (a new process each time, mean of all repeats), as is
the remesher's time with the mode of the scene; its process is the processor time of the whole program, files written included.
Peers: peer_geometry.py. Bars: ten times less than Gmsh on transformer3, machine and sphere_grid 4 to 6; no more than Manifold
where it needs over 3 ms for solids that it can do; 15 ms for the whole process on scenes 1 to 8. A benchmark, never a gate: exit
code 0."""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "../..")
SCENES = ["prism_holes", "cone", "union_two_differences", "cylinders_union_difference", "three_cylinders", "transformer3", "machine",
          "team07"] + [f"sphere_grid{n}" for n in range(2, 7)]
AFTER_BREP = {"remesh", "position", "plc", "measure", "write"}
GMSH_FACTOR, MANIFOLD_FLOOR, PROCESS_BAR = 10, 3e-3, 15e-3
# Manifold has no shared interfaces: only what has none, or parts that do not touch, is the same task.
SAME_TASK = {"union_two_differences", "cylinders_union_difference", "three_cylinders", "team07"} | {f"sphere_grid{n}" for n in range(2, 7)}


def gsm(program, scene, repeats, threads):
    name, arguments = scene, ["--threads", str(threads)]
    if scene.startswith("sphere_grid"):
        name, arguments = "sphere_grid", arguments + ["--set", f"n={scene[-1]}"]
    path = os.path.join(ROOT, "scenes", name + ".ron")
    geometry, process, stages = [], [], {}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(repeats):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            done = subprocess.run([program, "build", path, "--json", *arguments], cwd=folder, capture_output=True, check=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            process.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
            timings = json.loads(done.stdout)["timings"]
            geometry.append(sum(t["cpu"] for t in timings if t["stage"] not in AFTER_BREP))
            for t in timings:
                stages[t["stage"]] = stages.get(t["stage"], 0.0) + t["cpu"] / repeats
    return sum(geometry) / repeats, sum(process) / repeats, min(process), stages


def peer(python, name, scene, folder):
    done = subprocess.run([python, os.path.join(HERE, "peer_geometry.py"), name, scene, folder], capture_output=True, text=True,
                          check=False)
    return json.loads(done.stdout.splitlines()[-1])["mean"] if done.returncode == 0 else float("nan")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--gsm", default=os.path.join(ROOT, "target/release/gsm"))
    arguments.add_argument("--peers", default=os.path.join(ROOT, "../shared/peers"))
    arguments.add_argument("--python", default=sys.executable, help="a Python with gmsh and manifold3d")
    arguments.add_argument("--repeats", type=int, default=20)
    arguments.add_argument("--threads", type=int, default=1)
    arguments.add_argument("--only", default="")
    arguments.add_argument("--stages", action="store_true", help="also print each stage")
    options = arguments.parse_args()
    print("Processor time in ms. *process*: the whole program, mean and least.\n")
    print("| scene | gsm geometry | Gmsh fragments | ratio | Manifold | ratio | gsm remesh | gsm process | least | bars |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|--:|---|")
    for scene in SCENES:
        if options.only not in scene:
            continue
        repeats = options.repeats if not scene[-1] in "3456" or not scene.startswith("sphere") else max(3, options.repeats // 5)
        own, process, least, stages = gsm(os.path.abspath(options.gsm), scene, repeats, options.threads)
        gmsh, manifold = (peer(options.python, p, scene, options.peers) for p in ("gmsh", "manifold"))
        bars = []
        if scene in ("transformer3", "machine", "sphere_grid4", "sphere_grid5", "sphere_grid6") and not gmsh >= GMSH_FACTOR * own:
            bars.append("Gmsh")
        if scene in SAME_TASK and manifold > MANIFOLD_FLOOR and own > manifold:
            bars.append("Manifold")
        if not scene.startswith("sphere_grid") and process > PROCESS_BAR:
            bars.append("process")
        print(f"| {scene} | {own * 1e3:.2f} | {gmsh * 1e3:.1f} | {gmsh / own:.1f} | {manifold * 1e3:.2f} | {manifold / own:.2f} | "
              f"{stages['remesh'] * 1e3:.1f} | {process * 1e3:.1f} | {least * 1e3:.1f} | {'missed: ' + ', '.join(bars) if bars else 'held'} |", flush=True)
        if options.stages:
            print("  " + ", ".join(f"{name} {seconds * 1e3:.2f}" for name, seconds in stages.items()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
