"""Records from arrays, data frames and files, all by the rules of the program's reader."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping, Sequence
from typing import Any, Optional, Union

import numpy as np

from . import _mindahl
from ._arguments import (array, column_text, is_array, is_pair, is_quantity, several, with_unit,
                         words)
from ._mindahl import Record

Column = Union[str, int]
Path = Union[str, os.PathLike[str]]
Columns = list[tuple[str, Any]]
ROLES = ("displacement", "force", "time", "normal_load_column")
# Units in which a quantity is read.
SI = {"displacement": ("m", "rad"), "force": ("N", "N*m"), "time": ("s",), "normal_load_column": ("N",)}
UNITS = ("displacement_unit", "force_unit", "time_unit", "normal_load_unit")
OF_FILES = ("encoding", "sample_rate", "with_file", "broken_rows")


def name_of(source: Any, default: str) -> str:
    """What reports and messages call a path, an open file or a record, or else `default`."""
    if is_path(source):
        return str(os.fspath(source))
    name = getattr(source, "name", None) if hasattr(source, "read") or isinstance(source, Record) else None
    return name if isinstance(name, str) else default


def copy_of(file: Any, path: str) -> str:
    """What an open file holds, in a file of this path."""
    content = file.read()
    with open(path, "wb") as copy:
        copy.write(content.encode() if isinstance(content, str) else content)
    return path


def read_file(source: Any, request: _mindahl.FitRequest, name: str = "record") -> Record:
    """The record of a path, or of what an open file holds."""
    if not hasattr(source, "read"):
        path = os.fspath(source)
        return _mindahl.read_csv(path, request, path)
    with tempfile.TemporaryDirectory() as folder:
        return _mindahl.read_csv(copy_of(source, f"{folder}/copy"), request, name_of(source, name))


def read_csv(
    path: Any, *, displacement: Optional[Column] = None,
    force: Optional[Column] = None, time: Optional[Column] = None,
    normal_load_column: Optional[Column] = None, displacement_unit: Optional[str] = None,
    force_unit: Optional[str] = None, time_unit: Optional[str] = None,
    normal_load_unit: Optional[str] = None, covariates: Sequence[str] = (), encoding: str = "",
    sample_rate: Optional[float] = None, with_file: Optional[Path] = None,
    broken_rows: str = "refuse",
) -> Record:
    """Reads a hysteresis record from a CSV file as the program does.

    path: the file, or one that is open; delimiter, decimal mark, header and units are found by
        themselves.
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
    return read_file(path, RecordArguments(locals(), covariates).columns())


class RecordArguments:
    """How the arguments of fit(), track() and read_csv() that say what a record is are to be read."""

    def __init__(self, given: Mapping[str, Any], covariates: Sequence[str] = ()) -> None:
        self.roles: dict[str, Any] = {role: given.get(role) for role in ROLES}
        self.units: dict[str, Any] = {name: given.get(name) for name in UNITS}
        self.covariates = list(map(str, covariates))
        self.of_files = {name: given.get(name) for name in OF_FILES}
        self.assumed: list[str] = []
        """Of the columns and units of files and frames that were read, a sentence each."""

    def words(self, roles: Optional[Mapping[str, Any]] = None) -> list[str]:
        """How columns are read: those of `roles`, or those that were given by name or number."""
        for role, value in self.roles.items():
            if roles is None and value is not None and not isinstance(value, (str, int, np.integer)):
                raise ValueError(f"{role}: must be the name or the number of a column here, where "
                                 "the columns are in a file or a frame")
        texts = {role: column_text(role, value, unit) for (role, value), unit in
                 zip({**self.roles, **(roles or {})}.items(), self.units.values())}
        return words({**texts, **self.of_files, "covariate": self.covariates})

    def columns(self, roles: Optional[Mapping[str, Any]] = None) -> _mindahl.FitRequest:
        return _mindahl.FitRequest(self.words(roles))

    def of_table(self, name: str, names: Sequence[str], arrays: Sequence[Any],
                 request: _mindahl.FitRequest) -> Record:
        if self.of_files["with_file"] is not None:
            raise ValueError("with_file has no effect on what is no file: leave it out")
        return _mindahl.record_of_columns(name, names, arrays, request)

    def of_arrays(self, columns: Mapping[str, Any], name: str) -> Record:
        # In SI units, unless one is stated; an angle and a torque have units of their own.
        torsional = any(self.units[unit] is not None for unit in ("displacement_unit", "force_unit"))
        names, arrays = [], []
        for role, given in columns.items():
            if given is None:
                continue
            values, stated = with_unit(role, given, SI[role])
            if stated and is_quantity(given) and self.units.get(f"{role}_unit") is not None:
                raise ValueError(f"{role}_unit: {role} has a unit of its own: leave it out")
            unit = stated or ("" if torsional and len(SI[role]) > 1 else SI[role][0])
            names.append(role.replace("normal_load_column", "normal load") + (f" [{unit}]" if unit else ""))
            arrays.append(array(role, values))
        roles = {role: k + 1 for k, role in enumerate(role for role in columns if columns[role] is not None)}
        for header, values in zip(names, arrays):
            if len(values) != len(arrays[0]):
                raise ValueError(f"{header} has {len(values)} samples and {names[0]} "
                                 f"{len(arrays[0])}: give as many of both")
        return self.of_table(name, names, arrays, self.columns(roles))


def columns_by_name(source: Any) -> Optional[Columns]:
    """The columns of a record, a data frame, or a dictionary: {"x [um]": ..., "F": ...}."""
    if isinstance(source, Record):
        length, force = ("rad", "N m") if source.is_torsional else ("m", "N")
        found = [(f"displacement [{length}]", source.displacement), (f"force [{force}]", source.force),
                 ("time [s]", source.time), (f"normal load [{force}]", source.normal_load)]
        return [(name, values) for name, values in found if values is not None]
    if hasattr(source, "columns") and hasattr(source, "iloc"):  # as pandas has it
        frame = [(str(name), source.iloc[:, k].to_numpy()) for k, name in enumerate(source.columns)]
        return [(f"{name} [s]" if values.dtype.kind in "mM" else name, values) for name, values in frame]
    if isinstance(source, Mapping):
        members = {**getattr(source, "coords", {}), **source}  # as xarray's Dataset has them
        named = [(name, *with_unit(str(name), values, ())) for name, values in members.items() if np.ndim(values)]
        return [(f"{name} [{unit}]" if unit else str(name), values) for name, values, unit in named]
    return None


def is_path(value: Any) -> bool:
    return isinstance(value, (str, os.PathLike))


def is_source(value: Any) -> bool:
    """True of one record, in whatever form, and not of several."""
    return is_path(value) or hasattr(value, "read") or is_pair(value) or columns_by_name(value) is not None


def records_of(source: Any, arguments: RecordArguments) -> list[Record]:
    """The records that the arguments of fit() and track() say."""
    roles = arguments.roles
    if source is None:
        source, roles["displacement"] = roles["displacement"], None
        if source is None:
            raise ValueError("a record is missing: give displacement and force, a data frame, a "
                             "record or a file")
    if is_array(source):
        return [_record_of_arrays(source, roles, arguments)]
    elements = several(source)
    if elements is None:
        return [_record_of(source, arguments, "record")]
    if not elements:
        raise ValueError("a record is missing: the list is empty")
    return [_record_of(element, arguments, f"record {k + 1}") for k, element in enumerate(elements)]


def _record_of_arrays(displacement: Any, roles: Mapping[str, Any], arguments: RecordArguments) -> Record:
    if roles.get("displacement") is not None:
        raise ValueError("displacement is given twice: give it once")
    if roles.get("force") is None:
        raise ValueError("force is missing: give an array of the force [N], one a displacement")
    for role, value in roles.items():
        if isinstance(value, (str, int)):
            raise ValueError(f"{role} = {value!r} names a column, but the displacement is an array: "
                             "give an array")
    return arguments.of_arrays({**roles, "displacement": displacement}, "record")


def _record_of(source: Any, arguments: RecordArguments, name: str) -> Record:
    record = _read_record(source, arguments, name)
    arguments.assumed.extend(record.notes)
    return record


def _read_record(source: Any, arguments: RecordArguments, name: str) -> Record:
    if isinstance(source, Record):
        for choice, value in {**arguments.roles, **arguments.units}.items():
            if value is not None:
                raise ValueError(f"{choice} has no effect on a record that is read already: leave it out")
        return source
    if is_path(source) or hasattr(source, "read"):
        return read_file(source, arguments.columns(), name)
    if is_pair(source):
        return arguments.of_arrays({**arguments.roles, "displacement": source[0], "force": source[1]}, name)
    columns = columns_by_name(source)
    if columns is not None:
        return arguments.of_table(name, [header for header, _ in columns], [
            array(header, values, keep_missing=True) for header, values in columns], arguments.columns())
    if is_array(source):
        raise ValueError(f"{name} is a single array: give a pair of arrays (displacement, force)")
    array(name, source)  # says why it is no array
    raise ValueError(f"{name}: a {type(source).__name__} is no array, data frame, record or file")
