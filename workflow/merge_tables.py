#!/usr/bin/env python3
"""Makes one table of several of `mindahl track`, the name of the test before each row, and one
summary of theirs. Memory does not grow with the tables.

usage: merge_tables.py TABLE SUMMARY CYCLES.csv...
Beside each CYCLES.csv is its summary, CYCLES.json.
"""
import json
import os
import sys
from pathlib import Path


def merge(tables, table):
    """Rows of all tables, in the order of their names on the command line."""
    header = None
    for path in tables:
        with open(path, newline="") as rows:
            first = rows.readline()
            header = header or first
            if first != header:
                sys.exit(f"merge_tables: {path} has other columns than {tables[0]}")
            if path is tables[0]:
                table.write("test," + header)
            for row in rows:
                table.write(f"{path.stem},{row}")


def summarise(tables):
    """What all tests make together, and of each what its own run said."""
    tests = {}
    for path in tables:
        tests[path.stem] = json.loads(path.with_suffix(".json").read_text())
        del tests[path.stem]["output"]  # where it was while it was being made
    return {
        "schema": "mindahl.campaign/1",
        "tests": tests,
        "cycles": sum(test["input"]["cycles"] for test in tests.values()),
        "fits": sum(test["fits"] for test in tests.values()),
        "accumulated_energy": sum(test["accumulated_energy"] or 0.0 for test in tests.values()),
    }


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    table, summary, *tables = map(Path, sys.argv[1:])
    for path in tables:
        if "," in path.stem or '"' in path.stem:
            sys.exit(f"merge_tables: the name of {path} has a comma or a quote")
    # Each whole or not at all.
    with open(f"{table}.part", "w", newline="") as file:
        merge(tables, file)
    with open(f"{summary}.part", "w") as file:
        json.dump(summarise(tables), file, indent=1, ensure_ascii=False)
        file.write("\n")
    os.replace(f"{table}.part", table)
    os.replace(f"{summary}.part", summary)


if __name__ == "__main__":
    main()
