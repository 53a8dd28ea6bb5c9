"""mindahl.fit(): what it takes, what it gives, what it refuses."""

import html
import inspect
import re
import subprocess
import sys
import threading
import time
import warnings
from concurrent.futures import ThreadPoolExecutor

import matplotlib
import numpy as np
import pandas
import pytest

import mindahl
from conftest import DATA, program, program_json
from mindahl import _mindahl

matplotlib.use("Agg")
SPHERE = DATA / "mindlin_sphere_on_plane.csv"
LOADS = [20, 50, 120]
SERIES = [DATA / f"load_series_{load}N.csv" for load in LOADS]


def without_files(report):
    # Arrays have names, columns and rows of their own.
    del report["input"]["files"], report["input"]["columns"]
    for left_out in report["input"]["left_out"]:
        del left_out["file"], left_out["first"], left_out["last"]
    return report


def arrays_of(path):
    record = mindahl.read_csv(path)
    return record.displacement, record.force, record.time


@pytest.mark.filterwarnings("ignore::mindahl.FitWarning")
@pytest.mark.parametrize("keywords, options", [
    ({}, []),
    ({"normal_load": 50}, ["--normal-load", "50"]),
    ({"normal_load": (50, 0.5), "radius_1": 0.01, "radius_2": np.inf,
      "youngs_modulus_1": 2.1e11, "poisson_1": (0.3, 0.01), "youngs_modulus_2": 7e10,
      "poisson_2": 0.34},
     ["--normal-load", "50±0.5", "--radius-1", "0.01", "--radius-2", "inf", "--youngs-modulus-1",
      "2.1e11", "--poisson-1", "0.3±0.01", "--youngs-modulus-2", "7e10", "--poisson-2", "0.34"]),
    ({"model": "mindlin", "offsets": False, "force_noise": 0.07},
     ["--model", "mindlin", "--offsets", "off", "--force-noise", "0.07"]),
    ({"model": "dahl", "initial_state": "virgin"}, ["--model", "dahl", "--initial-state", "virgin"]),
    ({"fix": {"alpha": 1 / 3}, "bound": {"slip_force": (5, 50)}, "start": {"sigma": 3e7}},
     ["--fix", f"alpha={1 / 3!r}", "--bound", "slip_force=5:50", "--start", "sigma=3e7"]),
    ({"rig_stiffness": 1e9, "terms": "force_drift", "cycles": (1, 2)},
     ["--rig-stiffness", "1e9", "--terms", "force_drift", "--select", "cycles=1:2"]),
    ({"select": {"cycles": (1, 2), "samples": (1, 400)}},
     ["--select", "cycles=1:2", "--select", "samples=1:400"]),
    ({"select": ["time=0.2:2.5"]}, ["--select", "time=0.2:2.5"]),
    ({"fix": {"slip_trend": 0.01, "inertia": 0.001, "viscous": 5.0}},
     ["--fix", "slip_trend=0.01", "--fix", "inertia=0.001", "--fix", "viscous=5"]),
    ({"terms": "asymmetry", "initial_state": "steady", "fix": {"force_offset": 0}},
     ["--terms", "asymmetry", "--initial-state", "steady", "--fix", "force_offset=0"]),
    ({"time_window": (0.2, 2.5), "loss": "huber", "samples": (1, 400)},
     ["--select", "time=0.2:2.5", "--loss", "huber", "--select", "samples=1:400"]),
])
def test_a_fit_of_arrays_is_the_program_s_key_by_key(keywords, options):
    displacement, force, seconds = arrays_of(SPHERE)
    result = mindahl.fit(displacement, force, time=seconds, **keywords)
    expected = program_json("fit", SPHERE, *options)
    assert without_files(result.to_dict()) == without_files(expected)


def test_a_fit_of_a_file_prints_the_program_s_text():
    result = mindahl.fit(SPHERE, normal_load=50)
    assert str(result) == program("fit", SPHERE, "--normal-load", 50)
    assert result.to_json() == program("fit", SPHERE, "--normal-load", 50, "--json", "-")


@pytest.mark.filterwarnings("ignore::mindahl.FitWarning")
def test_a_load_series_is_one_joint_fit_of_whatever_holds_its_columns():
    arrays = [arrays_of(path) for path in SERIES]
    columns = [{"displacement [m]": x, "force [N]": f, "time [s]": t} for x, f, t in arrays]
    records = [mindahl.read_csv(path) for path in SERIES]
    frames = [pandas.read_csv(path, float_precision="round_trip") for path in SERIES]
    expected = without_files(program_json("fit", *SERIES, "--normal-load", ",".join(map(str, LOADS))))
    for sources in (columns, SERIES, records, frames):
        result = mindahl.fit(sources, normal_load=LOADS)
        assert without_files(result.to_dict()) == expected
    pairs = mindahl.fit([(x, f) for x, f, _ in arrays], normal_load=LOADS)
    assert pairs.sigma.value == result.sigma.value
    assert result.load_exponent.identifiability == "identifiable"
    for (_, force, _), fitted, residual in zip(arrays, result.fitted_force, result.residual, strict=True):
        # A rounding of the difference, and one of each of its two terms' own storage.
        rounding = 4 * np.finfo(float).eps * np.abs(force).max()
        np.testing.assert_allclose(fitted - force, residual, rtol=0, atol=rounding)


def test_a_frame_is_read_by_the_names_and_units_of_its_columns(sphere):
    seconds, displacement, force = sphere
    frame = pandas.DataFrame({"F (kN)": force / 1e3, "Time, s": seconds, "x [um]": displacement * 1e6})
    result = mindahl.fit(frame)
    # The three scalings round to a unit in the last place, which a fit does not enlarge much.
    scale_rounding = 1e-9
    expected = mindahl.fit(displacement, force, time=seconds)
    assert result.sigma.value == pytest.approx(expected.sigma.value, rel=scale_rounding)
    assert result.input.columns.displacement.unit == "um"
    series = mindahl.fit(frame["x [um]"], frame["F (kN)"], time=frame["Time, s"])
    assert series.sigma.value == pytest.approx(expected.sigma.value, rel=scale_rounding)


@pytest.mark.parametrize("times", [pandas.to_datetime, pandas.to_timedelta])
def test_times_of_pandas_are_read_in_seconds(times, sphere):
    seconds, displacement, force = sphere
    frame = pandas.DataFrame({"time": times(seconds, unit="s"), "x [m]": displacement, "F [N]": force})
    resolution = 2e-9  # [s], of two roundings
    for record in (mindahl.fit(frame).records[0],
                   mindahl.fit(displacement, force, time=frame["time"]).records[0]):
        np.testing.assert_allclose(record.time, seconds, rtol=0, atol=resolution)


@pytest.mark.parametrize("dtype", ["Float64", object, "string", str])
def test_a_frame_is_read_whatever_its_columns_hold_the_numbers_in(dtype, sphere):
    seconds, displacement, force = sphere
    frame = pandas.DataFrame({"x [m]": displacement, "F [N]": force, "t [s]": seconds})
    expected = mindahl.fit(frame)
    made = frame.astype(dtype)
    made["by"] = "somebody"
    assert mindahl.fit(made).sigma.value == expected.sigma.value
    if dtype in ("Float64", object):
        given = mindahl.fit(made["x [m]"], made["F [N]"], time=made["t [s]"])
        assert given.sigma.value == expected.sigma.value
        with pytest.raises(ValueError, match=r"force\[3\] = <NA> is invalid: must be finite"):
            mindahl.fit(made["x [m]"], made["F [N]"].mask(made.index == 3, pandas.NA))
    made.loc[3, "F [N]"] = pandas.NA
    frame.loc[3, "F [N]"] = np.nan
    with pytest.warns(mindahl.FitWarning, match="1 row is left out, the first: record:4:2:"):
        assert mindahl.fit(made).sigma.value == mindahl.fit(frame).sigma.value
    made["F [N]"] = made["F [N]"].astype(object)
    made.loc[5, "F [N]"] = "oops"
    with pytest.raises(mindahl.InputError, match=r"'F \[N\]' \(column 2\) holds no numbers"):
        mindahl.fit(made, force="F")


def test_units_that_a_frame_does_not_name_are_warned_of_once(sphere):
    seconds, displacement, force = sphere
    frame = pandas.DataFrame({"displacement": displacement, "force": force, "time [s]": seconds})
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        for _ in range(2):
            mindahl.fit(frame)
    said = [str(warning.message) for warning in caught]
    assert said == [
        "record: displacement 'displacement' (column 1) names no unit: taken as m; displacement "
        "'1 [m]' says so",
        "record: force 'force' (column 2) names no unit: taken as N; force '2 [N]' says so"]
    assert {warning.category for warning in caught} == {mindahl.FitWarning}
    assert {warning.filename for warning in caught} == {__file__}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mindahl.fit(frame, displacement_unit="m", force_unit="N")
        mindahl.fit(displacement, force, time=seconds)


@pytest.mark.filterwarnings("ignore::mindahl.FitWarning")
def test_what_is_not_known_has_no_number_where_it_is_printed():
    far = mindahl.fit(DATA / "far_from_slip.csv")
    assert not far.alpha.is_known and not far.slip_force.is_known and far.sigma.is_known
    assert repr(far.alpha) == "<mindahl.Parameter alpha: not identifiable>"
    assert str(far.slip_force).startswith("slip_force > 3.2") and "bounded below" in str(far.slip_force)
    assert str(far.sigma).endswith(" N/m, identifiable") and " ± " in str(far.sigma)
    for said in ("alpha: not identifiable", "slip_force > 3.2", "bounded below", "sigma = 4.84"):
        assert said in repr(far)
    assert float(far.sigma) == far.sigma.value
    with pytest.raises(ValueError, match="alpha: not identifiable: the record determines no value: ask is_known"):
        float(far.alpha)
    held = mindahl.fit(DATA / "far_from_slip.csv", fix={"alpha": 0.25})
    assert held.alpha.is_known and str(held.alpha) == "alpha = 0.25, held"
    effective = mindahl.fit(DATA / "lag.csv", terms="none").sigma  # in the program is_known() too
    assert effective.identifiability == "effective" and effective.is_known
    assert float(effective) == effective.value


def test_a_frame_s_columns_can_be_chosen(sphere):
    seconds, displacement, force = sphere
    frame = pandas.DataFrame({"left": displacement * 1e6, "right": force, "clock": seconds})
    chosen = mindahl.fit(frame, displacement="left", force="right", time=3, displacement_unit="um",
                         force_unit="N", time_unit="s")
    assert chosen.input.columns.displacement.unit == "um"
    texts = mindahl.fit(frame, displacement="1 [um]", force="right [N]", time="clock [s]")
    assert texts.to_json() == chosen.to_json()
    with pytest.raises(mindahl.InputError, match="no column is called 'middle'"):
        mindahl.fit(frame, displacement="middle")


def test_what_arrays_are_made_of_does_not_matter(sphere):
    _, displacement, force = sphere
    expected = mindahl.fit(displacement, force).to_dict()
    wide = np.column_stack([displacement, force])
    for x, f in [(list(displacement), list(force)), (wide[:, 0], wide[:, 1]),
                 (pandas.Series(displacement), pandas.Series(force)),
                 (displacement.astype(">f8"), force.astype(np.longdouble))]:
        assert mindahl.fit(x, f).to_dict() == expected


class ArrayWithAttributes(np.ndarray):
    """An array that states its unit as those of xarray do."""

    attrs: dict = {}


def test_units_of_arrays_are_said_or_their_attributes(sphere):
    _, displacement, force = sphere
    said = mindahl.fit(displacement * 1e6, force, displacement_unit="um")
    assert said.input.columns.displacement.unit == "um"
    micrometres = (displacement * 1e6).view(ArrayWithAttributes)
    micrometres.attrs = {"units": "um"}
    stated = mindahl.fit(micrometres, force)
    assert stated.input.columns.displacement.unit == "um" and stated.sigma == said.sigma
    assert mindahl.fit(displacement, force, displacement_unit="rad").sigma.unit == "N m/rad"


def test_a_further_array_can_be_a_covariate(sphere):
    _, displacement, force = sphere
    pressure = np.sin(np.arange(len(force)) / 7.0)
    factor = 2.0
    columns = {"x [m]": displacement, "F [N]": force + factor * pressure, "pressure": pressure}
    fitted = mindahl.fit(columns, covariate="pressure").covariate_pressure
    # The truth lies within five standard errors but once in two million.
    assert abs(fitted.value - factor) < 5 * fitted.standard_error


def test_attributes_are_the_report_s(sphere):
    seconds, displacement, force = sphere
    result = mindahl.fit(displacement, force, time=seconds, normal_load=50)
    report = result.to_dict()
    assert result.sigma.value == report["parameters"]["sigma"]["value"]
    assert result.sigma.interval == tuple(report["parameters"]["sigma"]["ci95"])
    assert result.slip_force.identifiability == "identifiable"
    assert result.adequacy.verdict == report["adequacy"]["verdict"]
    friction = result.contact.friction_coefficient.value
    assert friction == result.slip_force.value / 50
    assert result.measured.cycles[0].amplitude == report["measured"]["cycles"][0]["amplitude"]
    assert result.converged
    assert {"sigma", "adequacy", "contact", "plot"} <= set(dir(result))
    with pytest.raises(AttributeError, match="it has the parameters sigma, alpha"):
        result.siqma
    report["parameters"].clear()
    assert result.sigma.value > 0


def test_fitted_force_and_residual_are_read_only(sphere):
    _, displacement, force = sphere
    result = mindahl.fit(displacement, force)
    np.testing.assert_array_equal(result.records[0].force, force)
    with pytest.raises(ValueError, match="read-only"):
        result.residual[0] = 0.0


def test_arrays_outlive_their_result(sphere):
    _, displacement, force = sphere
    expected = mindahl.fit(displacement, force).residual.copy()
    residual = mindahl.fit(displacement, force).residual
    for _ in range(3):
        mindahl.fit(displacement[:200], force[:200])
    np.testing.assert_array_equal(residual, expected)


@pytest.mark.parametrize("arguments, message", [
    (([0, 1, 2], [0, 1]), r"force \[N\] has 2 samples and displacement \[m\] 3"),
    (([[0, 1], [1, 0]], None), "record 1 is a single array: give a pair"),
    (([np.zeros(3)], [np.zeros(3)]), "record 1 is a single array: give a pair"),
    ((np.zeros((3, 2)), np.zeros(3)), r"displacement has the shape \(3, 2\)"),
    (([0.0, 1.0, np.nan], [0.0, 1.0, 2.0]), r"displacement\[2\] = nan is invalid: must be finite"),
    (([0.0, 1.0, 2.0], [0.0, np.inf, 2.0]), r"force\[1\] = inf is invalid: must be finite"),
    ((np.array([0, 1, "x"], dtype=object), [0, 1, 2]), "."),
    ((np.array([1j, 2j, 3]), [0, 1, 2]), "dtype complex128: must be an array of real numbers"),
    ((np.array(["a", "b"]), [0, 1]), "dtype <U1: must be an array of real numbers"),
    (([], []), "displacement is empty"),
    (([0.0, 1.0, 0.0], None), "force is missing"),
    ((None, None), "a record is missing"),
    ((42, [1.0]), "."),
    (([0, 1, 2], np.ma.masked_array([0.0, 1, 2], [False, True, False])), "force has masked values"),
    (({"a": [0.0, 1.0], "b": [1.0, 2.0], "c": [3.0, 4.0]},),
     "choose it with displacement, by name or number"),
    (({"t [s]": [0.0, 1, 0.5], "x [m]": [0.0, 1, 0], "F [N]": [0.0, 1, 2]},),
     "has a time before that of the row above"),
    (({"x [m]": [0.0, 1, 2], "F [N]": [0.0, np.nan, 2]},), "record:2:2: holds no number"),
])
def test_what_is_no_record_is_refused_in_one_line(arguments, message):
    with pytest.raises(ValueError, match=message) as refused:
        mindahl.fit(*arguments)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("keywords, message", [
    ({"model": "coulomb"}, "model: coulomb not in {auto,mindlin-dahl,"),
    ({"offsets": "maybe"}, "offsets: maybe not in {on,off}"),
    ({"fix": {"alpha": "x"}}, "fix: 'alpha=x' is invalid: write NAME=VALUE"),
    ({"terms": "lags"}, "^terms: 'lags' is no term, so it is taken for a column: record: covariate lags: "),
    ({"rig_stiffness": 1e8, "fix": {"rig_stiffness": 1e8}}, "'rig_stiffness' is given twice"),
    ({"cycles": 3}, "cycles: 'cycles=3' is invalid: write cycles=LO:HI"),
    ({"cycles": (1, 2, 3)}, "must be a number or a pair"),
    ({"normal_load": -5}, r"normal_load \[N\] = -5 is invalid"),
    ({"normal_load": (50, -1)}, "'50±-1' is not a number or a quantity in N, nor one with its standard uncertainty"),
    ({"poisson_1": 0.7}, r"poisson_1 \[-\] = 0.7 is invalid"),
    ({"sample_rate": -1}, "sample_rate -1: must be finite and > 0 Hz"),
    ({"displacement_unit": "furlong"}, "furlong"),
    ({"time": "t"}, "names a column, but the displacement is an array"),
    ({"time_unit": "ms"}, "no column for the time"),
])
def test_an_option_that_breaks_a_rule_is_named_as_its_keyword(sphere, keywords, message):
    _, displacement, force = sphere
    with pytest.raises(ValueError, match=message) as refused:
        mindahl.fit(displacement, force, **keywords)
    assert "--" not in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_fault_of_a_file_is_an_input_error(tmp_path):
    broken = tmp_path / "loop.csv"
    broken.write_text("x [m],F [N]\n0,0\n1,one\n2,2\n3,1\n")
    with pytest.raises(mindahl.InputError, match=r"loop\.csv:3:2: 'one'"):
        mindahl.fit(broken)
    assert issubclass(mindahl.InputError, ValueError)
    with pytest.raises(mindahl.InputError, match="cannot read"):
        mindahl.read_csv(tmp_path / "none.csv")


@pytest.mark.parametrize("option, value", [("fix", 0.3), ("start", 0.3), ("bound", (0, 1)), ("prior", (0.3, 0.1))])
def test_a_name_of_no_parameter_is_an_input_error(option, value):
    with pytest.raises(mindahl.InputError, match=f"^{option}: parameter 'alfa' is unknown: must be one of sigma, "):
        mindahl.fit(SPHERE, **{option: {"alfa": value}})


def test_what_a_person_should_act_on_is_warned_of():
    with pytest.warns(mindahl.FitWarning) as warned:
        result = mindahl.fit(DATA / "far_from_slip.csv")
    assert [str(warning.message) for warning in warned] == [
        re.sub(r"--([a-z-]+)", lambda option: option[1].replace("-", "_"), warning.message)
        for warning in result.warnings]
    assert not result.slip_force.identifiability == "identifiable"


def test_a_prior_is_the_program_s(tmp_path):
    path = DATA / "partial_slip.csv"
    free = mindahl.fit(path, terms="none")
    value, error = free.sigma.value, free.sigma.standard_error
    result = mindahl.fit(path, terms="none", prior={"sigma": (value + error, error)})
    output = tmp_path / "fit.json"
    program("fit", path, "--terms", "none", "--prior", f"sigma={value + error!r}±{error!r}",
            "--json", output)
    assert result.to_json() == output.read_text()
    with pytest.raises(mindahl.InputError, match="prior: lag is not fitted"):
        mindahl.fit(path, prior={"lag": (1e-3, 1e-4)})
    with pytest.raises(ValueError, match="is invalid: write NAME=VALUE±U"):
        mindahl.fit(path, prior={"sigma": 1e7})


def test_every_option_of_the_program_s_fit_is_a_keyword():
    options = set(re.findall(r"^ {2}(?:-\w, ?)?--([a-z0-9-]+)", program("fit", "--help-all"), re.M))
    keywords = set(inspect.signature(mindahl.fit).parameters)
    outputs = {"json", "residuals", "plot", "strict", "report", "details"}
    general = {"help", "help-all", "config", "version"}
    missing = {option.replace("-", "_")
               for option in options - outputs - general} - keywords - {"with"}
    assert len(options) > 30
    assert not missing


def test_a_result_is_drawn(sphere):
    _, displacement, force = sphere
    result = mindahl.fit(displacement, force)
    loop, residual = result.plot()
    np.testing.assert_array_equal(loop.lines[0].get_ydata(), force)
    np.testing.assert_array_equal(loop.lines[1].get_ydata(), result.fitted_force)
    np.testing.assert_array_equal(residual.lines[0].get_ydata(), result.residual)
    assert loop.get_ylabel() == "force [N]"
    _, own = matplotlib.pyplot.subplots()
    assert result.plot(own) is own
    assert len(own.lines) == 2


def test_a_notebook_shows_parameters_and_warnings_escaped(sphere, tmp_path):
    _, displacement, force = sphere
    name = tmp_path / "a<b>&c.csv"
    np.savetxt(name, np.column_stack([displacement, force]), delimiter=",", header="x [m],F [N]",
               comments="")
    result = mindahl.fit(name)
    page = result.page()
    assert page.startswith("<!DOCTYPE html>") and page.count("<figure") >= 3
    assert "a&lt;b&gt;&amp;c.csv" in page and "<b>&c" not in page
    assert "half gap" in page and "σ" in page
    frame = result._repr_html_()
    assert frame.startswith("<iframe srcdoc=") and frame.count("<") == 2  # all else is escaped
    assert html.unescape(frame).count(page) == 1
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mindahl.FitWarning)
        warned = mindahl.fit(DATA / "far_from_slip.csv")
    assert html.escape(warned.warnings[0].message.split(": ")[1]) in warned.page()


def test_other_threads_run_while_it_fits(sphere):
    """No thread hands over by itself here: another one counts only where the fit lets go."""
    _, displacement, force = sphere
    many = np.tile(np.arange(len(force)), 20)
    request = _mindahl.FitRequest([])
    record = _mindahl.record_of_columns(
        "record", ["x [m]", "F [N]"], [displacement[many], force[many]], request)
    counted = [0]
    may_end = threading.Event()

    def count():
        while not may_end.is_set():
            counted[0] += 1
            time.sleep(0)

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1000.0)
    counting = threading.Thread(target=count)
    try:
        counting.start()
        before = counted[0]
        _mindahl.fit([record], request)
        after = counted[0]
    finally:
        may_end.set()
        sys.setswitchinterval(interval)
        counting.join()
    assert after > before


def test_results_of_fits_at_once_are_those_of_one_after_the_other(sphere):
    _, displacement, force = sphere
    expected = mindahl.fit(displacement, force).to_dict()
    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda _: mindahl.fit(displacement, force).to_dict(), range(2)))
    assert results == [expected, expected]


def test_a_loop_of_an_imposed_force_is_fitted_by_its_displacement():
    loop = DATA / "imposed_force.csv"
    result = mindahl.fit(loop, noise_in="displacement")
    assert without_files(result.to_dict()) == without_files(
        program_json("fit", loop, "--noise-in", "displacement"))
    record = result.records[0]
    np.testing.assert_array_equal(record.fitted_force, record.force)
    # Either difference rounds once, of displacements ten times as large as a residual.
    np.testing.assert_allclose(record.fitted_displacement - record.displacement, record.residual,
                               atol=1e-15 * np.ptp(record.displacement))


@pytest.mark.parametrize("call", [
    "[mindahl.fit(x, force, terms='auto') for _ in range(100)]",
    "mindahl.batch([(x, force)] * 100, terms='auto', threads=2)",
    "[mindahl.track(x, force) for _ in range(100)]",
    "mindahl.command('validate', cases=100000)"])
def test_ctrl_c_ends_a_fit_at_once(tmp_path, call):
    script = tmp_path / "long.py"
    script.write_text(f"""
import os, signal, threading, time
import numpy as np
import mindahl
_, x = mindahl.excitation(amplitude=3e-6, cycles=100, samples_per_cycle=1000)
force = mindahl.simulate(x, sigma=4e7, slip_force=40.0)
force += np.random.default_rng(1).normal(0, 0.1, force.size)
threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
begin = time.monotonic()
try:
    {call}
except KeyboardInterrupt:
    print(time.monotonic() - begin)
""")
    run = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True)
    assert 0.25 < float(run.stdout) < 5.0, run.stdout  # all take much longer
