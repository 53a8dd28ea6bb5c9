"""What a fit says: the program's report, with attributes."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any, NamedTuple, Optional, Union

import numpy as np

from . import _mindahl
from ._arguments import Floats, array

if TYPE_CHECKING:
    from . import _sections


class FitWarning(UserWarning):
    """What a fit found and a person should act on, which result.warnings has too, with codes; and
    what was assumed of the columns of a file or a frame and of their units: result.notes."""


class Table(Mapping[str, Any]):
    """Columns of one length by name, a NumPy array each."""

    _columns: dict[str, Any]

    def __getitem__(self, name: str) -> Any:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        rows = len(next(iter(self._columns.values()), ()))
        return f"<mindahl.{type(self).__name__}: {rows} rows of {', '.join(self._columns)}>"

    def to_pandas(self) -> Any:
        """A pandas DataFrame of the columns. Raises ImportError without pandas."""
        import pandas

        return pandas.DataFrame(self._columns)


class Section(Mapping[str, Any]):
    """A part of the report, by item or by attribute: what docs/contract.md lists. Read-only."""

    def __init__(self, values: Mapping[str, Any], path: str) -> None:
        self._values = values
        self._path = path

    def __getitem__(self, name: str) -> Any:
        return _wrapped(self._values[name], f"{self._path}.{name}")

    if not TYPE_CHECKING:  # type checkers know the sections of a fit by cmake/sections.py
        def __getattr__(self, name: str) -> Any:
            if name.startswith("_"):
                raise AttributeError(name)
            if name not in self._values:
                raise AttributeError(f"{self._path} has no '{name}': it has {', '.join(self._values)}")
            return self[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._values})

    def __repr__(self) -> str:
        return f"{self._path}: {dict(self._values)!r}"


class AnySection(Section):
    """A section whose items are not known to type checkers."""

    if TYPE_CHECKING:
        def __getattr__(self, name: str) -> Any: ...


class Told:
    """What a command of the program answered: its JSON and its text.

    established: did the program end with exit status 0? Of a fit: did it converge?
    """

    _document: str
    _text: str
    established: bool

    def to_dict(self) -> dict[str, Any]:
        """What the program writes as JSON, as a dict of one's own."""
        return dict(json.loads(self._document))

    def to_json(self) -> str:
        """The same as text, byte for byte as the program writes it."""
        return self._document

    def text(self) -> str:
        """What the program prints."""
        return self._text

    def __str__(self) -> str:
        return self._text

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self._text)}</pre>"


class Report(Told, AnySection):
    """The answer of a command, by item or by attribute: the program's JSON, as docs/contract.md lists it."""

    def __init__(self, document: str, text: str, established: bool, path: str) -> None:
        super().__init__(json.loads(document), path)
        self._document, self._text, self.established = document, text, established

    def to_pandas(self, table: Optional[str] = None) -> Any:
        """A table of the report as a pandas DataFrame; members of members have names such as
        "parameters_alpha_value".

        table: a list of the report, or a section of sections; by default the first.
        Raises ValueError for what is no table of this report, ImportError without pandas.
        """
        import pandas

        tables = {name: [{"name": key, **row} for key, row in rows.items()] if isinstance(rows, dict) else rows
                  for name, rows in self._values.items() if isinstance(rows, (dict, list)) and rows
                  and all(isinstance(row, dict) for row in (rows.values() if isinstance(rows, dict) else rows))}
        name = next(iter(tables), None) if table is None else table
        if name not in tables:
            raise ValueError(f"table = {table!r} is invalid: must be one of {', '.join(tables)}")
        rows = tables[name]
        if "points" in rows[0]:  # one row a point
            rows = [{"excitation": row["name"], **point} for row in rows for point in row["points"]]
        return pandas.json_normalize(rows, sep="_")


def _wrapped(value: Any, path: str) -> Any:
    if isinstance(value, dict):
        return Section(value, path)
    if isinstance(value, list):
        return tuple(_wrapped(element, f"{path}[{k}]") for k, element in enumerate(value))
    return value


@dataclass(frozen=True, repr=False)
class Parameter:
    """A fitted or held parameter, in SI units.

    is_known: True if it is held fixed, identifiable or effective. Check it before using value.
    value: where the fit ended; None if that is a bound and the parameter is not identifiable.
    interval: ends of the 95 % interval; None where it is open.
    status: "free", "fixed", "at_lower_bound" or "at_upper_bound".
    identifiability: "identifiable", "effective" (the model is not adequate),
        "bounded_below" or "not_identifiable".
    """

    name: str
    value: Optional[float]
    unit: str
    standard_error: Optional[float]
    interval: tuple[Optional[float], Optional[float]]
    status: str
    identifiability: str

    @property
    def is_known(self) -> bool:
        """True if held fixed, identifiable or effective, as the library's ParameterEstimate."""
        return self.status == "fixed" or self.identifiability in ("identifiable", "effective")

    def __str__(self) -> str:
        unit = "" if self.unit == "-" else f" {self.unit}"
        verdict = self.identifiability.replace("_", " ")
        if self.status == "fixed":
            return f"{self.name} = {self.value:.6g}{unit}, held"
        if self.identifiability == "bounded_below" and self.interval[0] is not None:
            return f"{self.name} > {self.interval[0]:.6g}{unit}, {verdict}"
        if self.value is None or self.identifiability == "not_identifiable":
            return f"{self.name}: {verdict}"
        error = "" if self.standard_error is None else f" ± {self.standard_error:.2g}"
        return f"{self.name} = {self.value:.6g}{error}{unit}, {verdict}"

    def __repr__(self) -> str:
        return f"<mindahl.Parameter {self}>"

    def __float__(self) -> float:
        """The value. Raises ValueError where the record does not determine it."""
        if self.value is None or not self.is_known:
            raise ValueError(f"{self}: the record determines no value: ask is_known, or hold it by fix")
        return self.value


@dataclass(frozen=True)
class FittedRecord:
    """A record that was fitted, [m], [N], [s] or [rad], [N m], [s]; arrays of a fit are read-only.

    fitted_force and residual = fitted - measured are None where the fit failed. With noise_in =
    "displacement" the residual is that of fitted_displacement, which is None otherwise, and
    fitted_force is the measured one.
    """

    name: str
    displacement: Floats
    force: Floats
    time: Optional[Floats]
    fitted_force: Optional[Floats]
    fitted_displacement: Optional[Floats]
    residual: Optional[Floats]


class Covariance(NamedTuple):
    """Covariances of the free parameters [product of their units], in the order of names; NaN where
    one has no standard error."""

    matrix: Floats
    names: tuple[str, ...]


class FitResult(Told):
    """A fit: sigma, alpha, slip_force and every section of the report as attributes.

    parameters: all, by name. records: the arrays of each record. warnings, notes: in words.
    adequacy, measured, contact, mapping, law, residuals, solver, ...: sections of the report, as
        docs/contract.md lists them; result.to_dict() is the same as the program's JSON. A further
        parameter, result.force_offset, is result.parameters["force_offset"] to a type checker.
    """

    def __init__(self, kept: Mapping[str, Any], fitted: Optional[_mindahl.Fitted] = None) -> None:
        self._kept = dict(kept)
        self._fitted = fitted
        self._document = kept["document"]
        self._report: dict[str, Any] = json.loads(self._document)
        self._text = kept["text"] or "\n".join(map(str, self.parameters.values())) or "the fit failed"
        self.established = self.converged

    @classmethod
    def load(cls, path: Union[str, os.PathLike[str]]) -> FitResult:
        """Reads a result that save() wrote, or `mindahl fit --json` or to_json().

        One of save() is complete; the other has parameters,
        sections and warnings, and neither records nor figures.
        Raises InputError (a ValueError) for another document, and where the file cannot be read.
        """
        try:
            with open(path, "rb") as file:
                content = file.read()
        except OSError as error:
            raise _mindahl.InputError(f"cannot read '{os.fspath(path)}': {error.strerror}") from None
        kept: dict[str, Any] = {"text": "", "notes": (), "units": ("m", "N"), "records": ()}
        try:
            read = json.loads(content)
            kept.update(read if "document" in read else {"document": content.decode()})
            is_fit = json.loads(kept["document"])["schema"] == "mindahl.fit/2"
        except (KeyError, TypeError, ValueError):
            is_fit = False
        if not is_fit:
            raise _mindahl.InputError(f"{os.fspath(path)}: is no result of a fit, of the schema mindahl.fit/2")
        kept["records"] = [{name: np.array(value) if isinstance(value, list) else value
                            for name, value in record.items()} for record in kept["records"]]
        return cls(kept)

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes JSON, text, page and arrays to one file of JSON, for load().

        Raises InputError (a ValueError) where the file cannot be written.
        """
        try:
            with open(path, "w", encoding="utf-8") as file:
                json.dump({**self._kept, "page": self.page()}, file,
                          default=lambda values: values.tolist())
        except OSError as error:
            raise _mindahl.InputError(f"cannot write '{os.fspath(path)}': {error.strerror}") from None

    def __reduce__(self) -> tuple[Any, ...]:
        return FitResult, (self._kept,)

    sigma: Parameter  # tangential stiffness [N/m] at the start of every branch
    alpha: Parameter  # shape exponent [-]
    slip_force: Parameter  # Tc [N]
    schema: str
    version: str
    model: str
    initial_state: str
    confidence: float
    input: _sections.input
    correlation: AnySection
    residuals: _sections.residuals
    solver: _sections.solver
    adequacy: _sections.adequacy
    measured: _sections.measured
    law: _sections.law
    contact: _sections.contact
    mapping: _sections.mapping
    terms: _sections.terms
    compared: tuple[_sections.compared, ...]  # of --compare, the best first
    next: Optional[_sections.next]
    warnings: tuple[_sections.warnings, ...]  # what a person should act on, with stable codes
    nulls: tuple[_sections.nulls, ...]

    if not TYPE_CHECKING:
        def __getattr__(self, name: str) -> Any:
            if name.startswith("_"):
                raise AttributeError(name)
            parameters = self._report.get("parameters") or {}
            if name in parameters:
                return self.parameters[name]
            if name in self._report:
                return _wrapped(self._report[name], f"result.{name}")
            if not parameters:
                raise AttributeError(f"the fit failed and has no '{name}': {self.text().strip()}")
            raise AttributeError(f"the fit has no '{name}': it has the parameters "
                                 f"{', '.join(parameters)} and {', '.join(self._report)}")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._report, *(self._report.get("parameters") or {})})

    @property
    def parameters(self) -> dict[str, Parameter]:
        """All parameters by name, as the program reports them; empty where the fit failed."""
        return {name: Parameter(name, values["value"], values["unit"], values["standard_error"],
                                (values["ci95"][0], values["ci95"][1]), values["status"],
                                values["identifiability"])
                for name, values in (self._report.get("parameters") or {}).items()}

    @property
    def converged(self) -> bool:
        """Did the solver converge?"""
        return bool(self._report["solver"]["converged"])

    @property
    def notes(self) -> tuple[str, ...]:
        """What was assumed of the record, such as a unit that it does not name."""
        return tuple(self._kept["notes"])

    @property
    def records(self) -> tuple[FittedRecord, ...]:
        """Each record with its fit: one a file or table, in order."""
        return tuple(FittedRecord(**arrays) for arrays in self._kept["records"])

    @property
    def fitted_force(self) -> Any:
        """Fitted force [N] of every sample; of several records a list of arrays."""
        return self._one_or_all("fitted_force")

    @property
    def residual(self) -> Any:
        """Fitted less measured [N], or [m] with noise_in = "displacement", of every sample; of several
        records a list of arrays."""
        return self._one_or_all("residual")

    def _one_or_all(self, name: str) -> Any:
        arrays = [getattr(record, name) for record in self.records]
        return arrays[0] if len(arrays) == 1 else arrays

    def to_pandas(self) -> Any:
        """A pandas DataFrame with one row a parameter. Raises ImportError without pandas."""
        import pandas

        return pandas.json_normalize([{"name": name, **values} for name, values in
                                      (self._report.get("parameters") or {}).items()], sep="_")

    def __repr__(self) -> str:
        if not self.parameters:
            return f"<mindahl.FitResult: {self.text().strip()}>"
        values = "; ".join(str(self.parameters[name]) for name in ("sigma", "alpha", "slip_force"))
        return f"<mindahl.FitResult: {values}; {self.adequacy.verdict or 'adequacy not decided'}>"

    @property
    def covariance(self) -> Covariance:
        """Covariances of the free parameters, and their names."""
        free = {name: parameter.standard_error for name, parameter in self.parameters.items()
                if parameter.status != "fixed"}
        errors = np.array(list(free.values()), dtype=np.float64)
        correlation = np.array([[self._report["correlation"][row][column] for column in free]
                                for row in free], dtype=np.float64).reshape(len(free), len(free))
        return Covariance(correlation * np.outer(errors, errors), tuple(free))

    def predict(self, displacement: Any) -> Floats:
        """The force [N] that the fit predicts along a displacement [m], of the sign that the record has:
        from the unloaded contact on, or, if initial_state is "steady", of a contact that has settled on
        the loop between the extremes of this displacement.

        Of several records it has the gate and the offsets of the first, of a load series the law at the
        mean load. Excursions that are smaller than the reversal gate are noise here too.
        Raises ValueError for a fit that failed, for one with terms other than rig_stiffness and
            asymmetry, which need more than a displacement (fit without them, or see fitted_force), and
            for one that was read from JSON, which has neither sign nor gate.
        """
        if not self.parameters:
            raise ValueError(self.text().strip())
        if "values" not in self._kept:
            raise ValueError("a result that was read from JSON has not the sign of its record's force: "
                             "fit it again, or save() it")
        values: dict[str, float] = dict(self._kept["values"])
        own = {name: values.pop(name) for name in ("sigma", "alpha", "slip_force", "rig_stiffness",
                                                   "asymmetry") if name in values}
        offset, origin = (values.get(name, values.get(f"{name}_1", 0.0))
                          for name in ("force_offset", "displacement_offset"))
        in_force = re.compile(r"(force|displacement)_offset(_\d+)?|load_exponent")
        others = [name for name, value in values.items() if value and not in_force.fullmatch(name)]
        if others:
            raise ValueError(f"predict() has no term {', '.join(others)}: fit without it")
        force = _mindahl.simulate(
            array("displacement", displacement) - origin, model=self.model,
            gate=self._kept["reversal_gate"], steady=self.initial_state == "steady", **own)
        return offset + int(self._kept["force_sign"]) * force

    def page(self) -> str:
        """The page of HTML that `mindahl fit --report` writes: verdict, parameters, figures."""
        if self._fitted is not None:
            return self._fitted.page()
        return self._kept.get("page") or (
            f"<!DOCTYPE html>\n<title>mindahl</title>\n<pre>{escape(self.text())}</pre>\n")

    def _repr_html_(self) -> str:
        """The page in a frame of its own, so that its style and a notebook's do not mix."""
        return (f'<iframe srcdoc="{escape(self.page())}" title="mindahl fit" sandbox '
                'style="width: 100%; height: 45em; border: 1px solid #888"></iframe>')

    def plot(self, ax: Any = None) -> Any:
        """Draws the measured and the fitted loop, and the residual below where ax is None.

        ax: two of matplotlib's Axes, for loop and residual, or one for the loop alone; by default
            a new figure.
        Returns the Axes that were drawn on.
        Raises ValueError for a fit that failed, which has no curve.
        """
        from ._plot import draw

        return draw(self.records, self._kept["units"], ax)
