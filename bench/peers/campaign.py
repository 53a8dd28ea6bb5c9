#!/usr/bin/env python3
"""Compares the processor time of `mindahl track` with reading the same file, and with other fits.

    bench/peers/campaign.py [--build build/release] [--cycles 10000] [--rounds 5]

Everything runs in turn on one core; the table has the ratio of the least times of all rounds, which
others on the machine disturb least, and the median and the range of the ratios of each round. Then
time against threads. Fails where the peers do not find the same parameters. docs/performance.md has
the tables; scaling.py goes on to long records.
Needs pandas, lmfit and SciPy: scripts/install-dependencies.sh --peers
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

from peers import LARGEST_DIFFERENCE_IN_STANDARD_ERRORS, PYTHON, disagreements, run_json

HERE = pathlib.Path(__file__).resolve().parent

# sigma = 5e7 N/m, Tc = 20 N, alpha = 1/3, lambda = 1.2; noise 1 % of Tc; 200 samples a cycle.
CONTACT = ("simulate --model mindlin --sigma 5e7 --slip-force 20 --lambda 1.2 "
           "--samples-per-cycle 200 --noise-force 0.2 --seed 1").split()

# The same against partial slip, whose fits take more steps, and against a file that pandas reads
# faster: numbers of six digits in two columns.
PARTIAL_SLIP = ("simulate --model mindlin --sigma 5e7 --slip-force 20 --lambda 0.9 "
                "--samples-per-cycle 200 --noise-force 0.066 --seed 1").split()
SIX_DIGITS = """
import sys, pandas
table = pandas.read_csv(sys.argv[1])
table.iloc[:, 1:].to_csv(sys.argv[2], index=False, float_format="%.6g")
"""

READ = """
import sys, time, pandas
start = time.process_time()
table = pandas.read_csv(sys.argv[1])
print(time.process_time() - start, len(table))
"""


def cost_of(command):
    """(processor seconds, seconds) of a program."""
    start = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    elapsed = time.monotonic() - start
    if status != 0:
        sys.exit(f"failed: {' '.join(map(str, command))}")
    return usage.ru_utime + usage.ru_stime, elapsed


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", default="build/release", type=pathlib.Path)
    parser.add_argument("--cycles", default=10_000, type=int)
    parser.add_argument("--rounds", default=5, type=int)
    arguments = parser.parse_args()
    program = arguments.build / "src/mindahl"
    cores = os.sched_getaffinity(0)
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")

    with tempfile.TemporaryDirectory() as directory:
        def simulated(cycles, contact=CONTACT):
            path = os.path.join(directory, f"{cycles}_{contact is CONTACT}.csv")
            if not os.path.exists(path):
                subprocess.run([program, *contact, "--cycles", str(cycles), "-o", path], check=True)
            return path

        def read_by_pandas(path):
            seconds, rows = subprocess.run([PYTHON, "-c", READ, path], check=True, text=True,
                                           capture_output=True).stdout.split()
            return float(seconds), int(rows)

        def track(path, *more):
            table = os.path.join(directory, "table.csv")
            return [program, "track", path, "--output", table, "--overwrite", *more]

        record = simulated(arguments.cycles)
        # From the first reversal on, as the campaign's: one cycle of a contact that had slipped.
        one_cycle = simulated(1.25)
        os.sched_setaffinity(0, {max(cores)})
        times = {}
        for _ in range(arguments.rounds):
            seconds, rows = read_by_pandas(record)
            lmfit = run_json(PYTHON, HERE / "lmfit_fit.py", one_cycle, "--repeats", "20",
                             "--initial-state", "steady")
            scipy = {route: run_json(PYTHON, HERE / "scipy_fit.py", one_cycle, "--route", route,
                                     "--repeats", repeats)
                     for route, repeats in (("closed", "20"), ("ode", "1"))}
            fits = run_json(arguments.build / "bench/peers/mindahl_cycles", simulated(400), "5")
            cycles = rows // 200
            for name, microseconds in {
                    "pandas, reading": 1e6 * seconds / cycles,
                    "mindahl track, reading and fits": 1e6 * cost_of(
                        track(record, "--threads", "1"))[0] / cycles,
                    "mindahl, a cycle's values": fits["estimate_us"],
                    "mindahl, values and errors": fits["errors_us"],
                    "lmfit, bare fit": 1e3 * lmfit["median_ms"],
                    "SciPy, closed form": 1e3 * scipy["closed"]["median_ms"],
                    "SciPy, integrated": 1e3 * scipy["ode"]["median_ms"]}.items():
                times.setdefault(name, []).append(microseconds)
        wrong = [line for route, fit in scipy.items()
                 for line in disagreements(f"SciPy, {route}", fit, lmfit)]
        print(f"{cycles} cycles of 200 samples, {os.path.getsize(record) / cycles / 1e3:.1f} kB "
              f"each, {arguments.rounds} rounds on one core\n")
        print("| what | least time a cycle over pandas' | median of rounds | range | least [µs] | "
              "over a cycle's values |")
        print("|---|---|---|---|---|---|")
        peers = times["pandas, reading"]
        least_fit = min(times["mindahl, a cycle's values"])
        for name, values in times.items():
            ratios = [own / peer for own, peer in zip(values, peers)]
            print(f"| {name} | {min(values) / min(peers):.3g} | {statistics.median(ratios):.3g} | "
                  f"{min(ratios):.3g} … {max(ratios):.3g} | {min(values):.3g} | "
                  f"{min(values) / least_fit:.3g} |")

        six_digits = os.path.join(directory, "six_digits.csv")
        subprocess.run([PYTHON, "-c", SIX_DIGITS, record, six_digits], check=True)
        print("\n| record | `track` over pandas' reading of it | range |")
        print("|---|---|---|")
        for name, path in {"gross slip, three columns of 17 digits": record,
                           "partial slip, three columns of 17 digits":
                               simulated(arguments.cycles, PARTIAL_SLIP),
                           "gross slip, two columns of six digits": six_digits}.items():
            ratios = [cost_of(track(path, "--threads", "1"))[0] / read_by_pandas(path)[0]
                      for _ in range(arguments.rounds)]
            print(f"| {name} | {statistics.median(ratios):.3g} | "
                  f"{min(ratios):.3g} … {max(ratios):.3g} |")

        os.sched_setaffinity(0, cores)
        print("\n| threads | time over one thread's |")
        print("|---|---|")
        alone = None
        for threads in range(1, len(cores) + 1):
            elapsed = min(cost_of(track(record, "--threads", str(threads)))[1] for _ in range(3))
            alone = alone or elapsed
            print(f"| {threads} | {elapsed / alone:.3g} |")
    print("\n" + ("\n".join(wrong) or "the peers found the same parameters within "
                  f"{LARGEST_DIFFERENCE_IN_STANDARD_ERRORS} standard errors"))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
