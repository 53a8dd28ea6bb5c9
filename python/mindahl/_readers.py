"""Records from files of other programs, each read by the library that exists for it."""

from __future__ import annotations

import inspect
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple, Optional, Union

import numpy as np

from . import _mindahl
from ._arguments import array
from ._mindahl import Record
from ._records import RecordArguments, read_csv

Path = Union[str, os.PathLike[str]]


class Column(NamedTuple):
    """A vector of numbers of a file, its path "run 1/x", and those of the groups that it is in, from "",
    the file's own, to the innermost."""

    path: str
    groups: tuple[str, ...]
    values: Any
    unit: str = ""

    @property
    def name(self) -> str:
        """The last part of its path."""
        return self.path[len(self.groups[-1]) + 1:] if self.groups[-1] else self.path



def read_mat(path: Path, *, within: Optional[str] = None, **options: Any) -> Record:
    """Reads a record from a MAT file (version 7 or before) by SciPy.

    Every numeric vector of the file is a column, "x" of a struct "test" by that name or as "test.x"; of a
    matrix the columns, "data_1", "data_2", ....
    within: the struct that has the record, as of read_hdf5().
    options: displacement, force, time, units and the others of read_csv().
    Raises ImportError without scipy, ValueError for a file of version 7.3, which is HDF5.
    """
    from scipy.io import loadmat

    try:
        found = loadmat(os.fspath(path), squeeze_me=True, struct_as_record=True)
    except NotImplementedError:
        raise ValueError(f"{os.fspath(path)}: is a MAT file of version 7.3, which is HDF5: read it "
                         "with read_hdf5()") from None
    return _record(path, [column for name, value in found.items() if not name.startswith("__")
                          for column in _columns(name, value)], within, options)


def read_hdf5(path: Path, *, within: Optional[str] = None, **options: Any) -> Record:
    """Reads a record from an HDF5 file by h5py.

    Every numeric dataset of one dimension is a column, "x" of a group "run 1" by that name or as
    "run 1/x", with the unit of its attribute "units", "unit" or "Unit"; of two dimensions the columns,
    "data_1", ..., of a compound one the fields. Those of a group that are of one length, with what the
    groups around it have of that length and by other names, are a table.
    within: the group that has the record, "/" for the file itself; by default the only one that has a
        displacement and a force.
    options: displacement, force, time, units and the others of read_csv().
    Raises ImportError without h5py, ValueError where no name says which is displacement, which force,
        where several groups have both, and where they are in two groups and no options name both.
    """
    import h5py

    columns: list[Column] = []

    def visit(name: str, node: Any) -> None:
        if not isinstance(node, h5py.Dataset):
            return
        unit = next((node.attrs[key] for key in ("units", "unit", "Unit") if key in node.attrs), "")
        unit = unit.decode() if isinstance(unit, bytes) else str(unit)
        parents = [at for at, letter in enumerate(name) if letter == "/"]
        columns.extend(column._replace(unit=unit) for column in _columns(
            name, np.squeeze(node[()]), ("", *(name[:at] for at in parents))))

    with h5py.File(os.fspath(path), "r") as file:
        file.visititems(visit)
    return _record(path, columns, within, options)


def _columns(path: str, value: Any, groups: tuple[str, ...] = ("",)) -> Iterator[Column]:
    """The numeric vectors in a variable, in a struct, a matrix and records of them."""
    values = np.asarray(value)
    if values.ndim == 0 and values.dtype == object:  # a field of a struct
        values = np.asarray(values.item())
    if values.dtype.names and values.ndim < 2:
        for field in values.dtype.names:
            yield from _columns(f"{path}.{field}", values[field], (*groups, path))
    elif values.dtype.kind in "fiu" and values.ndim == 1:
        yield Column(path, groups, values)
    elif values.dtype.kind in "fiu" and values.ndim == 2:
        yield from (Column(f"{path}_{k + 1}", groups, values[:, k]) for k in range(values.shape[1]))


def _of_one_length(columns: Sequence[Column]) -> list[Column]:
    lengths = [len(column.values) for column in columns if len(column.values) > 1]
    length = max(set(lengths), key=lambda size: (lengths.count(size), size), default=0)
    return [column for column in columns if len(column.values) == length > 0]


def _record(path: Path, columns: Sequence[Column], within: Optional[str],
            options: Mapping[str, Any]) -> Record:
    asked = None if within is None else within.strip("/")
    chosen = [column for column in columns if asked is None or asked in (*column.groups, column.path)]
    everything = _of_one_length(chosen)
    if not everything:
        raise ValueError(f"{os.fspath(path)}: holds no vector of numbers"
                         + ("" if within is None else f" within {within!r}")
                         + f": it has {', '.join(column.path for column in columns) or 'none'}")
    found = {}
    for groups in dict.fromkeys(column.groups for column in chosen):
        own = _of_one_length([column for column in chosen if column.groups == groups])
        names = [column.name for column in own]
        around = [column for column in chosen if column.groups == groups[:len(column.groups)] != groups
                  and own and len(column.values) == len(own[0].values) and column.name not in names]
        try:
            _read(path, [column._replace(values=np.nan_to_num(column.values)) for column in own + around],
                  options)
            found[groups[-1]] = own + around
        except ValueError:  # no displacement and force
            continue
    if asked in found:
        found = {asked: found[asked]}
    if len(found) > 1:
        raise ValueError(f"{os.fspath(path)}: {_some(found)} have a displacement and a force each: say "
                         "by within= which is meant")
    return _read(path, next(iter(found.values()), everything), options)


def _some(groups: Iterable[str]) -> str:
    named = [repr(group or "/") for group in groups]
    return ", ".join([*named[:9], *(["..."] if len(named) > 9 else [])])


def _read(path: Path, table: Sequence[Column], options: Mapping[str, Any]) -> Record:
    names = [column.name for column in table]
    headers = [column.name if names.count(column.name) == 1 else column.path for column in table]
    asked = {column.path: header for column, header in zip(table, headers)}
    given = {role: asked.get(value, value) if isinstance(value, str) else value
             for role, value in options.items()}
    bound = inspect.signature(read_csv).bind(path, **given)  # TypeError for what it has not
    bound.apply_defaults()
    record = _mindahl.record_of_columns(
        os.fspath(path), [f"{header} [{column.unit}]" if column.unit else header
                          for column, header in zip(table, headers)],
        [array(column.path, column.values, keep_missing=True) for column in table],
        RecordArguments(bound.arguments, bound.arguments["covariates"]).columns())
    # Of a text the columns have an order, which some go by; variables have none.
    if any("in their order" in note for note in record.notes):
        raise ValueError(f"{os.fspath(path)}: no name says which is the displacement and which the force: "
                         f"give displacement and force, of {', '.join(headers)}")
    places = [table[column["index"] - 1].groups[-1] for column in record.columns.values()]
    if len(set(places[:2])) > 1 and (options.get("displacement") is None or options.get("force") is None):
        raise ValueError(f"{os.fspath(path)}: displacement and force are of two groups, "
                         f"{_some(places[:2])}: say by within= which has both, or name both")
    return record
