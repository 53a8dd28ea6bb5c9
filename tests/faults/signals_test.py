#!/usr/bin/env python3
"""Ends mindahl by signals at random moments and looks at what is left.

usage: signals_test.py --program PATH [--kills N]

SIGKILL, SIGINT, SIGTERM and SIGHUP in turn, N times (default 25): the table of `track` holds rows of the
undisturbed table and perhaps a piece of one, and --resume completes it to the same bytes. A fit that a
signal ends leaves whole outputs or none.
"""
import argparse
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CONTACT = ["--sigma", "5e7", "--slip-force", "60", "--amplitude", "2.5e-6", "--noise-force", "0.5"]
CYCLES = 1500
SIGNALS = (signal.SIGKILL, signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Tests:
    def __init__(self, program, scratch):
        self.program = Path(program).resolve()
        self.folder = Path(scratch)
        self.random = random.Random(20)
        self.record = self.folder / "long.csv"
        subprocess.run([self.program, "simulate", *CONTACT, "--cycles", str(CYCLES),
                        "--samples-per-cycle", "24", "-o", self.record], check=True)
        self.track = [self.program, "track", self.record, "--output", "table.csv", "--threads", "2"]
        self.table = self.folder / "table.csv"
        begin = time.monotonic()
        subprocess.run(self.track, cwd=self.folder, check=True, stdout=subprocess.DEVNULL)
        self.seconds = time.monotonic() - begin
        self.whole = self.table.read_bytes()
        self.table.unlink()

    def start(self):
        resume = ["--resume"] if self.table.exists() else []
        return subprocess.Popen([*self.track, *resume], cwd=self.folder,
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)

    def end_at_random(self, process, number):
        try:
            process.wait(self.random.uniform(0, self.seconds))
        except subprocess.TimeoutExpired:
            process.send_signal(number)
        _, errors = process.communicate(timeout=60)
        assert process.returncode in (0, -number), (process.returncode, errors)
        return process.returncode != 0

    def check_table(self):
        content = self.table.read_bytes() if self.table.exists() else b""
        assert self.whole.startswith(content), "the table does not begin as the undisturbed one"

    def complete(self):
        process = self.start()
        _, errors = process.communicate(timeout=60)
        assert process.returncode == 0, errors
        assert self.table.read_bytes() == self.whole, "--resume makes another table"
        assert sorted(path.name for path in self.folder.iterdir()) == ["long.csv", "table.csv"]
        self.table.unlink()

    def kill(self, kills):
        """Every second one ends a run that goes on with what the one before left."""
        ended = 0
        tries = 0
        while ended < kills:
            tries += 1
            assert tries < 10 * kills, "the runs end before they are killed"
            was_ended = self.end_at_random(self.start(), SIGNALS[tries % len(SIGNALS)])
            ended += was_ended
            self.check_table()
            if tries % 2 == 0 or not was_ended:
                self.complete()
        if self.table.exists():
            self.complete()
        return ended

    def stop_fit(self, times):
        small = self.folder / "small.csv"
        subprocess.run([self.program, "simulate", *CONTACT, "--cycles", "3", "-o", small], check=True)
        words = [self.program, "fit", "small.csv", "--json", "out.json", "--report", "out.html"]
        outputs = [self.folder / "out.json", self.folder / "out.html"]
        begin = time.monotonic()
        subprocess.run(words, cwd=self.folder, check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
        self.seconds = time.monotonic() - begin
        whole = [output.read_bytes() for output in outputs]
        for number in [signal.SIGINT, signal.SIGTERM, signal.SIGKILL] * times:
            for output in outputs:
                output.unlink(missing_ok=True)
            process = subprocess.Popen(words, cwd=self.folder, stdout=subprocess.DEVNULL,
                                       stderr=subprocess.PIPE)
            self.end_at_random(process, number)
            for output, content in zip(outputs, whole):
                assert not output.exists() or output.read_bytes() == content, output
            left = {path.name for path in self.folder.iterdir()} - {"long.csv", "small.csv",
                                                                    "out.json", "out.html"}
            assert all(name.startswith(".") for name in left), left
            for name in left:
                (self.folder / name).unlink()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True)
    parser.add_argument("--kills", type=int, default=25)
    options = parser.parse_args()
    # A test started in the background of a script ignores SIGINT, and so would the program.
    for number in SIGNALS[1:]:
        signal.signal(number, signal.SIG_DFL)
    with tempfile.TemporaryDirectory() as scratch:
        tests = Tests(options.program, scratch)
        kills = tests.kill(options.kills)
        tests.stop_fit(5)
    print(f"{kills} runs ended by a signal; each completed to the same bytes")


if __name__ == "__main__":
    sys.exit(main())
