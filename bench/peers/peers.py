"""What the comparisons with other programs share."""

import json
import subprocess

PYTHON = "/usr/bin/python3"  # Debian's, which has Debian's lmfit, pandas and SciPy

# All minimise the same sum of squares: they may differ by their stopping rules, or by an integration's.
LARGEST_DIFFERENCE_IN_STANDARD_ERRORS = 0.05


def run_json(*command):
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def disagreements(name, fit, reference):
    """A line for each parameter of a fit that is not the reference's; one has to converge, too."""
    if not fit["converged"]:
        yield f"{name} has not converged"
    for parameter, expected in reference["parameters"].items():
        found = fit["parameters"][parameter]["value"]
        difference = abs(found - expected["value"]) / expected["standard_error"]
        if not difference <= LARGEST_DIFFERENCE_IN_STANDARD_ERRORS:
            yield f"{name}: {parameter} = {found:.8g} differs by {difference:.2g} standard errors"
