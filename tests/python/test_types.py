"""The package and its stubs by mypy, on itself and on what a user writes."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import mindahl
from conftest import DATA

pytest.importorskip("mypy")
USE = Path(__file__).with_name("typed_use.py")
MISTAKES = {
    "mindahl.simulate(displacement, sigma='stiff', slip_force=40.0)": 'has incompatible type "str"',
    "mindahl.plan(sigma='stiff')": 'has incompatible type "str"',
    "mindahl.fit(displacement, force, modell='dahl')": 'Unexpected keyword argument "modell"',
    "state.displacement = 1.0": "is read-only",
    "mindahl.fit(displacement, force).sgima": 'has no attribute "sgima"',
    "mindahl.fit(displacement, force).adequacy.verdcit": 'has no attribute "verdcit"',
    "mindahl.fit(displacement, force).contact.frction": 'has no attribute "frction"',
    "mindahl.fit(displacement, force).measured.cycles[0].gap": 'has no attribute "gap"',
    "text: str = mindahl.fit(displacement, force).sigma.unit_of": 'has no attribute "unit_of"',
}


@pytest.fixture(scope="module")
def mypy(tmp_path_factory):
    cache = tmp_path_factory.mktemp("mypy")
    package = os.environ["PYTHONPATH"].split(os.pathsep)[0]

    def run(*arguments):
        return subprocess.run(
            [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(cache), *arguments],
            env={**os.environ, "MYPYPATH": package}, capture_output=True, text=True, check=False)

    return run


def test_the_package_and_a_user_s_script_are_well_typed(mypy):
    checked = mypy(str(USE))
    assert checked.returncode == 0, checked.stdout
    package = mypy("--ignore-missing-imports", "-p", "mindahl")
    assert package.returncode == 0, package.stdout


def test_mistakes_are_found_before_a_script_runs(mypy, tmp_path):
    script = tmp_path / "mistaken.py"
    correct = USE.read_text(encoding="utf-8")
    script.write_text(correct + "\n" + "\n".join(MISTAKES) + "\n", encoding="utf-8")
    found = mypy(str(script)).stdout.splitlines()
    for line, (mistake, fault) in enumerate(MISTAKES.items(), start=correct.count("\n") + 2):
        assert any(f"mistaken.py:{line}:" in said and fault in said for said in found), mistake


def test_a_result_has_the_sections_of_the_schema():
    schema = json.loads((DATA.parent / "docs" / "schema" / "fit.json").read_text())["properties"]
    assert set(mindahl.FitResult.__annotations__) - {"sigma", "alpha", "slip_force"} == (
        set(schema) - {"parameters"})
