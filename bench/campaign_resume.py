#!/usr/bin/env python3
"""A campaign that is killed and goes on: bytes read a second and core, and nothing lost.

Tests are simulated, then tracked twice by `mindahl track --separate`: once undisturbed, and once in
shards of which every process is killed again and again and started anew with --resume. The tables
must be the same bytes.

    campaign_resume.py --program build/release/src/mindahl --tests 1000 --cycles 1000 --shards 20

is a million cycles over 1000 tests, 100 samples each: 5 GB of records. The default is a fiftieth.
"""
import argparse
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path


def simulate(program, path, cycles, samples, seed):
    subprocess.run([program, "simulate", "--sigma", "5e7", "--slip-force", str(50 + seed % 10),
                    "--amplitude", "2.5e-6", "--cycles", str(cycles + 1), "--samples-per-cycle",
                    str(samples), "--noise-force", "0.3", "--seed", str(seed), "-o", path],
                   check=True)


class Shard:
    """One process of many; killed after a while, and begun again until it is done."""

    def __init__(self, program, tests, number, shards, folder, kills, mean_life, chance):
        self.table = folder / f"shard-{number}.csv"
        self.words = [program, "track", "--separate", "--files-from", tests, "--shard",
                      f"{number}/{shards}", "--output", self.table, "--resume", "--threads", "1"]
        self.kills_left = kills
        self.kills = 0
        self.mean_life = mean_life
        self.chance = chance
        self.begin()

    def begin(self):
        self.process = subprocess.Popen(self.words, stdout=subprocess.DEVNULL)
        self.end = time.monotonic() + self.chance.expovariate(1 / self.mean_life)

    def is_done(self):
        status = self.process.poll()
        if status is None:
            if self.kills_left > 0 and time.monotonic() > self.end:
                self.process.send_signal(signal.SIGKILL)
            return False
        if status == -signal.SIGKILL:
            self.kills += 1
            self.kills_left -= 1
            self.begin()
            return False
        if status != 0:
            sys.exit(f"campaign_resume: {' '.join(map(str, self.words))} ended with {status}")
        return True


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--tests", type=int, default=100)
    parser.add_argument("--cycles", type=int, default=200, help="of each test")
    parser.add_argument("--samples", type=int, default=100, help="of a cycle")
    parser.add_argument("--shards", type=int, default=4)
    parser.add_argument("--kills", type=int, default=5, help="of each shard, at the most")
    parser.add_argument("--life", type=float, default=1.0, help="mean time to a kill [s]")
    parser.add_argument("--at-once", type=int, default=os.cpu_count(), help="processes")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    program = arguments.program.resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for number in range(arguments.tests):
            simulate(program, folder / f"test-{number:05}.csv", arguments.cycles, arguments.samples,
                     number)
        records = sorted(folder.glob("test-*.csv"))
        size = sum(path.stat().st_size for path in records)
        tests = folder / "tests.txt"
        tests.write_text("".join(f"{path}\n" for path in records))

        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([program, "track", "--separate", "--files-from", tests, "--output",
                        folder / "whole.csv", "--threads", "1"], check=True,
                       stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        whole = (folder / "whole.csv").read_bytes()
        rows = whole.count(b"\n") - 1
        print(f"{len(records)} tests, {rows} cycles, {size / 1e6:.0f} MB of records")
        print(f"undisturbed: {seconds:.1f} s of the processor, {size / 1e6 / seconds:.1f} MB/s and "
              f"{rows / seconds:.0f} cycles/s a core")

        chance = random.Random(arguments.seed)
        waiting = list(range(1, arguments.shards + 1))
        running, done = [], []
        while waiting or running:
            while waiting and len(running) < arguments.at_once:
                running.append(Shard(program, tests, waiting.pop(0), arguments.shards, folder,
                                     arguments.kills, arguments.life, chance))
            time.sleep(0.01)
            for shard in running[:]:
                if shard.is_done():
                    running.remove(shard)
                    done.append(shard)
        spent = resource.getrusage(resource.RUSAGE_CHILDREN)
        killed = spent.ru_utime + spent.ru_stime - after.ru_utime - after.ru_stime
        header = whole.split(b"\n", 1)[0] + b"\n"
        joined = header + b"".join((folder / f"shard-{k}.csv").read_bytes()[len(header):]
                                   for k in range(1, arguments.shards + 1))
        kills = sum(shard.kills for shard in done)
        print(f"{arguments.shards} shards killed {kills} times: {killed:.1f} s of the processor, "
              f"{size / 1e6 / killed:.1f} MB/s a core")
        if joined != whole:
            sys.exit("campaign_resume: the tables differ")
        print("the tables are the same bytes: nothing lost, nothing twice")


if __name__ == "__main__":
    main()
