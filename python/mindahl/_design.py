"""mindahl.plan(), tradeoff() and validate()."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Optional, Union

import numpy as np

from . import _mindahl
from ._arguments import (Uncertain, array, count, is_array, law_of, names_of, number, numbers,
                         optional_number, path_text)
from ._contact import report_of
from ._mindahl import Record
from ._records import RecordArguments, is_path, records_of
from ._result import Report


def _one_record(record: Any) -> tuple[Record, list[str]]:
    """A record from a file, a frame, a Record or a pair of arrays, and what was assumed of it."""
    arguments = RecordArguments({})
    is_pair = isinstance(record, (tuple, list)) and len(record) == 2 and all(map(is_array, record))
    source, force = record if is_pair else (record, None)
    records = records_of(source, force, arguments)
    if len(records) != 1:
        raise ValueError(f"record: {len(records)} records: give one")
    return records[0], arguments.assumed


def plan(
    record: Any = None, *, sigma: Optional[float] = None, alpha: Optional[float] = None,
    slip_force: Optional[float] = None, rig_stiffness: Optional[float] = None,
    force_noise: Optional[float] = None, displacement_noise: float = 0.0,
    autocorrelation: float = 0.0, load_exponent: Optional[float] = None,
    amplitude: Union[None, float, Sequence[float]] = None,
    load_ratio: Union[None, float, Sequence[float]] = None, cycles: float = 3.0,
    samples_per_cycle: int = 200, initial_state: str = "both",
    with_: Union[None, str, Sequence[str]] = None,
    want: Optional[Mapping[str, Union[float, str]]] = None, **contact: Optional[Uncertain],
) -> Report:
    """Plans a measurement: the standard errors that a loop of each amplitude would give.

    The contact, one of
        sigma [N/m], alpha [-] (1/3), slip_force Tc [N]; or friction, normal_load, ... of contact();
        record: a file, data frame, Record or (displacement [m], force [N]), whose fit gives contact
            and noise; alpha is used where it does not determine one.
    rig_stiffness: of a rig in series [N/m]. force_noise [N], displacement_noise [m]: standard deviations;
        autocorrelation of the force noise [-], in [0, 1). load_exponent: p of sigma ~ N^p [-].
    amplitude: X [m], one or several; by default 13 around the onset of slip. load_ratio: loads
        relative to the contact's own [-], one loop at each. cycles >= 1, samples_per_cycle >= 4.
    initial_state: "virgin", "steady" or "both". with_: further terms to fit, "rig_stiffness",
        "plateau_slope", "viscous", "force_drift".
    want: parameter to wanted standard error, in its unit or in percent: {"slip_force": "1%"}.
    Returns the sections of `mindahl plan --json`; .to_pandas() has a row a loop; .established is
        False where no amplitude reaches what is wanted.
    Raises InputError (a ValueError) naming what is missing, ValueError for a value out of range.
    """
    request = _mindahl.PlanRequest()
    request.law = law_of(sigma, alpha, slip_force, contact)
    request.rig_stiffness = optional_number("rig_stiffness", rig_stiffness)
    request.force_noise = optional_number("force_noise", force_noise)
    request.displacement_noise = number("displacement_noise", displacement_noise)
    request.autocorrelation = number("autocorrelation", autocorrelation)
    request.load_exponent = optional_number("load_exponent", load_exponent)
    request.amplitudes = numbers("amplitude", amplitude)
    request.load_ratios = numbers("load_ratio", load_ratio)
    request.cycles = number("cycles", cycles)
    request.samples_per_cycle = count("samples_per_cycle", samples_per_cycle, 4)
    request.with_terms = names_of(with_)
    for name, precision in (want or {}).items():
        is_relative = isinstance(precision, str) and precision.endswith("%")
        value = _tolerance(f"want[{name!r}]", precision)
        request.set_wanted(name, value, is_relative)
    read, assumed = (None, []) if record is None else _one_record(record)
    answer = _mindahl.plan(request, initial_state, read)
    return report_of(answer, "plan", ("loops", "reached"), assumed)


def _tolerance(name: str, value: Union[float, str]) -> float:
    """A number, 0.01, or a text in percent, "1%"."""
    if isinstance(value, str) and value.endswith("%"):
        try:
            return float(value[:-1]) / 100
        except ValueError:
            pass
    return number(name, value)


def tradeoff(
    displacement: Any = None, *, excitation: Union[None, str, Sequence[str]] = None,
    path_unit: Optional[str] = None, sigma: Optional[float] = None, alpha: Optional[float] = None,
    slip_force: Optional[float] = None, tolerance: Union[float, str] = 0.01,
    **contact: Optional[Uncertain],
) -> Report:
    """Error against cost of every model and method, and the cheapest within a tolerance.

    excitation: "micro", "macro", "growing", "random", "nested", one or several; by default all.
    displacement: an array [m] instead, or a file whose first column it is, in path_unit.
    sigma [N/m], alpha [-] (1/3), slip_force Tc [N], or friction, normal_load, ... of contact(); by
        default the contact of Peyret et al. (2017).
    tolerance: largest error of the force over its peak, and of the dissipated energy, 0.01 or "1%".
    Returns the sections of `mindahl tradeoff --json`; .to_pandas() has a row a point. Costs are by
        what a method does along the motion, and times of this run.
    Raises InputError (a ValueError) naming what is missing, ValueError for a value out of range.
    """
    samples = np.empty(0)
    if is_path(displacement):
        samples = _mindahl.read_displacement_path(path_text(displacement), path_unit or "")
    elif displacement is not None:
        samples = array("displacement", displacement)
    if samples.size and excitation is not None:
        raise ValueError("displacement excludes excitation: give one of the two")
    return report_of(_mindahl.tradeoff(
        law_of(sigma, alpha, slip_force, contact), names_of(excitation), samples,
        path_text(displacement) if is_path(displacement) else "displacement",
        _tolerance("tolerance", tolerance)), "tradeoff", ("excitations",))


def validate(cases: int = 500, seed: int = 1) -> Report:
    """Tests the mapping: fits Mindlin loops of many contacts and compares sigma, alpha and Tc.

    cases: contacts to draw, each fitted at every noise level. seed: of the random numbers.
    Returns the sections of `mindahl validate --json`; .passed, and .to_pandas() with a row an
        amplitude and noise level, .to_pandas("dahl_rows"), .to_pandas("coverage").
    Cost: some 10 ms a contact. Other threads run meanwhile.
    """
    return report_of(_mindahl.validate(count("cases", cases, 1), count("seed", seed, 0)),
                     "validation", ("rows", "dahl_rows", "coverage"))
