"""GetDP and NGSolve on a mesh that gsm wrote.

  solvers.py plate MESH.msh WORK      energy of the two-layer capacitor, exact to 1e-10 in both
  solvers.py coil  MESH.msh WORK      energy of the iron block in its coil, both agree to 1e-7
"""
import math
import os
import re
import subprocess
import sys

import ngsolve as ng
from netgen.read_gmsh import ReadGmsh

HERE = os.path.dirname(os.path.abspath(__file__))
CURRENT = 1e6
MU_R = 1000.0


def tags(msh):
    """Tag of each physical name: what a user looks up for GetDP."""
    with open(msh) as f:
        text = f.read().split("$EndPhysicalNames")[0]
    return {name: int(tag) for tag, name in re.findall(r'^[23] (\d+) "(.*)"$', text, re.M)}


def getdp(problem, msh, work, resolution, numbers):
    command = ["getdp", os.path.join(HERE, problem), "-msh", msh, "-name", os.path.join(work, "r"), "-v", "3",
               "-solve", resolution, "-pos", "Energy"]
    for name, value in numbers.items():
        command += ["-setnumber", name, repr(value)]
    # GetDP writes beside the problem file unless told otherwise, so it works on a copy.
    copy = os.path.join(work, problem)
    with open(os.path.join(HERE, problem)) as source, open(copy, "w") as target:
        target.write(source.read())
    command[1] = copy
    run = subprocess.run(command, capture_output=True, text=True, cwd=work)
    said = run.stdout + run.stderr
    assert run.returncode == 0 and "Error" not in said, said[-2000:]
    with open(os.path.join(work, "W.txt")) as f:
        return float(f.read().split()[-1])


def plate(msh, work):
    exact = 0.5 / (0.4 / 1.0 + 0.6 / 4.0)
    tag = tags(msh)
    dp = getdp("electrostatics.pro", msh, work, "Ele",
               dict(e1=1.0, e2=4.0, tag1=tag["lower"], tag2=tag["upper"], tagElectrode=tag["electrode"], tagGround=tag["ground"]))
    mesh = ng.Mesh(ReadGmsh(msh))
    space = ng.H1(mesh, order=1, dirichlet="electrode|ground")
    u, v = space.TnT()
    eps = mesh.MaterialCF({"lower": 1.0, "upper": 4.0})
    a = ng.BilinearForm(eps * ng.grad(u) * ng.grad(v) * ng.dx).Assemble()
    g = ng.GridFunction(space)
    g.Set(mesh.BoundaryCF({"electrode": 1.0}, default=0), ng.BND)
    g.vec.data -= a.mat.Inverse(space.FreeDofs(), "sparsecholesky") @ a.mat * g.vec
    w = ng.Integrate(0.5 * eps * ng.grad(g) * ng.grad(g), mesh)
    print(f"exact {exact!r} GetDP {dp / exact - 1:.1e} NGSolve {w / exact - 1:.1e}")
    assert abs(dp / exact - 1) < 1e-10 and abs(w / exact - 1) < 1e-10


def coil(msh, work):
    names = ["iron", "air", "coil_xp", "coil_yp", "coil_xm", "coil_ym", "hull"]
    tag = tags(msh)
    dp = getdp("magnetostatics.pro", msh, work, "Mag", {"mur": MU_R, "J0": CURRENT, **{n: tag[n] for n in names}})
    mesh = ng.Mesh(ReadGmsh(msh))
    space = ng.HCurl(mesh, order=0, dirichlet="hull")
    u, v = space.TnT()
    nu = mesh.MaterialCF({"iron": 1 / MU_R}, default=1.0) / (4e-7 * math.pi)
    j = mesh.MaterialCF({"coil_xp": (CURRENT, 0, 0), "coil_yp": (0, CURRENT, 0),
                         "coil_xm": (-CURRENT, 0, 0), "coil_ym": (0, -CURRENT, 0)}, default=(0, 0, 0))
    # The small mass term takes the place of a gauge.
    a = ng.BilinearForm(nu * ng.curl(u) * ng.curl(v) * ng.dx + 1e-8 * nu * u * v * ng.dx).Assemble()
    f = ng.LinearForm(j * v * ng.dx("coil_.*")).Assemble()
    g = ng.GridFunction(space)
    g.vec.data = a.mat.Inverse(space.FreeDofs(), "sparsecholesky") * f.vec
    w = ng.Integrate(0.5 * nu * ng.curl(g) * ng.curl(g), mesh)
    print(f"{mesh.ne} tetrahedra: GetDP {dp!r} NGSolve {w!r} difference {w / dp - 1:.1e}")
    assert w > 0 and abs(w / dp - 1) < 1e-7


{"plate": plate, "coil": coil}[sys.argv[1]](os.path.abspath(sys.argv[2]), os.path.abspath(sys.argv[3]))
