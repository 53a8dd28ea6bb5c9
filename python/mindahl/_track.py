"""mindahl.track()."""

from __future__ import annotations

import copy
import json
import os
import warnings
from collections.abc import Mapping, Sequence
from functools import cached_property
from html import escape
from typing import Any, Optional, Union, cast

import numpy as np

from . import _mindahl
from ._arguments import Uncertain, contact_options, count, in_executor, path_text, several
from ._fit import Asked, Range, request_of
from ._records import RecordArguments, is_path, records_of
from ._result import FitWarning, Table


class CycleTable(Table):
    """The answer of track(): one row a cycle, a NumPy array a column; unknown values are NaN.

    units: of the columns that have one. to_pandas(): the same as a data frame.
    headline: the whole test in one line.
    changes: sentences on steps and trends beyond chance, at most ten; empty if there are none.
    energy_counts: number of fits that `accumulated_energy` counts with their own energy,
        "measured", with that of the fits before them, "replaced", or not at all, "left_out".
    quantities: the time history of each quantity by name, as `mindahl track --json` has it: "unit",
        "first", "last", "settled_at", "steps" and "trends".
    """

    def __init__(self, columns: Mapping[str, Any], units: Mapping[str, str],
                 test: _mindahl.TrackedTest) -> None:
        self._columns = {name: np.asarray(values) for name, values in columns.items()}
        self.units = dict(units)
        self._test: Optional[_mindahl.TrackedTest] = test
        self._established = test.established

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_described": self._described, "_test": None}

    @cached_property
    def _described(self) -> tuple[str, str, list[str]]:
        assert self._test is not None  # of a pickled table the description is there
        return self._test.describe()

    @cached_property
    def _document(self) -> dict[str, Any]:
        return dict(json.loads(self.to_json()))

    def to_dict(self) -> dict[str, Any]:
        """What `mindahl track --json` writes; its "output" is None."""
        return copy.deepcopy(self._document)

    def to_json(self) -> str:
        """The same as text, byte for byte."""
        return self._described[0]

    def text(self) -> str:
        """What `mindahl track` prints."""
        return self._described[1]

    def __str__(self) -> str:
        return self.text()

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self.text())}</pre>"

    @property
    def established(self) -> bool:
        """Did any fit converge?"""
        return self._established

    @property
    def energy_counts(self) -> dict[str, int]:
        return dict(self._document["energy_counts"])

    @property
    def headline(self) -> str:
        return str(self._document["headline"])

    @property
    def quantities(self) -> dict[str, dict[str, Any]]:
        return copy.deepcopy(dict(self._document["quantities"]))

    @property
    def changes(self) -> tuple[str, ...]:
        return tuple(self._described[2])

    def __repr__(self) -> str:
        return f"<mindahl.CycleTable: {len(self['cycle'])} rows of {', '.join(self._columns)}>"


def track(
    source: Any = None, force: Any = None, *, displacement: Any = None, time: Any = None,
    normal_load: Optional[Uncertain] = None, normal_load_column: Any = None,
    displacement_unit: Optional[str] = None, force_unit: Optional[str] = None,
    time_unit: Optional[str] = None, normal_load_unit: Optional[str] = None,
    encoding: str = "", sample_rate: Optional[float] = None, join: bool = False,
    model: str = "auto", initial_state: str = "auto", force_sign: str = "auto",
    offsets: Union[bool, str] = True, rig_stiffness: Optional[Asked] = None,
    terms: Union[str, Sequence[str]] = "none",
    fix: Optional[Mapping[str, float]] = None,
    start: Optional[Mapping[str, float]] = None, bound: Optional[Mapping[str, Range]] = None,
    prior: Optional[Mapping[str, Range]] = None, loss: str = "none", confidence: float = 0.95,
    force_noise: Optional[float] = None,
    displacement_noise: Optional[float] = None, reversal_gate: Optional[float] = None,
    average: int = 1, every: int = 1, broken_rows: str = "refuse", threads: Optional[int] = None,
    executor: Any = None, **known: Optional[Uncertain],
) -> CycleTable:
    """Fits every cycle of a long record on its own: one row a cycle.

    source, force, displacement, time, normal_load_column, units, encoding, sample_rate: as of
        fit(). A file is read piece by piece, in constant memory; a list of sources
        is one test in this order, and no cycle extends over two sources unless join is
        True.
    normal_load: [N] of all cycles; by default the column's mean over each. With compliance, or
        youngs_modulus_1, poisson_1 and those of body 2, as of fit(), it has the contact radius.
    average: number of consecutive cycles that are fitted together. every: fits only every n-th.
    broken_rows: of files, "refuse" or "skip". threads: number of workers; default one per core.
    terms: as in fit(); "auto" chooses by the first cycles of the first source, for all cycles.
    The others: as of fit(), but that covariates are not for single cycles.
    Returns the columns of `mindahl track --output` (docs/track.md), in SI units.
    Warns with FitWarning of what was assumed of columns and units, of uncertain reversals and of
        rows that were skipped.
    Raises InputError (a ValueError) for a fault in data or options, ValueError for one of a value.
    executor: where the test is tracked instead of here, as of batch(): what it gives back is pickled.
    Other threads run while it fits.
    """
    given = dict(locals())
    if executor is not None:
        words = {name: value for name, value in given.items() if name not in ("executor", "known")}
        return cast(CycleTable, in_executor(executor, _track_one, [{**words, **known}])[0])
    fit = request_of(given)
    fit.contact = contact_options(normal_load=normal_load, **known)
    request = _mindahl.TrackRequest()
    request.average = count("average", average, 1)
    request.every = count("every", every, 1)
    request.threads = (os.cpu_count() or 1) if threads is None else count("threads", threads, 1)
    arguments = RecordArguments(given)
    files = _files_of(source)
    if files is None:
        if broken_rows == "skip":
            raise ValueError("broken_rows has no effect on what is no file: leave it out")
        request.fit = fit
        found = _mindahl.track(request, records_of(source, force, arguments))
    else:
        arguments.roles["force"] = force
        fit.columns = arguments.columns()
        fit.files = list(files)
        request.fit = fit
        request.skips_broken_rows = broken_rows == "skip"
        found = _mindahl.track(request, [])
    columns, units, doubts, test = found
    for doubt in (*arguments.assumed, *doubts):
        warnings.warn(_mindahl.with_keywords(doubt), FitWarning, stacklevel=2)
    return CycleTable(columns, units, test)


def _track_one(words: dict[str, Any]) -> CycleTable:
    return track(**words)


def _files_of(source: Any) -> Optional[Sequence[str]]:
    """The paths, where all sources are files."""
    if is_path(source):
        return [path_text(source)]
    elements = several(source)
    if elements and all(is_path(element) for element in elements):
        return [path_text(element) for element in elements]
    return None
