#!/usr/bin/env python3
"""Compares the processor time of a fit of one noisy record with other programs', in turn in one run.

    bench/peers/compare.py [--build build/release] [--rounds 7]

Everything runs on one core, each round runs every program once, and a ratio is that of one round;
the table has the median of the ratios and their range. Fails where the programs do not find the
same parameters. docs/performance.md has the table. Needs lmfit: scripts/install-dependencies.sh --peers
"""

import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

from peers import LARGEST_DIFFERENCE_IN_STANDARD_ERRORS, PYTHON, disagreements, run_json

HERE = pathlib.Path(__file__).resolve().parent

# sigma = 5e7 N/m, Tc = 20 N, alpha = 1/3, lambda = 1.2; noise 1 % of Tc.
RECORD = ("simulate --model mindlin --sigma 5e7 --slip-force 20 --lambda 1.2 --cycles 2 "
          "--samples-per-cycle 200 --noise-force 0.2 --seed 1").split()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", default="build/release", type=pathlib.Path)
    parser.add_argument("--rounds", default=7, type=int)
    parser.add_argument("--repeats", default=20, type=int, help="fits a round of each program")
    arguments = parser.parse_args()

    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})  # the programs inherit it
    os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    repeats = str(arguments.repeats)
    with tempfile.TemporaryDirectory() as directory:
        record = os.path.join(directory, "record.csv")
        subprocess.run([arguments.build / "src/mindahl", *RECORD, "-o", record], check=True)
        peer = [PYTHON, HERE / "lmfit_fit.py", record, "--repeats", repeats]
        own = [arguments.build / "bench/peers/mindahl_fit", record, repeats]
        rounds = [(run_json(*peer), run_json(*own)) for _ in range(arguments.rounds)]

    times = {}  # of each row, one a round, [ms]
    for lmfit, mindahl in rounds:
        rows = {"lmfit, bare fit": lmfit["median_ms"],
                "lmfit, the model once": lmfit["force_evaluation_ms"]}
        for depth, fit in mindahl["depths"].items():
            rows[f"mindahl, {depth}"] = fit["median_ms"]
        rows["mindahl, the model and its gradient once"] = mindahl["one_gradient_ms"]
        for name, milliseconds in rows.items():
            times.setdefault(name, []).append(milliseconds)

    lmfit, mindahl = rounds[0]
    print(f"{lmfit['program']}, {mindahl['program']}: "
          f"{arguments.rounds} rounds of {repeats} fits on one core\n")
    print("| what | time over lmfit's bare fit | range | this run [ms] |")
    print("|---|---|---|---|")
    reference = times["lmfit, bare fit"]
    for name, milliseconds in times.items():
        ratios = [own / peer for own, peer in zip(milliseconds, reference)]
        print(f"| {name} | {statistics.median(ratios):.3g} | {min(ratios):.3g} … {max(ratios):.3g} "
              f"| {statistics.median(milliseconds):.3g} |")
    print()
    for parameter, value in lmfit["parameters"].items():
        print(f"{parameter:10s} lmfit {value['value']:.6g} ± {value['standard_error']:.2g}", end="")
        for depth, fit in mindahl["depths"].items():
            print(f"   mindahl, {depth}: {fit['parameters'][parameter]['value']:.6g}", end="")
        print()

    wrong = [line for depth, fit in mindahl["depths"].items()
             for line in disagreements(f"mindahl, {depth}", fit, lmfit)]
    if not lmfit["converged"]:
        wrong.insert(0, "lmfit has not converged")
    print("\n".join(wrong) or "same parameters within "
          f"{LARGEST_DIFFERENCE_IN_STANDARD_ERRORS} standard errors")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
