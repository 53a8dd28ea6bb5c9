"""The contact that the loops of other programs are of, and how far such a loop is from Mindlin's."""

import json
import math
import subprocess

YOUNGS_MODULUS = 2.1e11  # [Pa]
POISSON = 0.3
RADIUS = 0.01            # equivalent, [m]
NORMAL_LOAD = 100.0      # [N]
FRICTION = 0.4
MOBILISED = 0.8          # amplitude over the displacement at gross slip

EFFECTIVE_MODULUS = YOUNGS_MODULUS / 2 / (1 - POISSON**2)
SHEAR_MODULUS = YOUNGS_MODULUS / 2 / (1 + POISSON)
COMPLIANCE = 2 * (2 - POISSON) / SHEAR_MODULUS
OVERLAP = (3 * NORMAL_LOAD / (4 * EFFECTIVE_MODULUS * math.sqrt(RADIUS))) ** (2 / 3)
CONTACT_RADIUS = math.sqrt(RADIUS * OVERLAP)
SIGMA = 8 * CONTACT_RADIUS / COMPLIANCE
SLIP_FORCE = FRICTION * NORMAL_LOAD
GROSS_SLIP = 1.5 * SLIP_FORCE / SIGMA
AMPLITUDE = MOBILISED * GROSS_SLIP


def mindlin_force(distance):
    """Of the virgin curve, Johnson (1985) eq. 7.42 [N]."""
    return SLIP_FORCE * (1 - max(0.0, 1 - distance / GROSS_SLIP) ** 1.5)


def mindlin_energy():
    """Of the steady loop, Johnson (1985) eq. 7.57 [J]."""
    r = mindlin_force(AMPLITUDE) / SLIP_FORCE
    return 9 * SLIP_FORCE**2 * COMPLIANCE / (10 * CONTACT_RADIUS) * (
        1 - (1 - r) ** (5 / 3) - 5 * r / 6 * (1 + (1 - r) ** (2 / 3)))


PEAK_FORCE = mindlin_force(AMPLITUDE)


def converted(program, target, *options):
    """Returns the lines that `mindahl convert --to target` writes, and what it states of them."""
    command = [program, "convert", "--sigma", repr(SIGMA), "--slip-force", repr(SLIP_FORCE),
               "--amplitude", repr(AMPLITUDE), "--to", target, *options]
    lines = subprocess.run([*command, "--input-lines", "-"], check=True, capture_output=True,
                           text=True).stdout.splitlines()
    stated = subprocess.run([*command, "--json", "-"], check=True, capture_output=True, text=True)
    lines = [line.split("  #")[0] for line in lines if not line.startswith(("#", "<!--"))]
    return lines, json.loads(stated.stdout)


def loop_error(displacement, force):
    """Largest difference of force from Mindlin's steady loop over T*, and of the energy."""
    worst = 0.0
    rising = [b >= a for a, b in zip(displacement, displacement[1:])]
    for i, up in enumerate([rising[-1], *rising]):
        side = 1 if up else -1
        expected = 2 * mindlin_force((AMPLITUDE + side * displacement[i]) / 2) - PEAK_FORCE
        worst = max(worst, abs(side * force[i] - expected))
    energy = sum((force[i] + force[i + 1]) / 2 * (displacement[i + 1] - displacement[i])
                 for i in range(len(force) - 1))
    return worst / PEAK_FORCE, energy / mindlin_energy() - 1
