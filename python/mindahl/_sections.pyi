"""Sections of a fit, for type checkers: docs/schema/fit.json."""

from typing import Optional

from ._result import AnySection, Section

class Column(Section):
    name: str
    index: int
    unit: str

class Columns(Section):
    displacement: Optional[Column]
    force: Optional[Column]
    time: Optional[Column]
    normal_load: Optional[Column]

class LeftOut(Section):
    file: str
    samples: int
    first: Optional[int]
    last: Optional[int]
    why: str

class Input(Section):
    files: tuple[str, ...]
    columns: Columns
    samples: int
    cycles: int
    reversals: int
    left_out: tuple[LeftOut, ...]

class Residuals(Section):
    rms: Optional[float]
    max_abs: Optional[float]
    r_squared: Optional[float]
    durbin_watson: Optional[float]
    effective_samples: Optional[float]

class Solver(Section):
    solver: str
    termination: str
    converged: bool
    iterations: int
    final_cost: Optional[float]

class Cause(Section):
    code: str
    term: Optional[str]
    delta_aicc: Optional[float]
    explains: Optional[float]

class Adequacy(Section):
    verdict: Optional[str]
    use: Optional[str]
    p_value: Optional[float]
    misfit_over_noise: Optional[float]
    misfit_over_half_gap: Optional[float]
    causes: tuple[Cause, ...]

class HalfGap(Section):
    value: Optional[float]
    standard_deviation: Optional[float]

class CycleFacts(Section):
    start: int
    amplitude: Optional[float]
    peak_force: Optional[float]
    half_gap: Optional[float]
    energy: Optional[float]
    energy_ratio: Optional[float]

class Measured(Section):
    half_gap: HalfGap
    amplitude: Optional[float]
    peak_force: Optional[float]
    energy_per_cycle: Optional[float]
    energy_ratio: Optional[float]
    asymmetry: Optional[float]
    slides: Optional[bool]
    cycles: tuple[CycleFacts, ...]

class Alternative(Section):
    law: str
    sigma: Optional[float]
    alpha: Optional[float]
    slip_force: Optional[float]

class Law(Section):
    decided: bool
    preferred: Optional[str]
    alternatives: tuple[Alternative, ...]
    delta_aicc: Optional[float]

class Mapping(Section):
    alpha_minus_third: Optional[float]
    p_value: Optional[float]
    sigma_over_hertz_mindlin: Optional[float]

class ConsideredTerm(Section):
    name: str
    gain: Optional[float]
    added: bool
    refused: str

class Terms(Section):
    mode: str
    considered: tuple[ConsideredTerm, ...]
    added: tuple[str, ...]

class NextStep(Section):
    text: str
    options: str
    misfit_before: float
    misfit_after: float
