#!/usr/bin/env python3
"""peer_geometry.py gmsh|manifold SCENE PEERS_FOLDER: processor seconds of a peer's geometry, as JSON.

Takes the peers' own scripts (PEERS_FOLDER/peer_*.py) without their mains: only primitives and Booleans (Gmsh: fragments of all
parts) are timed, in one thread, mean of as many repeats as fit into a few seconds."""
import json
import os
import sys
import time

peer, name, folder = sys.argv[1:]
sys.path.insert(0, folder)
with open(os.path.join(folder, f"peer_{peer}.py")) as file:
    source = file.read()
assert source.rstrip().endswith("main()"), "the peer's script has changed"
module = {"__name__": "peer"}
exec(compile(source.rstrip()[:-len("main()")], peer, "exec"), module)
scene = module["scenes"].get(name)
build = module["build"]


def gmsh_geometry():
    gmsh = module["gmsh"]
    gmsh.clear()
    start = time.process_time()
    parts = [build(t) for _, t in scene["parts"]] + ([build(scene["air"])] if scene["air"] else [])
    if len(parts) > 1:
        flat = [entity for part in parts for entity in part]
        gmsh.model.occ.fragment(flat[:1], flat[1:])
    gmsh.model.occ.synchronize()
    return time.process_time() - start


def manifold_geometry():
    M, m3 = module["M"], module["m3"]
    start = time.process_time()
    parts = [build(t) for _, t in scene["parts"]]
    if scene["air"]:
        parts.append(M.batch_boolean([build(scene["air"])] + parts, m3.OpType.Subtract))
    for part in parts:  # Manifold is lazy: the volume makes it evaluate.
        part.volume()
    return time.process_time() - start


if peer == "gmsh":
    module["gmsh"].initialize()
    module["gmsh"].option.setNumber("General.Terminal", 0)
    module["gmsh"].option.setNumber("General.NumThreads", 1)
run = gmsh_geometry if peer == "gmsh" else manifold_geometry
first, times, start = run(), [], time.process_time()
while len(times) < 100 and (not times or time.process_time() - start < 3.0):
    times.append(run())
print(json.dumps({"first": first, "mean": sum(times) / len(times), "repeats": len(times)}))
