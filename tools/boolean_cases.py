#!/usr/bin/env python3
"""boolean_cases.py [--only TEXT] [--limit SECONDS]: the peers' Boolean cases through gsm, judged by their own checker.

Takes the cases that ../shared/peers/boolean/gen_cases.py writes and those in ../shared/data/boolean, writes each as a scene, runs
`gsm build`, and compares volume and area with what the case expects; bool_check.py finds whether the result is closed and free of
self-contact. Rules:
- a case of volume 0 passes when gsm says that the part is empty and exits 1;
- cases finer than the default tolerance (near_*, ulp*, rotcubes_*_1e-9, rotcubes_*_1e-12) run with tolerance 1e-14; at the
  default they run again and have to be valid, with a volume within area times tolerance;
- where no volume is known (fetched cases without consensus), set identities over gsm's own results decide;
- an input that is open or crosses itself passes when gsm refuses it by name and the peers' checker finds the same fault.
Prints a table per family and every failure; exit code 1 if there is one. Needs numpy, scipy; mapbox_earcut is not needed."""
import argparse
import collections
import concurrent.futures as futures
import fnmatch
import json
import math
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from fractions import Fraction

import numpy as np

import judge
import plc

HERE = os.path.dirname(os.path.abspath(__file__))
FINE = ("near_*", "ulp*", "rotcubes_*_1e-9_*", "rotcubes_*_1e-12_*")
DEFAULT_TOLERANCE = 1e-9
FINE_TOLERANCE = 1e-14
# Volumes of fetched meshes: their own coordinates have about 7 digits, the consensus about 16.
VOLUME_TOLERANCE = 1e-9
EMPTY = {"empty-part"}
REFUSED = {"self-intersection", "open-surface", "flat-facet"}


def number(x):
    return float(Fraction(x)) if isinstance(x, str) else x


class Runner:
    """Runs gsm on the solids of one case; `gsm` counts the processor time."""

    def __init__(self, case, source, gsm, limit):
        self.case, self.gsm, self.limit, self.cpu = case, gsm, limit, 0.0
        self.is_refused = False
        self.files = {}
        self.folder = tempfile.mkdtemp(prefix="gsm-case-")
        self.solids = {}
        for name, solid in case["solids"].items():
            if "box" in solid:
                lo, hi = (", ".join(repr(float(x)) for x in corner) for corner in solid["box"])
                self.solids[name] = f"Block(min: ({lo}), max: ({hi}))"
                continue
            if "mesh" in solid:
                file = solid["mesh"]
                os.symlink(os.path.join(source, file), os.path.join(self.folder, file))
            else:
                file = name + ".off"
                V, F = np.reshape(solid["v"], (-1, 3)).astype(float), np.reshape(solid["f"], (-1, 3))
                with open(os.path.join(self.folder, file), "w") as out:
                    out.write(f"OFF\n{len(V)} {len(F)} 0\n")
                    out.writelines("%r %r %r\n" % tuple(map(float, v)) for v in V)
                    out.writelines("3 %d %d %d\n" % tuple(f) for f in F)
            self.files[name] = file
            self.solids[name] = f'Import(file: "{file}")'

    def close(self):
        shutil.rmtree(self.folder)

    def is_broken(self, name):
        """Whether the peers' checker, too, finds an input open, crossing itself or with flat facets."""
        checker = judge.bool_check()
        V, F = checker.read_mesh(os.path.join(self.folder, self.files[name]), weld=True)
        found = checker.check(V, F, budget=60.0)
        return not found["closed"] or bool(found["degenerate"] or found["self"]["cross"] or found["self"]["coplanar"])

    def text(self, tree):
        if isinstance(tree, str):
            return f'Use("{tree}")'
        return f"{tree[0].capitalize()}([{', '.join(self.text(t) for t in tree[1:])}])"

    def build(self, tree, tolerance):
        """(exit code, faults, report, path of the .poly) of one tree."""
        solids = ", ".join(f'"{name}": {solid}' for name, solid in self.solids.items())
        scene = os.path.join(self.folder, "case.ron")
        with open(scene, "w") as out:
            out.write(f'Scene(units: "mm", tolerance: {tolerance!r}, remesh: Off, solids: {{{solids}}},\n'
                      f'    parts: [Part(name: "result", solid: {self.text(tree)})])\n')
        poly = os.path.join(self.folder, "case.poly")

        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (self.limit, self.limit + 5))

        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([self.gsm, "build", scene, "-o", poly, "--json", "--threads", "1"], capture_output=True,
                              text=True, preexec_fn=limit, check=False)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.cpu += after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        try:
            report = json.loads(done.stdout)
        except ValueError:
            report = {"errors": [{"code": "cpu-limit" if done.returncode < 0 else "crash", "message": done.stderr[-300:]}]}
        return done.returncode, report.get("errors", []), report, poly

    def volume(self, tree, tolerance=DEFAULT_TOLERANCE):
        if isinstance(tree, list) and len(tree) == 2:
            tree = tree[1]
        code, faults, report, _ = self.build(tree, tolerance)
        if code == 0:
            return report["parts"][0]["volume"]
        if {f["code"] for f in faults} <= EMPTY and faults:
            return 0.0
        raise RuntimeError(f"identity: {tree!r:.60}: {said(faults)}")


def said(faults):
    texts = list(dict.fromkeys(f"{f['code']}: {f['message'][:160]}" for f in faults))
    more = f" and {len(texts) - 3} more" if len(texts) > 3 else ""
    return "; ".join(texts[:3]) + more or "nothing said"


def judge_case(case, runner, tolerance, expected, is_coarse):
    """Problems of one run of a case."""
    code, faults, report, poly = runner.build(case["tree"], tolerance)
    scale = max(abs(expected or 0.0), case["expect"].get("volume_scale", 0.0))
    if code == 1 and faults and {f["code"] for f in faults} <= EMPTY:
        if expected is None:
            return []
        slack = 0.0 if expected == 0 else case["tol"] * scale
        return [] if abs(expected) <= slack or (is_coarse and abs(expected) <= tolerance * scale) else ["empty, but volume is expected"]
    if code == 1 and faults and {f["code"] for f in faults} <= REFUSED:
        named = {name for f in faults for name in re.findall(r"solid '(\w+)'", f["message"])}
        wrong = [name for name in sorted(named) if not runner.is_broken(name)]
        runner.is_refused = bool(named) and not wrong
        return [] if runner.is_refused else [f"{said(faults)} - but {wrong or 'no input'} is good"]
    if code != 0:
        return [said(faults)] if code == 1 else [f"exit {code}: {said(faults)}"]
    file = plc.Plc(poly)
    if not file.facets:
        return ["exit 0, but the result is empty"]
    T, owner = file.triangles()
    S = file.surfaces(T, owner)["result"]
    problems = []
    if plc.open_edges(S):
        problems.append("not closed")
    problems += judge.touching(file.V, T, judge.bool_check())
    volume, area = plc.volume(file.V, S), plc.area(file.V, S)
    size = float(np.linalg.norm(np.ptp(file.V, axis=0)))
    slack = max(case["tol"] * scale, area * tolerance * size if is_coarse else 0.0)
    if expected is not None and abs(volume - expected) > slack:
        problems.append(f"volume {volume!r}, expected {expected!r}")
    if "area" in case["expect"] and not is_coarse:
        right = number(case["expect"]["area"])
        if abs(area - right) > case["tol"] * right:
            problems.append(f"area {area!r}, expected {right!r}")
    return problems


def identity(case, runner):
    """Problems of a case whose volume nobody knows: inclusion and exclusion over gsm's own results."""
    expect, tree = case["expect"], case["tree"]
    if "identity" in expect:
        total, right = runner.volume(tree), expect.get("sum")
        other = runner.volume(expect["also"])
        left = total - other if expect["identity"] == "equals" else total + other
        right = 0.0 if expect["identity"] == "equals" else right
        scale = max(abs(total), abs(other))
    else:
        first, rest = tree[1], ["union", *tree[2:]]
        whole, a = runner.volume(tree), runner.volume(first)
        if tree[0] == "intersection":
            rest[0] = "intersection"
        if tree[0] == "difference":
            left, right = whole, a - runner.volume(["intersection", first, rest])
        else:
            b = runner.volume(rest)
            other = runner.volume([{"union": "intersection", "intersection": "union"}[tree[0]], first, rest])
            left, right = whole + other, a + b
        scale = max(abs(a), abs(whole))
    good = abs(left - right) <= max(case["tol"], DEFAULT_TOLERANCE * 30) * scale
    return [] if good else [f"identity: {left!r} is not {right!r}"]


def run(job):
    case, source, gsm, limit = job
    runner = Runner(case, source, gsm, limit)
    name, problems = case["name"], []
    expected = number(case["expect"]["volume"]) if "volume" in case["expect"] else None
    is_fine = any(fnmatch.fnmatch(name, pattern) for pattern in FINE)
    try:
        problems += judge_case(case, runner, FINE_TOLERANCE if is_fine else DEFAULT_TOLERANCE, expected, False)
        if is_fine:
            problems += ["at the default tolerance: " + p for p in judge_case(case, runner, DEFAULT_TOLERANCE, expected, True)]
        if expected is None and not problems and not runner.is_refused:
            problems += identity(case, runner)
    except (plc.Fault, RuntimeError, OSError) as fault:
        problems.append(f"{type(fault).__name__}: {fault}")
    finally:
        runner.close()
    return case, problems, runner.cpu, runner.is_refused


def load(folder, family=None):
    cases = []
    for name in sorted(os.listdir(folder)):
        if name.endswith(".json"):
            with open(os.path.join(folder, name)) as file:
                case = json.load(file)
            case["family"] = family or case["family"]
            cases.append((case, os.path.abspath(folder)))
    return cases


def collect(shared, scratch):
    subprocess.run([sys.executable, os.path.join(shared, "peers/boolean/gen_cases.py"), scratch], check=True,
                   stdout=subprocess.DEVNULL)
    cases = load(scratch)
    data = os.path.join(shared, "data/boolean")
    with open(os.path.join(data, "reference.json")) as file:
        reference = json.load(file)
    for family in ("fetched", "thingicsg"):
        for case, source in load(os.path.join(data, family), family):
            known = reference.get("open/" + case["name"], {})
            if known.get("consensus") is not None:
                case["expect"]["volume"] = known["consensus"]
                case["tol"] = max(case["tol"], 3e-8)  # area times the default tolerance
            case["manifold"] = known.get("manifold", {}).get("volume")
            cases.append((case, source))
    return cases


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--gsm", default=os.path.join(HERE, "../target/release/gsm"))
    arguments.add_argument("--shared", default=os.path.join(HERE, "../../shared"))
    arguments.add_argument("--only", default="", help="cases whose family/name holds this text")
    arguments.add_argument("--limit", type=int, default=20, help="processor seconds per run of gsm")
    arguments.add_argument("--jobs", type=int, default=os.cpu_count())
    options = arguments.parse_args()
    table = collections.OrderedDict()
    failed = 0
    with tempfile.TemporaryDirectory(prefix="gsm-cases-") as scratch:
        jobs = [(case, source, os.path.abspath(options.gsm), options.limit) for case, source in collect(options.shared, scratch)
                if options.only in case["family"] + "/" + case["name"]]
        with futures.ProcessPoolExecutor(options.jobs) as pool:
            for case, problems, cpu, is_refused in pool.map(run, jobs):
                row = table.setdefault(case["family"], [0, 0, 0.0, 0.0, 0])
                row[4] += is_refused
                row[0] += 1
                row[1] += not problems
                row[2] += cpu
                row[3] = max(row[3], cpu)
                if problems:
                    failed += 1
                    print(f"FAILED {case['family']}/{case['name']} ({cpu:.1f} s): {' | '.join(problems)}", flush=True)
    print(f"\n{'family':20} {'cases':>6} {'good':>6} {'refused':>8} {'CPU s':>8} {'most':>7}")
    for family, (count, good, cpu, most, refused) in table.items():
        print(f"{family:20} {count:6} {good:6} {refused:8} {cpu:8.2f} {most:7.2f}")
    rows = list(table.values())
    print(f"{'all':20} {sum(r[0] for r in rows):6} {sum(r[1] for r in rows):6} {sum(r[4] for r in rows):8} {sum(r[2] for r in rows):8.2f} "
          f"{max((r[3] for r in rows), default=math.nan):7.2f}")
    return 1 if failed or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
