#!/usr/bin/env python3
"""Checks what mindahl writes as JSON against docs/schema, and docs/schema against what it must refuse.

    json_schemas.py --program build/dev/src/mindahl outputs    runs a table of commands
    json_schemas.py --program build/dev/src/mindahl refusals   alters a document
"""

import argparse
import collections
import copy
import json
import pathlib
import random
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import warnings

import jsonschema

warnings.filterwarnings("ignore", category=DeprecationWarning)  # of RefResolver, in new jsonschema

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "docs/schema"
SCHEMAS = {path.stem: json.loads(path.read_text()) for path in sorted(FOLDER.glob("*.json"))}

# What every command writes as JSON, each in a directory with data/ and the files of MAKE. The exit
# status is 0 unless it is given.
MAKE = [
    "simulate --sigma 4e7 --slip-force 40 --lambda 1.2 --cycles 3 --noise-force 0.1 -o loop.csv",
    "simulate --sigma 4e7 --slip-force 40 --lambda 1.2 --cycles 3 --noise-force 0.1 --seed 2 -o twin.csv",
    "simulate --sigma 4e7 --slip-force 40 --lambda 1.2 --cycles 12 --noise-force 0.1 -o long.csv",
    "simulate --model dahl --sigma 4e7 --alpha 0.5 --slip-force 40 --lambda 2 --waveform growing-sine "
    "--cycles 4 -o dahl.csv",
    "simulate --sigma 4e7 --slip-force 40 --lambda 0.02 --cycles 2 --noise-force 2 -o hopeless.csv",
    "simulate --sigma 4e7 --slip-force 40 --model mindlin-dahl --alpha 1.5 --amplitude 3e-6 --cycles 2.5 "
    "--noise-force 0.05 -o exponential.csv",
    "simulate --sigma 4e7 --slip-force 40 --model jenkins --lambda 3 --cycles 2.5 --noise-force 0.05 --seed 2 "
    "-o slider.csv",
    "simulate --sigma 4e7 --slip-force 40 --lambda 1.2 --cycles 0.25 --noise-force 0.05 -o quarter.csv",
]
STEEL = ("--radius-1 0.05 --radius-2 inf --youngs-modulus-1 210e9±1% --poisson-1 0.3 "
         "--youngs-modulus-2 210e9±1% --poisson-2 0.3")
BALL = "data/mindlin_sphere_on_plane.csv"
SERIES = "data/load_series_20N.csv data/load_series_50N.csv data/load_series_120N.csv"
ANY_CONTACT = "contact --friction 0.3 --normal-load 50 --contact-radius 3e-4 --compliance 4.2e-11"
COMMANDS = [
    (f"fit {BALL}", 0),
    (f"fit {BALL} --normal-load 50±0.5 {STEEL}", 0),
    (f"fit {BALL} --normal-load 50 --contact-radius 3e-4±2% --compliance 4.2e-11", 0),
    (f"fit {BALL} --model mindlin --offsets off --initial-state virgin", 0),
    (f"fit {BALL} --model jenkins", 0),
    (f"fit {BALL} --model dahl --loss huber", 0),
    (f"fit {BALL} --compare", 0),
    (f"fit {BALL} --fix sigma=4e7 --terms force_drift,plateau_slope,viscous,lag", 0),
    (f"fit {BALL} --terms auto", 0),
    ("fit walk.csv --terms auto", 0),
    (f"fit {BALL} --fix speed_exponent=0.5 --fix ripple_period=1e-7 --terms inertia,slip_position_quadratic", None),
    (f"fit {BALL} --terms asymmetry", 0),
    (f"fit {BALL} --fix asymmetry=0.1 --fix slip_force=15", 0),
    (f"fit {BALL} --select samples=1:60", 0),
    (f"fit {BALL} --bound alpha=0:0.1", 0),
    ("fit data/partial_slip.csv", 0),
    ("fit data/far_from_slip.csv --normal-load 80", 0),
    ("fit data/far_from_slip.csv --strict", 3),
    (f"fit {SERIES} --normal-load 20,50,120 {STEEL}", 0),
    ("fit dahl.csv", 0),
    ("fit hopeless.csv", 0),
    ("fit torque.csv", 0),
    ("fit steps.csv", 0),
    ("fit rested.csv --trim on", 0),
    (f"fit {BALL} --trim on", 0),
    ("fit noise.csv", 0),
    ("fit loaded.csv", 0),
    ("fit walk.csv", 0),
    (f"fit {BALL} --force-sign opposite", 3),
    (f"fit {BALL} --force-sign opposite --normal-load 50 {STEEL}", 3),
    (f"fit {BALL} --fix sigma=4.8e7 --fix alpha=0.3 --fix slip_force=15", 0),
    (f"fit {BALL} --fix sigma=4.8e7 --contact-radius 2.5e-4 --compliance 4.2e-11", 0),
    (f"fit {BALL} --contact-radius 2.5e-4", 0),
    (f"fit {BALL} --rig-stiffness fit --model mindlin", 0),
    (f"fit {BALL} --initial-state steady", 0),
    ("fit exponential.csv", 0),
    ("fit slider.csv", 0),
    ("fit quarter.csv", 0),
    (f"fit {BALL} loop.csv --normal-load 50", None),
    ("contact --friction 0.3 --normal-load 50±1% " + STEEL, 0),
    (ANY_CONTACT, 0),
    *[(f"convert --sigma 4e7 --slip-force 40 --amplitude 1.2e-6 --to {law}", 0)
      for law in ("masing", "dahl", "lugre", "bouc-wen", "iwan")],
    ("convert --sigma 4e7 --slip-force 40 --amplitude 1.2e-6 --to lammps --normal-load 50", 0),
    ("convert --from dahl --alpha 1 --sigma 4e7 --slip-force 40 --amplitude 1.2e-6 --to iwan", 0),
    ("plan --sigma 4e7 --slip-force 40 --force-noise 0.1", 0),
    ("plan --sigma 4e7 --slip-force 40 --force-noise 0.1 --rig-stiffness 1e8 "
     "--want alpha=0.001,slip_force=1%", None),
    ("plan --record loop.csv --amplitude 1e-6", 0),
    ("tradeoff", 0),
    ("validate --cases 2", 0),
    ("validate --cases 1 --seed 3", None),
    ("fit loop.csv --terms none --prior sigma=4e7±10% --prior force_offset=0±1", 0),
    ("track long.csv --output cycles.csv --normal-load 50", 0),
    ("track long.csv --output again.csv --average 3", 0),
    ("batch loop.csv twin.csv data/partial_slip.csv --output table.csv --normal-load 50", 0),
    ("batch loop.csv broken.csv --output table2.csv", 3),
]


def make_files(directory, run):
    shutil.copytree(ROOT / "data", directory / "data")
    for words in MAKE:
        run(shlex.split(words))
    rows = (directory / "loop.csv").read_text().splitlines()[1:]
    cells = [row.split(",") for row in rows]

    def write(name, header, lines):
        (directory / name).write_text("\n".join([header, *lines]) + "\n")

    write("torque.csv", "angle [rad],torque [N m]", [f"{x},{force}" for _, x, force in cells])
    write("noise.csv", "displacement [m],force [N]",
          [f"{x},{(k * 7919 % 101) / 50 - 1}" for k, (_, x, _) in enumerate(cells)])
    write("loaded.csv", "time [s],displacement [m],force [N],normal load [N]",
          [f"{row},{50 + k % 3}" for k, row in enumerate(rows)])
    write("broken.csv", "displacement [m],force [N]", ["0,0", "1e-6,much"])
    # Excursions of all sizes: no gate of the reversals is surer than another.
    steps_to_and_fro = random.Random(2)
    place, walk = 0.0, []
    for _ in range(400):
        place += steps_to_and_fro.gauss(0, 1e-7)
        walk.append(f"{place}")
    write("walk_path.csv", "displacement [m]", walk)
    run(shlex.split("simulate --sigma 4e7 --slip-force 40 --path walk_path.csv -o walk.csv"))
    write("rested.csv", "displacement [m],force [N]",
          ["0,0"] * 150 + [f"{x},{force}" for _, x, force in cells])
    steps = []
    for n, load in enumerate((25, 100)):
        steps += [f"{float(t) + 3 * n},{x},{force},{load}" for t, x, force in cells]
    write("steps.csv", "time [s],displacement [m],force [N],normal load [N]", steps)


def validator(name):
    by_place = {place_of(name): schema for name, schema in SCHEMAS.items()}
    resolver = jsonschema.RefResolver(place_of(name), SCHEMAS[name], store=by_place)
    return jsonschema.Draft202012Validator(SCHEMAS[name], resolver=resolver)


def place_of(name):
    return (FOLDER / f"{name}.json").as_uri()


def schema_of(name):
    return f"mindahl.{name}/{2 if name == 'fit' else 1}"


def faults(document):
    """What is wrong with a document, by the schema that it names."""
    name = re.fullmatch(r"mindahl\.([a-z_]+)/[12]", document["schema"]).group(1)
    for error in validator(name).iter_errors(document):
        yield f"{'.'.join(map(str, error.absolute_path))}: {error.message[:300]}"
    if name == "fit":
        yield from null_faults(document)
    for file in document.get("files", []) if name == "batch" else []:
        yield from null_faults(file["fit"]) if file["fit"] else []


def resolved(schema, root):
    """What a reference in the same schema stands for, or null; empty of another's."""
    while "$ref" in schema or "anyOf" in schema:
        reference = schema.get("$ref") or schema["anyOf"][0].get("$ref", "")
        schema = root["$defs"][reference.rpartition("/")[2]] if reference.startswith("#") else {}
    return schema


def keys_of(value, schema, root, path=""):
    """Every key of a document, as a schema knows it: by its place there."""
    schema = resolved(schema, root)
    if isinstance(value, dict):
        for key, member in value.items():
            known = schema.get("properties", {}).get(key)
            yield f"{path}.{key}" if known else f"{path}.NAME"
            below = known if known is not None else schema.get("additionalProperties")
            if isinstance(below, dict):
                yield from keys_of(member, below, root, f"{path}.{key}" if known else f"{path}.NAME")
    elif isinstance(value, list) and "items" in schema:
        for member in value:
            yield from keys_of(member, schema["items"], root, f"{path}[]")


def optional_keys(schema, root, path=""):
    schema = resolved(schema, root)
    for key, member in schema.get("properties", {}).items():
        if key not in schema.get("required", []):
            yield f"{path}.{key}"
        yield from optional_keys(member, root, f"{path}.{key}")
    if isinstance(schema.get("additionalProperties"), dict):
        yield from optional_keys(schema["additionalProperties"], root, f"{path}.NAME")
    if "items" in schema:
        yield from optional_keys(schema["items"], root, f"{path}[]")


def null_paths(value, path=""):
    if value is None:
        yield path
    members = (value.items() if isinstance(value, dict)
               else enumerate(value) if isinstance(value, list) else [])
    for key, member in members:
        step = f"[{key}]" if isinstance(value, list) else f".{key}" if path else key
        yield from null_paths(member, path + step)


def null_faults(fit):
    """Every null has its reason, and every reason its null."""
    listed = collections.Counter(null["path"] for null in fit["nulls"])
    found = collections.Counter(null_paths({key: value for key, value in fit.items()
                                            if key != "nulls"}))
    for path in (found - listed):
        yield f"{path}: is null, and nulls does not say why"
    for path in (listed - found):
        yield f"nulls: {path} is not null"
    for null in fit["nulls"]:
        if null["why"] in ("", "not a finite number"):
            yield f"nulls: {null['path']}: '{null['why']}' is no reason"


def check_outputs(program):
    problems = []
    seen = collections.Counter()
    keys = collections.defaultdict(set)
    with tempfile.TemporaryDirectory() as scratch:
        directory = pathlib.Path(scratch)

        def run(words):
            return subprocess.run([program, *words], cwd=directory, capture_output=True,
                                  encoding="utf-8", check=False)

        def make(words):
            done = run(words)
            assert done.returncode == 0, done.stderr

        make_files(directory, make)
        for line, status in COMMANDS:
            done = run([*shlex.split(line), "--json", "-"])
            if status is not None and done.returncode != status:
                problems.append(f"{line}: exit status {done.returncode}: {done.stderr.strip()}")
            if not done.stdout:
                problems.append(f"{line}: no JSON: {done.stderr.strip()}")
                continue
            document = json.loads(done.stdout, parse_constant=lambda text: problems.append(
                f"{line}: {text} is no JSON"))
            seen[document["schema"]] += 1
            name = line.split()[0]
            if document["schema"] != schema_of(name):
                problems.append(f"{line}: schema {document['schema']}")
            problems += [f"{line}: {fault}" for fault in faults(document)]
            keys[name].update(keys_of(document, SCHEMAS[name], SCHEMAS[name]))
    for name in SCHEMAS:
        if not seen[schema_of(name)]:
            problems.append(f"{name}.json: no command of the table writes it")
        for key in sorted(set(optional_keys(SCHEMAS[name], SCHEMAS[name])) - keys[name]):
            problems.append(f"{name}.json: no command of the table writes {key[1:]}")
    print(f"{sum(seen.values())} documents of {len(seen)} schemas")
    return problems


# --- documents that the schemas must refuse ----------------------------------------------------

ABSENT = object()

def altered(document, value, *path):
    """A copy with another value at a path; without it where the value is ABSENT."""
    changed = copy.deepcopy(document)
    place = changed
    for key in path[:-1]:
        place = place[key]
    if value is ABSENT:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    return changed


def keys_in(schema):
    for name, part in schema.items():
        if name == "properties":
            yield from part
        for below in part if isinstance(part, list) else [part]:
            if isinstance(below, dict):
                yield from keys_in(below)


def undocumented_keys():
    """Of the other commands, whose keys docs/contract.md names in its text."""
    pages = re.split(r"\n## mindahl (\w+)\n", (ROOT / "docs/contract.md").read_text())
    sections = dict(zip(pages[1::2], pages[2::2]))
    for name, schema in SCHEMAS.items():
        text = sections[name]
        for key in sorted(set(keys_in(schema)) - set(re.findall(r"`([a-z_0-9]+)`", text)) if name != "fit" else []):
            yield f"{name}.json: {key} is not in docs/contract.md"


def check_refusals(program):
    """A schema that lets anything pass is worth nothing."""
    contact = json.loads(subprocess.run([program, *shlex.split(ANY_CONTACT), "--json", "-"], check=True,
                                        capture_output=True, encoding="utf-8").stdout)
    for name, schema in SCHEMAS.items():
        jsonschema.Draft202012Validator.check_schema(schema)
        if validator(name).is_valid({"schema": schema_of(name), "version": "0.1.0"}):
            yield f"{name}.json lets a document pass that has nothing else than its name"
    yield from undocumented_keys()
    check = validator("contact")
    if not check.is_valid(contact):
        yield "contact.json refuses a document as it should be"
    for why, document in [
            ("a missing key", altered(contact, ABSENT, "version")),
            ("a missing parameter", altered(contact, ABSENT, "parameters", "alpha")),
            ("another schema", altered(contact, "mindahl.fit/2", "schema")),
            ("a text for a number", altered(contact, "1.0", "parameters", "sigma", "value")),
            ("a null", altered(contact, None, "contact", "compliance", "value")),
            ("a negative error", altered(contact, -1, "contact", "compliance", "standard_error")),
            ("a key that it does not know", altered(contact, 1, "temperature")),
    ]:
        if check.is_valid(document):
            yield f"contact.json does not refuse {why}"
    if len(list(null_faults({"nulls": [{"path": "a[0].b", "why": "."}], "a": [{"b": None}]}))) > 0:
        yield "a null with its reason is refused"
    if len(list(null_faults({"nulls": [], "a": [{"b": None}]}))) != 1:
        yield "a null without a reason is not refused"
    if len(list(null_faults({"nulls": [{"path": "a", "why": "."}], "a": 1}))) != 1:
        yield "a reason without a null is not refused"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["outputs", "refusals"])
    parser.add_argument("--program", type=pathlib.Path)
    arguments = parser.parse_args()
    check = {"outputs": check_outputs, "refusals": check_refusals}[arguments.what]
    problems = list(check(arguments.program.resolve()))
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
