"""mindahl.contact(), convert() and simulate()."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any, Optional

from . import _mindahl
from ._arguments import (Floats, Uncertain, array, contact_options, count, number,
                         optional_number, path_text)
from ._result import FitWarning, Report


class Conversion(Report):
    """A conversion: sections of the program's JSON, and the lines that the target reads."""

    def __init__(self, answer: _mindahl.Answer, input_lines: Optional[list[str]]) -> None:
        super().__init__(answer, "conversion", ("parameters", "elements"))
        self.input_lines = input_lines


def report_of(answer: _mindahl.Answer, path: str, tables: tuple[str, ...],
              assumed: Sequence[str] = ()) -> Report:
    """The answer, its warnings and what was assumed as FitWarning of the caller's caller."""
    for doubt in (*assumed, *answer.warnings):
        warnings.warn(_mindahl.with_keywords(doubt), FitWarning, stacklevel=3)
    return Report(answer, path, tables)


def contact(
    *, friction: Optional[Uncertain] = None, normal_load: Optional[Uncertain] = None,
    youngs_modulus_1: Optional[Uncertain] = None, poisson_1: Optional[Uncertain] = None,
    radius_1: Optional[Uncertain] = None, youngs_modulus_2: Optional[Uncertain] = None,
    poisson_2: Optional[Uncertain] = None, radius_2: Optional[Uncertain] = None,
    contact_radius: Optional[Uncertain] = None, compliance: Optional[Uncertain] = None,
) -> Report:
    """Hertz, Mindlin and the Mindlin-Dahl mapping: sigma = 8a/G*, alpha = 1/3, Tc = mu N.

    Each a number or (number, standard uncertainty):
    friction: mu [-]. normal_load: N [N].
    youngs_modulus_1 [Pa], poisson_1 [-], radius_1 [m] (inf a plane, negative a seat) and the same
        of body 2; or contact_radius a [m] and compliance G* = (2-nu1)/G1 + (2-nu2)/G2 [1/Pa].
    Returns the sections contact and parameters: result.parameters.sigma.value [N/m],
        .standard_error, .unit.
    Raises InputError naming what is missing, ValueError for a value out of range.
    """
    return report_of(_mindahl.contact(contact_options(
        friction, youngs_modulus_1=youngs_modulus_1, poisson_1=poisson_1, radius_1=radius_1,
        youngs_modulus_2=youngs_modulus_2, poisson_2=poisson_2, radius_2=radius_2,
        contact_radius=contact_radius, compliance=compliance, normal_load=normal_load)),
        "contact", ("contact", "parameters"))


def convert(
    fit: Any = None, *, to: str, sigma: Optional[float] = None, slip_force: Optional[float] = None,
    amplitude: Optional[float] = None, alpha: Optional[float] = None, from_: Optional[str] = None,
    tolerance: float = 0.01, elements: int = 8, beta: float = 0.5,
    normal_load: Optional[float] = None, contact_radius: Optional[float] = None,
    viscous: float = 0.0,
) -> Conversion:
    """Converts a contact's steady loop to another law or program.

    fit: file of `mindahl fit --json`, whose law and amplitude are taken unless given here.
    sigma [N/m], alpha [-] (1/3), slip_force Tc [N]: parameters of the law from_, "masing" (default)
        or "dahl".
    amplitude: X [m] of the contact's steady loop.
    to: "masing", "dahl", "lugre", "bouc-wen", "iwan", "lammps", "liggghts", "yade",
        "mujoco", "mujoco-joint", "urdf" or "sdf".
    tolerance: of force and energy [-]. elements: number for "iwan". beta: of "bouc-wen".
    normal_load [N]: for "lammps", "liggghts", "yade". contact_radius [m]: for "lammps".
    viscous [N s/m]: for "lugre" and the four laws of robots.
    Returns the sections of `mindahl convert --json`; .input_lines are the lines the target reads,
        None for codes of discrete elements without a normal load.
    Raises ValueError naming the quantity, its value and the rule.
    """
    return Conversion(*_mindahl.convert(
        fit="" if fit is None else path_text(fit), sigma=optional_number("sigma", sigma),
        alpha=optional_number("alpha", alpha), slip_force=optional_number("slip_force", slip_force),
        amplitude=optional_number("amplitude", amplitude), from_law=from_ or "", to=to,
        tolerance=number("tolerance", tolerance), elements=count("elements", elements, 1),
        beta=number("beta", beta), normal_load=optional_number("normal_load", normal_load),
        contact_radius=optional_number("contact_radius", contact_radius),
        viscous=number("viscous", viscous)))


def excitation(
    waveform: str = "sine", *, amplitude: float, cycles: float = 1.0, samples_per_cycle: int = 200,
    frequency: float = 1.0, growth: float = 10.0, seed: int = 1,
) -> tuple[Floats, Floats]:
    """Time [s] and imposed displacement [m], as `mindahl simulate --waveform` makes them.

    waveform: "sine", "triangle", "growing-sine", "random", "nested".
    amplitude: [m], > 0, the largest. cycles: > 0, multiples of 1/samples_per_cycle.
    samples_per_cycle: from 4; a multiple of 4 puts samples on the extremes. frequency: [Hz], > 0.
    growth: of a growing sine, last over first envelope, >= 1. seed: of a random waveform.
    Returns two arrays of one length, from 0 at time 0.
    Raises InputError for an unknown waveform, ValueError for a value out of range.
    """
    return _mindahl.excitation(
        waveform=waveform, amplitude=number("amplitude", amplitude),
        cycles=number("cycles", cycles),
        samples_per_cycle=count("samples_per_cycle", samples_per_cycle, 4),
        frequency=number("frequency", frequency), growth=number("growth", growth),
        seed=count("seed", seed, 0))


def simulate(
    displacement: Any, *, sigma: float, slip_force: float, alpha: Optional[float] = None,
    model: str = "mindlin-dahl", rig_stiffness: Optional[float] = None, asymmetry: float = 0.0,
    load: Any = None, reference_load: float = 1.0,
) -> Floats:
    """Computes the tangential force [N] of a contact along a displacement, exactly for any history.

    displacement: array [m]; the contact is unloaded at 0, and a first sample that is not 0 is the
        first loading step. Used where it is when it is contiguous float64.
    sigma: tangential stiffness [N/m], > 0. slip_force: Tc [N], > 0.
    alpha: shape exponent [-], >= 0; by default the model's own, or 1/3.
    model: "mindlin-dahl", "mindlin", "dahl", "jenkins", "simplified-dahl".
    rig_stiffness: of a spring [N/m] in series, by default rigid.
    asymmetry: A of slip forces Tc(1 ± A) [-], in (-1, 1).
    load: array, of "dahl": the force is in proportion to it, slip_force being that under
        reference_load; of either sign, as the torque that a joint carries.
    Returns an array of the same length. Noise is NumPy's: + rng.normal(0, deviation, force.size).
    Raises ValueError naming the quantity, its value and the rule.
    """
    return _mindahl.simulate(
        array("displacement", displacement), sigma=number("sigma", sigma),
        slip_force=number("slip_force", slip_force), alpha=optional_number("alpha", alpha),
        model=model, rig_stiffness=optional_number("rig_stiffness", rig_stiffness),
        asymmetry=number("asymmetry", asymmetry),
        load=None if load is None else array("load", load),
        reference_load=number("reference_load", reference_load))
