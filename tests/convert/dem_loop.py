#!/usr/bin/env python3
"""Runs LIGGGHTS or YADE with what `mindahl convert --input-lines` writes, and checks the loop.

    dem_loop.py liggghts|yade --program build/dev/src/mindahl [--engine PATH]

Two spheres are pressed together and sheared to and fro. Of the second cycle the script takes what
mindahl states of its conversion: the largest difference of force from Mindlin's loop over T*, and
the energy lost over that of Mindlin's loop. Exit status 77, for ctest a skipped test, where the
engine is absent.
"""

import argparse
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from mindlin_contact import (AMPLITUDE, NORMAL_LOAD, OVERLAP, PEAK_FORCE, RADIUS, SIGMA, converted,
                             loop_error)

SKIPPED = 77
CYCLES = 2
NORMAL_STIFFNESS = NORMAL_LOAD / OVERLAP  # [N/m], of the linear spring normal to the contact
STEEPEST = SIGMA * AMPLITUDE / PEAK_FORCE  # of either loop, in T* a displacement of X

LIGGGHTS = """\
units si
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
region box block -0.1 0.1 -0.1 0.1 -0.1 0.1 units box
create_box 1 box
neighbor 0.001 bin
neigh_modify delay 0
timestep {timestep}
fix young all property/global youngsModulus peratomtype 1e9
fix poisson all property/global poissonsRatio peratomtype 0.3
fix kn all property/global kn peratomtypepair 1 {normal}
fix gamman all property/global gamman peratomtypepair 1 0.0
{lines}
pair_coeff * *
create_atoms 1 single 0 0 0 units box
create_atoms 1 single 0 0 {distance} units box
set group all diameter {diameter} density 7800
group moved id 2
fix drive moved move wiggle {amplitude} 0 0 1.0 units box
thermo {steps}
run {transient}
compute fx moved property/atom fx
compute fz moved property/atom fz
compute sx moved reduce sum c_fx
compute sz moved reduce sum c_fz
thermo_style custom step c_sx c_sz
thermo_modify format float %.15g lost ignore norm no
thermo {every}
run {steps}
"""

YADE = """\
import math
from yade import *
O.materials.append(FrictMat(young=1e9, poisson=0.3, frictionAngle=0.1, density=7800))
first = O.bodies.append(utils.sphere((0, 0, 0), {diameter} / 2, fixed=True))
second = O.bodies.append(utils.sphere((0, 0, {distance}), {diameter} / 2, fixed=True))
O.dt = {timestep}

def place(step):
    return {amplitude} * math.sin(2 * math.pi * step / {steps})

def drive():
    O.bodies[second].state.vel = Vector3((place(O.iter + 1) - place(O.iter)) / O.dt, 0, 0)

def note():
    contact = O.interactions[first, second].phys
    print("row", O.iter, contact.shearForce[0], contact.normalForce[2])

stiffness = {lines}
stiffness.kn = MatchMaker(algo="val", val={normal})
O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb()]),
             InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [stiffness],
                             [Law2_ScGeom_FrictPhys_CundallStrack()]),
             PyRunner(command="note()", iterPeriod={every}),
             PyRunner(command="drive()", iterPeriod=1),
             NewtonIntegrator(damping=0, gravity=(0, 0, 0))]
O.run({transient} + {steps} + 1, True)
"""

# Script, steps a cycle, every how many are printed, options before the script, and what a row is.
ENGINES = {
    "liggghts": (LIGGGHTS, 100_000, 10, ["-log", "none", "-in"], r"^ *(\d+) +(\S+) +(\S+) *$"),
    "yade": (YADE, 10_000, 1, ["-x", "-n"], r"^row (\d+) (\S+) (\S+)$"),
}


def run(name, engine, lines):
    """Returns displacement, force and load of the last cycle."""
    script, steps, every, options, row = ENGINES[name]
    text = script.format(timestep=1 / steps, normal=NORMAL_STIFFNESS, lines="\n".join(lines),
                         distance=4 * RADIUS - OVERLAP, diameter=4 * RADIUS, amplitude=AMPLITUDE,
                         steps=steps, every=every, transient=(CYCLES - 1) * steps)
    with tempfile.TemporaryDirectory() as directory:
        path = pathlib.Path(directory, "loop.py" if name == "yade" else "loop.in")
        path.write_text(text, encoding="utf-8")
        output = subprocess.run([engine, *options, path.name], cwd=directory, capture_output=True,
                                text=True, check=False, stdin=subprocess.DEVNULL)
    rows = {int(step): (float(fx), float(fz))
            for step, fx, fz in re.findall(row, output.stdout, re.MULTILINE)}
    wanted = range((CYCLES - 1) * steps, CYCLES * steps + 1, every)
    missing = [step for step in wanted if step not in rows]
    if output.returncode != 0 or missing:
        sys.exit(f"{engine} failed, {len(missing)} rows are missing, on:\n{text}\n"
                 f"{output.stdout[-2000:]}{output.stderr[-2000:]}")
    displacement = [AMPLITUDE * math.sin(2 * math.pi * step / steps) for step in wanted]
    return displacement, [-rows[step][0] for step in wanted], [abs(rows[step][1]) for step in wanted]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("name", choices=ENGINES)
    parser.add_argument("--program", required=True, help="mindahl")
    parser.add_argument("--engine", help="path of LIGGGHTS or YADE; default: its name")
    arguments = parser.parse_args()
    engine = arguments.engine or arguments.name
    if shutil.which(engine) is None:
        print(f"skipped: there is no {engine}; install-dependencies.sh --peers has it")
        return SKIPPED
    _, steps, every, _, _ = ENGINES[arguments.name]
    lines, report = converted(arguments.program, arguments.name, "--normal-load", repr(NORMAL_LOAD))
    stated = report["error_at_amplitude"]
    displacement, force, load = run(arguments.name, engine, lines)
    worst, energy = loop_error(displacement, force)
    print(f"largest error of force {100 * worst:.3f} % of T*, stated {100 * stated['force']:.3f} %; "
          f"of energy {100 * energy:.3f} %, stated {100 * stated['energy']:.3f} %")
    # An engine adds up velocity times time step: since a reversal, half a step too much; the loops
    # differ most at a corner, up to half a print away. A loop loses more than a tenth of 4XT*.
    step_error = STEEPEST * math.pi / steps
    force_error = step_error + STEEPEST * math.pi * every / steps
    # A sphere that moves by X is X^2 / 2d further away: so much of the overlap, of the load.
    load_error = AMPLITUDE**2 / (8 * RADIUS) / OVERLAP + 1e-9
    failed = (abs(worst - stated["force"]) > force_error or
              abs(energy - stated["energy"]) > 10 * step_error or
              any(abs(n / NORMAL_LOAD - 1) > 2 * load_error for n in load))
    if failed:
        print(f"what {arguments.name} does is not what is stated", file=sys.stderr)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
