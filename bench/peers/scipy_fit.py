"""A least-squares fit of a hysteresis loop with SciPy alone, as a user would write it: by the closed
form of its branches, or by integrating their differential equation as most do for a friction model.

    /usr/bin/python3 scipy_fit.py RECORD.csv --route closed|ode --repeats 20

RECORD.csv is as lmfit_fit.py takes it, of a contact that had slipped before, from the first reversal on.
Prints JSON: sigma [N/m], alpha, slip_force [N], and the median processor time of a fit [ms].
"""

import argparse
import json

import numpy as np
import scipy
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

from lmfit_fit import MICROMETRE, MasingLoop, median_ms, starting_values, steady_part

# Of the integration: the residuals' differences by the parameters must not be noise.
RELATIVE_TOLERANCE = 1e-6


class IntegratedLoop(MasingLoop):
    """The same branches by dT/dx = sigma·(1 − T/(2·Tc))^alpha from each reversal on."""

    def force(self, sigma, alpha, slip_force):
        def slope(_, rise):
            return sigma * np.maximum(1 - rise / (2 * slip_force), 0.0) ** alpha

        force = np.empty_like(self.displacement)
        ends = np.append(self.reversals, self.displacement.size - 1)
        begin = 0
        for branch, end in enumerate(ends):
            ways = np.abs(self.displacement[begin:end + 1] - self.displacement[begin])
            # In a steady loop a whole stroke goes from the one extreme force to the other.
            whole = 2 * self.amplitude
            at = np.append(ways, whole) if ways[-1] < whole else ways
            rise = solve_ivp(slope, (0.0, at[-1]), [0.0], t_eval=at, rtol=RELATIVE_TOLERANCE,
                             atol=RELATIVE_TOLERANCE * slip_force).y[0]
            sign = self.sign[end]
            first = begin if branch == 0 else begin + 1
            force[first:end + 1] = sign * (rise[first - begin:end - begin + 1] - rise[-1] / 2)
            begin = end
        return force


def fit(loop_class, displacement, force):
    loop = loop_class(displacement, "steady")
    start = starting_values(loop, force).valuesdict()

    def residual(x):
        return loop.force(*x[:3]) + x[3] - force

    x0 = np.array([start["sigma"], start["alpha"], start["slip_force"], start["force_offset"]])
    scale = np.array([start["sigma"], 1.0, start["slip_force"], start["slip_force"]])
    lower, upper = [1e-12, 0.0, 1e-12, -np.inf], [np.inf, 0.99, np.inf, np.inf]
    return least_squares(residual, x0, bounds=(lower, upper), x_scale=scale)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("record")
    parser.add_argument("--route", choices=["closed", "ode"], default="closed")
    parser.add_argument("--repeats", type=int, default=20)
    arguments = parser.parse_args()

    columns = np.loadtxt(arguments.record, delimiter=",", skiprows=1, unpack=True)
    displacement, force = steady_part(columns[1] / MICROMETRE, columns[2])
    loop_class = MasingLoop if arguments.route == "closed" else IntegratedLoop
    result = fit(loop_class, displacement, force)
    sigma, alpha, slip_force = result.x[:3]
    print(json.dumps({
        "program": f"SciPy {scipy.__version__}",
        "converged": bool(result.success),
        "median_ms": median_ms(arguments.repeats,
                               lambda: fit(loop_class, displacement, force)),
        "parameters": {"sigma": {"value": sigma / MICROMETRE}, "alpha": {"value": alpha},
                       "slip_force": {"value": slip_force}},
    }))


if __name__ == "__main__":
    main()
