"""Other commands of the program: contact(), convert(), plan() and command(); and the functions of the
library excitation() and simulate()."""

from __future__ import annotations

import json
import os
import re
import tempfile
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, Optional, Union

import numpy as np

from . import _mindahl
from ._arguments import Floats, Uncertain, array, is_pair, number, words
from ._records import columns_by_name, copy_of, is_path, name_of
from ._result import FitWarning, Report, Told


class Answer(NamedTuple):
    document: str
    text: str
    established: bool


def ask(command: str, options: Sequence[str], files: Sequence[tuple[str, Any]] = (),
        outputs: Sequence[str] = (), say: Optional[Callable[[str], None]] = None) -> tuple[Answer, list[str]]:
    """What a command of the program answers, and what it writes to the outputs that are named by their
    options.

    files: an option, "" for none, with a path, an open file, or the record, table or arrays of a file
        that is written.
    say: is told what the program warns of and assumes; by default it is a FitWarning of the caller's
        caller.
    Raises InputError where the program refuses.
    """
    say = say or (lambda message: warnings.warn(message, FitWarning, stacklevel=4))
    shown: dict[str, str] = {}

    def named(text: str, quoted: Callable[[str], str] = str) -> str:
        """What is written for this call has a name, and no folder."""
        for path in sorted(shown, reverse=True):
            text = text.replace(path, quoted(shown[path]))
        return text.replace(f"{folder}/", "")

    with tempfile.TemporaryDirectory() as folder:
        written = ["json", *outputs]
        asked = [*options, *(f"--{name}={folder}/{name}" for name in written)]
        for k, (option, given) in enumerate(files):
            name = option or ("record" if len(files) == 1 else f"record {k + 1}")
            path = os.fspath(given) if is_path(given) else _written(f"{folder}/{name}", given)
            asked.append(f"--{option}={path}" if option else path)
            shown[path] = name_of(given, name)
        out, said, is_done = _run(command, asked, named)
        document, *texts = (Path(folder, name).read_text(encoding="utf-8") for name in written)
        document = named(document, lambda name: json.dumps(name, ensure_ascii=False)[1:-1])
        for message in (*(each.partition(": ")[2] for each in said
                          if each.startswith(("note: ", "warning: "))),
                        *json.loads(document).get("notes", [])):
            say(_mindahl.with_keywords(message))
        return Answer(document, out, is_done), list(map(named, texts))


def _run(command: str, options: Sequence[str],
         named: Callable[[str], str] = str) -> tuple[str, list[str], bool]:
    """What a command prints, its messages, and whether its status is 0."""
    status, *told = _mindahl.run_command(["mindahl", command, *options])
    out, err = map(named, told)
    said = re.findall(r"mindahl(?: \w+)?: ([^\r\n]*)", err)
    if status not in (0, 3):
        refusal = re.sub("; see mindahl .*", "", said[-1]) if said else err
        raise _mindahl.InputError(_mindahl.with_keywords(refusal))
    return out, said, status == 0


def _written(path: str, source: Any) -> str:
    """A copy of an open file, or a CSV file of a record, a table or arrays, of as many digits as they
    have."""
    if hasattr(source, "read"):
        return copy_of(source, path)
    if isinstance(source, Told):
        Path(path).write_text(source.to_json(), encoding="utf-8")
        return path
    columns = (list(zip(("displacement [m]", "force [N]"), source)) if is_pair(source) else
               columns_by_name(source))
    if columns is None:
        raise ValueError(f"a {type(source).__name__} is no array, data frame, record or file")
    with open(path, "w", encoding="utf-8") as file:
        file.write(",".join(name for name, _ in columns) + "\n")
        file.writelines(",".join(row) + "\n"
                        for row in zip(*(map(repr, np.asarray(values, dtype=np.float64).tolist())
                                         for _, values in columns)))
    return path


class Conversion(Report):
    """A conversion: sections of the program's JSON, and the lines that the target reads."""

    input_lines: Optional[list[str]] = None


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
    return Report(*ask("contact", words(locals()))[0], "contact")


def convert(
    fit: Any = None, *, to: str, sigma: Optional[float] = None, slip_force: Optional[float] = None,
    amplitude: Optional[float] = None, alpha: Optional[float] = None, from_: Optional[str] = None,
    tolerance: float = 0.01, elements: int = 8,
    normal_load: Optional[float] = None,
) -> Conversion:
    """Converts a contact's steady loop to another law or program.

    fit: a result of fit(), a file of `mindahl fit --json` or to_json(), or a record, which is fitted:
        law and amplitude are taken unless given here.
    sigma [N/m], alpha [-] (1/3), slip_force Tc [N]: parameters of the law from_, "masing" (default)
        or "dahl".
    amplitude: X [m] of the contact's steady loop.
    to: "masing", "dahl", "lugre", "bouc-wen", "iwan" or "lammps".
    tolerance: of force and energy [-]. elements: number for "iwan". normal_load [N]: for "lammps".
    Returns the sections of `mindahl convert --json`; .input_lines are the lines the target reads,
        None for "lammps" without a normal load.
    Raises ValueError naming the quantity, its value and the rule.
    """
    given = dict(locals())
    del given["fit"]
    has_lines = to != "lammps" or normal_load is not None
    answer, lines = ask("convert", words(given), [] if fit is None else [("", fit)],
                        ["input-lines"] if has_lines else [])
    conversion = Conversion(*answer, "conversion")
    conversion.input_lines = lines[0].splitlines() if lines else None
    return conversion


def excitation(
    waveform: str = "sine", *, amplitude: float, cycles: float = 1.0, samples_per_cycle: int = 200,
    frequency: float = 1.0, growth: Optional[float] = None,
) -> tuple[Floats, Floats]:
    """Time [s] and imposed displacement [m], as `mindahl simulate --waveform` makes them.

    waveform: "sine", "triangle", "growing-sine".
    amplitude: [m], > 0, the largest. cycles: > 0, multiples of 1/samples_per_cycle.
    samples_per_cycle: from 4; a multiple of 4 puts samples on the extremes. frequency: [Hz], > 0.
    growth: of a growing sine, last over first envelope, >= 1; default 10.
    Returns two arrays of one length, from 0 at time 0.
    Raises InputError (a ValueError) for an unknown waveform or a value out of range.
    """
    told = _run("simulate", [*words(locals()), "--sigma=1", "--slip-force=1"])[0]
    rows = np.array([line.split(",")[:2] for line in told.splitlines()[1:]], dtype=np.float64)
    return rows[:, 0].copy(), rows[:, 1].copy()


def simulate(
    displacement: Any, *, sigma: float, slip_force: float, alpha: Optional[float] = None,
    model: str = "mindlin-dahl", rig_stiffness: Optional[float] = None, asymmetry: float = 0.0,
) -> Floats:
    """Computes the tangential force [N] of a contact along a displacement, exactly for any history.

    displacement: array [m]; the contact is unloaded at 0, and a first sample that is not 0 is the
        first loading step. Used where it is when it is contiguous float64.
    sigma: tangential stiffness [N/m], > 0. slip_force: Tc [N], > 0.
    alpha: shape exponent [-], >= 0; by default the model's own, or 1/3.
    model: "mindlin-dahl", "mindlin", "dahl", "jenkins", "simplified-dahl".
    rig_stiffness: of a spring [N/m] in series, by default rigid.
    asymmetry: A of slip forces Tc(1 ± A) [-], in (-1, 1).
    Returns an array of the same length. Noise is NumPy's: + rng.normal(0, deviation, force.size).
    Raises ValueError naming the quantity, its value and the rule.
    """
    numbers = {name: number(name, value) for name, value in locals().items()
               if name not in ("displacement", "model")
               and not (value is None and name in ("alpha", "rig_stiffness"))}
    return _mindahl.simulate(array("displacement", displacement), model=model, **numbers)


def plan(
    record: Any = None, *, sigma: Optional[float] = None, alpha: Optional[float] = None,
    slip_force: Optional[float] = None, model: Optional[str] = None,
    rig_stiffness: Optional[float] = None, force_noise: Optional[float] = None, displacement_noise: float = 0.0,
    amplitude: Union[None, float, Sequence[float]] = None, cycles: float = 3.0,
    samples_per_cycle: int = 200, want: Optional[Mapping[str, Union[float, str]]] = None,
) -> Report:
    """Plans a measurement: the standard errors that a loop of each amplitude would give.

    The contact, one of
        sigma [N/m], alpha [-] (1/3), slip_force Tc [N], model "mindlin-dahl" (default) or "dahl";
        record: a file, data frame, Record or (displacement [m], force [N]), whose fit gives law and
            noise.
    rig_stiffness: known, of a rig in series [N/m]. force_noise [N], displacement_noise [m]: standard deviations.
    amplitude: X [m], one or several; by default 13 around the onset of slip. cycles >= 1,
        samples_per_cycle >= 4.
    want: parameter to wanted standard error, in its unit or in percent: {"slip_force": "1%"}.
    Returns the sections of `mindahl plan --json`; .to_pandas() has a row a loop; .established is
        False where no amplitude reaches what is wanted.
    Raises InputError (a ValueError) naming what is missing, ValueError for a value out of range.
    """
    given = {name: value for name, value in locals().items() if name != "record"}
    given["amplitude"] = list(amplitude) if isinstance(amplitude, tuple) else amplitude
    files = [] if record is None else [("record", record)]
    return Report(*ask("plan", words(given), files)[0], "plan")


def command(name: str, *files: Any, **options: Any) -> Report:
    """Any command of the program that writes JSON, with its options as keywords: command("validate", cases=5).

    files: what the command takes without an option: paths, or open files, Records, data frames and
        dictionaries of arrays, {"x [um]": ..., "F [N]": ...}, in the place of one.
    options: as `mindahl NAME --help-all` has them, with underscores, numbers in SI units. One that
        takes a path takes all of these.
    Returns the sections of the JSON that the command writes.
    Raises InputError (a ValueError) where the program refuses.
    """
    tables = {option: each for option, each in options.items() if hasattr(each, "read") or any(
        not isinstance(values, tuple) for _, values in columns_by_name(each) or [])}  # as bounds are
    rest = {option: each for option, each in options.items() if option not in tables}
    return Report(*ask(name, words(rest), [*(("", each) for each in files), *tables.items()])[0], name)
