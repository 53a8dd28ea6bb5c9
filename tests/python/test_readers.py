"""Records from MAT and HDF5 files, each made by the library that reads it, from xarray and pint;
a result from its JSON. A library that is not installed is skipped."""
import io

import numpy as np
import pytest

import mindahl
from conftest import DATA

pytestmark = pytest.mark.filterwarnings("ignore::mindahl.FitWarning")

TIME = np.linspace(0.0, 2.0, 81)
X = 2e-6 * np.sin(2 * np.pi * TIME)  # [m]
FORCE = 20.0 * np.sin(2 * np.pi * TIME + 0.3)  # [N]


UNIT = 4e-16  # a factor that is not a power of two: two roundings


def is_the_record(record, tolerance=0.0):
    for found, expected in ((record.displacement, X), (record.force, FORCE), (record.time, TIME)):
        np.testing.assert_allclose(found, expected, rtol=tolerance, atol=0)


def is_as(found, expected):
    """The same law, but for a thousandth of its errors."""
    for name in ("sigma", "alpha", "slip_force"):
        parameter = expected.parameters[name]
        assert found.parameters[name].value == pytest.approx(parameter.value, abs=1e-3 * parameter.standard_error)


def test_mat_files_are_read_by_name_in_structs_and_matrices(tmp_path):
    scipy_io = pytest.importorskip("scipy.io")
    path = tmp_path / "test.mat"
    scipy_io.savemat(path, {"time": TIME, "x": X, "F": FORCE, "rate": 40.0, "who": "me"})
    is_the_record(mindahl.read_mat(path))
    scipy_io.savemat(path, {"run": {"time": TIME, "x": X, "F": FORCE}, "other": np.arange(5.0)})
    is_the_record(mindahl.read_mat(path, within="run", time="run.time", displacement="run.x",
                                   force="run.F"))
    scipy_io.savemat(path, {"data": np.column_stack([TIME, X * 1e6, FORCE])})
    is_the_record(mindahl.read_mat(path, time="data_1", displacement="data_2", force="data_3",
                                   displacement_unit="um", force_unit="N"), tolerance=UNIT)
    scipy_io.savemat(path, {"name": "empty"})
    with pytest.raises(ValueError, match="holds no vector of numbers"):
        mindahl.read_mat(path)
    # By the order of their names the force would be the displacement.
    scipy_io.savemat(path, {"run": {"a": FORCE, "b": X}})
    with pytest.raises(ValueError, match="no name says which is the displacement"):
        mindahl.read_mat(path)
    scipy_io.savemat(path, {"run": {"time": TIME, "x": X, "F": FORCE}})
    is_the_record(mindahl.read_mat(path))


def test_hdf5_files_are_read_with_the_units_of_their_attributes(tmp_path):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "test.h5"
    with h5py.File(path, "w") as file:
        group = file.create_group("run 1")
        for name, values, unit in (("time", TIME, "s"), ("displacement", X * 1e6, "um"),
                                   ("force", FORCE, "N")):
            group.create_dataset(name, data=values).attrs["units"] = unit
        file.create_dataset("run 2", data=np.array(list(zip(TIME, X, FORCE)),
                                                   dtype=[("time", "f8"), ("x", "f8"), ("F", "f8")]))
        file.create_dataset("settings", data=np.arange(3.0))
    record = mindahl.read_hdf5(path, within="run 1", time="run 1/time",
                               displacement="run 1/displacement", force="run 1/force")
    is_the_record(record, tolerance=UNIT)
    assert record.columns["displacement"]["unit"] == "um"
    # By the last part of their names; "F" comes before "x".
    is_the_record(mindahl.read_hdf5(path, within="run 2"))
    is_the_record(mindahl.read_hdf5(path, within="run 1"), tolerance=UNIT)
    is_the_record(mindahl.read_hdf5(path, within="run 2", displacement="x", force="F"))
    is_the_record(mindahl.read_hdf5(path, within="run 2", time="run 2.time",
                                    displacement="run 2.x", force="run 2.F"))


OTHER = {"time": np.linspace(0.0, 3.0, 121), "x": 3e-6 * np.sin(np.linspace(0.0, 9.0, 121)),
         "F": 10.0 * np.sin(np.linspace(0.0, 9.0, 121) + 0.3)}
MEANT = {"time": TIME, "x": X, "F": FORCE}


def hdf5(path, groups):
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        for group, columns in groups.items():
            for name, values in columns.items():
                file[f"{group}/{name}"] = values
    return path


@pytest.mark.parametrize("groups, within", [
    ({"run 1": MEANT, "run 1 repeat": OTHER}, "run 1"),
    ({"v1": MEANT, "v1.2": OTHER}, "v1"),
    ({"run": MEANT, "run/raw": OTHER}, "run"),
    ({"run/raw": MEANT, "other": OTHER}, "run"),
    ({"run 1": OTHER, "run 2": MEANT}, "/run 2"),
    ({"": MEANT, "raw": OTHER}, "/"),
    ({"": {"time": TIME}, "run": {"x": X, "F": FORCE}}, None),
    ({"settings": {"gain": np.arange(3.0), "limit": np.arange(3.0)}, "run": MEANT}, None),
    ({"a": {"x": X, "time": TIME}, "b": {"F": FORCE, "G": FORCE}, "run": MEANT}, "run"),
])
def test_the_group_that_is_asked_for_is_read_and_no_other(tmp_path, groups, within):
    is_the_record(mindahl.read_hdf5(hdf5(tmp_path / "test.h5", groups), within=within))


REFUSED = [
    ({"run 1": MEANT, "run 2": OTHER}, "'run 1', 'run 2' have a displacement and a force each: say by within="),
    ({"a": {"displacement": X, "F": FORCE}, "b": {"x": X, "force": FORCE}}, "'a', 'b' have .* by within="),
    ({"first": {"x": X}, "second": {"F": FORCE}}, "of two groups, 'first', 'second': say by within="),
]


@pytest.mark.parametrize("groups, message", REFUSED)
def test_columns_of_two_groups_make_no_record_by_themselves(tmp_path, groups, message):
    scipy_io = pytest.importorskip("scipy.io")
    paths = hdf5(tmp_path / "test.h5", groups), tmp_path / "test.mat"
    scipy_io.savemat(paths[1], {group.replace(" ", "_"): columns for group, columns in groups.items()})
    with pytest.raises(ValueError, match=message) as refused:
        mindahl.read_hdf5(paths[0])
    assert "\n" not in str(refused.value)
    with pytest.raises(ValueError, match=message.replace("run ", "run_")):
        mindahl.read_mat(paths[1])


def test_columns_of_two_groups_are_a_record_where_both_are_named(tmp_path):
    path = hdf5(tmp_path / "test.h5", {"first": {"x": X, "time": TIME}, "second": {"F": FORCE}})
    is_the_record(mindahl.read_hdf5(path, displacement="first/x", force="second/F"))


def test_the_struct_that_is_asked_for_is_read_and_no_other(tmp_path):
    scipy_io = pytest.importorskip("scipy.io")
    path = tmp_path / "test.mat"
    scipy_io.savemat(path, {"run": {**MEANT, "raw": OTHER}, "run_1": OTHER})
    is_the_record(mindahl.read_mat(path, within="run"))


def test_an_open_file_is_called_by_its_name(tmp_path):
    path = tmp_path / "loop.csv"
    np.savetxt(path, np.column_stack([TIME, X, FORCE]), delimiter=",", header="t,x,F", comments="")

    def content(name=None):
        file = io.BytesIO(path.read_bytes())
        if name is not None:
            file.name = name
        return file

    expected = mindahl.fit(path)
    for mode in ("r", "rb"):
        with open(path, mode) as file:
            found = mindahl.fit(file)
        assert found.to_json() == expected.to_json() and found.notes == expected.notes
        assert found.records[0].name == str(path)
    assert mindahl.fit(content()).to_json() == mindahl.fit(content(3)).to_json()
    assert mindahl.fit(content()).records[0].name == "record"
    assert [record.name for record in mindahl.fit([content(), content("a.csv")]).records] == ["record 1", "a.csv"]
    assert list(mindahl.batch([content("a.csv"), content()])["file"]) == ["a.csv", "record"]
    assert mindahl.track(content('say "a"')).to_dict()["input"]["files"] == ['say "a"']
    with pytest.raises(mindahl.InputError, match="^a.csv:3:2: 'no'"):
        broken = io.StringIO("x,F\n1,2\n2,no\n3,4\n4,5\n")
        broken.name = "a.csv"
        mindahl.fit(broken)


def test_an_open_file_is_taken_where_a_path_is(tmp_path):
    path = DATA / "mindlin_sphere_on_plane.csv"
    law = {"sigma": 4e7, "slip_force": 40.0}

    def answers(given):
        return (mindahl.read_csv(given()).displacement.tolist(), mindahl.plan(given()).to_json(),
                mindahl.command("fit", given(), terms="none").parameters,
                mindahl.command("tradeoff", path=given(), **law).to_dict()["excitations"][0]["points"])

    def without_seconds(answer):
        return *answer[:3], [point["max_force_error"] for point in answer[3]]

    assert without_seconds(answers(path.open)) == without_seconds(answers(lambda: path))
    with pytest.raises(ValueError, match="^a int is no array, data frame, record or file$"):
        mindahl.plan(5)
    with pytest.raises(mindahl.InputError, match="^record:1: no row down to"):
        mindahl.plan(io.StringIO("nothing"))


def test_a_dictionary_of_arrays_is_a_record():
    expected = mindahl.fit(X, FORCE, time=TIME)
    columns = {"F [N]": FORCE, "x [m]": X, "t [s]": TIME}
    assert mindahl.fit(columns).sigma.value == expected.sigma.value
    assert mindahl.fit(columns, displacement=2, force="F").sigma.value == expected.sigma.value


def test_quantities_of_pint_are_fitted_in_their_units(sphere):
    pint = pytest.importorskip("pint")
    units = pint.UnitRegistry()
    time, displacement, force = sphere
    expected = mindahl.fit(displacement, force, time=time)
    found = mindahl.fit((displacement * 1e6) * units.micrometer, (force / 1e3) * units.kilonewton,
                        time=time * units.second)
    is_as(found, expected)
    with pytest.raises(ValueError, match="force has the unit kilogram: must be one of N, N"):
        mindahl.fit(displacement * units.meter, force * units.kilogram)
    with pytest.raises(ValueError, match="has a unit of its own"):
        mindahl.fit(displacement * units.meter, force, displacement_unit="um")


def test_datasets_of_xarray_are_fitted_with_the_units_of_their_attributes(sphere):
    xarray = pytest.importorskip("xarray")
    time, displacement, force = sphere
    expected = mindahl.fit(displacement * 1e6, force, time=time, displacement_unit="um")
    dataset = xarray.Dataset(
        {"displacement": ("time", displacement * 1e6, {"units": "um"}),
         "force": ("time", force, {"units": "N"})}, coords={"time": ("time", time, {"units": "s"})})
    of_dataset = mindahl.fit(dataset)
    of_arrays = mindahl.fit(dataset["displacement"], dataset["force"], time=dataset["time"])
    for name in ("sigma", "alpha", "slip_force"):
        assert of_dataset.parameters[name].value == expected.parameters[name].value
        assert of_arrays.parameters[name].value == expected.parameters[name].value


def test_columns_in_volts_are_calibrated(tmp_path, sphere):
    time, displacement, force = sphere
    expected = mindahl.fit(displacement, force, time=time, initial_state="virgin")
    path = tmp_path / "volts.csv"
    np.savetxt(path, np.column_stack([time, displacement, force / 8 + 0.5]), delimiter=",", fmt="%.17g",
               header="time [s],x [m],F [V]", comments="")
    is_as(mindahl.fit(path, force="F*8-4 [N]", initial_state="virgin"), expected)
    path = tmp_path / "of_a_zero_alone.csv"
    np.savetxt(path, np.column_stack([time, displacement, force + 0.5]), delimiter=",", fmt="%.17g",
               header="time [s],x [m],F [N]", comments="")
    zeroed = mindahl.fit(path, force="F-0.5", initial_state="virgin")
    np.testing.assert_allclose(zeroed.records[0].force, force, rtol=0, atol=1e-12 * np.ptp(force))
