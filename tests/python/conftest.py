"""What the tests share: the program beside which the package is tested, and records."""

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

SOURCE = Path(__file__).resolve().parents[2]
DATA = SOURCE / "data"


def program(*arguments):
    """Standard output of the program built with the package."""
    run = subprocess.run([os.environ["MINDAHL_PROGRAM"], *map(str, arguments)], cwd=SOURCE,
                         capture_output=True, text=True, check=False)
    assert run.returncode in (0, 3), run.stderr
    return run.stdout


def program_json(*arguments):
    return json.loads(program(*arguments, "--json", "-"))


def read_columns(path):
    """The columns of a file with a header, without the reader under test."""
    return np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)


@pytest.fixture(scope="session")
def sphere():
    """time [s], displacement [m], force [N] of a sphere on a plane."""
    return read_columns(DATA / "mindlin_sphere_on_plane.csv")
