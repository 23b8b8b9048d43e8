#!/usr/bin/env python3
"""judge.py FILE.poly...: the outside judge. Reads .poly and manifest, never calls gsm.

For each file: every part's surface is closed and consistently oriented, its volume is positive and that of the manifest to 1e-9;
all facets together meet only in whole shared vertices and edges, exactly; every seed lies inside a region of its number.
The contact test is bool_check.py of the peers where it is found (../shared/peers/boolean or --bool-check), else the one of plc.py.
Exit code 0 if all files pass, else 1. Needs numpy."""
import argparse
import os
import sys

import numpy as np

import plc

HERE = os.path.dirname(os.path.abspath(__file__))
VOLUME_TOLERANCE = 1e-9  # the manifest's volumes and ours come from the same coordinates: only rounding is between them


def bool_check(folder=None):
    """The peers' checker, if it is there."""
    for place in (folder, os.path.join(HERE, "../../shared/peers/boolean"), "/work/shared/peers/boolean"):
        if place and os.path.exists(os.path.join(place, "bool_check.py")):
            sys.path.insert(0, place)
            import bool_check as module
            return module
    return None


def judge(path, checker=None):
    """Faults of one file, as texts; and what was seen."""
    faults = []
    try:
        file = plc.Plc(path)
        T, owner = file.triangles()
        surfaces = file.surfaces(T, owner) if file.manifest else {}
    except plc.Fault as fault:
        return [str(fault)], {}
    if file.manifest is None:
        faults.append("no manifest beside it")
    regions = {r["part"]: r for r in file.manifest["regions"]} if file.manifest else {}
    for name, S in surfaces.items():
        edges = plc.open_edges(S)
        if edges:
            faults.append(f"{name}: {len(edges)} open edges, e.g. {file.V[list(edges[0])].tolist()}")
        volume, stated = plc.volume(file.V, S), regions[name]["volume"]
        if not volume > 0 or abs(volume - stated) > VOLUME_TOLERANCE * stated:
            faults.append(f"{name}: volume {volume!r}, the manifest says {stated!r}")
    for point, region in file.seeds:
        names = [r["part"] for r in regions.values() if r["region"] == region]
        if not names or round(winding(file.V, surfaces[names[0]], point)) != 1:
            faults.append(f"seed {point} is not in region {region}")
    faults += touching(file.V, T, checker)
    return faults, {"vertices": len(file.V), "facets": len(file.facets), "triangles": len(T), "parts": len(surfaces)}


def touching(V, T, checker):
    if checker is None:
        pairs = plc.contacts(V, T)
        return [f"{len(pairs)} pairs of triangles touch, e.g. {V[T[list(pairs[0])]].tolist()}"] if pairs else []
    r = checker.self_intersections(V, T, np.arange(len(T)))
    bad = r["cross"] + r["coplanar"]
    return [f"{bad} pairs of triangles touch: {r['examples'][:2]}"] if bad else []


def winding(V, T, point):
    """Winding number of a closed surface about a point (Van Oosterom and Strackee 1983)."""
    a, b, c = (V[T[:, k]] - np.array(point) for k in range(3))
    na, nb, nc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    numerator = np.einsum("ij,ij->i", a, np.cross(b, c))
    denominator = na * nb * nc + (a * b).sum(1) * nc + (b * c).sum(1) * na + (c * a).sum(1) * nb
    return float(np.arctan2(numerator, denominator).sum() / (2 * np.pi))


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("files", nargs="+")
    arguments.add_argument("--bool-check", metavar="FOLDER", help="where bool_check.py is")
    arguments.add_argument("--own", action="store_true", help="use the contact test of plc.py")
    options = arguments.parse_args()
    checker = None if options.own else bool_check(options.bool_check)
    failed = 0
    for path in options.files:
        faults, seen = judge(path, checker)
        failed += bool(faults)
        print(f"{path}: {'; '.join(faults) if faults else 'good'}  {seen}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
