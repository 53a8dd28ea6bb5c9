"""mindahl.track()."""

from __future__ import annotations

import csv
import inspect
import io
import warnings
from typing import Any, Optional

import numpy as np

from . import _mindahl
from ._arguments import in_executor, several, words
from ._commands import Answer, ask
from ._fit import fit
from ._records import OF_FILES, ROLES, UNITS, RecordArguments, is_path, records_of
from ._result import FitWarning, Table, Told


class CycleTable(Told, Table):
    """The answer of track(): one row a cycle, a NumPy array a column; unknown values are NaN.

    units: of the columns that have one. to_pandas(): the same as a data frame.
    headline: the whole test in one line.
    changes: sentences on steps and trends beyond chance, at most ten; empty if there are none.
    quantities: the time history of each quantity by name, as `mindahl track --json` has it: "unit",
        "first", "last", "settled_at", "varies" and "changes".
    established: did any fit converge?
    """

    def __init__(self, answer: Answer, table: str) -> None:
        self._document = answer.document.replace('"output": "output"', '"output": null')
        self._text, self.established = answer.text.replace(" in output", "", 1), answer.established
        document = self.to_dict()
        self.headline: str = document["headline"]
        self.quantities: dict[str, dict[str, Any]] = document["quantities"]
        self.changes = tuple(document["changes"])
        header, *rows = csv.reader(io.StringIO(table))
        self.units: dict[str, str] = {}
        self._columns = {}
        for name, cells in zip(header, zip(*rows) if rows else [()] * len(header)):
            name, _, unit = name.partition(" [")
            if unit:
                self.units[name] = unit[:-1]
            if name in ("cycle", "first_line", "samples", "cycles"):
                self._columns[name] = np.array(cells, dtype=np.int64)
            elif name == "flags":
                self._columns[name] = np.array(cells, dtype=str)
            else:
                self._columns[name] = np.array([float(cell or "nan") for cell in cells])


def track(source: Any = None, force: Any = None, *, average: int = 1,
          threads: Optional[int] = None, executor: Any = None, **keywords: Any) -> CycleTable:
    """Fits every cycle of a long record on its own: one row a cycle.

    source, force: as of fit(). A file is read piece by piece, in constant memory; a list of sources is
        one test in this order, and no cycle extends over two sources.
    average: number of consecutive cycles that are fitted together, fewer at the end of a source.
    threads: number of workers; default one per core. executor: where the test is tracked instead of
        here, as of batch(): what it gives back is pickled.
    keywords: of fit(), but for single cycles' covariates, trim and selections. terms: "auto" chooses by
        the first cycles of the first source, for all. normal_load: [N] of all cycles; by default the
        column's mean over each; with compliance, or youngs_modulus_1 and the others, it has the
        contact radius.
    Returns the columns of `mindahl track --output` (docs/track.md), in SI units.
    Warns with FitWarning of what was assumed of columns and units, of uncertain reversals and of
        rows that were skipped.
    Raises InputError (a ValueError) for a fault in data or options, ValueError for one of a value,
        TypeError for a keyword that fit() does not have.
    Other threads run while it fits.
    """
    inspect.signature(fit).bind_partial(**keywords)
    task = {"source": source, "force": force, "average": average, "threads": threads,
            **keywords}
    done: tuple[CycleTable, list[str]] = (_tracked(task) if executor is None else
                                          in_executor(executor, _tracked, [task])[0])
    for message in done[1]:
        warnings.warn(message, FitWarning, stacklevel=2)
    return done[0]


def _tracked(keywords: dict[str, Any]) -> tuple[CycleTable, list[str]]:
    """The table, and what is to be warned of."""
    said: list[str] = []
    of_records = ("source", *ROLES, *UNITS, *OF_FILES)
    asked = words({name: value for name, value in keywords.items() if name not in of_records})
    arguments = RecordArguments(keywords)
    sources = several(keywords["source"]) or [keywords["source"]]
    if all(map(is_path, sources)):
        asked += arguments.words()
    else:
        if keywords.get("broken_rows") == "skip":
            raise ValueError("broken_rows has no effect on what is no file: leave it out")
        sources = records_of(keywords["source"], arguments)
        said += map(_mindahl.with_keywords, arguments.assumed)
    answer, (table,) = ask("track", asked, [("", each) for each in sources], ["output"], said.append)
    return CycleTable(answer, table), said
