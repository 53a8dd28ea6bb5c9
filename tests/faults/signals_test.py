#!/usr/bin/env python3
"""Ends mindahl by signals at random moments and looks at what is left.

usage: signals_test.py --program PATH [--kills N]

SIGKILL, N times (default 25): the table of `track` holds rows of the undisturbed table and perhaps a
piece of one, and --resume completes it to the same bytes. SIGINT, SIGTERM and SIGHUP: the table holds
whole rows, as many as the message says, and the program ends by the signal. A fit that a signal ends
leaves whole outputs or none.
"""
import argparse
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CONTACT = ["--sigma", "5e7", "--slip-force", "60", "--amplitude", "2.5e-6", "--noise-force", "0.5"]
CYCLES = 1500
PIECE = 1 << 20  # bytes that are read at once
STOPPED = re.compile(r"mindahl track: stopped by a signal; (\d+) rows are kept in table.csv: add --resume")


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

    def start(self, words=None, **options):
        resume = ["--resume"] if self.table.exists() else []
        return subprocess.Popen([*(words or self.track), *resume], cwd=self.folder,
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, **options)

    def end_at_random(self, process, number):
        try:
            process.wait(self.random.uniform(0, self.seconds))
        except subprocess.TimeoutExpired:
            process.send_signal(number)
        _, errors = process.communicate(timeout=60)
        assert process.returncode in (0, -number), (process.returncode, errors)
        return process.returncode != 0, errors.decode()

    def check_table(self, may_be_cut):
        content = self.table.read_bytes() if self.table.exists() else b""
        assert self.whole.startswith(content), "the table does not begin as the undisturbed one"
        assert may_be_cut or not content or content.endswith(b"\n"), "the table ends within a row"
        return max(0, content.count(b"\n") - 1)

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
            was_ended, _ = self.end_at_random(self.start(), signal.SIGKILL)
            ended += was_ended
            self.check_table(may_be_cut=True)
            if tries % 2 == 0 or not was_ended:
                self.complete()
        return ended

    def stop(self, number, times):
        said = 0
        for _ in range(times):
            was_ended, errors = self.end_at_random(self.start(), number)
            rows = self.check_table(may_be_cut=False)
            found = STOPPED.search(errors)
            if found:
                assert int(found[1]) == rows, (found[0], rows)
                said += 1
            else:  # before the first row, or when all were written
                assert not was_ended or rows in (0, self.whole.count(b"\n") - 1), (errors, rows)
            self.complete()
        return said

    def stop_while_waiting(self):
        """A record that comes through a pipe and does not go on."""
        words = [self.program, "track", "-", "--output", "table.csv", "--threads", "1"]
        process = self.start(words, stdin=subprocess.PIPE)
        record = self.record.read_bytes()
        assert len(record) > PIECE, "the record is too short to be waited for within"
        process.stdin.write(record[:-1])
        process.stdin.flush()
        for _ in range(600):
            if self.table.exists() and self.table.stat().st_size > 0:
                break
            time.sleep(0.05)
        process.send_signal(signal.SIGTERM)
        errors = process.stderr.read().decode()  # stdin stays open
        assert process.wait(60) == -signal.SIGTERM, errors
        process.stdin.close()
        process.stderr.close()
        found = STOPPED.search(errors)
        assert found and int(found[1]) == self.check_table(may_be_cut=False) > 0, errors
        self.table.unlink()

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
            assert number == signal.SIGKILL or not left, left
            for name in left:
                (self.folder / name).unlink()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True)
    parser.add_argument("--kills", type=int, default=25)
    options = parser.parse_args()
    # A test started in the background of a script ignores SIGINT, and so would the program.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    with tempfile.TemporaryDirectory() as scratch:
        tests = Tests(options.program, scratch)
        kills = tests.kill(options.kills)
        said = sum(tests.stop(number, 4) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP))
        assert said > 0, "no run was stopped while it wrote"
        tests.stop_while_waiting()
        tests.stop_fit(5)
    print(f"{kills} runs killed, {said} of 12 stopped while they wrote; each completed to the same bytes")


if __name__ == "__main__":
    sys.exit(main())
