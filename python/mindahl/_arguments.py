"""What a user gives, as the library takes it: numbers, names, ranges and arrays."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from numbers import Number
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _mindahl

Floats = NDArray[np.float64]

Uncertain = Union[float, tuple[float, float]]
"""A number, or a pair of it and one standard uncertainty, both in its unit."""


def number(name: str, value: Any) -> float:
    """A real number."""
    if isinstance(value, (bool, np.bool_, str, bytes)):
        raise ValueError(f"{name} = {value!r} is invalid: must be a number")
    try:
        return float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} = {value!r} is invalid: must be a number") from None


def optional_number(name: str, value: Any) -> Optional[float]:
    return None if value is None else number(name, value)


def count(name: str, value: Any, least: int) -> int:
    """A whole number that is not below `least`."""
    if isinstance(value, (bool, np.bool_)) or not hasattr(value, "__index__"):
        raise ValueError(f"{name} = {value!r} is invalid: must be a whole number")
    whole = int(value.__index__())
    if whole < least:
        raise ValueError(f"{name} = {whole} is invalid: must be >= {least}")
    return whole


def uncertain(name: str, value: Any) -> _mindahl.UncertainValue:
    """A number, or (number, standard uncertainty)."""
    if not isinstance(value, tuple):
        return _mindahl.UncertainValue(number(name, value))
    if len(value) != 2:
        raise ValueError(f"{name} = {value!r} is invalid: must be a number or (number, uncertainty)")
    error = number(name, value[1])
    if not (np.isfinite(error) and error >= 0):
        raise ValueError(f"{name}: the standard uncertainty {error!r} is invalid: must be finite and >= 0")
    return _mindahl.UncertainValue(number(name, value[0]), error)


def pair(name: str, value: Any) -> tuple[Any, Any]:
    """(low, high), of whatever kind."""
    if not isinstance(value, Sequence) or isinstance(value, (str, bytes)) or len(value) != 2:
        raise ValueError(f"{name} = {value!r} is invalid: must be a pair (low, high)")
    return value[0], value[1]


def interval(name: str, value: Any) -> Optional[tuple[float, float]]:
    if value is None:
        return None
    low, high = pair(name, value)
    return number(name, low), number(name, high)


def counts(name: str, value: Any) -> Optional[tuple[int, int]]:
    """Whole numbers from 1 on."""
    if value is None:
        return None
    low, high = pair(name, value)
    return count(name, low, 1), count(name, high, 1)


def fitted_or_number(name: str, value: Any) -> Optional[float]:
    """None of "fit"."""
    return None if isinstance(value, str) and value == "fit" else number(name, value)


def on_off(name: str, value: Union[bool, str]) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "on" if value else "off"
    if isinstance(value, str):
        return value
    raise ValueError(f"{name} = {value!r} is invalid: must be True or False")


def mapping(name: str, values: Optional[Mapping[str, Any]], what: str) -> Mapping[str, Any]:
    if values is not None and not isinstance(values, Mapping):
        raise ValueError(f"{name} = {values!r} is invalid: must be a dict of parameters and {what}")
    return values or {}


def assignments(name: str, values: Optional[Mapping[str, Any]]) -> dict[str, float]:
    return {parameter: number(f"{name}[{parameter!r}]", value)
            for parameter, value in mapping(name, values, "numbers").items()}


def priors_of(values: Optional[Mapping[str, Any]]) -> dict[str, _mindahl.UncertainValue]:
    """Parameter to (value, standard uncertainty)."""
    priors = {}
    for parameter, value in mapping("prior", values, "(value, uncertainty)").items():
        middle, error = pair(f"prior[{parameter!r}]", value)
        priors[parameter] = uncertain(f"prior[{parameter!r}]", (middle, error))
    return priors


def column_text(name: str, value: Any, unit: Optional[str] = None) -> str:
    """A column by its name or sum, or by its number counted from 1, with its unit."""
    if value is None:
        column = ""
    elif isinstance(value, str):
        column = value
    else:
        column = str(count(name, value, 1))
    return f"{column} [{unit}]" if unit else column


def path_text(path: Union[str, os.PathLike[str]]) -> str:
    return os.fspath(path)


def array(name: str, values: Any, *, keep_missing: bool = False) -> Floats:
    """A contiguous array of float64, the one given where it is one.

    keep_missing: NaN and what is no number at all stay, as NaN, for the reader to judge.
    """
    if isinstance(values, np.ma.MaskedArray) and np.any(values.mask):
        raise ValueError(f"{name} has masked values: leave these samples out of all arrays")
    given = np.asarray(values)
    if keep_missing and (given.dtype == object or given.dtype.kind not in "fiu"):
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
        raise ValueError(f"{name}[{at}] = {converted[at]} is invalid: must be finite")
    return converted


def is_quantity(value: Any) -> bool:
    """Numbers with a unit, as pint has them."""
    return hasattr(value, "magnitude") and hasattr(value, "to")


def with_unit(name: str, value: Any, units: Sequence[str]) -> tuple[Any, Optional[str]]:
    """Numbers and their unit: of a quantity of pint in the first of `units` that it can be in, of an
    array of xarray that of its attribute "units"; None of what states none."""
    if is_quantity(value):
        for symbol in units:
            if value.check(value._REGISTRY.Quantity(1, symbol).dimensionality):
                return value.to(symbol).magnitude, symbol.replace("*", " ")
        raise ValueError(f"{name} has the unit {value.units}: must be one of {', '.join(units)}")
    attributes = getattr(value, "attrs", None)
    unit = attributes.get("units") if isinstance(attributes, Mapping) else None
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


def is_frame(value: Any) -> bool:
    """A table of named columns, as pandas has it."""
    return hasattr(value, "columns") and hasattr(value, "__getitem__") and hasattr(value, "iloc")


def several(value: Any) -> Optional[list[Any]]:
    """The elements of a list or tuple of sources; None of one source."""
    if isinstance(value, (list, tuple)) and not is_array(value):
        return list(value)
    return None


def known_contact(
    *,
    youngs_modulus_1: Optional[Uncertain] = None, poisson_1: Optional[Uncertain] = None,
    radius_1: Optional[Uncertain] = None, youngs_modulus_2: Optional[Uncertain] = None,
    poisson_2: Optional[Uncertain] = None, radius_2: Optional[Uncertain] = None,
    contact_radius: Optional[Uncertain] = None, compliance: Optional[Uncertain] = None,
    normal_load: Optional[Uncertain] = None,
) -> _mindahl.KnownContact:
    def known(name: str, value: Any) -> Optional[_mindahl.UncertainValue]:
        return None if value is None else uncertain(name, value)

    contact = _mindahl.ContactOptions().known
    body_1, body_2 = contact.body_1, contact.body_2
    body_1.youngs_modulus = known("youngs_modulus_1", youngs_modulus_1)
    body_1.poisson = known("poisson_1", poisson_1)
    body_1.radius = known("radius_1", radius_1)
    body_2.youngs_modulus = known("youngs_modulus_2", youngs_modulus_2)
    body_2.poisson = known("poisson_2", poisson_2)
    body_2.radius = known("radius_2", radius_2)
    contact.contact_radius = known("contact_radius", contact_radius)
    contact.compliance = known("compliance", compliance)
    contact.normal_load = known("normal_load", normal_load)
    return contact


def names_of(values: Union[None, str, Iterable[str]]) -> list[str]:
    """One name, or several."""
    if values is None:
        return []
    return [values] if isinstance(values, str) else list(values)


def contact_options(friction: Optional[Uncertain] = None, **known: Optional[Uncertain]) -> _mindahl.ContactOptions:
    """friction and what known_contact() takes."""
    options = _mindahl.ContactOptions()
    options.known = known_contact(**known)
    options.friction = None if friction is None else uncertain("friction", friction)
    return options


def law_of(sigma: Optional[float], alpha: Optional[float], slip_force: Optional[float],
           contact: Mapping[str, Optional[Uncertain]]) -> _mindahl.LawRequest:
    law = _mindahl.LawRequest()
    law.sigma = optional_number("sigma", sigma)
    law.alpha = optional_number("alpha", alpha)
    law.slip_force = optional_number("slip_force", slip_force)
    law.contact = contact_options(**contact)
    return law


def numbers(name: str, values: Any) -> list[float]:
    """A number, or several."""
    if values is None:
        return []
    given = [values] if isinstance(values, (Number, np.generic)) else values
    return [float(value) for value in array(name, given)]


def in_executor(executor: Any, function: Callable[[Any], Any], tasks: Sequence[Any]) -> list[Any]:
    """What an executor makes of each task: concurrent.futures, or dask.distributed's Client."""
    if hasattr(executor, "submit"):
        return [future.result() for future in [executor.submit(function, task) for task in tasks]]
    if hasattr(executor, "map"):
        return list(executor.map(function, tasks))
    raise ValueError(f"executor: a {type(executor).__name__} has neither submit() nor map()")
