"""What a user gives, as the library takes it: numbers and arrays, and keywords as the program's options."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Mapping, Sequence
from numbers import Number
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

Uncertain = Union[float, tuple[float, float]]
"""A number, or a pair of it and one standard uncertainty, both in its unit."""

_FLAGS = ("compare",)
_RANGES = ("cycles", "samples", "time_window", "load_window", "bound", "select")
_OPTIONS = {"with_file": "with"}


def number(name: str, value: Any) -> float:
    """A real number."""
    if isinstance(value, (bool, np.bool_, str, bytes)):
        raise ValueError(f"{name} = {value!r} is invalid: must be a number")
    try:
        return float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} = {value!r} is invalid: must be a number") from None


def count(name: str, value: Any, least: int) -> int:
    """A whole number that is not below `least`."""
    if isinstance(value, (bool, np.bool_)) or not hasattr(value, "__index__"):
        raise ValueError(f"{name} = {value!r} is invalid: must be a whole number")
    whole = int(value.__index__())
    if whole < least:
        raise ValueError(f"{name} = {whole} is invalid: must be >= {least}")
    return whole


def words(given: Mapping[str, Any]) -> list[str]:
    """The options that keywords are: fix={"alpha": 0} is --fix=alpha=0; what is None is left out."""
    found = []
    for name, value in given.items():
        option = "--" + _OPTIONS.get(name, name.rstrip("_").replace("_", "-"))
        if value is None or isinstance(value, str) and not value:
            continue
        if name in _FLAGS:
            found += [option] if value else []
        elif isinstance(value, Mapping):
            found += [f"{option}={key}={_text(f'{name}[{key!r}]', each, name)}"
                      for key, each in value.items()]
        elif isinstance(value, list) and name == "normal_load":  # one a record
            found.append(f"{option}={','.join(_text(name, each, name) for each in value)}")
        elif isinstance(value, (list, np.ndarray)) or (
                isinstance(value, tuple) and any(isinstance(each, str) for each in value)):
            found += [f"{option}={_text(name, each, name)}" for each in value]
        else:
            found.append(f"{option}={_text(name, value, name)}")
    return found


def _text(name: str, value: Any, keyword: str) -> str:
    """A number, a name, (low, high) or (number, standard uncertainty)."""
    if isinstance(value, (bool, np.bool_)):
        return "on" if value else "off"
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, (tuple, list)):
        if len(value) != 2:
            raise ValueError(f"{name} = {value!r} is invalid: must be a number or a pair")
        return (":" if keyword in _RANGES else "±").join(_text(name, each, "") for each in value)
    return str(value.__index__()) if hasattr(value, "__index__") else repr(number(name, value))


def column_text(name: str, value: Any, unit: Optional[str] = None) -> str:
    """A column by its name or sum, or by its number counted from 1, with its unit."""
    if value is None:
        column = ""
    elif isinstance(value, str):
        column = value
    else:
        column = str(count(name, value, 1))
    return f"{column} [{unit}]" if unit else column


def array(name: str, values: Any, *, keep_missing: bool = False) -> Floats:
    """A contiguous array of float64, the one given where it is one.

    keep_missing: NaN stays, for the reader to judge; texts are read as numbers, and what holds
        anything else is NaN throughout.
    """
    if isinstance(values, np.ma.MaskedArray) and np.any(values.mask):
        raise ValueError(f"{name} has masked values: leave these samples out of all arrays")
    given = np.asarray(values)
    if given.dtype.kind in "mM":  # times of pandas
        given = (given - given[:1]) / np.timedelta64(1, "s")
    elements = given
    if given.dtype == object or (keep_missing and given.dtype.kind in "UT"):  # as of pandas' Float64
        try:
            given = np.array([_number(each) for each in given.flat]).reshape(given.shape)
        except (TypeError, ValueError):
            if keep_missing:
                return np.full(given.shape, np.nan)
    elif keep_missing and given.dtype.kind not in "fiu":
        return np.full(given.shape, np.nan)
    if given.dtype.kind not in "fiu":
        raise ValueError(f"{name} has the dtype {given.dtype}: must be an array of real numbers")
    if given.ndim != 1:
        raise ValueError(f"{name} has the shape {given.shape}: must be an array of one dimension")
    converted = np.ascontiguousarray(given, dtype=np.float64)
    if keep_missing:
        return converted
    if converted.size == 0:
        raise ValueError(f"{name} is empty: must hold a number a sample")
    finite = np.isfinite(converted)
    if not finite.all():
        at = int(np.argmin(finite))
        raise ValueError(f"{name}[{at}] = {elements[at]} is invalid: must be finite")
    return converted


def _number(value: Any) -> float:
    """A number, or a text that is one; NaN of what is missing, as pandas has it."""
    if value is None or type(value).__name__ == "NAType" or value == "":
        return math.nan
    if isinstance(value, (bool, np.bool_)):
        raise TypeError
    return float(value)


def is_quantity(value: Any) -> bool:
    """Numbers with a unit, as pint has them."""
    return hasattr(value, "magnitude") and hasattr(value, "to")


def with_unit(name: str, value: Any, units: Sequence[str]) -> tuple[Any, Optional[str]]:
    """Numbers and their unit: of a quantity of pint in the first of `units` that it can be in, of an
    array of xarray that of its attribute "units", of a series of pandas that in brackets behind its
    name, "x [um]"; None of what states none."""
    if is_quantity(value):
        for symbol in units:
            if value.check(value._REGISTRY.Quantity(1, symbol).dimensionality):
                return value.to(symbol).magnitude, symbol.replace("*", " ")
        raise ValueError(f"{name} has the unit {value.units}: must be one of {', '.join(units)}")
    attributes = getattr(value, "attrs", None)
    unit = attributes.get("units") if isinstance(attributes, Mapping) else None
    named = re.search(r"[\[(]([^\])]+)[\])]\s*$", str(getattr(value, "name", "")))
    if unit is None and named:
        unit = named[1]
    return value, unit if isinstance(unit, str) else None


def is_array(value: Any) -> bool:
    """Numbers, and neither a path nor several arrays."""
    if is_quantity(value):
        return is_array(value.magnitude)
    if isinstance(value, np.ndarray):
        return bool(value.dtype != object)
    if hasattr(value, "to_numpy"):
        return getattr(value, "ndim", 1) == 1
    return isinstance(value, Sequence) and not isinstance(value, (str, bytes)) and all(
        isinstance(element, (Number, np.generic)) for element in value)


def is_pair(value: Any) -> bool:
    """The arrays (displacement, force)."""
    return isinstance(value, tuple) and len(value) == 2 and all(map(is_array, value))


def several(value: Any) -> Optional[list[Any]]:
    """The elements of a list or tuple of sources; None of one source."""
    if isinstance(value, (list, tuple)) and not is_array(value) and not is_pair(value):
        return list(value)
    return None


def in_executor(executor: Any, function: Callable[[Any], Any], tasks: Sequence[Any]) -> list[Any]:
    """What an executor makes of each task: concurrent.futures, or dask.distributed's Client."""
    if hasattr(executor, "submit"):
        return [future.result() for future in [executor.submit(function, task) for task in tasks]]
    if hasattr(executor, "map"):
        return list(executor.map(function, tasks))
    raise ValueError(f"executor: a {type(executor).__name__} has neither submit() nor map()")
