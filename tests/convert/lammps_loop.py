#!/usr/bin/env python3
"""Runs LAMMPS with what `mindahl convert --to lammps --input-lines` writes, and checks the loop.

    lammps_loop.py --program build/dev/src/mindahl [--lammps lmp]

Two steel spheres, and a sphere against a plane, are pressed together and sheared to and fro. Of the
last cycle the script takes what mindahl states of its conversion: the largest difference of force
from Mindlin's loop over T*, and the energy lost over that of Mindlin's loop. The truth here is
Mindlin's closed form, which shares no code with mindahl. Exit status 77, for ctest a skipped test,
where the program is absent.
"""

import argparse
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from mindlin_contact import (AMPLITUDE, CONTACT_RADIUS, EFFECTIVE_MODULUS, NORMAL_LOAD, OVERLAP,
                             PEAK_FORCE, RADIUS, SIGMA, SLIP_FORCE, converted, loop_error)

SKIPPED = 77

STEPS = 100_000   # a cycle
EVERY = 10        # of them is printed of the last cycle
CYCLES = 2        # the first of a sphere on a plane has another centre

HEAD = """\
units si
atom_style sphere
atom_modify map array
boundary f f f
newton off
comm_modify vel yes
region box block -0.1 0.1 -0.1 0.1 -0.1 0.1
create_box 1 box
neighbor 0.001 bin
timestep {timestep}
"""
# The displacement is X sin of the upper one.
SPHERES = """\
create_atoms 1 single 0 0 0
create_atoms 1 single 0 0 {distance}
set group all diameter {diameter} density 7800
pair_style granular
pair_coeff * * {normal} {tangential}
group moved id 2
fix drive moved move wiggle {amplitude} 0 0 1.0 units box
"""
# The displacement is X (1 - cos) of the plane.
PLANE = """\
create_atoms 1 single 0 0 {height}
set group all diameter {diameter} density 7800
pair_style granular
pair_coeff * * {normal} {tangential}
group moved id 1
fix plane all wall/gran granular {normal} {tangential} zplane 0.0 NULL wiggle x {amplitude} 1.0
"""
TAIL = """\
thermo {steps}
run {transient}
compute force moved property/atom fx fz
compute fx moved reduce sum c_force[1]
compute fz moved reduce sum c_force[2]
thermo_style custom step c_fx c_fz
thermo_modify format float %.15g
thermo {every}
run {steps}
"""


STEEPEST = SIGMA * AMPLITUDE / PEAK_FORCE  # of either loop, in T* a displacement of X
# LAMMPS adds up velocity times time step: since a reversal, half a step of the velocity too much.
STEP_ERROR = STEEPEST * math.pi / STEPS
# The loops differ most at a corner, which is up to half a print away.
FORCE_ERROR = STEP_ERROR + STEEPEST * math.pi * EVERY / STEPS
# The two branches' energy is 2XT* each way, of which a loop loses more than a tenth.
ENERGY_ERROR = 10 * STEP_ERROR
# A sphere that moves by X is X^2 / 2d further away: so much of the overlap, times 3/2, of the load.
LOAD_ERROR = 1.5 * AMPLITUDE**2 / (8 * RADIUS) / OVERLAP


def run(lammps, setting, tangential):
    """Displacement about its centre, force and load of the last cycle."""
    # By its stiffness: of hertz/material a wall of this version takes E/2(1 - nu) for E/2(1 - nu^2).
    normal = f"hertz {4 / 3 * EFFECTIVE_MODULUS!r} 0.0"
    script = (HEAD + setting + TAIL).format(
        timestep=1 / STEPS, normal=normal, tangential=tangential, amplitude=AMPLITUDE, every=EVERY,
        steps=STEPS, transient=(CYCLES - 1) * STEPS, distance=4 * RADIUS - OVERLAP, height=RADIUS - OVERLAP,
        diameter=4 * RADIUS if setting is SPHERES else 2 * RADIUS)
    with tempfile.TemporaryDirectory() as directory:
        path = pathlib.Path(directory, "loop.in")
        path.write_text(script, encoding="utf-8")
        output = subprocess.run([lammps, "-in", path.name, "-log", "none"], cwd=directory,
                                capture_output=True, text=True, check=False)
    if output.returncode != 0:
        sys.exit(f"{lammps} failed on:\n{script}\n{output.stdout}{output.stderr}")
    rows = [tuple(map(float, match)) for match in
            re.findall(r"^ *(\d+) +(\S+) +(\S+) *$", output.stdout, re.MULTILINE)]
    rows = rows[-STEPS // EVERY - 1:]
    if len(rows) != STEPS // EVERY + 1 or rows[0][0] != (CYCLES - 1) * STEPS:
        sys.exit(f"{lammps} printed {len(rows)} rows of the loop:\n{output.stdout}")
    displacement, force, load = [], [], []
    for step, fx, fz in rows:
        phase = 2 * math.pi * step / STEPS
        if setting is SPHERES:  # the force is the one on what moves
            displacement.append(AMPLITUDE * math.sin(phase))
            force.append(-fx)
        else:
            displacement.append(-AMPLITUDE * math.cos(phase))
            force.append(fx)
        load.append(abs(fz))
    return displacement, force, load


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--program", required=True, help="mindahl")
    parser.add_argument("--lammps", default="lmp", help="LAMMPS, of the package lammps")
    arguments = parser.parse_args()
    if shutil.which(arguments.lammps) is None:
        print(f"skipped: there is no {arguments.lammps}; install-dependencies.sh --peers has it")
        return SKIPPED

    version = subprocess.run([arguments.lammps, "-help"], check=True, capture_output=True, text=True)
    print(re.search(r"^Large-scale.*", version.stdout, re.MULTILINE)[0])
    print(f"sigma {SIGMA:.8g} N/m, Tc {SLIP_FORCE:g} N, X {AMPLITUDE:.6g} m, a {CONTACT_RADIUS:.6g} m\n")
    lines, report = converted(arguments.program, "lammps", "--normal-load", repr(NORMAL_LOAD))
    stated = report["error_at_amplitude"]
    failed = False
    print(f"{'line':<32} {'against':<7} {'force':>8} {'stated':>8} {'energy':>9} {'stated':>9}")
    for tangential in lines:
        for name, setting in (("sphere", SPHERES), ("plane", PLANE)):
            displacement, force, load = run(arguments.lammps, setting, tangential)
            worst, energy = loop_error(displacement, force)
            print(f"{' '.join(tangential.split()[:2]):<32} {name:<7} {100 * worst:8.3f} "
                  f"{100 * stated['force']:8.3f} {100 * energy:9.3f} {100 * stated['energy']:9.3f}")
            failed |= (abs(worst - stated["force"]) > FORCE_ERROR or
                       abs(energy - stated["energy"]) > ENERGY_ERROR or
                       any(abs(n / NORMAL_LOAD - 1) > LOAD_ERROR for n in load))
    print("\nin per cent of T* and of the energy")
    if failed:
        print("what LAMMPS does is not what is stated", file=sys.stderr)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
