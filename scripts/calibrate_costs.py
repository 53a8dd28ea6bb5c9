#!/usr/bin/env python3
"""Prices of the operations that methods are made of, for src/tradeoff/approximation.cc.

    scripts/calibrate_costs.py build/release/src/mindahl [RUNS]

Times every method and model along the five excitations of `tradeoff` for α = 1/3, 0, 0.6 and 1, the
least of RUNS (3) runs each, and fits non-negative prices [ns] to the counted operations by least
squares of the relative errors, coordinate by coordinate. What the fit leaves is printed beside it.
"""
import json
import math
import subprocess
import sys

LAWS = [("0.3333333333333333", "30"), ("0", "30"), ("0.6", "30"), ("1", "30")]
SWEEPS = 20000


def timed(program, runs):
    """Least measured time [ns/sample] and operations per sample of every point."""
    least = {}
    for _ in range(runs):
        for alpha, slip_force in LAWS:
            command = [program, "tradeoff", "--sigma", "4.8e8", "--alpha", alpha, "--slip-force",
                       slip_force, "--json", "-"]
            study = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
            for excitation in study["excitations"]:
                for point in excitation["points"]:
                    key = (alpha, excitation["name"], point["model"], point["method"],
                           point["steps"], point["tolerance"], str(point["refitted"]))
                    known = least.get(key, (math.inf, None))[0]
                    if point["measured_ns_per_sample"] < known:
                        least[key] = (point["measured_ns_per_sample"],
                                      point["operations_per_sample"])
    return least


def prices(points):
    """Non-negative least squares of Σ(Σ price·count/time − 1)²."""
    names = sorted({name for _, counts in points for name in counts})
    rows = [[counts.get(name, 0.0) / time for name in names] for time, counts in points]
    price = [1.0] * len(names)
    left = [sum(a * p for a, p in zip(row, price)) - 1 for row in rows]
    squares = [sum(row[j] ** 2 for row in rows) for j in range(len(names))]
    for _ in range(SWEEPS):
        largest = 0.0
        for j, square in enumerate(squares):
            slope = sum(row[j] * r for row, r in zip(rows, left))
            change = max(price[j] - slope / square, 0.0) - price[j]
            if change == 0:
                continue
            largest = max(largest, abs(change))
            price[j] += change
            left = [r + row[j] * change for r, row in zip(left, rows)]
        if largest < 1e-6:
            break
    return dict(zip(names, price)), left


def main():
    runs = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    least = timed(sys.argv[1], runs)
    price, left = prices(list(least.values()))
    for name, value in price.items():
        print(f"{name:<12} {value:8.2f} ns")
    sizes = sorted(abs(r) for r in left)
    print(f"{len(sizes)} points, modelled over measured - 1: half within "
          f"{100 * sizes[len(sizes) // 2]:.0f} %, nine of ten within "
          f"{100 * sizes[len(sizes) * 9 // 10]:.0f} %, largest {100 * sizes[-1]:.0f} %")
    worst = sorted(zip(left, least), key=lambda pair: -abs(pair[0]))[:8]
    for r, key in worst:
        print(f"  {100 * r:+.0f} %  {' '.join(str(part) for part in key)}")


if __name__ == "__main__":
    main()
