"""track(), simulate(), contact(), convert(), read_csv() and ContactState."""

import copy
import csv
import math

import numpy as np
import pandas
import pytest

import mindahl
from conftest import DATA, program, program_json, read_columns

SIGMA, SLIP_FORCE = 4e7, 40.0
LAW = {"sigma": SIGMA, "slip_force": SLIP_FORCE}
SPHERE = DATA / "mindlin_sphere_on_plane.csv"


@pytest.fixture(scope="module")
def long_record(tmp_path_factory):
    """Thirty cycles, of noise that does not hide them."""
    path = tmp_path_factory.mktemp("track") / "long.csv"
    path.write_text(program("simulate", "--model", "mindlin-dahl", "--sigma", SIGMA, "--slip-force",
                            SLIP_FORCE, "--waveform", "sine", "--amplitude", "3e-6", "--cycles", 30,
                            "--samples-per-cycle", 100, "--noise-force", 0.2, "--seed", 3))
    return path


def table_of(path, tmp_path, *options):
    output = tmp_path / "cycles.csv"
    program("track", path, "--output", output, *options)
    with open(output, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    # The checksum is what --resume goes on by, which a table in memory has no use for.
    return {name.split(" [")[0]: [row[name] for row in rows] for name in rows[0]
            if name != "checksum"}


def assert_same_table(tracked, table):
    assert list(tracked) == [name for name in tracked if name in table]
    assert set(tracked) == set(table)
    for name, cells in table.items():
        if name == "flags":
            assert list(tracked[name]) == cells, name
            continue
        expected = np.array([float(cell) if cell else np.nan for cell in cells])
        np.testing.assert_array_equal(tracked[name], expected, err_msg=name)


@pytest.mark.parametrize("keywords, options", [
    ({"normal_load": 100}, ["--normal-load", 100]),
    ({"compliance": 4e-11}, ["--compliance", "4e-11"]),
    ({"average": 2}, ["--average", 2]),
])
def test_track_gives_the_program_s_table(long_record, tmp_path, keywords, options):
    table = table_of(long_record, tmp_path, *options)
    tracked = mindahl.track(long_record, **keywords)
    assert_same_table(tracked, table)
    assert len(tracked["cycle"]) == math.ceil(29 / keywords.get("average", 1))
    assert tracked.units["sigma"] == "N/m"
    assert list(tracked.to_pandas()["cycle"]) == list(tracked["cycle"])
    if "compliance" in keywords:
        assert tracked["contact_radius"] == pytest.approx(tracked["sigma"] * 4e-11 / 8)
    if "average" in keywords:  # of two cycles a row each dissipates the same but for the noise
        single = mindahl.track(long_record)
        assert tracked["accumulated_energy"][-1] == pytest.approx(single["accumulated_energy"][-1], rel=0.01)


def test_track_says_what_changed_as_the_program_does(long_record, tmp_path):
    worn = tmp_path / "worn.csv"
    worn.write_text(program("simulate", "--model", "mindlin-dahl", "--sigma", SIGMA, "--slip-force",
                            0.8 * SLIP_FORCE, "--waveform", "sine", "--amplitude", "3e-6",
                            "--cycles", 30, "--samples-per-cycle", 100, "--noise-force", 0.2,
                            "--seed", 4))
    expected = program_json("track", long_record, worn, "--output", tmp_path / "worn_cycles.csv")
    tracked = mindahl.track([long_record, worn])
    assert tracked.quantities == expected["quantities"]
    written = program("track", long_record, worn, "--output", tmp_path / "again.csv", "--json", "-")
    assert tracked.to_json() == written.replace(f'"output": "{tmp_path}/again.csv"', '"output": null')
    printed = program("track", long_record, worn, "--output", tmp_path / "third.csv")
    assert tracked.text() == printed.replace(f" in {tmp_path}/third.csv", "")
    assert "<pre>" in tracked._repr_html_() and tracked.established
    step, = tracked.quantities["slip_force"]["changes"]
    assert step["to"] == pytest.approx(0.8 * step["from"], rel=0.01)
    assert any(line.startswith(f"slip_force: a step at cycle {step['first_cycle']}, ") for line in tracked.changes)
    assert tracked.headline.startswith("Tc ")
    assert not any("step" in line for line in mindahl.track(long_record).changes)


def test_excitation_is_the_program_s_waveform():
    for waveform in ("sine", "triangle", "growing-sine"):
        lines = program("simulate", "--sigma", SIGMA, "--slip-force", SLIP_FORCE, "--waveform",
                        waveform, "--amplitude", "3e-6", "--cycles", 3, "--samples-per-cycle", 40)
        expected = np.loadtxt(lines.splitlines(), delimiter=",", skiprows=1, unpack=True)
        time, displacement = mindahl.excitation(waveform, amplitude=3e-6, cycles=3,
                                                samples_per_cycle=40)
        np.testing.assert_array_equal(time, expected[0])
        np.testing.assert_array_equal(displacement, expected[1])


def test_track_of_arrays_frames_and_files_is_the_same(long_record):
    expected = mindahl.track(long_record, average=2)
    time, displacement, force = read_columns(long_record)
    frame = pandas.read_csv(long_record, float_precision="round_trip")
    for tracked in (mindahl.track(displacement, force, time=time, average=2),
                    mindahl.track(frame, average=2)):
        for name in set(expected) - {"first_line"}:  # a file's first sample is on line 2
            np.testing.assert_array_equal(tracked[name], expected[name], err_msg=name)


def test_track_has_every_whole_cycle_whatever_it_averages(long_record):
    single = mindahl.track(long_record)
    averaged = mindahl.track(long_record, average=len(single["cycle"]) - 1)
    assert averaged["cycles"].tolist() == [len(single["cycle"]) - 1, 1]
    np.testing.assert_allclose(averaged["accumulated_energy"][-1],
                               single["accumulated_energy"][-1], rtol=1e-3)


def test_track_warns_of_rows_that_it_skipped(long_record, tmp_path):
    broken = tmp_path / "broken.csv"
    lines = long_record.read_text().splitlines()
    lines[700] = "7,oops,3"
    broken.write_text("\n".join(lines) + "\n")
    with pytest.raises(mindahl.InputError, match=r"broken\.csv:701:2: 'oops'"):
        mindahl.track(broken)
    with pytest.warns(mindahl.FitWarning, match=r"1 row is left out, the first: .*broken\.csv:701:2"):
        tracked = mindahl.track(broken, broken_rows="skip")
    assert len(tracked["cycle"]) == 29


@pytest.mark.parametrize("model", ["mindlin-dahl", "mindlin", "dahl", "jenkins", "simplified-dahl"])
def test_simulate_gives_the_program_s_force(model, tmp_path):
    generator = np.random.default_rng(7)
    displacement = np.cumsum(generator.normal(size=400)) * 3e-7
    path = tmp_path / "path.csv"
    path.write_text("\n".join(map(repr, displacement.tolist())) + "\n")
    output = tmp_path / "force.csv"
    program("simulate", "--model", model, "--sigma", SIGMA, "--slip-force", SLIP_FORCE, "--path",
            path, "-o", output)
    force = mindahl.simulate(displacement, **LAW, model=model)
    np.testing.assert_array_equal(force, read_columns(output)[2])


def test_a_contact_state_moves_as_simulate_does():
    generator = np.random.default_rng(11)
    displacement = np.cumsum(generator.normal(size=300)) * 3e-7
    for model in ("mindlin-dahl", "dahl", "jenkins"):
        expected = mindahl.simulate(displacement, **LAW, model=model)
        state = mindahl.ContactState(**LAW, model=model)
        moved = [state.move(x) for x in displacement]
        # docs/accuracy.md: below 5e-14 of the slip force after reversals, in either of the two.
        accuracy = 1e-13 * SLIP_FORCE
        np.testing.assert_allclose(moved, expected, rtol=0, atol=accuracy)
        assert state.force == moved[-1] and state.displacement == displacement[-1]
        assert state.peek(2e-7) == copy.copy(state).move(2e-7)
        assert state.displacement == displacement[-1]
        state.reset()
        assert state.force == 0 and state.tangent_stiffness == SIGMA


def test_a_joint_follows_the_torque_that_it_carries():
    generator = np.random.default_rng(12)
    angle = np.cumsum(generator.normal(size=300)) * 4e-4
    torque = 10 + 40 * np.cos(np.arange(300) / 17)
    state = mindahl.ContactState(sigma=2500 / 3, slip_force=1, alpha=1.0, model="dahl")
    z = np.array([state.move(x) for x in angle])
    force = 3 * (np.abs(torque) * z - 0.2 * torque * z**2) / 22
    one_load = mindahl.simulate(angle, sigma=2500, slip_force=3, alpha=1.0, model="dahl", asymmetry=-0.2)
    np.testing.assert_allclose(one_load, 3 * (z - 0.2 * z**2), rtol=0, atol=1e-12)
    fit = mindahl.fit(angle, force, normal_load_column=torque, model="dahl", terms="asymmetry",
                      initial_state="virgin", reversal_gate=0)
    assert abs(fit.asymmetry.value + 0.2) < 1e-9
    assert abs(fit.slip_force.value * 22 / 3 / np.abs(torque).mean() - 1) < 1e-9


@pytest.mark.parametrize("call, message", [
    (lambda: mindahl.simulate([0, 1e-6], sigma=-1, slip_force=1), "must be finite and > 0"),
    (lambda: mindahl.simulate([0, 1e-6], sigma=1, slip_force=1, model="oak"), "model: 'oak' is unknown"),
    (lambda: mindahl.simulate([0, 1e-6], sigma=1, slip_force=1, model="mindlin", alpha=0.5),
     "alpha=0.5 contradicts model mindlin"),
    (lambda: mindahl.simulate(np.zeros((2, 2)), sigma=1, slip_force=1), "shape"),
    (lambda: mindahl.simulate([0, "x"], sigma=1, slip_force=1), "dtype"),
    (lambda: mindahl.simulate([0, 1.0], sigma="stiff", slip_force=1), "sigma = 'stiff' is invalid"),
    (lambda: mindahl.ContactState(sigma=1, slip_force=1).move(np.nan), "displacement"),
    (lambda: mindahl.contact(friction=0.3), "normal_load and either contact_radius"),
    (lambda: mindahl.contact(friction=-1, normal_load=1, contact_radius=1, compliance=1),
     r"friction \[-\] = -1 is invalid"),
    (lambda: mindahl.convert(sigma=1, slip_force=1, amplitude=1, to="brass"),
     "to: brass not in"),
    (lambda: mindahl.convert(sigma=1, slip_force=1, amplitude=-1, to="dahl"), "invalid"),
    (lambda: mindahl.convert(sigma=1, slip_force=1, amplitude=1, to="dahl", normal_load=3),
     "normal_load has no effect unless to is lammps"),
    (lambda: mindahl.track([0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 1.0, 1.5, 1.6, 1.7]), "record: no whole cycle"),
    (lambda: mindahl.track(SPHERE, average=0), "average: Value 0 not in range"),
    (lambda: mindahl.track(SPHERE, broken_rows="mend"), "broken_rows: mend not in"),
    (lambda: mindahl.track(SPHERE, normal_load=0), r"normal_load \[N\] = 0 is invalid"),
    (lambda: mindahl.excitation("triangel", amplitude=1e-6),
     "waveform: triangel not in"),
    (lambda: mindahl.excitation(amplitude=-1.0), "amplitude"),
    (lambda: mindahl.plan(**LAW), "force_noise missing"),
    (lambda: mindahl.plan(**LAW, force_noise=1, want={"alpa": 1}), "'alpa' is unknown"),
    (lambda: mindahl.plan(**LAW, force_noise=1, want={"alpha": "much"}), "want: 'alpha=much' is no precision"),
    (lambda: mindahl.plan(SPHERE, **LAW), "record excludes sigma"),
    (lambda: mindahl.command("validate", cases=0), "cases: Value 0 not in range"),
    (lambda: mindahl.command("validate", cases=2).to_pandas("lines"), "table = 'lines' is invalid"),
    (lambda: mindahl.batch([SPHERE], model="oak"), "model: oak not in"),
    (lambda: mindahl.batch([SPHERE], strict="very"), "strict = 'very' is invalid"),
    (lambda: mindahl.batch([SPHERE], executor=3), "executor: a int has neither"),
    (lambda: mindahl.batch([]), "sources is empty: give a file"),
    (lambda: mindahl.track(SPHERE, terms="lags"), "^terms: 'lags' is no term: that of a column is not available"),
])
def test_what_breaks_a_rule_is_refused(call, message):
    with pytest.raises(ValueError, match=message) as refused:
        call()
    assert "\n" not in str(refused.value)


def test_read_csv_converts_units_and_says_what_it_read(tmp_path):
    path = tmp_path / "rig.csv"
    path.write_text("Time, ms;disp_mm;F (kN);temp\n0;0;0;20\n1;0,5;1;21\n2;1;2;22\n3;0,5;1;23\n")
    record = mindahl.read_csv(path)
    np.testing.assert_array_equal(record.displacement, [0, 0.5 / 1e3, 1e-3, 0.5 / 1e3])
    np.testing.assert_array_equal(record.force, [0, 1e3, 2e3, 1e3])
    np.testing.assert_array_equal(record.time, [0, 1e-3, 2e-3, 3e-3])
    np.testing.assert_array_equal(record.covariates["temp"], [20, 21, 22, 23])
    assert record.normal_load is None
    assert record.columns["force"] == {"name": "F (kN)", "index": 3, "unit": "kN"}
    assert len(record) == 4


def test_read_csv_takes_a_rate_a_second_file_and_broken_rows(tmp_path):
    path, other = tmp_path / "x.csv", tmp_path / "force.csv"
    path.write_text("x [mm]\n0\n1\n2\n1\n")
    other.write_text("F [N]\n0\n3\n5\n2\n")
    record = mindahl.read_csv(path, with_file=other, sample_rate=200)
    np.testing.assert_array_equal(record.force, [0, 3, 5, 2])
    np.testing.assert_allclose(record.time, [0, 5e-3, 1e-2, 1.5e-2])
    path.write_text("x [mm],F [N]\n0,0\n1,one\n2,5\n1,2\n")
    with pytest.raises(mindahl.InputError, match="'one'"):
        mindahl.read_csv(path)
    assert len(mindahl.read_csv(path, broken_rows="skip")) == 3
    with pytest.raises(ValueError, match="with_file has no effect on what is no file"):
        mindahl.fit(record.displacement, record.force, with_file=other)


def test_arrays_are_used_where_they_are():
    """A read-only array is taken as it is, and none is written to."""
    displacement = np.linspace(0, 1e-6, 50)
    displacement.setflags(write=False)
    before = displacement.copy()
    mindahl.simulate(displacement, **LAW)
    np.testing.assert_array_equal(displacement, before)
    from mindahl._arguments import array
    assert array("displacement", displacement) is displacement
