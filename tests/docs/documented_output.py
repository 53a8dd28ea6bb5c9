#!/usr/bin/env python3
"""Runs the commands that pages of the documentation show and compares what they print with the page.

    documented_output.py --program build/dev/src/mindahl README.md docs/measured.md
    documented_output.py --program build/dev/src/mindahl --update README.md     rewrites the page
    documented_output.py --program build/dev/src/mindahl --slow …               likewise, what takes long

A command is a line of an indented block that begins with `mindahl `, backslashes continuing it. What
is indented after it, in the same block or in the next one of the section, is its output:

- lines are found in order in what the program prints (messages before results); a page may leave
  lines out, and wrap one line into several;
- text agrees but for the width of blanks, and numbers to the digits shown: rounded where more are
  printed, else within one of the last, which another processor may round differently.

Comments above a block say what is special, and hold for that block alone:

    <!-- docs test: slow -->             only checked with --slow
    <!-- docs test: skip REASON -->      neither run nor checked
    <!-- docs test: ignore REGEX -->     matches are dropped on both sides, and lines left empty

Commands run in a copy of data/, so that `-o data/…` can be compared with the file that is there.
Records in ../shared/measured are those of MINDAHL_MEASURED_DIR where that is set; commands that name
an absent one are skipped, and said.
"""

import argparse
import dataclasses
import difflib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[2]
INDENT = "    "
DIRECTIVE = re.compile(r"<!-- docs test: (slow|skip|ignore)(?: (.*?))? -->")
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w])", re.IGNORECASE)
LONGEST_WRAP = 8  # lines of a page that may be one line of output
FINE = (0, 3)     # exit status: done; ran, but not established
WIDTH = 116       # of a wrapped line in a page


@dataclasses.dataclass
class Block:
    """A command, and where its page shows the output: lines [begin, end)."""
    line: int
    command: str
    directives: list
    begin: int = 0
    end: int = 0

    def has(self, name):
        return any(directive == name for directive, _ in self.directives)

    def ignored(self):
        return [re.compile(text) for directive, text in self.directives if directive == "ignore"]


def blocks_of(lines):
    """Commands of a page with their output, in order."""
    found = []
    directives = []
    open_block = None  # a command whose output is yet to come
    fenced = False
    i = 0
    while i < len(lines):
        line = lines[i]
        if line.startswith("```"):
            fenced = not fenced
        if fenced or not line.startswith(INDENT):
            if line.startswith("#"):
                open_block, directives = None, []
            directives += DIRECTIVE.findall(line)
            i += 1
            continue
        if line.startswith(INDENT + "mindahl "):
            first = i
            words = lines[i].strip()
            while words.endswith("\\"):
                i += 1
                words = words[:-1] + " " + lines[i].strip()
            i += 1
            # `mindahl fit: warning: …` is a message, not a command.
            if re.match(r"mindahl [a-z]+:", words):
                i = first
            else:
                open_block = Block(first, re.sub(r"\s+#\s.*", "", words), directives, i, i)
                found.append(open_block)
                directives = []
                while i < len(lines) and not lines[i].strip():
                    i += 1
                if i == len(lines) or not lines[i].startswith(INDENT) or is_command(lines[i]):
                    continue
        begin = i
        end = i
        while i < len(lines) and (lines[i].startswith(INDENT) or not lines[i].strip()):
            if is_command(lines[i]):
                break
            i += 1
            if lines[i - 1].strip():
                end = i
        if open_block is not None:
            open_block.begin, open_block.end = begin, end
            open_block.directives += directives
        open_block, directives = None, []
    return found


def is_command(line):
    return line.startswith(INDENT + "mindahl ") and not re.match(r" {4}mindahl [a-z]+:", line)


def normalised(line, ignored=()):
    for pattern in ignored:
        line = pattern.sub("", line)
    return " ".join(line.split())


def skeleton(line):
    """The text without its numbers. A minus before a number is a number's."""
    return NUMBER.sub("#", line)


def place_of_last_digit(number):
    mantissa, _, exponent = number.lower().partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def agree(shown, printed):
    """Whether two normalised lines say the same to the digits shown."""
    if skeleton(shown) != skeleton(printed):
        return False
    for mine, its in zip(NUMBER.findall(shown), NUMBER.findall(printed)):
        tolerance = 0.0
        if "." in mine or "e" in mine.lower():
            digit = place_of_last_digit(mine)
            tolerance = 1.001 * (digit if place_of_last_digit(its) >= digit else digit / 2)
        if abs(float(mine) - float(its)) > tolerance:
            return False
    return True


class Output:
    """What a command printed, messages first."""

    def __init__(self, done, ignored):
        self.raw = [line.rstrip() for line in (done.stderr + done.stdout).splitlines()]
        self.lines = [normalised(line, ignored) for line in self.raw]


def find(shown, printed):
    """For each shown line the index of the printed one; None where there is no such line."""
    place = 0
    matches = []
    i = 0
    while i < len(shown):
        if not shown[i]:
            matches.append(None)
            i += 1
            continue
        for count in range(1, min(LONGEST_WRAP, len(shown) - i) + 1):
            text = " ".join(shown[i:i + count])
            index = next((k for k in range(place, len(printed)) if agree(text, printed[k])), None)
            if index is not None:
                matches += [index] * count
                place = index + 1
                i += count
                break
        else:
            matches.append(-1)
            i += 1
    return matches


def nearest(shown, printed):
    close = difflib.get_close_matches(shown, [line for line in printed if line], 1, 0.3)
    return close[0] if close else "(nothing like it)"


def check(block, lines, output):
    """What is wrong, one message a shown line."""
    ignored = block.ignored()
    shown = [normalised(line, ignored) for line in lines[block.begin:block.end]]
    matches = find(shown, output.lines)
    problems = []
    for i, match in enumerate(matches):
        if match == -1:
            problems.append(f"line {block.begin + i + 1} is not printed, or not here:\n"
                            f"      shown    {shown[i]}\n"
                            f"      nearest  {nearest(shown[i], output.lines)}")
    return problems


def updated(block, lines, output):
    """The shown output as it is printed now, and what could not be found again."""
    ignored = block.ignored()
    shown = [normalised(line, ignored) for line in lines[block.begin:block.end]]
    matches = find(shown, output.lines)
    result, lost = [], []
    place = 0      # of the first printed line that is yet to be shown
    put = ""       # the line put in place of the one before: a page may have wrapped what it was
    for i, match in enumerate(matches):
        if match != -1:
            place, put = place if match is None else match + 1, ""
            result.append(lines[block.begin + i])
            continue
        if put and skeleton(shown[i]) in skeleton(put):
            continue
        end = next((k for k in matches[i:] if k not in (None, -1)), len(output.lines))
        put = next(iter(difflib.get_close_matches(shown[i], output.lines[place:end], 1, 0.5)), "")
        if put:
            place = output.lines.index(put, place) + 1
            fresh = (INDENT + output.raw[place - 1]).rstrip()
            result += [fresh] if len(fresh) <= WIDTH else textwrap.wrap(
                fresh.strip(), WIDTH, initial_indent=INDENT, subsequent_indent=INDENT,
                break_on_hyphens=False)
        else:
            result.append(lines[block.begin + i])
            lost.append((block.begin + i, shown[i]))
    return result, lost


def same_file(made, kept):
    """Whether a command made the file that the project has, but for rounding."""
    mine, its = made.read_text().splitlines(), kept.read_text().splitlines()
    if len(mine) != len(its) or mine[0] != its[0]:
        return False
    largest = [max(abs(float(row.split(",")[i])) for row in its[1:])
               for i in range(len(its[0].split(",")))]
    return all(abs(float(a) - float(b)) <= 1e-12 * scale
               for left, right in zip(mine[1:], its[1:])
               for a, b, scale in zip(left.split(","), right.split(","), largest))


class Workshop:
    """A scratch copy of what commands may name: data/ and ../shared/measured."""

    def __init__(self, program):
        self.program = pathlib.Path(program).resolve()
        self.measured = pathlib.Path(os.environ.get("MINDAHL_MEASURED_DIR",
                                                    ROOT / "../shared/measured")).resolve()
        self.scratch = tempfile.TemporaryDirectory()
        self.directory = pathlib.Path(self.scratch.name) / "mindahl"
        shutil.copytree(ROOT / "data", self.directory / "data")
        if self.measured.is_dir():
            (self.directory.parent / "shared").mkdir()
            (self.directory.parent / "shared/measured").symlink_to(self.measured)

    def absent(self, words):
        return [word for word in words
                if word.startswith("../shared/") and not (self.directory / word).exists()]

    def run(self, words):
        return subprocess.run([self.program, *words[1:]], cwd=self.directory, text=True,
                              capture_output=True, check=False)

    def compare_written(self, words):
        """Problems with a file of data/ that the command has written."""
        for option, path in zip(words, words[1:]):
            if option in ("-o", "--output") and path.startswith("data/"):
                if not same_file(self.directory / path, ROOT / path):
                    yield f"writes another {path} than the project has"


def run_page(page, arguments, workshop):
    """Prints what is wrong; returns (checked, skipped, failed) blocks."""
    path = ROOT / page
    lines = path.read_text().splitlines()
    counts = {"checked": 0, "skipped": 0, "failed": 0}
    replacements = []
    for block in blocks_of(lines):
        place = f"{page}:{block.line + 1}"
        if block.has("slow") != arguments.slow:
            continue
        words = shlex.split(block.command)
        reason = next((text for directive, text in block.directives if directive == "skip"), None)
        if reason is None and workshop.absent(words):
            reason = f"there is no {workshop.absent(words)[0]} (set MINDAHL_MEASURED_DIR)"
        if reason is not None:
            print(f"{place}: skipped: {reason}")
            counts["skipped"] += 1
            continue
        done = workshop.run(words)
        output = Output(done, block.ignored())
        problems = check(block, lines, output)
        if done.returncode not in FINE:
            problems.append(f"exit status {done.returncode}: {done.stderr.strip()}")
        elif arguments.update and problems:
            fresh, lost = updated(block, lines, output)
            replacements.append((block.begin, block.end, fresh))
            problems = [f"line {line + 1} has no successor, mend by hand: {text}"
                        for line, text in lost]
            print(f"{place}: output rewritten")
        problems += workshop.compare_written(words)
        if problems:
            print(f"{place}: {block.command}")
            for problem in problems:
                print(f"    {problem}")
            counts["failed"] += 1
        counts["checked"] += 1
    for begin, end, fresh in reversed(replacements):
        lines[begin:end] = fresh
    if replacements:
        path.write_text("\n".join(lines) + "\n")
    return counts


def pages_with_commands():
    for path in sorted([ROOT / "README.md", *ROOT.glob("docs/*.md"), *ROOT.glob("data/*.md")]):
        if blocks_of(path.read_text().splitlines()):
            yield str(path.relative_to(ROOT))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pages", nargs="*", help="from the project's root; none: all with commands")
    parser.add_argument("--program", help="the mindahl to run")
    parser.add_argument("--slow", action="store_true", help="check the slow blocks only")
    parser.add_argument("--update", action="store_true", help="rewrite the output shown")
    parser.add_argument("--only-these", action="store_true",
                        help="run nothing; fail where another page has commands")
    arguments = parser.parse_args()

    if arguments.only_these:
        forgotten = sorted(set(pages_with_commands()) ^ set(arguments.pages))
        for page in forgotten:
            print(f"{page}: has commands and no test, or a test and no commands")
        return 1 if forgotten else 0
    if not arguments.program:
        parser.error("--program missing")

    workshop = Workshop(arguments.program)
    failed = False
    for page in arguments.pages or pages_with_commands():
        counts = run_page(page, arguments, workshop)
        print(f"{page}: {counts['checked']} blocks checked, {counts['failed']} of them failed, "
              f"{counts['skipped']} skipped")
        if counts["checked"] + counts["skipped"] == 0 and page in arguments.pages:
            print(f"{page}: nothing to check: the page has lost its commands")
            failed = True
        failed |= counts["failed"] > 0
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
