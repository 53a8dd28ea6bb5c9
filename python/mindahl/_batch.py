"""mindahl.batch()."""

from __future__ import annotations

import inspect
import json
import os
import threading
import warnings
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Optional, Union

import numpy as np

from . import _mindahl
from ._arguments import count, in_executor
from ._fit import fit, prepared, request_and_arguments
from ._records import is_source, name_of
from ._result import FitWarning, Report, Table, Told

STRICTNESS = (False, "doubtful", True)  # as the library counts


class BatchTable(Told, Table):
    """The answer of batch(): one row a source, an array a column; unknown values are NaN or None.

    report: sections of `mindahl batch --json`, `files` with the fit of each, and `repeats`.
    faults: why a source has no fit or is not established, by its name.
    """

    def __init__(self, entries: list[_mindahl.BatchEntry]) -> None:
        table, self._csv, self._document, self._text, self.established = _mindahl.batch(entries)
        rows = json.loads(table)
        self._columns = {name: _column([row[name] for row in rows]) for name in (rows[0] if rows else ())}
        self.report = Report(self._document, self._text, self.established, "batch")
        self.faults = {name: fault for name, fault, *_ in entries if fault}

    def to_csv(self) -> str:
        """What `mindahl batch --output` writes."""
        return self._csv


def _column(cells: list[Any]) -> Any:
    """Numbers as float64 or int64, with NaN for None; texts as objects."""
    cells = [("no", "yes")[cell] if isinstance(cell, bool) else cell for cell in cells]
    if any(isinstance(cell, str) for cell in cells):
        return np.array(cells, dtype=object)
    if all(isinstance(cell, int) for cell in cells):
        return np.array(cells, dtype=np.int64)
    return np.array([np.nan if cell is None else cell for cell in cells], dtype=np.float64)


def batch(
    sources: Any, *, strict: Union[bool, str] = False, threads: Optional[int] = None,
    executor: Any = None, **keywords: Any,
) -> BatchTable:
    """Fits each source on its own, with any keyword of fit() for all of them: one row a source.

    sources: files, data frames, Records or pairs (displacement [m], force [N]), each a test of its
        own; or one of these. A source that fails does not stop the others.
    strict: True, or "doubtful", as --strict: a source whose fit is not established fails too.
    threads: number of worker threads (default: one per core); the results are identical.
    executor: instead of threads, an object with submit(function, *arguments) whose futures have
        result(), or with map(function, arguments): concurrent.futures, dask.distributed's Client.
        What its workers are given and give back can be pickled.
    keywords: of fit(), except arrays that belong to one record, as force and time.
    Returns a BatchTable, the columns of `mindahl batch --output`.
    Warns with FitWarning of what was assumed of columns and units and of every source that failed.
    Raises InputError (a ValueError) or ValueError for keywords that break a rule whatever the sources
        are, TypeError for one that fit() does not have.
    """
    bound = inspect.signature(fit).bind_partial(**keywords)  # TypeError for what fit() has not
    bound.apply_defaults()
    given = dict(bound.arguments)
    request_and_arguments(given)[0].check()
    if strict not in STRICTNESS:
        raise ValueError(f"strict = {strict!r} is invalid: must be True, False or 'doubtful'")
    listed = [sources] if is_source(sources) else list(sources)
    if not listed:
        raise _mindahl.InputError("sources is empty: give a file, data frame, Record or pair")
    stop = threading.Event()
    tasks = [(source, f"record {k + 1}", STRICTNESS.index(strict), given, None if executor is not None else stop.is_set)
             for k, source in enumerate(listed)]
    if executor is not None:
        entries = in_executor(executor, _fit_one, tasks)
    else:
        workers = (os.cpu_count() or 1) if threads is None else count("threads", threads, 1)
        pool = ThreadPoolExecutor(workers)
        try:
            entries = list(pool.map(_fit_one, tasks))
        finally:
            stop.set()  # of fits that Ctrl-C left
            pool.shutdown(cancel_futures=True)
    for name, fault, _, notes, *_ in entries:
        for message in (*notes, *([f"{name}: {fault}"] if fault else [])):
            warnings.warn(_mindahl.with_keywords(message), FitWarning, stacklevel=2)
    return BatchTable(entries)


def _fit_one(task: tuple[Any, str, int, dict[str, Any], Any]) -> _mindahl.BatchEntry:
    source, name, strictness, given, stops = task
    name = name_of(source, name)
    try:
        records, request, _ = prepared({**given, "source": source})
        if len(records) != 1:
            raise ValueError(f"{name}: {len(records)} records: each is a source of its own")
        return _mindahl.fit_one(records[0], request, strictness, stops)
    except ValueError as error:
        return name, str(error) or repr(error), False, [], "", {}
