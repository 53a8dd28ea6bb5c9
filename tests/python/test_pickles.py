"""Results and records that are pickled, copied, saved and read again."""

import copy
import json
import pickle
import warnings
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import matplotlib
import numpy as np
import pytest

import mindahl
from conftest import DATA

matplotlib.use("Agg")
SPHERE = DATA / "mindlin_sphere_on_plane.csv"


def saved_and_loaded(result, tmp_path):
    result.save(tmp_path / "fit.mindahl")
    return mindahl.FitResult.load(tmp_path / "fit.mindahl")


@pytest.mark.parametrize("again", [
    lambda result, _: pickle.loads(pickle.dumps(result)), saved_and_loaded,
    lambda result, _: copy.copy(result), lambda result, _: copy.deepcopy(result)])
def test_a_result_is_the_same_afterwards(again, tmp_path):
    result = mindahl.fit(SPHERE, normal_load=50)
    other = again(result, tmp_path)
    assert other.to_json() == result.to_json()
    assert other.text() == result.text()
    assert other.notes == result.notes and repr(other) == repr(result)
    for name in ("force", "displacement", "time", "fitted_force", "residual"):
        np.testing.assert_array_equal(getattr(other.records[0], name),
                                      getattr(result.records[0], name))
    assert other.records[0].fitted_displacement is None
    np.testing.assert_array_equal(other.plot()[0].lines[1].get_ydata(), result.fitted_force)
    assert other._repr_html_().startswith("<iframe")


def test_a_saved_result_has_its_page_and_a_pickled_one_its_text(tmp_path):
    result = mindahl.fit(SPHERE)
    assert saved_and_loaded(result, tmp_path).page() == result.page()
    assert "stiffness" in pickle.loads(pickle.dumps(result)).page()


def test_a_result_of_json_is_shown_and_says_what_it_has_not(tmp_path):
    result = mindahl.fit(SPHERE)
    (tmp_path / "fit.json").write_text(result.to_json(), encoding="utf-8")
    loaded = mindahl.FitResult.load(tmp_path / "fit.json")
    assert loaded.to_dict() == result.to_dict() and loaded.to_json() == result.to_json()
    assert loaded.sigma == result.sigma and repr(loaded) == repr(result)
    assert loaded.adequacy.verdict == result.adequacy.verdict
    assert "sigma = " in loaded._repr_html_() and "sigma = " in str(loaded)
    assert loaded.records == ()
    with pytest.raises(ValueError, match="has no records"):
        loaded.plot()
    for content in (b"PK nothing", b"\xff", b"[]", b"{", b'{"schema": "mindahl.contact/1"}'):
        (tmp_path / "other").write_bytes(content)
        with pytest.raises(mindahl.InputError, match="is no result of a fit"):
            mindahl.FitResult.load(tmp_path / "other")
    with pytest.raises(mindahl.InputError, match="cannot read '.*none.json': No such file"):
        mindahl.FitResult.load(tmp_path / "none.json")
    with pytest.raises(mindahl.InputError, match="cannot write '.*none/fit.json': No such file"):
        result.save(tmp_path / "none" / "fit.json")


@pytest.mark.filterwarnings("ignore::mindahl.FitWarning")
def test_processes_fit_files_and_records():
    loads = [DATA / f"load_series_{load}N.csv" for load in (20, 50, 120)]
    records = [mindahl.read_csv(path) for path in loads]
    expected = [mindahl.fit(record).parameters for record in records]
    with ProcessPoolExecutor(2) as pool:
        assert [fit.parameters for fit in pool.map(mindahl.fit, loads)] == expected
        assert [fit.parameters for fit in pool.map(mindahl.fit, records)] == expected
    joblib = pytest.importorskip("joblib")
    fits = joblib.Parallel(2)(joblib.delayed(mindahl.fit)(record) for record in records)
    assert [fit.parameters for fit in fits] == expected


def test_a_record_is_copied_with_all_its_columns(tmp_path):
    path = tmp_path / "loop.csv"
    path.write_text("t [s],phi [deg],M [N m],load [N],temp\n"
                    "0,0,0,5,20\n1,1,2,6,21\n2,2,3,5,22\n3,1,1,6,23\n")
    record = mindahl.read_csv(path, displacement="2", force="3", normal_load_column="4",
                              covariates=["temp"])
    for other in (copy.deepcopy(record), pickle.loads(pickle.dumps(record))):
        assert other.name == record.name and other.is_torsional == record.is_torsional
        assert other.columns == record.columns and other.notes == record.notes
        for name in ("displacement", "force", "time", "normal_load"):
            np.testing.assert_array_equal(getattr(other, name), getattr(record, name))
        np.testing.assert_array_equal(other.covariates["temp"], [20, 21, 22, 23])


def test_a_copied_record_still_has_columns_without_units(sphere, tmp_path):
    path = tmp_path / "loop.csv"
    np.savetxt(path, np.column_stack(sphere[1:]), delimiter=",", header="motion,PULL-N", comments="")
    record = mindahl.read_csv(path, displacement="1", force="2")
    text = mindahl.fit(record).text()
    assert "'motion' (1) in m (assumed), force 'PULL-N' (2) in N (assumed)" in text
    assert mindahl.fit(pickle.loads(pickle.dumps(record))).text() == text


@pytest.mark.filterwarnings("ignore::mindahl.FitWarning")
def test_tables_and_reports_are_pickled():
    for table in (mindahl.track(SPHERE), mindahl.batch([SPHERE, DATA / "none.csv"])):
        other = pickle.loads(pickle.dumps(table))
        assert other.to_json() == table.to_json() and other.text() == table.text()
        assert other.established == table.established
        assert other.to_pandas().equals(table.to_pandas())
    report = mindahl.convert(sigma=4e7, slip_force=40, amplitude=1e-6, to="iwan")
    other = pickle.loads(pickle.dumps(report))
    assert other.to_json() == report.to_json() and other.input_lines == report.input_lines


def test_a_section_is_copied():
    adequacy = mindahl.fit(SPHERE).adequacy
    assert copy.copy(adequacy) == copy.deepcopy(adequacy) == adequacy
    assert pickle.loads(pickle.dumps(adequacy)).verdict == "adequate"


def test_covariances_are_those_of_the_errors_and_correlations(sphere):
    _, displacement, force = sphere
    result = mindahl.fit(displacement, force, fix={"force_offset": 0})
    matrix, names = result.covariance
    assert names == ("sigma", "alpha", "slip_force", "displacement_offset")
    errors = [result.parameters[name].standard_error for name in names]
    np.testing.assert_allclose(np.sqrt(np.diag(matrix)), errors)
    assert matrix[0, 1] == errors[0] * errors[1] * result.correlation.sigma.alpha
    np.testing.assert_array_equal(matrix, matrix.T)


@pytest.mark.parametrize("keywords", [
    {}, {"rig_stiffness": 1e9}, {"model": "dahl"}, {"terms": "asymmetry", "fix": {"force_offset": 0}},
    {"model": "dahl", "terms": "asymmetry", "fix": {"force_offset": 0}}])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("state", ["virgin", "steady"])
def test_a_prediction_along_the_record_is_the_fit(sphere, keywords, sign, state):
    displacement, force = sphere[1], sign * sphere[2]
    result = mindahl.fit(displacement, force, initial_state=state, **keywords)
    rounding = 64 * np.finfo(float).eps * np.abs(force).max()
    np.testing.assert_allclose(result.predict(displacement), result.fitted_force, rtol=0, atol=rounding)


def test_a_prediction_of_several_records_is_of_the_first(sphere):
    _, displacement, force = sphere
    result = mindahl.fit([(displacement, force), (displacement + 1e-6, force + 5.0)], initial_state="virgin")
    rounding = 64 * np.finfo(float).eps * np.abs(force).max()
    np.testing.assert_allclose(result.predict(displacement), result.fitted_force[0], rtol=0, atol=rounding)


def test_a_prediction_of_a_steady_fit_is_of_a_contact_that_has_settled():
    _, displacement = mindahl.excitation(amplitude=2e-6, cycles=4, samples_per_cycle=200)
    force = mindahl.simulate(displacement, sigma=4e7, slip_force=40.0)
    result = mindahl.fit(displacement[200:], force[200:], initial_state="steady")
    smaller = 0.6 * displacement  # [m], a loop that was not measured
    settled = mindahl.simulate(smaller, sigma=4e7, slip_force=40.0)[200:]
    accuracy = 1e-6 * 40.0  # [N], of parameters of a record without noise
    np.testing.assert_allclose(result.predict(smaller[200:]), settled, rtol=0, atol=accuracy)


@pytest.mark.filterwarnings("ignore::mindahl.FitWarning")
def test_a_prediction_does_not_need_a_value_that_is_reported(tmp_path):
    result = mindahl.fit(DATA / "far_from_slip.csv")
    assert result.alpha.value is None and result.alpha.status == "at_upper_bound"
    displacement = result.records[0].displacement
    rounding = 64 * np.finfo(float).eps * np.abs(result.fitted_force).max()
    for again in (result, pickle.loads(pickle.dumps(result)), saved_and_loaded(result, tmp_path)):
        np.testing.assert_allclose(again.predict(displacement), result.fitted_force, rtol=0, atol=rounding)


def test_a_prediction_takes_no_noise_for_a_reversal(tmp_path):
    generator = np.random.default_rng(4)
    _, drive = mindahl.excitation(amplitude=2e-6, cycles=3, samples_per_cycle=2000)
    noise = 5e-9
    force = mindahl.simulate(drive, sigma=4e7, slip_force=30.0, model="dahl")
    measured = drive + generator.normal(0, noise, drive.size)
    result = mindahl.fit(measured, -force + generator.normal(0, 0.05, drive.size), initial_state="virgin")
    # 5 standard deviations of the noise where the branch begins and here, by the largest stiffness.
    bound = 2 * 5 * noise * 4e7
    for again in (result, pickle.loads(pickle.dumps(result)), saved_and_loaded(result, tmp_path)):
        assert np.abs(again.predict(measured) + force).max() < bound


def test_what_cannot_be_predicted_is_refused(sphere, tmp_path):
    seconds, displacement, force = sphere
    result = mindahl.fit(displacement, force)
    failed = {"document": json.dumps({**result.to_dict(), "parameters": {}}), "text": "the fit failed: it diverged\n"}
    with pytest.raises(ValueError, match="^the fit failed: it diverged$"):
        mindahl.FitResult(failed).predict(displacement)
    (tmp_path / "fit.json").write_text(result.to_json())
    with pytest.raises(ValueError, match="read from JSON has not the sign"):
        mindahl.FitResult.load(tmp_path / "fit.json").predict(displacement)
    with pytest.raises(ValueError, match="has no term viscous"):
        mindahl.fit(displacement, force, time=seconds, fix={"viscous": 5.0}).predict(displacement)


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy])
@pytest.mark.parametrize("model,rig", [("mindlin-dahl", None), ("dahl", 1e8)])
def test_a_contact_that_is_moved_goes_on_from_where_it_was(again, model, rig):
    state = mindahl.ContactState(sigma=4e7, slip_force=40.0, model=model, rig_stiffness=rig)
    path = 2e-6 * np.sin(np.linspace(0, 9, 200)) * np.linspace(1, 0.3, 200)
    for displacement in path:
        state.move(displacement)
    other = again(state)
    assert other.force == state.force and other.displacement == state.displacement
    assert [other.move(x) for x in -path] == [state.move(x) for x in -path]


@pytest.mark.parametrize("executor", [ThreadPoolExecutor, ProcessPoolExecutor])
def test_a_test_that_is_tracked_elsewhere_has_the_same_table_and_warnings(tmp_path, executor):
    lines = SPHERE.read_text(encoding="utf-8").splitlines()
    path = tmp_path / "no units.csv"
    path.write_text("\n".join(["t,x,F", *lines[1:300], "7,oops,3", *lines[300:]]), encoding="utf-8")

    def warned(**keywords):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            table = mindahl.track(path, broken_rows="skip", **keywords)
        return table.text(), table.to_json(), [
            (str(each.message), each.category, each.filename) for each in caught]

    with executor(1) as pool:
        assert warned(executor=pool) == warned()
        assert len(warned()[2]) >= 3
        with pytest.raises(mindahl.InputError, match="record"):
            mindahl.track({"x": np.arange(9.0), "F": np.arange(9.0)}, executor=pool)
