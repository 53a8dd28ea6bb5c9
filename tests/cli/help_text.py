#!/usr/bin/env python3
"""Checks the help of mindahl and of each of its commands.

    help_text.py --program build/dev/src/mindahl rules       what follows for every option
    help_text.py --program build/dev/src/mindahl examples    runs the examples of every command

The rules: every option is described; an option that takes a physical quantity states its unit in
brackets; no line is wider than a page; every option that the documentation names exists. The
options are those of `--help-all`.
"""

import argparse
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]

WIDTH = 100
# Lines wider than that which are still to be wrapped: the numbers may only fall.
WIDE_LINES_LEFT = {"fit": 1, "simulate": 1, "tradeoff": 1,
                   "track": 1, "batch": 1}  # those that it shares with fit

# What an option may take without having a unit: names, files and whole numbers.
WITHOUT_UNIT = re.compile(r"^(|COL|DIR|FILE|PATH|PATH REQUIRED|UNIT|FILE \.\.\. REQUIRED|UINT=\d+|TEXT:\{.*)$")
# And these of some commands, each with the reason.
EXEMPT = {
    "--start": ("fit track batch", "in the unit of the parameter, which --fix lists"),
    "--bound": ("fit track batch", "in the unit of the parameter, which --fix lists"),
    "--select": ("fit batch", "of what it selects"),
    "--terms": ("fit track batch", "names"),
    "--threads": ("track batch", "a count"),
    "--steps": ("simulate", "a count"),
    "--cycles": ("plan", "a count"),
    "--want": ("plan", "in the unit of the parameter, or in percent"),
    "--tolerance": ("tradeoff convert", "relative, and says so"),
}

# Options of other programs in the documentation.
OF_OTHERS = {
    "--samples", "--time-window", "--load-window",  # older names of --select, hidden
    "--preset", "--build", "--install", "--target", "--peers", "--prefix", "--cflags", "--libs",
    "--static", "--enable", "--std",
    "--component", "--no-index", "--no-deps", "--no-build-isolation",
    "--details", "--half", "--jobs", "--kind", "--loops", "--problems", "--repeats", "--rounds",
    "--tests", "--write",
    "--add-terms", "--cores", "--profile", "--rerun-incomplete", "--snakefile", "--unlock", "--workflow",
}


COLUMN = 30  # where descriptions begin


def option_of(line):
    """Name, what it takes and the description so far of the option that a line begins, or None."""
    match = re.match(r"  (?:-\w,)?(--[a-z][a-z0-9-]*) ?(.*)", line)
    if not match:
        return None
    name, rest = match.groups()
    # A head that is too long for its column has the description on the next lines.
    related = re.search(r" ?\b(Excludes|Needs):( --[a-z0-9-]+)+", rest)
    if related:
        words = re.sub(r"^( ?(Excludes|Needs):( --[a-z0-9-]+)+)+", "", rest[related.start():])
        return [name, rest[:related.start()].strip(), words.strip()]
    if len(line) > COLUMN and line[COLUMN - 1] == " " != line[COLUMN]:
        return [name, line[:COLUMN].strip().partition(" ")[2], line[COLUMN:]]
    return [name, rest.strip(), ""]


def parse(text):
    """The options, the commands and the examples of a help."""
    options, commands, examples = [], [], []
    title = None
    for line in text[text.index("Usage: "):].splitlines()[1:]:
        heading = re.fullmatch(r"([A-Z][^:]*):", line)
        if heading:
            title = heading.group(1)
        elif line and not line.startswith(" "):
            title = None
        elif title == "Subcommands" and line and line[2] != " ":
            commands.append(line.split()[0])
        elif title == "Examples" and line.startswith("  mindahl"):
            examples.append(line.strip())
        elif title == "Examples" and line:
            examples[-1] = examples[-1].removesuffix("\\") + line.strip()
        elif title not in (None, "Positionals", "Subcommands"):
            option = option_of(line)
            if option:
                options.append(option)
            elif line.startswith(" " * COLUMN) and options:
                options[-1][2] += " " + line.strip()
    return options, commands, examples


def helps(program):
    """The help of mindahl itself and of every command it lists."""
    def run(*words):
        return subprocess.run([program, *words], check=True, capture_output=True, encoding="utf-8").stdout
    own = run("--help")
    return {"mindahl": own, **{command: run(command, "--help-all") for command in parse(own)[1]}}


def check_rules(texts):
    options = {command: parse(text)[0] for command, text in texts.items()}
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
        exempt = [name for name, (commands, _) in EXEMPT.items() if command in commands.split()]
        for name, taken, description in options[command]:
            if not description:
                yield f"{command} {name}: no description"
            elif (not WITHOUT_UNIT.match(taken) and not re.search(r"\[[^\]]+\]", description)
                  and name not in exempt):
                yield f"{command} {name} {taken}: no unit in brackets: {description}"
        for name in set(exempt) - {option for option, _, _ in options[command]}:
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


# Options that name a file to be written.
WRITES = ("-o", "--json", "--plot", "--output", "--csv", "--input-lines")
# Files that examples name, and what makes them.
RECORDS = {
    "loop.csv": "--lambda 1.2 --cycles 2",
    **{f"{load}N.csv": f"--lambda 1.2 --cycles 2 --seed {load}" for load in (20, 50, 120)},
    **{f"run{k}.csv": f"--lambda 1.2 --cycles 2 --seed {k}" for k in (1, 2, 3)},
    **{f"day{k}.csv": f"--lambda 1.2 --cycles 6 --seed {k}" for k in (1, 2)},
}


def check_examples(program, texts):
    """Every command but the program itself has two or three examples, which work."""
    with tempfile.TemporaryDirectory() as scratch:
        def run(words):
            return subprocess.run([program, *words], cwd=scratch, capture_output=True,
                                  encoding="utf-8", check=False)

        for record, options in RECORDS.items():
            load = int(record.removesuffix("N.csv")) if record.endswith("N.csv") else 50
            law = f"--sigma {8e5 * load} --slip-force {0.8 * load}"
            done = run(shlex.split(f"simulate {law} {options} --noise-force 0.1 -o {record}"))
            if done.returncode != 0:
                yield f"{record}: {done.stderr}"
        path = pathlib.Path(scratch, "path.csv")
        path.write_text("displacement\n" + "".join(f"{x}\n" for x in (0, 0.5, 1, 0.5, -0.5, -1, 0, 1)))
        number = 0
        for command, text in texts.items():
            examples = parse(text)[2]
            if command != "mindahl" and len(examples) not in (2, 3):
                yield f"{command}: {len(examples)} examples"
            for example in examples:
                words = shlex.split(example)
                if words[:2] != ["mindahl", command]:
                    yield f"{command}: an example of another command: {example}"
                    continue
                done = run(words[1:])
                number += 1
                if done.returncode != 0:
                    yield f"{example}\n    exit status {done.returncode}: {done.stderr.strip()}"
                written = [words[k + 1] for k, word in enumerate(words) if word in WRITES]
                for name in written:
                    if not pathlib.Path(scratch, name).stat().st_size:
                        yield f"{example}: nothing in {name}"
        print(f"{number} examples")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["rules", "examples"])
    parser.add_argument("--program", required=True)
    arguments = parser.parse_args()
    program = pathlib.Path(arguments.program).resolve()
    texts = helps(program)
    if arguments.what == "rules":
        problems = list(check_rules(texts))
    else:
        problems = list(check_examples(program, texts))
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
