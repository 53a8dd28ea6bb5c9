#!/usr/bin/env python3
"""Makes each call of the C library fail in turn while mindahl runs, and looks at what is left.

usage: fault_test.py --program PATH --library PATH [--most N] [--only COMMAND]

Every command is run once undisturbed, which also counts its calls, and then with the n-th call of
each kind failing: once, from then on, or (write) half done. N is how many places are tried of a
call that is made more often, spread over all of them (default 6).

What must hold whatever fails:
  - the program ends by itself with a documented status, and with 0 only where every output is whole;
    where memory runs out it may seldom be SIGABRT: Eigen 3.4 frees a matrix before it allocates the
    larger one and keeps the pointer, which is freed again where that fails
  - an output is, under its name, what the undisturbed run wrote, what was there before, or absent
  - nothing else is left behind
  - a run that fails says so in its last line: "mindahl COMMAND: ..."
  - the table of `track` holds whole rows of the undisturbed table, and --resume completes it
"""
import argparse
import csv
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

OLD = b"what was there before\n"
CONTACT = ["--sigma", "5e7", "--slip-force", "60", "--amplitude", "2.5e-6", "--noise-force", "0.5"]


class Command(NamedTuple):
    """A command of which `whole` outputs appear whole or not at all, and `table` grows by rows.

    Of `parts` files one may fail and the others go on: status 3, and what is written says so.
    """
    name: str
    words: list
    whole: list
    table: str | None = None
    parts: int = 0


COMMANDS = [
    Command("simulate", ["simulate", *CONTACT, "--cycles", "2", "-o", "out.csv"], ["out.csv"]),
    Command("fit", ["fit", "a.csv", "--json", "out.json", "--residuals", "out.csv", "--report",
                    "out.html"], ["out.json", "out.csv", "out.html"]),
    Command("plot", ["fit", "a.csv", "--plot", "out.png"], ["out.png"]),
    Command("batch", ["batch", "a.csv", "b.csv", "--output", "out.csv", "--json", "out.json",
                      "--report", "pages", "--threads", "2"],
            ["out.csv", "out.json", "pages/page-1.html", "pages/page-2.html", "pages/index.html"], parts=2),
    Command("track", ["track", "long.csv", "a.csv", "--output", "table.csv", "--json", "out.json",
                      "--report", "out.html", "--threads", "2"], ["out.json", "out.html"],
            table="table.csv"),
]
KINDS = {"write": "1+~", "open": "1+", "rename": "1", "fsync": "1+", "truncate": "1", "close": "1",
         "mkdir": "1", "system": "1", "thread": "1+", "malloc": "1+"}


def places(count, most):
    """The first ones and then some that are spread evenly up to the last."""
    if count <= most:
        return range(1, count + 1)
    return sorted({1 + round(k * (count - 1) / (most - 1)) for k in range(most)})


class Harness:
    def __init__(self, program, library, scratch):
        self.program = program
        self.library = library
        self.scratch = Path(scratch)
        self.inputs = {}
        for name, cycles, seed in [("a.csv", 3, 1), ("b.csv", 3, 2), ("long.csv", 150, 3)]:
            path = self.scratch / name
            subprocess.run([program, "simulate", *CONTACT, "--cycles", str(cycles), "--seed", str(seed),
                            "--samples-per-cycle", "24", "-o", path], check=True)
            self.inputs[name] = path.read_bytes()

    def folder(self, command, old):
        """A directory with the inputs and, where `old`, with outputs that were there before."""
        path = Path(tempfile.mkdtemp(dir=self.scratch))
        for name, content in self.inputs.items():
            (path / name).write_bytes(content)
        if old:
            for name in command.whole:
                (path / name).parent.mkdir(exist_ok=True)
                (path / name).write_bytes(OLD)
        (path / "tmp").mkdir()
        return path

    def run(self, command, path, fault=None, extra=(), limit=None, stdout=subprocess.PIPE):
        environment = {**os.environ, "TMPDIR": str(path / "tmp"), "LC_ALL": "C"}
        if limit is None:
            environment["LD_PRELOAD"] = str(self.library)
            environment["MINDAHL_FAULT_COUNTS"] = str(path) + ".counts"
        if fault:
            environment["MINDAHL_FAULT"] = fault

        def set_limit():
            if limit:
                resource.setrlimit(limit[0], (limit[1], limit[1]))

        return subprocess.run([self.program, *command.words, *extra], cwd=path, env=environment,
                              stdout=stdout, stderr=subprocess.PIPE, timeout=120,
                              preexec_fn=set_limit if limit else None)

    def reference(self, command):
        path = self.folder(command, old=False)
        done = self.run(command, path)
        assert done.returncode == 0, done.stderr.decode()
        files = {name: (path / name).read_bytes()
                 for name in [*command.whole, *([command.table] if command.table else [])]}
        counts = dict(line.split() for line in Path(str(path) + ".counts").read_text().splitlines())
        shutil.rmtree(path)
        return done.stdout, files, {name: int(count) for name, count in counts.items()}

    def check(self, command, reference, fault, old, limit=None, stdout=subprocess.PIPE):
        """Runs it with a fault; returns what is wrong with what became of it."""
        stdout_expected, files, _ = reference
        path = self.folder(command, old)
        done = self.run(command, path, fault, limit=limit, stdout=stdout)
        errors = done.stderr.decode(errors="replace")
        wrong = []
        # No fault from outside is an internal error, 1; 3 says that one of several files failed.
        is_abort = done.returncode == -signal.SIGABRT and str(fault).startswith("malloc")
        if done.returncode not in ((0, 2, 3) if command.parts else (0, 2)) and not is_abort:
            wrong.append(f"ended with {done.returncode}")
        known = set(self.inputs) | {"tmp"}
        for name in command.whole:
            known |= {name, name.split("/")[0]}
            content = (path / name).read_bytes() if (path / name).exists() else None
            # Where one of several files fails, the others go on and what is written says so.
            if content == files[name] or done.returncode != 0 and (
                    content is None or content == OLD and old
                    or command.parts and content and self.is_whole(command, name, content)):
                continue
            wrong.append(f"{name} is " + ("absent" if content is None else
                                          f"neither old nor whole, {len(content)} bytes"))
        if command.table:
            known.add(command.table)
            wrong += self.check_table(command, path, files[command.table], done.returncode)
        for found in sorted(path.rglob("*")):
            name = str(found.relative_to(path))
            # Without memory nobody may be left to remove a temporary file.
            is_temporary = found.name.startswith(".") and str(fault).startswith("malloc")
            if name not in known and not is_temporary:
                wrong.append(f"left behind: {name}")
        if done.returncode == 0 and stdout == subprocess.PIPE:
            if done.stdout != stdout_expected:
                wrong.append("says something else on standard output")
        if done.returncode == 2:
            last = errors.rstrip("\n").rsplit("\n", 1)[-1]
            if not last.startswith((f"mindahl {command.words[0]}: ", "mindahl: memory ran out")):
                wrong.append(f"its last line is {last!r}")
        shutil.rmtree(path)
        if not wrong:
            return done.returncode, None
        return done.returncode, (f"{command.name}, {fault or limit or stdout}"
                                 f"{', over old outputs' if old else ''}: "
                                 f"{'; '.join(wrong)} (status {done.returncode}: {errors.strip()})")

    @staticmethod
    def is_whole(command, name, content):
        text = content.decode()
        if name.endswith(".json"):
            document = json.loads(text)
            return len(document["files"]) == command.parts
        if name.endswith(".csv"):
            rows = list(csv.reader(text.splitlines()))
            return len(rows) == 1 + command.parts and len({len(row) for row in rows}) == 1
        return text.rstrip().endswith("</html>")

    def check_table(self, command, path, whole, status):
        table = path / command.table
        content = table.read_bytes() if table.exists() else b""
        if status == 0:
            return [] if content == whole else ["the table is not whole"]
        wrong = []
        if not whole.startswith(content):
            wrong.append("the table does not begin as the undisturbed one")
        if content and not content.endswith(b"\n"):
            wrong.append("the table ends within a row")
        again = self.run(command, path, extra=["--resume"])
        if again.returncode != 0 or table.read_bytes() != whole:
            wrong.append(f"--resume does not complete the table: {again.stderr.decode()}")
        return wrong


def faults_of(command, counts, most):
    for call, ways in KINDS.items():
        for way in ways:
            # Memory is asked for so often that every place is too many.
            for place in places(counts[call], most):
                yield f"{call}:{place}{'' if way == '1' else way}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True)
    parser.add_argument("--library", required=True)
    parser.add_argument("--most", type=int, default=6)
    parser.add_argument("--only")
    options = parser.parse_args()
    findings = []
    runs = 0
    statuses = {}
    with tempfile.TemporaryDirectory() as scratch, ThreadPoolExecutor(os.cpu_count()) as pool:
        harness = Harness(Path(options.program).resolve(), Path(options.library).resolve(), scratch)
        for command in COMMANDS:
            if options.only and command.name != options.only:
                continue
            if command.name == "plot" and shutil.which("rsvg-convert") is None:
                continue
            reference = harness.reference(command)
            tasks = []
            for index, fault in enumerate(faults_of(command, reference[2], options.most)):
                tasks.append((fault, index % 2 == 1, None))
            # Memory and files that a limit of the process ends, as mmap() and write() then say.
            for megabytes in places(options.most * 4, options.most):
                tasks.append((None, False, (resource.RLIMIT_AS, (60 + 10 * megabytes) << 20)))
            for size in (0, 1, 1000, 5000):
                tasks.append((None, True, (resource.RLIMIT_FSIZE, size)))
            results = list(pool.map(
                lambda task: harness.check(command, reference, task[0], task[1], task[2]), tasks))
            with open("/dev/full", "w") as full:
                results.append(harness.check(command, reference, None, False, None, full))
            if command.name != "simulate" and results[-1][0] == 0:
                findings.append(f"{command.name}: status 0 though standard output is full")
            runs += len(results)
            for status, finding in results:
                statuses[status] = statuses.get(status, 0) + 1
                if finding:
                    findings.append(finding)
            # A write, a rename and a synchronisation that fail once are never without consequence.
            for (fault, _, _), (status, _) in zip(tasks, results):
                if fault and fault.startswith(("write", "rename", "fsync", "truncate")) and status == 0:
                    findings.append(f"{command.name}, {fault}: status 0")
    aborted = statuses.get(-signal.SIGABRT, 0)
    if aborted > 0.02 * runs:
        findings.append(f"{aborted} of {runs} runs were aborted")
    for finding in findings:
        print(finding)
    print(f"{runs} runs with a fault, by their status {dict(sorted(statuses.items()))}, "
          f"{len(findings)} findings")
    return 1 if findings or runs < 10 else 0


if __name__ == "__main__":
    sys.exit(main())
