"""mindahl.fit()."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from typing import Any, Optional, Union

from . import _mindahl
from ._arguments import Uncertain, words
from ._records import OF_FILES, ROLES, UNITS, RecordArguments, records_of
from ._result import FitResult, FitWarning

Range = tuple[float, float]
Asked = Union[float, str]


def fit(
    source: Any = None, force: Any = None, *, displacement: Any = None, time: Any = None,
    normal_load: Union[None, Uncertain, Sequence[Uncertain]] = None,
    normal_load_column: Any = None,
    displacement_unit: Optional[str] = None, force_unit: Optional[str] = None,
    time_unit: Optional[str] = None, normal_load_unit: Optional[str] = None,
    encoding: str = "", sample_rate: Optional[float] = None,
    with_file: Union[None, str, os.PathLike[str]] = None, broken_rows: str = "refuse",
    model: str = "auto", initial_state: str = "auto", force_sign: str = "auto",
    noise_in: str = "force", offsets: Union[bool, str] = True,
    rig_stiffness: Optional[Union[Asked, tuple[float, float]]] = None,
    terms: Union[str, Sequence[str]] = "none", compare: bool = False,
    covariate: Union[None, str, Sequence[str], Mapping[str, Asked]] = None,
    fix: Optional[Mapping[str, float]] = None, start: Optional[Mapping[str, float]] = None,
    bound: Optional[Mapping[str, Range]] = None, prior: Optional[Mapping[str, Range]] = None,
    select: Union[None, str, Sequence[str], Mapping[str, Range]] = None,
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
        A list of any of these, of arrays as pairs (displacement, force): one joint fit of the same
            contact.
            A column is "Fx", 5, "5 [mm]", or a sum, "cell1+cell2".
    encoding: of files, as iconv names it. sample_rate: [Hz], where there is no time. with_file:
        another file of the same test, whose columns follow. broken_rows: of files, "refuse" or
        "skip".
    time: array [s], or column. normal_load_column: array [N], one a sample, or column.

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
        select: "cycles=2:5", or a dict of cycles, samples, time and load with (first, last), cycles
            and samples counted from 1. cycles, samples: the same of one.
        trim: leaves out what at the ends is not of the test, with a note.
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
    fitted = _mindahl.fit(records, request)
    result = FitResult(fitted.kept, fitted)
    for message in (*assumed, *(warning.message for warning in result.warnings)):
        warnings.warn(_mindahl.with_keywords(message), FitWarning, stacklevel=2)
    return result


def request_and_arguments(given: Mapping[str, Any]) -> tuple[_mindahl.FitRequest, RecordArguments]:
    """What the arguments of fit() ask for, and how they say that records are to be read."""
    of_records = ("source", *ROLES, *UNITS, *OF_FILES)
    request = _mindahl.FitRequest(words({name: value for name, value in given.items()
                                         if name not in of_records}))
    return request, RecordArguments(given, request.covariate_columns())


def prepared(given: Mapping[str, Any]) -> tuple[list[_mindahl.Record], _mindahl.FitRequest, list[str]]:
    """The records and the request that the arguments of fit() say, and what was assumed."""
    request, arguments = request_and_arguments(given)
    try:
        return records_of(given["source"], arguments), request, arguments.assumed
    except _mindahl.InputError as error:
        raise _mindahl.InputError(request.explained(str(error))) from None
