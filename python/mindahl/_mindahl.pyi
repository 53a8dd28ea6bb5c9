from collections.abc import Mapping, Sequence
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

__version__: str

class InputError(ValueError): ...

def with_keywords(message: str) -> str: ...

class ColumnChoice:
    def __init__(self, column: str = ..., unit: str = ..., gain: Optional[float] = ...,
                 zero: float = ...) -> None: ...

class RecordColumns:
    def __init__(self, displacement: ColumnChoice, force: ColumnChoice, time: ColumnChoice,
                 normal_load: ColumnChoice, covariates: Sequence[str],
                 encoding: str = ...) -> None: ...

class Record:
    @property
    def name(self) -> str: ...
    @property
    def displacement(self) -> Floats: ...
    @property
    def force(self) -> Floats: ...
    @property
    def time(self) -> Optional[Floats]: ...
    @property
    def normal_load(self) -> Optional[Floats]: ...
    @property
    def covariates(self) -> dict[str, Floats]: ...
    @property
    def columns(self) -> dict[str, dict[str, Any]]: ...
    @property
    def is_torsional(self) -> bool: ...
    @property
    def notes(self) -> list[str]: ...
    def __len__(self) -> int: ...

def read_csv(path: str, columns: RecordColumns, max_rows: Optional[int] = None,
             max_memory: Optional[int] = None) -> Record: ...
def record_of_columns(name: str, names: Sequence[str], arrays: Sequence[Floats],
                      columns: RecordColumns) -> Record: ...

class UncertainValue:
    def __init__(self, value: float, standard_error: float = ...) -> None: ...
    @property
    def value(self) -> float: ...
    @property
    def standard_error(self) -> float: ...

class KnownBody:
    youngs_modulus: Optional[UncertainValue]
    poisson: Optional[UncertainValue]
    radius: Optional[UncertainValue]

class KnownContact:
    normal_load: Optional[UncertainValue]
    contact_radius: Optional[UncertainValue]
    compliance: Optional[UncertainValue]
    body_1: KnownBody
    body_2: KnownBody

class ContactOptions:
    known: KnownContact
    friction: Optional[UncertainValue]

class FitRequest:
    time_window: str
    model: str
    initial_state: str
    force_sign: str
    noise_in: str
    offsets: str
    covariates: list[str]
    term_choice: str
    load_window: str
    cycles: str
    samples: str
    skip_cycles: int
    trim: str
    loss: str
    starts: int
    seed: int
    fix: list[str]
    start: list[str]
    bound: list[str]
    confidence: float
    force_noise: Optional[float]
    displacement_noise: Optional[float]
    reversal_gate: Optional[float]
    columns: RecordColumns
    join: bool
    contact: ContactOptions
    def set_term(self, name: str, asked: str) -> None: ...
    def set_normal_loads(self, loads: Sequence[UncertainValue]) -> None: ...
    def covariate_columns(self) -> list[str]: ...

class Fitted:
    def json(self) -> str: ...
    def page(self) -> str: ...
    def text(self) -> str: ...
    def residuals_csv(self) -> str: ...
    @property
    def records(self) -> list[dict[str, Any]]: ...
    @property
    def failed(self) -> bool: ...
    @property
    def units(self) -> tuple[str, str]: ...
    @property
    def notes(self) -> list[str]: ...

def fit(records: Sequence[Record], request: FitRequest) -> Fitted: ...
def terms() -> list[tuple[str, str]]: ...

class TrackedCourses:
    def describe(self) -> tuple[dict[str, dict[str, Any]], list[str]]: ...

Tracked = tuple[dict[str, Any], dict[str, str], list[str], TrackedCourses, dict[str, Any]]

class TrackRequest:
    fit: FitRequest
    normal_load: Optional[float]
    average: int
    every: int
    threads: int
    shares_alpha: bool

def track_files(request: TrackRequest, files: Sequence[str],
                skip_broken_rows: bool) -> Tracked: ...
def track_records(request: TrackRequest,
                  records: Sequence[Record]) -> Tracked: ...
def contact(options: ContactOptions) -> dict[str, Any]: ...
def doubts_about(options: ContactOptions) -> list[str]: ...
def convert(*, sigma: float, alpha: float, slip_force: float, amplitude: float, from_law: str,
            to: str, range: Optional[tuple[float, float]], tolerance: float, elements: int,
            beta: float, normal_load: Optional[float],
            contact_radius: Optional[float]) -> tuple[dict[str, Any], Optional[list[str]]]: ...
def excitation(*, waveform: str, amplitude: float, cycles: float, samples_per_cycle: int,
               frequency: float, growth: float, seed: int) -> tuple[Floats, Floats]: ...
def simulate(displacement: Floats, *, sigma: float, slip_force: float,
             alpha: Optional[float], model: str, rig_stiffness: Optional[float]) -> Floats: ...

class ContactState:
    """A contact that is moved step by step: help(mindahl.ContactState) has the units."""

    def __init__(self, *, sigma: float, slip_force: float, alpha: Optional[float] = ...,
                 model: str = ..., unloaded_displacement: float = ...,
                 rig_stiffness: Optional[float] = ...) -> None: ...
    def move(self, displacement: float) -> float: ...
    def peek(self, displacement: float) -> float: ...
    def reset(self) -> None: ...
    @property
    def force(self) -> float: ...
    @property
    def displacement(self) -> float: ...
    @property
    def tangent_stiffness(self) -> float: ...
    @property
    def remembered_extremes(self) -> int: ...
    def __copy__(self) -> ContactState: ...
    def __deepcopy__(self, memo: Mapping[Any, Any]) -> ContactState: ...
