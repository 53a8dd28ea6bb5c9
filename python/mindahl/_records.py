"""Records from arrays, data frames and files, all by the rules of the program's reader."""

from __future__ import annotations

import copyreg
import os
import tempfile
from collections.abc import Mapping, Sequence
from typing import Any, Optional, Union

import numpy as np

from . import _mindahl
from ._arguments import (array, column_text, is_array, is_frame, is_quantity, optional_number,
                         path_text, several, with_unit)
from ._mindahl import Record

Column = Union[str, int]
Path = Union[str, os.PathLike[str]]
# Units in which a quantity is read, by its role.
UNITS = {"displacement": ("m", "rad"), "force": ("N", "N*m"), "time": ("s",),
         "normal_load_column": ("N",)}
UNIT_KEYWORDS = ("displacement_unit", "force_unit", "time_unit", "normal_load_unit")
FILE_KEYWORDS = ("encoding", "sample_rate", "with_file", "broken_rows")


def columns_of(
    displacement: Optional[Column], force: Optional[Column], time: Optional[Column],
    normal_load_column: Optional[Column], displacement_unit: Optional[str],
    force_unit: Optional[str], time_unit: Optional[str], normal_load_unit: Optional[str],
    covariates: Sequence[str] = (), encoding: str = "", sample_rate: Optional[float] = None,
    with_file: Optional[Path] = None, broken_rows: str = "refuse",
) -> _mindahl.RecordColumns:
    columns = _mindahl.RecordColumns(
        column_text("displacement", displacement, displacement_unit),
        column_text("force", force, force_unit), column_text("time", time, time_unit),
        column_text("normal_load_column", normal_load_column, normal_load_unit), list(covariates),
        encoding)
    columns.sample_rate = optional_number("sample_rate", sample_rate)
    columns.with_file = "" if with_file is None else path_text(with_file)
    if broken_rows not in ("refuse", "skip"):
        raise ValueError(f"broken_rows = {broken_rows!r} is invalid: must be 'refuse' or 'skip'")
    columns.skip_broken_rows = broken_rows == "skip"
    return columns


def record_options(given: Mapping[str, Any]) -> _mindahl.RecordColumns:
    """What the arguments of read_csv() say of the columns."""
    return columns_of(**{name: given[name] for name in (
        *UNITS, *UNIT_KEYWORDS, "covariates", *FILE_KEYWORDS)})


def read_csv(
    path: Path, *, displacement: Optional[Column] = None,
    force: Optional[Column] = None, time: Optional[Column] = None,
    normal_load_column: Optional[Column] = None, displacement_unit: Optional[str] = None,
    force_unit: Optional[str] = None, time_unit: Optional[str] = None,
    normal_load_unit: Optional[str] = None, covariates: Sequence[str] = (), encoding: str = "",
    sample_rate: Optional[float] = None, with_file: Optional[Path] = None,
    broken_rows: str = "refuse",
) -> Record:
    """Reads a hysteresis record from a CSV file as the program does.

    path: the file; delimiter, decimal mark, header and units are found by themselves.
    displacement, force, time, normal_load_column: column by header name or number counted from 1,
        with its unit, "5 [mm]", or that alone, "[mm]"; or a sum with factors and an offset,
        "cell1+cell2", "raw*0.0123-4.5 [N]"; by default found from names, units and numbers.
    displacement_unit, force_unit, time_unit, normal_load_unit: symbols such as "um" and "kN"; by
        default the header's, else m, N and s with a note.
    covariates: further columns, by name or number, kept in units of their own.
    encoding: as iconv names it; by default UTF-8, or found from the first bytes.
    sample_rate: [Hz], where there is no time. with_file: another file of the same test, whose
        columns follow. broken_rows: "refuse" or "skip" rows without a number.
    Returns a Record in SI units: displacement [m], force [N], time [s], normal_load [N].
    Raises InputError naming file, line and column.
    """
    return _mindahl.read_csv(path_text(path), record_options(locals()))


class RecordArguments:
    """How the arguments of fit() and track() that say what a record is are to be read."""

    def __init__(self, given: Mapping[str, Any], covariates: Sequence[str] = (),
                 max_memory: Optional[int] = None) -> None:
        self.roles: dict[str, Any] = {**{role: given.get(role) for role in UNITS}, "force": None}
        self.units: dict[str, Any] = {name: given.get(name) for name in UNIT_KEYWORDS}
        self.covariates = list(covariates)
        self.of_files = {name: given[name] for name in FILE_KEYWORDS if name in given}
        self.max_memory = max_memory
        """Of the files that are still to be read, all together."""
        self.assumed: list[str] = []
        """Of the columns and units of files and frames that were read, a sentence each."""

    def columns(self) -> _mindahl.RecordColumns:
        for role, value in self.roles.items():
            if value is not None and not isinstance(value, (str, int, np.integer)):
                raise ValueError(f"{role}: must be the name or the number of a column here, where "
                                 "the columns are in a file or a frame")
        return columns_of(**self.roles, **self.units, covariates=self.covariates, **self.of_files)

    def refuse_choices(self, what: str) -> None:
        given = [name for name, value in {**self.roles, **self.units}.items() if value is not None]
        if given:
            raise ValueError(f"{given[0]} has no effect on {what}: leave it out")

    def of_table(self, name: str, names: Sequence[str], arrays: Sequence[Any],
                 columns: _mindahl.RecordColumns) -> Record:
        if columns.with_file:
            raise ValueError("with_file has no effect on what is no file: leave it out")
        return _mindahl.record_of_columns(name, names, arrays, columns)

    def of_frame(self, frame: Any, name: str) -> Record:
        names = [str(column) for column in frame.columns]
        arrays = [array(name, frame.iloc[:, k].to_numpy(), keep_missing=True)
                  for k, name in enumerate(names)]
        return self.of_table(name, names, arrays, self.columns())

    def of_mapping(self, columns: Mapping[str, Any], name: str) -> Record:
        """Arrays by the names of columns, with their units, as in a file: {"x [um]": ..., "F": ...}."""
        return self.of_table(name, [str(column) for column in columns],
                             [array(str(column), values, keep_missing=True)
                              for column, values in columns.items()], self.columns())

    def of_file(self, file: Any, name: str) -> Record:
        """What a file object holds, read as a file of its name is."""
        content = file.read()
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, os.path.basename(str(getattr(file, "name", name))) or name)
            with open(path, "wb") as copy:
                copy.write(content.encode() if isinstance(content, str) else content)
            return _mindahl.read_csv(path, self.columns(), self.max_memory)

    def of_dataset(self, dataset: Any, name: str) -> Record:
        """A Dataset of xarray: its variables and coordinates of one dimension, with their units."""
        names, arrays = [], []
        for column, values in {**dataset.coords, **dataset.data_vars}.items():
            if values.ndim == 1 and np.asarray(values).dtype.kind in "fiu":
                unit = values.attrs.get("units")
                names.append(f"{column} [{unit}]" if unit else str(column))
                arrays.append(array(str(column), values, keep_missing=True))
        if len({len(values) for values in arrays}) > 1:
            raise ValueError(f"{name}: its variables have {', '.join(map(str, dataset.sizes))} for "
                             "dimensions: select those of one")
        return self.of_table(name, names, arrays, self.columns())

    def of_arrays(self, columns: Mapping[str, Any], name: str,
                  covariates: Mapping[str, Any]) -> Record:
        names, arrays = [], []
        choices: dict[str, Any] = {}
        headers = {"displacement": "displacement", "force": "force", "time": "time",
                   "normal_load_column": "normal load"}
        torsional = any(self.units[f"{role}_unit"] is not None for role in ("displacement", "force"))
        for role, header in headers.items():
            choices[role] = None
            if columns.get(role) is None:
                continue
            unit = {"time": " [s]", "normal_load_column": " [N]"}.get(
                role, "" if torsional else {"displacement": " [m]", "force": " [N]"}.get(role, ""))
            values, stated = with_unit(role, columns[role], UNITS[role])
            if stated is not None:
                unit = f" [{stated}]"
                if is_quantity(columns[role]) and self.units.get(f"{role}_unit") is not None:
                    raise ValueError(f"{role}_unit: {role} has a unit of its own: leave it out")
            names.append(header + unit)
            arrays.append(array(role, values))
            choices[role] = len(names)
        for covariate, values in covariates.items():
            names.append(covariate)
            arrays.append(array(covariate, values))
        for header, values in zip(names, arrays):
            if len(values) != len(arrays[0]):
                raise ValueError(f"{header} has {len(values)} samples and {names[0]} "
                                 f"{len(arrays[0])}: give as many of both")
        return self.of_table(name, names, arrays, columns_of(
            **choices, **self.units, covariates=self.covariates, **self.of_files))


def _record_again(name: str, names: list[str], arrays: list[Any], roles: dict[str, int],
                  covariates: list[str]) -> Record:
    choices: dict[str, Any] = {**dict.fromkeys((*UNITS, *UNIT_KEYWORDS)), **roles}
    return _mindahl.record_of_columns(name, names, arrays, columns_of(**choices, covariates=covariates))


def _reduced(record: Record) -> Any:
    """A record for pickle and copy: its arrays, called by what they are; its notes are said already."""
    length, force = ("rad", "N m") if record.is_torsional else ("m", "N")
    found = {"displacement": (f"displacement [{length}]", record.displacement),
             "force": (f"force [{force}]", record.force), "time": ("time [s]", record.time),
             "normal_load_column": (f"normal load [{force}]", record.normal_load)}
    given = {role: column for role, column in found.items() if column[1] is not None}
    others = record.covariates
    return _record_again, (record.name, [*(name for name, _ in given.values()), *others],
                           [np.array(values) for values in (
                               *(values for _, values in given.values()), *others.values())],
                           {role: k + 1 for k, role in enumerate(given)}, list(others))


copyreg.pickle(Record, _reduced)


def is_path(value: Any) -> bool:
    return isinstance(value, (str, os.PathLike))


def records_of(source: Any, force: Any, arguments: RecordArguments,
               covariates: Optional[Mapping[str, Any]] = None) -> list[Record]:
    """The records that the arguments of fit() and track() say."""
    roles = arguments.roles
    if source is None:
        source, roles["displacement"] = roles["displacement"], None
        if source is None:
            raise ValueError("a record is missing: give displacement and force, a data frame, a "
                             "record or a file")
    if force is not None:
        roles["force"] = force
    elements = several(source)
    if elements is None and is_array(source):
        return [_record_of_arrays(source, roles, arguments, "record", covariates or {})]
    if elements is None:
        return [_record_of(source, arguments, "record")]
    if not elements:
        raise ValueError("a record is missing: the list is empty")
    if not all(is_array(element) for element in elements):
        return [_record_of(element, arguments, f"record {k + 1}")
                for k, element in enumerate(elements)]
    records = []
    for k, element in enumerate(elements):
        own = {role: _element(role, value, k, len(elements)) for role, value in roles.items()
               if role != "displacement"}
        records.append(_record_of_arrays(
            element, {"displacement": None, **own}, arguments, f"record {k + 1}",
            {name: _element(name, values, k, len(elements))
             for name, values in (covariates or {}).items()}))
    return records


def _element(name: str, values: Any, k: int, count: int) -> Any:
    if values is None:
        return None
    elements = several(values)
    if elements is None or len(elements) != count:
        raise ValueError(f"{name}: must be a list of {count} arrays, one a record")
    return elements[k]


def _record_of_arrays(displacement: Any, roles: Mapping[str, Any], arguments: RecordArguments,
                      name: str, covariates: Mapping[str, Any]) -> Record:
    if roles.get("displacement") is not None:
        raise ValueError("displacement is given twice: give it once")
    if roles.get("force") is None:
        raise ValueError("force is missing: give an array of the force [N], one a displacement")
    for role, value in roles.items():
        if isinstance(value, (str, int)):
            raise ValueError(f"{role} = {value!r} names a column, but the displacement is an array: "
                             "give an array")
    return arguments.of_arrays({**roles, "displacement": displacement}, name, covariates)


def _record_of(source: Any, arguments: RecordArguments, name: str) -> Record:
    record = _read_record(source, arguments, name)
    arguments.assumed.extend(record.notes)
    return record


def _read_record(source: Any, arguments: RecordArguments, name: str) -> Record:
    if isinstance(source, Record):
        arguments.refuse_choices("a record that is read already")
        return source
    if is_path(source):
        return _mindahl.read_csv(path_text(source), arguments.columns(), arguments.max_memory)
    if is_frame(source):
        return arguments.of_frame(source, name)
    if hasattr(source, "data_vars"):
        return arguments.of_dataset(source, name)
    if isinstance(source, Mapping):
        return arguments.of_mapping(source, name)
    if hasattr(source, "read"):
        return arguments.of_file(source, name)
    array(name, source)  # says why it is no array
    raise ValueError(f"{name}: a {type(source).__name__} is no array, data frame, record or file")
