"""Records from files of other programs, each read by the library that exists for it."""

from __future__ import annotations

import inspect
import os
import re
from collections.abc import Iterator, Mapping
from typing import Any, Optional, Union

import numpy as np

from . import _mindahl
from ._arguments import array
from ._mindahl import Record
from ._records import read_csv, reading

Path = Union[str, os.PathLike[str]]
Columns = dict[str, Any]


def read_mat(path: Path, *, within: Optional[str] = None, **options: Any) -> Record:
    """Reads a record from a MAT file (version 7 or before) by SciPy.

    Every numeric vector of the file is a column, called by its variable, "test.x" in a struct; of a
    matrix the columns, called "data_1", "data_2", .... Those of the length that most have make the
    table, each by the last part of its name, "x", where that is its alone.
    within: only variables of this struct.
    options: displacement, force, time, units and the others of read_csv().
    Raises ImportError without scipy, ValueError for a file of version 7.3, which is HDF5.
    """
    from scipy.io import loadmat

    try:
        found = loadmat(os.fspath(path), squeeze_me=True, struct_as_record=True)
    except NotImplementedError:
        raise ValueError(f"{os.fspath(path)}: is a MAT file of version 7.3, which is HDF5: read it "
                         "with read_hdf5()") from None
    variables = {name: value for name, value in found.items() if not name.startswith("__")}
    return _record(path, dict(_vectors(variables)), within, options)


def read_hdf5(path: Path, *, within: Optional[str] = None, **options: Any) -> Record:
    """Reads a record from an HDF5 file by h5py.

    Every numeric dataset of one dimension is a column, called by its path without the first slash,
    with the unit of its attribute "units", "unit" or "Unit"; of two dimensions the columns, of a
    compound one the fields. Those of the length that most have make the table, each by the last
    part of its path, where that is its alone.
    within: only datasets of this group.
    options: displacement, force, time, units and the others of read_csv().
    Raises ImportError without h5py, ValueError where no name says which is displacement, which force.
    """
    import h5py

    columns: Columns = {}

    def visit(name: str, node: Any) -> None:
        if not isinstance(node, h5py.Dataset):
            return
        unit = next((node.attrs[key] for key in ("units", "unit", "Unit") if key in node.attrs), "")
        unit = unit.decode() if isinstance(unit, bytes) else str(unit)
        for column, values in _vectors({name: np.squeeze(node[()])}):
            columns[f"{column} [{unit}]" if unit else column] = values

    with h5py.File(os.fspath(path), "r") as file:
        file.visititems(visit)
    return _record(path, columns, within, options)


def _vectors(variables: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """The numeric vectors in variables, in structs, matrices and records of them."""
    for name, value in variables.items():
        values = np.asarray(value)
        if values.dtype.names:
            if values.ndim == 0:
                yield from _vectors({f"{name}.{field}": values[field].item()
                                     if values.dtype[field] == object else values[field]
                                     for field in values.dtype.names})
            elif values.ndim == 1:
                yield from _vectors({f"{name}.{field}": values[field]
                                     for field in values.dtype.names})
        elif values.dtype.kind not in "fiu":
            continue
        elif values.ndim == 1:
            yield name, values
        elif values.ndim == 2:
            for k in range(values.shape[1]):
                yield f"{name}_{k + 1}", values[:, k]


def _record(path: Path, columns: Columns, within: Optional[str],
            options: Mapping[str, Any]) -> Record:
    chosen = {name: values for name, values in columns.items()
              if within is None or re.match(re.escape(within.rstrip("/.")) + r"([/. ]|$)", name)}
    lengths = [len(values) for values in chosen.values() if len(values) > 1]
    if not lengths:
        raise ValueError(f"{os.fspath(path)}: holds no vector of numbers"
                         + ("" if within is None else f" within {within!r}")
                         + f": it has {', '.join(columns) or 'none'}")
    length = max(set(lengths), key=lambda size: (lengths.count(size), size))
    # A column is called by the last part of its name, where no other has that.
    last = {name: re.sub(r"^[^\[]*[/.](?=[^/.])", "", name)
            for name, values in chosen.items() if len(values) == length}
    headers = {name: short if list(last.values()).count(short) == 1 else name
               for name, short in last.items()}
    asked = {name.partition(" [")[0]: header.partition(" [")[0] for name, header in headers.items()}
    given = {role: asked.get(value, value) if isinstance(value, str) else value
             for role, value in options.items()}
    bound = inspect.signature(read_csv).bind(path, **given)  # TypeError for what it has not
    bound.apply_defaults()
    record = _mindahl.record_of_columns(
        os.fspath(path), list(headers.values()),
        [array(name, chosen[name], keep_missing=True) for name in headers],
        reading(bound.arguments, list(map(str, bound.arguments["covariates"]))))
    # Of a text the columns have an order, which some go by; variables have none.
    if any("in their order" in note for note in record.notes):
        raise ValueError(f"{os.fspath(path)}: no name says which is the displacement and which the force: "
                         f"give displacement and force, of {', '.join(headers)}")
    return record
