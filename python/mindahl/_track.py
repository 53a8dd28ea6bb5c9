"""mindahl.track()."""

from __future__ import annotations

import csv
import io
import warnings
from collections.abc import Mapping, Sequence
from typing import Any, Optional, Union, cast

import numpy as np

from . import _mindahl
from ._arguments import Uncertain, in_executor, several, words
from ._commands import Answer, ask
from ._fit import Asked, Range
from ._records import OF_FILES, ROLES, UNITS, RecordArguments, is_path, records_of
from ._result import FitWarning, Table, Told


class CycleTable(Told, Table):
    """The answer of track(): one row a cycle, a NumPy array a column; unknown values are NaN.

    units: of the columns that have one. to_pandas(): the same as a data frame.
    headline: the whole test in one line.
    changes: sentences on steps and trends beyond chance, at most ten; empty if there are none.
    energy_counts: number of fits that `accumulated_energy` counts with their own energy,
        "measured", with that of the fits before them, "replaced", or not at all, "left_out".
    quantities: the time history of each quantity by name, as `mindahl track --json` has it: "unit",
        "first", "last", "settled_at", "steps" and "trends".
    established: did any fit converge?
    """

    def __init__(self, answer: Answer, table: str) -> None:
        self._document = answer.document.replace('"output": "output"', '"output": null')
        self._text, self.established = answer.text.replace(" in output", "", 1), answer.established
        document = self.to_dict()
        self.headline: str = document["headline"]
        self.energy_counts: dict[str, int] = document["energy_counts"]
        self.quantities: dict[str, dict[str, Any]] = document["quantities"]
        _, _, changes = self._text.partition("\nChanges beyond chance:\n")
        self.changes = tuple(line.strip() for line in changes.splitlines())
        header, *rows = csv.reader(io.StringIO(table))
        self.units: dict[str, str] = {}
        self._columns = {}
        for name, cells in zip(header, zip(*rows) if rows else [()] * len(header)):
            name, _, unit = name.partition(" [")
            if unit:
                self.units[name] = unit[:-1]
            if name in ("cycle", "first_line", "samples"):
                self._columns[name] = np.array(cells, dtype=np.int64)
            elif name in ("slip_regime", "flags"):
                self._columns[name] = np.array(cells, dtype=str)
            elif name != "checksum":
                self._columns[name] = np.array([float(cell or "nan") for cell in cells])

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
        passed = {name: value for name, value in given.items() if name not in ("executor", "known")}
        return cast(CycleTable, in_executor(executor, _track_one, [{**passed, **known}])[0])
    own = ("source", "force", "executor", "known", *ROLES, *UNITS, *OF_FILES)
    asked = words({**{name: value for name, value in given.items() if name not in own}, **known,
                   "normal_load": normal_load})
    arguments = RecordArguments(given)
    sources = several(source) or [source]
    if all(map(is_path, sources)):
        arguments.roles["force"] = force
        asked += arguments.words()
    else:
        if broken_rows == "skip":
            raise ValueError("broken_rows has no effect on what is no file: leave it out")
        sources = records_of(source, force, arguments)
        for doubt in arguments.assumed:
            warnings.warn(_mindahl.with_keywords(doubt), FitWarning, stacklevel=2)
    answer, (table,) = ask("track", asked, [("", each) for each in sources], ["output"])
    return CycleTable(answer, table)


def _track_one(keywords: dict[str, Any]) -> CycleTable:
    return track(**keywords)
