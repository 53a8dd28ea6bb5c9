#!/usr/bin/env python3
"""Checks the help of mindahl and of each of its commands.

    help_text.py --program build/dev/src/mindahl text             compares it with tests/cli/help/*.txt
    help_text.py --program build/dev/src/mindahl --update text    rewrites these files: read the diff
    help_text.py --program build/dev/src/mindahl rules            what no update of files can satisfy

The rules: every option is described; an option that takes a physical quantity states its unit in
brackets; no line is wider than a page; every option that the documentation names exists.
"""

import argparse
import difflib
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
KEPT = pathlib.Path(__file__).resolve().parent / "help"

WIDTH = 100
# Lines wider than that which are still to be wrapped: the numbers may only fall.
WIDE_LINES_LEFT = {"mindahl": 12, "fit": 13, "simulate": 6, "contact": 2, "tradeoff": 3,
                   "recommend": 3, "plan": 2,
                   "track": 10, "batch": 13}  # those that it shares with fit

# What an option may take without having a unit: names, files and whole numbers.
WITHOUT_UNIT = re.compile(r"^(|COL|DIR|FILE|PATH|PATH REQUIRED|UNIT|FILE \.\.\. REQUIRED|UINT=\d+|TEXT:\{.*)$")
# And these, each with the reason.
EXEMPT = {
    ("fit", "--start"): "in the unit of the parameter, which --fix lists",
    ("fit", "--bound"): "likewise",
    ("fit", "--cycles"): "counts",
    ("fit", "--samples"): "counts",
    ("simulate", "--steps"): "a count",
    ("recommend", "--tolerance"): "relative, and says so",
    ("plan", "--cycles"): "a count",
    ("track", "--threads"): "a count",
    ("batch", "--threads"): "a count",
    ("batch", "--start"): "in the unit of the parameter, which --fix lists",
    ("batch", "--bound"): "likewise",
    ("batch", "--cycles"): "counts",
    ("batch", "--samples"): "counts",
    ("track", "--start"): "in the unit of the parameter, which --fix lists",
    ("track", "--bound"): "likewise",
    ("plan", "--with"): "names",
    ("plan", "--want"): "in the unit of the parameter, or in percent",
    ("convert", "--tolerance"): "relative, and says so",
    ("convert", "--beta"): "a share, and says so",
}

# Options of other programs in the documentation.
OF_OTHERS = {
    "--preset", "--build", "--install", "--target", "--peers",
    "--details", "--half", "--jobs", "--kind", "--loops", "--repeats", "--rounds", "--write",
    "--cores", "--profile", "--rerun-incomplete", "--snakefile", "--unlock", "--workflow",
}


def help_of(program, command):
    words = [program, "--help"] if command == "mindahl" else [program, command, "--help"]
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def helps(program):
    """The help of mindahl itself and of every command it lists."""
    listed = help_of(program, "mindahl").split("Subcommands:")[1]
    commands = re.findall(r"^  ([a-z]+) ", listed, re.MULTILINE)
    return {command: help_of(program, command) for command in ["mindahl", *commands]}


def options_of(text):
    """(name, what it takes, description) of every option of a help text.

    A description begins at one column, on the option's line or where that is long on the next."""
    found = []
    lines = text.splitlines()
    for i, line in enumerate(lines):
        match = re.match(r"  (?:-\w,)?(--[a-z][a-z0-9-]*) ?(.*)", line)
        if not match:
            continue
        name, rest = match.groups()
        if len(line) > 30 and line[29] == " " and line[30] != " ":
            taken, description = line[:30].strip().partition(" ")[2], [line[30:]]
        else:
            taken, description = rest, []
        taken = re.sub(r" ?(Excludes|Needs):.*", "", taken).strip()
        for more in lines[i + 1:]:
            if not more.startswith(" " * 30):
                break
            description.append(more.strip())
        found.append((name, taken, " ".join(description)))
    return found


def check_text(texts, update):
    problems = []
    if update:
        KEPT.mkdir(exist_ok=True)
    for path in KEPT.glob("*.txt"):
        if path.stem not in texts:
            if update:
                path.unlink()
            else:
                problems.append(f"{path.name}: there is no such command")
    for command, text in texts.items():
        path = KEPT / f"{command}.txt"
        if update:
            path.write_text(text)
            continue
        kept = path.read_text() if path.exists() else ""
        if kept != text:
            problems += difflib.unified_diff(kept.splitlines(), text.splitlines(),
                                             f"tests/cli/help/{path.name}", "printed", lineterm="")
    if problems:
        problems.append("if that is meant: tests/cli/help_text.py --program PROGRAM --update text")
    return problems


def check_rules(texts):
    options = {command: options_of(text) for command, text in texts.items()}
    for command, text in texts.items():
        wide = [line for line in text.splitlines() if len(line) > WIDTH]
        left = WIDE_LINES_LEFT.get(command, 0)
        if len(wide) > left:
            yield f"{command}: {len(wide)} lines are wider than {WIDTH} columns, {left} were:"
            yield from wide
        elif len(wide) < left:
            print(f"{command}: only {len(wide)} lines are wide now: lower WIDE_LINES_LEFT")
        if not options[command]:
            yield f"{command}: no options found: has the form of the help changed?"
        for name, taken, description in options[command]:
            if not description:
                yield f"{command} {name}: no description"
            elif (not WITHOUT_UNIT.match(taken) and not re.search(r"\[[^\]]+\]", description)
                  and (command, name) not in EXEMPT):
                yield f"{command} {name} {taken}: no unit in brackets: {description}"
    for command, name in EXEMPT:
        if name not in [option for option, _, _ in options.get(command, [])]:
            yield f"{command} {name}: exempt, but there is no such option"

    known = {name for listed in options.values() for name, _, _ in listed} | OF_OTHERS
    named = 0
    for path in [ROOT / "README.md", *sorted(ROOT.glob("docs/*.md")), ROOT / "data/README.md"]:
        for number, line in enumerate(path.read_text().splitlines(), 1):
            for name in re.findall(r"(?<![\w-])--[a-z][a-z0-9-]*", line):
                named += 1
                if name not in known:
                    yield f"{path.relative_to(ROOT)}:{number}: there is no option {name}"
    print(f"{sum(map(len, options.values()))} options of {len(texts)} helps, {named} in the pages")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["text", "rules"])
    parser.add_argument("--program", required=True)
    parser.add_argument("--update", action="store_true")
    arguments = parser.parse_args()
    texts = helps(arguments.program)
    problems = (check_text(texts, arguments.update) if arguments.what == "text"
                else list(check_rules(texts)))
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
