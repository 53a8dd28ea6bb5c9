"""plan(), contact(), convert(), batch() and what command() runs are the program's."""

import csv
import io
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pandas
import pytest

import mindahl
from conftest import DATA, program

LAW = {"sigma": 4e7, "slip_force": 40.0}
LAW_OPTIONS = ["--sigma", "4e7", "--slip-force", "40"]
CONTACT = {"friction": (0.3, 0.01), "normal_load": 50, "contact_radius": 2.5e-4, "compliance": 4.2e-11}
CONTACT_OPTIONS = ["--friction", "0.3±0.01", "--normal-load", "50", "--contact-radius", "2.5e-4",
                   "--compliance", "4.2e-11"]
SPHERE = DATA / "mindlin_sphere_on_plane.csv"
FAR = DATA / "far_from_slip.csv"


def same_document(result, *options):
    """The JSON byte for byte, and the text."""
    assert result.to_json() == program(*options, "--json", "-")
    assert result.text() == program(*options)
    assert "<pre>" in result._repr_html_()


@pytest.mark.parametrize("keywords, options", [
    ({**LAW, "force_noise": 0.1, "want": {"alpha": 0.01, "slip_force": "1%"}},
     [*LAW_OPTIONS, "--force-noise", "0.1", "--want", "alpha=0.01,slip_force=1%"]),
    ({**LAW, "alpha": 0.5, "force_noise": 0.1, "displacement_noise": 1e-9, "rig_stiffness": 1e9, "cycles": 2,
      "samples_per_cycle": 80, "amplitude": [1e-6, 2e-6]},
     [*LAW_OPTIONS, "--alpha", "0.5", "--force-noise", "0.1", "--displacement-noise", "1e-9",
      "--rig-stiffness", "1e9", "--cycles", "2",
      "--samples-per-cycle", "80", "--amplitude", "1e-6", "--amplitude", "2e-6"]),
    ({"record": SPHERE, "cycles": 10}, ["--record", SPHERE, "--cycles", "10"]),
])
def test_plan_is_the_program_s(keywords, options):
    result = mindahl.plan(**keywords)
    same_document(result, "plan", *options)
    loops = result.to_pandas()
    assert list(loops["parameters_alpha_standard_error"]) == [
        loop.parameters.alpha.standard_error for loop in result.loops]


def test_plan_warns_of_a_record_and_says_what_is_not_reached():
    with pytest.warns(mindahl.FitWarning, match="alpha is not identified"):
        result = mindahl.plan(FAR, want={"slip_force": "0.0001%"})
    assert not result.established
    record = mindahl.read_csv(SPHERE)
    pair = mindahl.plan((record.displacement, record.force))
    assert pair.to_json() == mindahl.plan(record).to_json() == mindahl.plan(SPHERE).to_json()


def test_convert_takes_a_result_and_a_record():
    expected = program("convert", SPHERE, "--to", "dahl", "--json", "-")
    assert mindahl.convert(mindahl.fit(SPHERE), to="dahl").to_json() == expected
    assert mindahl.convert(SPHERE, to="dahl").to_json() == expected


def test_tradeoff_is_the_program_s():
    result = mindahl.command("tradeoff", tolerance="5%", **LAW)
    expected = program("tradeoff", "--tolerance", "5%", *LAW_OPTIONS, "--json", "-")
    assert result.to_json() == expected
    points = result.to_pandas()
    assert len(points) == sum(len(excitation.points) for excitation in result.excitations)


def test_an_option_that_takes_a_file_takes_arrays(tmp_path):
    path = tmp_path / "path.csv"
    path.write_text("\n".join(["x [m]", *map(repr, np.linspace(0, 2e-6, 40).tolist())]) + "\n")
    expected = mindahl.command("tradeoff", path=path, **LAW)
    found = mindahl.command("tradeoff", path={"x [m]": np.linspace(0, 2e-6, 40)}, **LAW)
    assert [point.max_force_error for point in found.excitations[0].points] == [
        point.max_force_error for point in expected.excitations[0].points]


def test_validate_is_the_program_s():
    result = mindahl.command("validate", cases=2, seed=3)
    same_document(result, "validate", "--cases", "2", "--seed", "3")
    assert result.passed and result.established
    assert len(result.to_pandas()) == 4 * 7  # noise levels and amplitudes


@pytest.mark.parametrize("keywords, options", [
    (CONTACT, CONTACT_OPTIONS),
    ({"friction": 0.3, "normal_load": 50, "youngs_modulus_1": 2.1e11, "poisson_1": 0.3, "radius_1": 0.01,
      "youngs_modulus_2": 7e10, "poisson_2": 0.34, "radius_2": float("inf")},
     ["--friction", "0.3", "--normal-load", "50", "--youngs-modulus-1", "2.1e11", "--poisson-1", "0.3",
      "--radius-1", "0.01", "--youngs-modulus-2", "7e10", "--poisson-2", "0.34", "--radius-2", "inf"]),
])
def test_contact_is_the_program_s(keywords, options):
    result = mindahl.contact(**keywords)
    same_document(result, "contact", *options)
    assert result.parameters.slip_force.value == pytest.approx(15.0, rel=1e-15)


@pytest.mark.parametrize(
    "to", ["masing", "dahl", "lugre", "bouc-wen", "iwan", "lammps"])
def test_convert_is_the_program_s_and_has_its_lines(to):
    load = {"normal_load": 100} if to == "lammps" else {}
    options = [*LAW_OPTIONS, "--amplitude", "1.2e-6", "--to", to, *(["--normal-load", 100] if load else [])]
    result = mindahl.convert(**LAW, amplitude=1.2e-6, to=to, **load)
    same_document(result, "convert", *options)
    assert "\n".join(result.input_lines) + "\n" == program("convert", *options, "--input-lines", "-")


BATCH = [SPHERE, DATA / "partial_slip.csv", FAR, DATA / "not_there.csv", DATA / "load_series_20N.csv",
         DATA / "load_series_50N.csv"]


@pytest.fixture(scope="module")
def batch_of_program(tmp_path_factory):
    """Table and JSON of the program."""
    output = tmp_path_factory.mktemp("batch") / "table.csv"
    text = program("batch", *BATCH, "--output", output, "--terms", "none", "--json", "-")
    return output.read_text(), text.replace(f'"output": "{output}"', '"output": null')


@pytest.mark.filterwarnings("ignore::mindahl.FitWarning")
@pytest.mark.parametrize("executor", [None, ThreadPoolExecutor, ProcessPoolExecutor, "dask"])
def test_batch_is_the_program_s_whatever_runs_it(batch_of_program, executor):
    if executor is None:
        table = mindahl.batch(BATCH, terms="none", threads=2)
    elif executor == "dask":
        distributed = pytest.importorskip("distributed", reason="python3-distributed is not installed")
        with distributed.Client(processes=False, n_workers=1, dashboard_address=None) as client:
            table = mindahl.batch(BATCH, terms="none", executor=client)
    else:
        with executor(2) as pool:
            table = mindahl.batch(BATCH, terms="none", executor=pool)
    assert table.to_csv() == batch_of_program[0]
    assert table.to_json() == batch_of_program[1]


def test_batch_has_typed_columns_and_says_what_failed(batch_of_program):
    with pytest.warns(mindahl.FitWarning, match="not_there.csv: cannot read"):
        table = mindahl.batch(BATCH, terms="none")
    assert not table.established
    assert list(table.faults) == [str(DATA / "not_there.csv")]
    frame = table.to_pandas()
    rows = list(csv.DictReader(io.StringIO(batch_of_program[0])))
    assert frame["sigma"].dtype == np.float64
    assert list(frame["file"]) == [row["file"] for row in rows]
    for row, sigma in zip(rows, frame["sigma"]):
        assert (row["sigma"] == "") == np.isnan(sigma)
        assert row["sigma"] == "" or float(row["sigma"]) == sigma
    assert table.report.files[0].fit.parameters.sigma.value == frame["sigma"][0]


@pytest.mark.filterwarnings("ignore::mindahl.FitWarning")
def test_batch_takes_records_frames_and_arrays_and_the_keywords_of_fit():
    record = mindahl.read_csv(SPHERE)
    frame = pandas.read_csv(SPHERE, float_precision="round_trip")
    table = mindahl.batch([SPHERE, record, frame, (record.displacement, record.force)], model="mindlin",
                          normal_load=50, terms="none")
    expected = mindahl.fit(record, model="mindlin", normal_load=50, terms="none")
    assert list(expected.to_pandas()["name"]) == list(expected.parameters)
    assert set(table["sigma"]) == {expected.sigma.value}
    assert set(table["friction_coefficient"]) == {expected.contact.friction_coefficient.value}
    for one in (SPHERE, str(SPHERE), record, frame, (record.displacement, record.force)):
        single = mindahl.batch(one, model="mindlin", normal_load=50, terms="none")
        assert list(single["sigma"]) == [expected.sigma.value]
    strict = mindahl.batch([FAR], strict=True, terms="none")
    assert "not established" in strict.faults[str(FAR)]


def test_a_keyword_that_fit_has_not_is_refused():
    with pytest.raises(TypeError, match="modell"):
        mindahl.batch([SPHERE], modell="dahl")
    with pytest.raises(TypeError, match="output"):
        mindahl.track(SPHERE, output="cycles.csv")
