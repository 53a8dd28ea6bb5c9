"""A bare least-squares fit of a hysteresis loop with lmfit, as a user who knows lmfit and the record
would write it: the closed form in NumPy, the reversals known, starting values from the data.

    /usr/bin/python3 lmfit_fit.py RECORD.csv --repeats 20

RECORD.csv has time [s], displacement [m] and force [N], as `mindahl simulate` writes it. Prints JSON:
sigma [N/m], alpha, slip_force [N] with lmfit's standard errors, and the median processor time of a fit [ms].
"""

import argparse
import json
import statistics
import time

import lmfit
import numpy as np

# The solver differentiates by steps relative to each parameter; micrometres keep all of order 1.
MICROMETRE = 1e-6


class MasingLoop:
    """What does not change during a fit: the branch of every sample, its sign and where it starts."""

    def __init__(self, displacement, initial_state):
        steps = np.sign(np.diff(displacement))
        self.reversals = np.flatnonzero(steps[1:] != steps[:-1]) + 1
        branch = np.searchsorted(self.reversals, np.arange(displacement.size), side="left")
        start = np.concatenate([[0], self.reversals])
        self.branch = branch
        virgin = (branch == 0) & (initial_state == "virgin")
        self.sign = np.where(branch % 2 == 0, steps[0], -steps[0])
        self.signed_scale = self.sign * np.where(virgin, 1.0, 2.0)
        self.distance = np.abs(displacement - displacement[start][branch]) / 2
        self.displacement = displacement
        self.amplitude = np.ptp(displacement) / 2
        self.steady = initial_state == "steady"
        self.virgin_displacement = displacement[virgin]

    def force(self, sigma, alpha, slip_force, origin=0.0):
        """Masing: each branch is the backbone in twice the scale, from where the last one ended."""
        if self.steady:
            rise = self.signed_scale * backbone(self.distance, sigma, alpha, slip_force)
            return rise - self.sign * backbone(self.amplitude, sigma, alpha, slip_force)
        from_origin = self.virgin_displacement - origin
        x = np.concatenate([np.abs(from_origin), self.distance[from_origin.size:]])
        rise = self.signed_scale * backbone(x, sigma, alpha, slip_force)
        rise[:from_origin.size] *= np.sign(from_origin) * self.sign[0]
        start = np.concatenate([[0.0], np.cumsum(rise[self.reversals])])
        return start[self.branch] + rise


def backbone(x, sigma, alpha, slip_force):
    beta = 1 - alpha
    remaining = np.maximum(1 - beta * sigma / slip_force * x, 0.0)
    return slip_force * (1 - remaining ** (1 / beta))


def residual(parameters, loop, force):
    v = parameters.valuesdict()
    model = loop.force(v["sigma"], v["alpha"], v["slip_force"], v.get("origin", 0.0))
    return model + v["force_offset"] - force


def starting_values(loop, force):
    parameters = lmfit.Parameters()
    slip_force = np.ptp(force) / 2
    after_reversal = slice(loop.reversals[0], loop.reversals[0] + 10)
    sigma = np.polyfit(loop.displacement[after_reversal], force[after_reversal], 1)[0]
    parameters.add("sigma", value=sigma, min=0)
    parameters.add("alpha", value=0.5, min=0, max=0.99)
    parameters.add("slip_force", value=slip_force, min=0)
    parameters.add("force_offset", value=(force.max() + force.min()) / 2)
    if not loop.steady:
        parameters.add("origin", value=0.0)
    return parameters


def steady_part(displacement, force):
    """From the first reversal on: the virgin branch of a steady record tells something else."""
    steps = np.sign(np.diff(displacement))
    first = np.flatnonzero(steps[1:] != steps[:-1])[0] + 1
    return displacement[first:], force[first:]


def fit(displacement, force, initial_state):
    loop = MasingLoop(displacement, initial_state)
    start = starting_values(loop, force)
    return lmfit.minimize(residual, start, method="leastsq", args=(loop, force))


def median_ms(repeats, call):
    """Of the processor, which other programs on the machine disturb less than the clock."""
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        call()
        times.append(1e3 * (time.process_time() - begin))
    return statistics.median(times)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("record")
    parser.add_argument("--repeats", type=int, default=20)
    parser.add_argument("--initial-state", choices=["virgin", "steady"], default="virgin")
    arguments = parser.parse_args()

    columns = np.loadtxt(arguments.record, delimiter=",", skiprows=1, unpack=True)
    displacement, force = columns[1] / MICROMETRE, columns[2]
    if arguments.initial_state == "steady":
        displacement, force = steady_part(displacement, force)

    result = fit(displacement, force, arguments.initial_state)
    loop = MasingLoop(displacement, arguments.initial_state)
    values = [result.params[name].value for name in ("sigma", "alpha", "slip_force")]
    units = {"sigma": 1 / MICROMETRE, "alpha": 1.0, "slip_force": 1.0}
    print(json.dumps({
        "program": f"lmfit {lmfit.__version__}",
        "converged": bool(result.success and result.errorbars),
        "median_ms": median_ms(arguments.repeats,
                               lambda: fit(displacement, force, arguments.initial_state)),
        "force_evaluation_ms": median_ms(arguments.repeats, lambda: loop.force(*values)),
        "force_evaluations": result.nfev,
        "parameters": {
            name: {"value": result.params[name].value * unit,
                   "standard_error": result.params[name].stderr * unit}
            for name, unit in units.items()},
    }))


if __name__ == "__main__":
    main()
