#!/usr/bin/env python3
"""Keeps about a thousand answers of the program, and says which of them a change has moved.

    tools/frozen/frozen.py make --program PROGRAM --writer measure_reliability     # the baseline
    tools/frozen/frozen.py diff --program PROGRAM [--only PATTERN] [--most 40]     # what has changed

The baseline lies outside the repository, in MINDAHL_FROZEN_DIR (default: ../frozen): the inputs as CSV in
SI units, `answers.jsonl` with one answer a line, and the commit whose program gave them. `make` writes
 - the loops of every kind of tools/reliability at three levels and three seeds (`--writer`),
 - the records of MINDAHL_MEASURED_DIR (default: ../shared/measured; skipped with a message where absent)
   whole, halved, and without their first 3 and 7 %,
 - the loops of data/ and simulated loops of many seeds,
and runs the other commands once each. `diff` runs the same commands on the same inputs and sorts the answers:
 identical    every number within 1e-9 of its value, the same verdicts
 equivalent   ends of intervals within 2 % of the half width, the same verdicts
 changed      all others, listed, the worst first
A number that only one of the two answers has is not compared. Ends with 1 where an answer has changed."""

import argparse
import collections
import concurrent.futures
import csv
import fnmatch
import json
import math
import os
import pathlib
import subprocess
import sys

HOUSE = pathlib.Path(__file__).resolve().parents[2]
SAME = 1e-9         # relative, of a number
EQUIVALENT = 0.02   # of the half width of an interval
LEVELS, SEEDS = 3, 3
PARAMETERS = ("sigma", "alpha", "slip_force")
LAW_ALONE = ["--model", "mindlin-dahl", "--terms", "none", "--trim", "off"]

SEAL = {"time": (0, 1e-3), "displacement": (4, 1e-3), "force": (6, 1.0)}
DAMPER = {"time": (0, 1.0), "displacement": (1, 1e-3), "force": (2, 1.0)}
BRAKE = {"time": (0, 1.0), "displacement": (1, 0.0254), "force": (2, 4448.2216152605)}
# Folder, pattern of names: columns by number from 0, with the factor to SI, and rows of a header.
MEASURED = [
    ("tribometer", "*.txt", {"time": (0, 1.0), "displacement": (2, 1e-3), "force": (3, 1e-6)}, 1),
    ("seals", "*.csv", SEAL, 0),
    ("mr_damper_labcontrol", "*.csv", DAMPER, 1),
    ("mr_damper_utfsm", "*.csv", DAMPER, 1),
    ("band_brake", "dataset-1*", {name: (column, 1.0) for name, (column, _) in BRAKE.items()}, 1),
    ("band_brake", "dataset-[24]*", BRAKE, 1),
    ("cycloidal", "*.csv", {"time": (0, 1.0), "displacement": (1, 2 * math.pi), "force": (2, 1.0)}, 1),
]
# Parts of a measured record, as fractions of its rows.
WINDOWS = {"whole": (0, 1), "first_half": (0, 0.5), "second_half": (0.5, 1), "without_3": (0.03, 1),
           "without_7": (0.07, 1)}

LAW = ["--sigma", "4.8e7", "--alpha", "0.3333", "--slip-force", "15"]
OTHER_COMMANDS = {
    "contact": ["contact", "--normal-load", "50", "--friction", "0.3", "--youngs-modulus-1", "210e9", "--poisson-1",
                "0.3", "--radius-1", "0.05", "--youngs-modulus-2", "210e9", "--poisson-2", "0.3", "--radius-2", "inf",
                "--json", "-"],
    "convert": ["convert", *LAW, "--amplitude", "8e-7", "--from", "masing", "--to", "dahl", "--json", "-"],
    "plan": ["plan", *LAW, "--force-noise", "0.1", "--json", "-"],
    "validate": ["validate", "--cases", "20", "--json", "-"],
    "simulate": ["simulate", "--model", "mindlin-dahl", *LAW, "--amplitude", "8e-7", "--cycles", "2"],
}


def frozen_dir():
    return pathlib.Path(os.environ.get("MINDAHL_FROZEN_DIR", HOUSE.parent / "frozen"))


def write_record(path, columns):
    """Writes columns, by their names with units, as CSV."""
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values()))


def read_measured(path, roles, header):
    """Returns the columns of a measured record in SI; rows without a number are left out."""
    rows = []
    with open(path, newline="", encoding="latin-1") as file:
        for number, line in enumerate(file):
            if number < header or not line.strip():
                continue
            cells = line.strip().split("\t" if "\t" in line else ",")
            try:
                rows.append([float(cells[column]) * factor for column, factor in roles.values()])
            except (ValueError, IndexError):
                continue
    units = {"time": "time [s]", "displacement": "displacement [m]", "force": "force [N]"}
    return {units[role]: column for role, column in zip(roles, zip(*rows))}


def make_measured(inputs):
    measured = pathlib.Path(os.environ.get("MINDAHL_MEASURED_DIR", HOUSE.parent / "shared" / "measured"))
    cases = {}
    if not measured.is_dir():
        print(f"skipped: no measured records in {measured} (MINDAHL_MEASURED_DIR)")
        return cases
    for folder, pattern, roles, header in MEASURED:
        for path in sorted((measured / folder).glob(pattern)):
            columns = read_measured(path, roles, header)
            length = len(next(iter(columns.values())))
            for window, (first, last) in WINDOWS.items():
                name = f"measured/{folder}/{path.stem}/{window}"
                file = inputs / (name.replace("/", "__") + ".csv")
                part = slice(int(first * length), int(last * length))
                write_record(file, {key: values[part] for key, values in columns.items()})
                cases[name] = ["fit", str(file), *LAW_ALONE, "--json", "-"]
                if window == "whole":
                    cases[name + "/terms"] = ["fit", str(file), "--model", "mindlin-dahl", "--terms", "auto",
                                                "--trim", "off", "--json", "-"]
    return cases


def make_kinds(inputs, writer):
    listed = subprocess.run([writer, "--write", "?", "1", "1", "x"], capture_output=True, text=True).stderr
    kinds = [line.strip() for line in listed.splitlines()[1:]]
    cases = {}
    for kind in kinds:
        for level in range(1, LEVELS + 1):
            for seed in range(1, SEEDS + 1):
                name = f"kind/{kind}/{level}/{seed}"
                file = inputs / ("kind__" + "".join(c if c.isalnum() else "_" for c in kind) + f"_{level}_{seed}.csv")
                subprocess.run([writer, "--write", kind, str(level), str(seed), str(file)], check=True)
                cases[name] = ["fit", str(file), *LAW_ALONE, "--json", "-"]
    return cases


def make_loops(inputs, program):
    """Loops of data/, and simulated ones of many seeds."""
    cases = {}
    for path in sorted((HOUSE / "data").glob("*.csv")):
        copy = inputs / ("data__" + path.name)
        copy.write_bytes(path.read_bytes())
        if path.stem in ("joint", "raw_rig_record"):
            continue  # files to read, not loops to fit
        cases[f"data/{path.stem}"] = ["fit", str(copy), *LAW_ALONE, "--json", "-"]
    series = [str(inputs / f"data__load_series_{load}N.csv") for load in (20, 50, 120)]
    cases["data/load_series"] = ["fit", *series, "--normal-load", "20,50,120", *LAW_ALONE, "--json", "-"]
    for model, alpha in (("mindlin-dahl", "0.3333"), ("mindlin-dahl", "0.7"), ("dahl", "1")):
        for reach in ("0.5", "0.9", "1.2", "3"):
            for seed in range(1, 9):
                amplitude = float(reach) * 15 / 4.8e7 / (1 - 0.3333)
                name = f"seeds/{model}/{alpha}/{reach}/{seed}"
                file = inputs / (name.replace("/", "__") + ".csv")
                subprocess.run([program, "simulate", "--model", model, "--sigma", "4.8e7", "--alpha", alpha, "--slip-force",
                                "15", "--amplitude", repr(amplitude), "--cycles", "2", "--samples-per-cycle", "200",
                                "--noise-force", "0.075", "--seed", str(seed), "-o", str(file)],
                               check=True, capture_output=True)
                cases[name] = ["fit", str(file), "--model", model, "--terms", "none", "--trim", "off",
                                "--json", "-"]
    steady = str(inputs / "data__steady.csv")
    # A lone name in braces stands for a file that the run writes.
    cases["command/track"] = ["track", steady, "--output", "{table}"]
    cases["command/batch"] = ["batch", steady, str(inputs / "data__partial_slip.csv"), *LAW_ALONE, "--output", "{table}"]
    cases |= {f"command/{name}": arguments for name, arguments in OTHER_COMMANDS.items()}
    return cases


def leaves(value, path=""):
    """Yields the numbers of a JSON with their paths."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from leaves(item, f"{path}.{key}")
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from leaves(item, f"{path}[{index}]")
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield path, value


def answer_of_fit(fit):
    parameters = {name: {"value": entry.get("value"), "ci95": entry.get("ci95"),
                         "identifiability": entry.get("identifiability"), "status": entry.get("status")}
                  for name, entry in fit["parameters"].items() if name in PARAMETERS}
    adequacy, measured = fit.get("adequacy") or {}, fit.get("measured") or {}
    return {"converged": fit["solver"]["converged"], "initial_state": fit["initial_state"],
            "verdict": adequacy.get("verdict"), "use": adequacy.get("use"), "parameters": parameters,
            "rms": fit["residuals"].get("rms"), "half_gap": (measured.get("half_gap") or {}).get("value")}


def answer_of_table(text):
    """Returns the columns of a table, by their names without units."""
    rows = list(csv.reader(line for line in text.splitlines() if not line.startswith("#")))
    columns = {name.split(" [")[0]: column for name, column in zip(rows[0], zip(*rows[1:]))}
    numbers = {}
    for name, column in columns.items():
        if name in ("checksum", "first_line"):
            continue
        try:
            numbers[name] = [float(cell) if cell else None for cell in column]
        except ValueError:
            continue
    return numbers


def run(program, name, arguments, folder):
    table = pathlib.Path(folder) / (name.replace("/", "__") + ".table")
    table.unlink(missing_ok=True)
    done = subprocess.run([program, *(str(table) if a == "{table}" else a for a in arguments)], capture_output=True,
                          text=True, timeout=300)
    answer = {"exit": done.returncode}
    try:
        if arguments[0] == "fit":
            answer |= answer_of_fit(json.loads(done.stdout))
        elif table.exists():
            answer["table"] = answer_of_table(table.read_text())
        elif "--json" in arguments:
            answer["numbers"] = dict(leaves(json.loads(done.stdout)))
        else:
            answer["table"] = answer_of_table(done.stdout)
    except (ValueError, KeyError, IndexError):
        answer["fault"] = (done.stderr.strip().splitlines() or ["no answer"])[-1][:200]
    return name, answer


def answers_of(program, cases, folder):
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        return dict(pool.map(lambda case: run(program, *case, folder), cases.items()))


def half_width(interval):
    if not interval or None in interval:
        return None
    return (interval[1] - interval[0]) / 2


def moved(before, after):
    """How far a number moved, relative to its size."""
    if before is None or after is None or before == after:
        return 0.0 if before == after else math.inf
    return abs(after - before) / max(abs(before), abs(after))


def compare(before, after):
    """Returns the class of a change, its size, and what it is."""
    for key in ("exit", "converged", "initial_state", "verdict", "use", "fault"):
        if before.get(key) != after.get(key):
            return "changed", math.inf, f"{key} {before.get(key)} -> {after.get(key)}"
    size, worst = 0.0, ""
    inexact = 0.0

    def note(amount, what):
        nonlocal size, worst
        if amount > size:
            size, worst = amount, what

    for name, old in (before.get("parameters") or {}).items():
        new = after["parameters"].get(name)
        if new is None or old["identifiability"] != new["identifiability"] or old["status"] != new["status"]:
            return "changed", math.inf, f"{name} {old['identifiability']} -> {new and new['identifiability']}"
        inexact = max(inexact, moved(old["value"], new["value"]))
        width = half_width(old["ci95"])
        for end in (0, 1):
            ends = [(entry["ci95"] or [None, None])[end] for entry in (old, new)]
            inexact = max(inexact, moved(*ends))
            if (ends[0] is None) != (ends[1] is None):
                note(math.inf, f"{name} {ends[0]} -> {ends[1]}")
            elif ends[0] is not None:
                scale = width or abs(ends[0])
                note(abs(ends[1] - ends[0]) / scale if scale else 0.0, f"{name} {ends[0]:.6g} -> {ends[1]:.6g}")
        if width:
            note(abs(new["value"] - old["value"]) / width, f"{name} {old['value']:.6g} -> {new['value']:.6g}")
    for key in ("rms", "half_gap"):
        change = moved(before.get(key), after.get(key)) if key in before else 0.0
        inexact = max(inexact, change)
        note(change, f"{key} {before.get(key)} -> {after.get(key)}")
    for group in ("numbers", "table"):
        old, new = before.get(group) or {}, after.get(group) or {}
        for name in old.keys() & new.keys():
            pairs = zip(old[name], new[name]) if group == "table" else [(old[name], new[name])]
            change = max((moved(*pair) for pair in pairs), default=0.0)
            inexact = max(inexact, change)
            note(change, f"{name} moved by {change:.2g}")
    if inexact <= SAME:
        return "identical", inexact, ""
    return ("equivalent" if size <= EQUIVALENT else "changed"), size, worst


def commit_of():
    return subprocess.run(["git", "-C", str(HOUSE), "rev-parse", "HEAD"], capture_output=True, text=True).stdout.strip()


def make(options):
    folder = frozen_dir()
    inputs = folder / "inputs"
    inputs.mkdir(parents=True, exist_ok=True)
    cases = make_measured(inputs) | make_kinds(inputs, options.writer) | make_loops(inputs, options.program)
    answers = answers_of(options.program, cases, folder)
    with open(folder / "answers.jsonl", "w") as file:
        for name, arguments in cases.items():
            file.write(json.dumps({"name": name, "arguments": arguments, "answer": answers[name]}) + "\n")
    (folder / "commit").write_text((options.commit or commit_of()) + "\n")
    print(f"{len(cases)} answers of {options.commit or commit_of()} in {folder}")
    return 0


def diff(options):
    folder = frozen_dir()
    if not (folder / "answers.jsonl").is_file():
        sys.exit(f"frozen: there is no baseline in {folder}: make one first, or set MINDAHL_FROZEN_DIR")
    kept = [json.loads(line) for line in open(folder / "answers.jsonl")]
    if options.only:
        kept = [entry for entry in kept if fnmatch.fnmatch(entry["name"], f"*{options.only}*")]
    answers = answers_of(options.program, {entry["name"]: entry["arguments"] for entry in kept}, options.scratch)
    counts, changed = collections.Counter(), []
    for entry in kept:
        verdict, size, what = compare(entry["answer"], answers[entry["name"]])
        counts[verdict] += 1
        if verdict == "changed":
            changed.append((size, entry["name"], what))
    print(f"against {(folder / 'commit').read_text().strip()}: "
          + ", ".join(f"{counts[name]} {name}" for name in ("identical", "equivalent", "changed")))
    for size, name, what in sorted(changed, key=lambda row: -row[0])[:options.most]:
        print(f"  {size:9.3g}  {name}: {what}")
    return 1 if changed else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    for name, function in (("make", make), ("diff", diff)):
        command = commands.add_parser(name)
        command.set_defaults(function=function)
        command.add_argument("--program", required=True)
    commands.choices["make"].add_argument("--writer", required=True)
    commands.choices["make"].add_argument("--commit", help="whose program it is (default: that of this checkout)")
    commands.choices["diff"].add_argument("--only", help="answers whose names match this pattern")
    commands.choices["diff"].add_argument("--most", type=int, default=40, help="changes that are listed")
    commands.choices["diff"].add_argument("--scratch", default="/tmp", help="folder of tables that are compared")
    options = parser.parse_args()
    return options.function(options)


if __name__ == "__main__":
    sys.exit(main())
