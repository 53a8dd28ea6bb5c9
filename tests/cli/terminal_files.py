#!/usr/bin/env python3
"""Checks the manual page and the completions that the build makes in a folder.

    terminal_files.py --program build/dev/src/mindahl --directory build/dev/terminal manual|bash|zsh

Exits with 77 where the program that would read them is absent.
"""

import argparse
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "cmake"))

import command_help  # noqa: E402

SKIPPED = 77

# What is typed, the last word being completed, and what is offered: all of it, or where it ends
# with "…" at least that.
COMPLETIONS = [
    ("mindahl ", "fit simulate validate contact convert tradeoff recommend plan track batch"),
    ("mindahl con", "contact convert"),
    ("mindahl --v", "--version"),
    ("mindahl fit --displacement-", "--displacement-noise"),
    ("mindahl fit --model ", "mindlin-dahl mindlin jenkins dahl auto"),
    ("mindahl fit --model mind", "mindlin-dahl mindlin"),
    ("mindahl fit --model = mind", "mindlin-dahl mindlin"),
    ("mindahl fit --model = ", "mindlin-dahl mindlin jenkins dahl auto"),
    ("mindahl fit loop.csv --loss t", "tukey"),
    ("mindahl --config my.toml fit --lo", "--load-window --loss"),
    ("mindahl fit --confid", "--confidence"),
    ("mindahl simulate --waveform ne", "nested"),
    ("mindahl simulate --out", "--output"),
    ("mindahl convert --to b", "bouc-wen"),
    ("mindahl fit lo", "loop.csv"),
    ("mindahl fit --json o", "of two words.json"),
    ("mindahl batch ", "loop.csv …"),
    ("mindahl fit --config my", "my.toml"),
    ("mindahl fit --force-noise ", ""),
    ("mindahl contact ", ""),
    ("mindahl nonsense --m", ""),
]


def check_bash(helps, directory):
    if not shutil.which("bash"):
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory() as scratch:
        for name in ("loop.csv", "my.toml", "of two words.json"):
            pathlib.Path(scratch, name).touch()
        lines = [f"source {shlex.quote(str(directory / 'mindahl.bash'))}"]
        for typed, _ in COMPLETIONS:
            words = typed.split(" ")
            lines += [f"COMP_WORDS=({' '.join(map(shlex.quote, words))})",
                      f"COMP_CWORD={len(words) - 1}", "_mindahl",
                      "printf '%s\\n' \"${COMPREPLY[@]}\"", "echo ----"]
        lines.append("complete -p mindahl")
        done = subprocess.run(["bash", "--norc", "-u", "-c", "\n".join(lines)], cwd=scratch,
                              capture_output=True, encoding="utf-8", check=False)
    if done.stderr:
        yield f"bash: {done.stderr.strip()}"
    *offers, registered = done.stdout.split("----\n")
    if registered.strip() != "complete -F _mindahl mindahl":
        yield f"bash has registered: {registered.strip()}"
    for (typed, expected), offered in zip(COMPLETIONS, offers, strict=True):
        offered = [line for line in offered.splitlines() if line]
        if expected.endswith("…"):
            missing = set(expected.split()[:-1]) - set(offered)
            if missing:
                yield f"'{typed}' does not offer {missing}: {offered}"
        elif " ".join(sorted(offered)) != " ".join(sorted(expected.split())) \
                and offered != [expected]:
            yield f"'{typed}' offers {offered}, not {expected}"
    print(f"{len(COMPLETIONS)} completions")


def check_zsh(helps, directory):
    path = directory / "_mindahl"
    text = path.read_text(encoding="utf-8")
    if not text.startswith("#compdef mindahl\n"):
        yield f"{path}: compinit does not find it"
    cases = dict(re.findall(r"^    ([a-z]+)\)\n      _arguments (.*?) ;;$", text,
                            re.MULTILINE | re.DOTALL))
    for found in helps[1:]:
        names = re.findall(r"'\*?(-[\w-]+)\[", cases.get(found.command, ""))
        missing = {option.name for option in found.options} - set(names)
        if missing:
            yield f"zsh: {found.command} lacks {missing}"
        if "--config" not in names:
            yield f"zsh: {found.command} lacks --config"
    if not shutil.which("zsh"):
        print("there is no zsh to read it")
        return
    done = subprocess.run(["zsh", "-n", path], capture_output=True, encoding="utf-8", check=False)
    if done.returncode != 0 or done.stderr:
        yield f"zsh: {done.stderr.strip()}"


def check_manual(helps, directory):
    if not shutil.which("man") or not shutil.which("groff"):
        sys.exit(SKIPPED)
    page = directory / "mindahl.1.gz"

    def run(*words, width):
        done = subprocess.run(
            ["man", *words, "-l", page], capture_output=True, encoding="utf-8", check=False,
            env={**os.environ, "LC_ALL": "C.UTF-8", "MANWIDTH": width, "MANPAGER": "cat",
                 "MAN_KEEP_FORMATTING": ""})
        return done.stdout, done.stderr.strip()

    for width in ("80", "120"):
        _, messages = run("--warnings", "-E", "UTF-8", "-Tutf8", "-Z", width=width)
        if messages:
            yield f"at {width} columns: {messages}"
    text, _ = run("-E", "UTF-8", width="200")
    text = re.sub(r".\x08|\x1b\[[0-9;]*m", "", text).replace("‐", "-")
    sections = re.split(r"^(?=[A-Z])", text, flags=re.MULTILINE)
    for found in helps[1:]:
        section = next((part for part in sections
                        if part.startswith(f"MINDAHL {found.command.upper()}\n")), "")
        listed = set(re.findall(r"^ +(?:-\w, )?(--[a-z][\w-]*)", section, re.MULTILINE))
        missing = {option.name for option in found.options} - {"--help"} - listed
        if missing:
            yield f"MINDAHL {found.command.upper()} lacks {missing}"
        words = " ".join(section.replace("\\", " ").split())
        for example in found.examples:
            if " ".join(example.split()) not in words:
                yield f"MINDAHL {found.command.upper()} lacks the example: {example}"
    for title in ("NAME", "SYNOPSIS", "DESCRIPTION", "COMMANDS", "EXIT STATUS"):
        if not any(part.startswith(title) for part in sections):
            yield f"there is no {title}"
    print(f"{sum(len(found.options) for found in helps)} options, {len(text.splitlines())} lines")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["manual", "bash", "zsh"])
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--directory", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    helps = command_help.helps_of(arguments.program.resolve())
    check = {"manual": check_manual, "bash": check_bash, "zsh": check_zsh}[arguments.what]
    problems = list(check(helps, arguments.directory.resolve()))
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
