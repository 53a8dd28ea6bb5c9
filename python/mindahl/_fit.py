"""mindahl.fit()."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from typing import Any, Optional, Union

from . import _mindahl
from ._arguments import (Uncertain, array, assignments, column_text, contact_options, count, counts,
                         fitted_or_number, interval, mapping, names_of, number, on_off,
                         optional_number, pair, path_text, priors_of, uncertain)
from ._contact import report_of
from ._mindahl import Record
from ._records import RecordArguments, columns_of, is_path, records_of
from ._result import FitResult, FitWarning, Report

Range = tuple[float, float]
Asked = Union[float, str]


def request_of(given: Mapping[str, Any]) -> _mindahl.FitRequest:
    """What the arguments of fit() or track() ask of the model and of its terms."""
    request = _mindahl.FitRequest()
    request.model = given["model"]
    request.initial_state = given["initial_state"]
    request.force_sign = given["force_sign"]
    request.noise_in = given.get("noise_in", "force")
    request.offsets = on_off("offsets", given["offsets"])
    covariate = given.get("covariate")
    if isinstance(covariate, Mapping):
        for column, value in covariate.items():
            request.add_covariate(column, fitted_or_number(f"covariate[{column!r}]", value))
    else:
        for column in names_of(covariate):
            request.add_covariate(column, None)
    request.fix = assignments("fix", given["fix"])
    request.start = assignments("start", given["start"])
    request.prior = priors_of(given["prior"])
    for parameter, value in mapping("bound", given["bound"], "(low, high)").items():
        low, high = pair(f"bound[{parameter!r}]", value)
        request.set_bound(parameter, number(f"bound[{parameter!r}]", low),
                          number(f"bound[{parameter!r}]", high))
    request.terms = names_of(given["terms"])
    request.compare = given.get("compare", False)
    request.loss = given["loss"]
    request.confidence = number("confidence", given["confidence"])
    for name in ("force_noise", "displacement_noise", "reversal_gate"):
        setattr(request, name, optional_number(name, given[name]))
    request.join = given["join"]
    rig = given["rig_stiffness"]
    if isinstance(rig, tuple):
        value, uncertainty = pair("rig_stiffness", rig)
        request.set_rig_stiffness(number("rig_stiffness", value),
                                  number("rig_stiffness", uncertainty))
    elif rig is not None:
        request.set_rig_stiffness(fitted_or_number("rig_stiffness", rig), None)
    return request


def fit(
    source: Any = None, force: Any = None, *, displacement: Any = None, time: Any = None,
    normal_load: Union[None, Uncertain, Sequence[Uncertain]] = None,
    normal_load_column: Any = None, columns: Optional[Mapping[str, Any]] = None,
    displacement_unit: Optional[str] = None, force_unit: Optional[str] = None,
    time_unit: Optional[str] = None, normal_load_unit: Optional[str] = None,
    encoding: str = "", sample_rate: Optional[float] = None,
    with_file: Union[None, str, os.PathLike[str]] = None, broken_rows: str = "refuse",
    join: bool = False, model: str = "auto", initial_state: str = "auto", force_sign: str = "auto",
    noise_in: str = "force", offsets: Union[bool, str] = True,
    rig_stiffness: Optional[Union[Asked, tuple[float, float]]] = None,
    terms: Union[str, Sequence[str]] = "none", compare: bool = False,
    covariate: Union[None, str, Sequence[str], Mapping[str, Asked]] = None,
    fix: Optional[Mapping[str, float]] = None, start: Optional[Mapping[str, float]] = None,
    bound: Optional[Mapping[str, Range]] = None, prior: Optional[Mapping[str, Range]] = None,
    cycles: Optional[tuple[int, int]] = None,
    samples: Optional[tuple[int, int]] = None,
    trim: Union[bool, str] = True, time_window: Optional[Range] = None,
    load_window: Optional[Range] = None, loss: str = "none", confidence: float = 0.95,
    force_noise: Optional[float] = None,
    displacement_noise: Optional[float] = None, reversal_gate: Optional[float] = None,
    youngs_modulus_1: Optional[Uncertain] = None, poisson_1: Optional[Uncertain] = None,
    radius_1: Optional[Uncertain] = None, youngs_modulus_2: Optional[Uncertain] = None,
    poisson_2: Optional[Uncertain] = None, radius_2: Optional[Uncertain] = None,
    contact_radius: Optional[Uncertain] = None, compliance: Optional[Uncertain] = None,
    max_memory: Optional[int] = None,
) -> FitResult:
    """Fits sigma [N/m], alpha [-] and Tc [N] of a contact to its hysteresis loop.

    Keywords are the options of `mindahl fit`, with underscores.

    The record, one of
        fit(displacement, force): arrays, [m] and [N] or displacement_unit and force_unit; of a
            torsional record an angle [rad] and a torque [N m] by displacement_unit="rad".
        fit(frame): a data frame with named columns, "x [um]", recognised as in a file;
            displacement, force, time and normal_load_column choose others by name or number.
        fit({"x [um]": ..., "F": ...}): arrays by the names of columns, as in a frame.
        fit("loop.csv"), fit(file), fit(read_csv(...)): a file, one that is open, or a record.
        A list of any of these: one joint fit of the same contact, arrays in lists of one length.
            A column is "Fx", 5, "5 [mm]", or a sum, "cell1+cell2".
    encoding: of files, as iconv names it. sample_rate: [Hz], where there is no time. with_file:
        another file of the same test, whose columns follow. broken_rows: of files, "refuse" or
        "skip". join: a list is one record in pieces, as of a logger that begins a file with every
        stroke.
    time: array [s], or column. normal_load_column: array [N], one a sample, or column.
    columns: further arrays by name beside displacement and force, for covariate.

    The model
        model: "auto", Masing's law or Dahl's own, whichever the record supports; "mindlin-dahl",
            "dahl", "mindlin" (alpha = 1/3), "jenkins" (alpha = 0).
        initial_state: "auto", "virgin", "steady". force_sign: "auto", "same", "opposite".
        noise_in: the channel that has the noise and is fitted, "force", or "displacement" where the
            force is imposed and exact; residuals are then in [m].
        offsets: of force [N] and displacement [m], fitted unless False.
        rig_stiffness [N/m]: a known value, "fit", or (K, U) to fit it about K with standard
            uncertainty U.
        terms: names of terms that are fitted in addition to the law, as of `mindahl fit
            --help-all`, or of columns; "auto" adds those that the record requires, as judged by
            held-out cycles; "none".
        compare: adds the table of all models, with and without a rig.
        covariate: column or columns in proportion to which a force is added, or a dict of them
            with "fit" or the known factor [N/unit].
        fix: parameter to value, which adds its term; start: likewise, to begin with; bound:
            parameter to (low, high); prior: parameter to (prior value, standard uncertainty); SI
            units.

    What counts
        cycles, samples: (first, last), counted from 1.
        trim: leaves out what at the ends is not of the test, with a note.
        max_memory: files whose fit needs more memory [bytes] are refused; default: the limit of the
            process. Arrays in memory are not counted.
        time_window: (low, high) [s]. load_window: (low, high) [N].
        loss: "none", "huber", "cauchy", "tukey". force_noise [N], displacement_noise [m]: known
            standard deviations. reversal_gate [m]: smaller excursions are noise.
        confidence: of every interval.

    What is known of the contact, each a number or (number, standard uncertainty)
        normal_load [N], also a list, one a record; youngs_modulus_1 [Pa], poisson_1 [-], radius_1
        [m] (inf a plane, negative a seat) and the same of body 2; contact_radius [m]; compliance
        G* [1/Pa] = (2-nu1)/G1 + (2-nu2)/G2.

    Returns a FitResult; one that failed or did not converge is a result too (result.converged).
    What a person should act on, and what was assumed of columns and units, is also a FitWarning.
    Raises InputError (a ValueError) for a fault in data or options, ValueError for one of a value.
    Other threads run while it fits. Cost: the library's fit and a millisecond.
    """
    records, request, assumed = prepared(locals())
    result = FitResult(_mindahl.fit(records, request))
    for message in (*assumed, *(warning.message for warning in result.warnings)):
        warnings.warn(_mindahl.with_keywords(message), FitWarning, stacklevel=2)
    return result


def sweep(
    source: Any = None, *, kind: str = "secant", displacement: Any = None, force: Any = None,
    response: Any = None, displacement_unit: Optional[str] = None,
    force_unit: Optional[str] = None, response_unit: Optional[str] = None,
    response_noise: Optional[float] = None, encoding: str = "", model: str = "mindlin-dahl",
    fix: Optional[Mapping[str, float]] = None, confidence: float = 0.95,
) -> Report:
    """Fits sigma, alpha and Tc to stiffnesses or compliances over the amplitude, as `mindahl fit --sweep`.

    The sweep, one of
        sweep(path), sweep(frame): columns recognised by name, or named by force or displacement, of
            which the amplitudes are, and response.
        sweep(force=amplitudes, response=stiffnesses): arrays, [N] or displacement [m], and [N/m],
            or in force_unit, displacement_unit and response_unit; "m/N" and the like are compliances.
    kind: "secant", of the loop from end to end, or "tangent", of a small oscillation at a force.
    response_noise: known standard deviation of a response [N/m] or [m/N].
    model: "mindlin-dahl", "mindlin" or "jenkins". fix: parameter to value. confidence: of intervals.
    Returns the sections of `mindahl fit --sweep --json`; .to_pandas() has a row a parameter.
    Raises InputError (a ValueError) for a fault in data or options, ValueError for one of a value.
    """
    request = _mindahl.FitRequest()
    request.model = model
    request.fix = assignments("fix", fix)
    request.confidence = number("confidence", confidence)
    names: list[str] = []
    arrays: list[Any] = []
    roles: dict[str, Any] = {"displacement": displacement, "force": force, "response": response}
    units: dict[str, Optional[str]] = {
        "displacement": displacement_unit, "force": force_unit, "response": response_unit}
    if source is None:
        for role, values in roles.items():
            if values is None:
                continue
            names.append(role)
            arrays.append(array(role, values))
            roles[role] = len(names)
            units[role] = units[role] or {"displacement": "m", "force": "N", "response": "N/m"}[role]
        if len(names) != 2 or "response" not in names:
            raise ValueError("a sweep of arrays is of response and one of force and displacement")
    elif not is_path(source):
        names = [str(column) for column in source.columns]
        arrays = [array(column, source.iloc[:, k].to_numpy(), keep_missing=True)
                  for k, column in enumerate(names)]
    request.columns = columns_of(
        displacement=roles["displacement"], force=roles["force"], time=None,
        normal_load_column=None, displacement_unit=units["displacement"],
        force_unit=units["force"], time_unit=None, normal_load_unit=None, encoding=encoding)
    name = path_text(source) if is_path(source) else "sweep"
    answer = _mindahl.sweep(
        request, kind, name, names, arrays,
        column_text("response", roles["response"], units["response"]),
        optional_number("response_noise", response_noise))
    return report_of(answer, "sweep", ("parameters",))


_KNOWN = ("youngs_modulus_1", "poisson_1", "radius_1", "youngs_modulus_2", "poisson_2", "radius_2",
          "contact_radius", "compliance")


def request_and_arguments(given: Mapping[str, Any]) -> tuple[_mindahl.FitRequest, RecordArguments]:
    """What the arguments of fit() ask for, and how they say that records are to be read."""
    request = request_of(given)
    request.set_cycles(counts("cycles", given["cycles"]))
    request.set_samples(counts("samples", given["samples"]))
    request.set_time_window(interval("time_window", given["time_window"]))
    request.set_load_window(interval("load_window", given["load_window"]))
    request.trim = on_off("trim", given["trim"])
    request.contact = contact_options(**{name: given[name] for name in _KNOWN})
    loads = given["normal_load"]
    if loads is not None:
        request.set_normal_loads([uncertain("normal_load", load)
                                  for load in (loads if isinstance(loads, list) else [loads])])
    most = given["max_memory"]
    arguments = RecordArguments(
        given, request.covariate_columns(),
        None if most is None else count("max_memory", most, 1))
    request.columns = _mindahl.RecordColumns(
        "", "", column_text("time", None, given["time_unit"]),
        column_text("normal_load_column", None, given["normal_load_unit"]), [])
    return request, arguments


def prepared(given: Mapping[str, Any]) -> tuple[list[Record], _mindahl.FitRequest, list[str]]:
    """The records and the request that the arguments of fit() say, and what was assumed."""
    request, arguments = request_and_arguments(given)
    records = records_of(given["source"], given["force"], arguments, given["columns"])
    return records, request, arguments.assumed
