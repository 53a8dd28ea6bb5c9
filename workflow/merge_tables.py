#!/usr/bin/env python3
"""Makes one table of those of the tests of a campaign, each row with its test, and one summary of theirs.
Memory does not grow with the tables.

usage: merge_tables.py RESULTS TABLE.csv...
Beside each TABLE.csv is its summary, TABLE.json, empty where the record has a fault; its log is
RESULTS/log/TABLE.txt.
"""
import csv
import json
import os
import sys
from pathlib import Path


def merge(tables, to):
    """Rows of all tables, in the order of their names on the command line."""
    writer = csv.writer(to, lineterminator="\n")
    header = None
    for path in tables:
        with open(path, newline="") as rows:
            reader = csv.reader(rows)
            first = next(reader, None)
            if first is None:
                continue
            if header is None:
                header = first
                writer.writerow(["test", *header])
            if first != header:
                sys.exit(f"merge_tables: {path} has other columns than those before")
            writer.writerows([path.stem, *row] for row in reader)


def test_of(results, path):
    """What a test's own run said, or the fault of its record."""
    said = path.with_suffix(".json").read_text()
    if said:
        return {"test": path.stem, "fault": None, **json.loads(said)}
    log = (results / "log" / f"{path.stem}.txt").read_text().strip().splitlines()
    return {"test": path.stem, "fault": log[-1] if log else "no message"}


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    results, *tables = map(Path, sys.argv[1:])
    tests = [test_of(results, path) for path in tables]
    summary = {
        "schema": "mindahl.campaign/2",
        "fits": sum(test.get("fits", 0) for test in tests),
        "failed": [test["test"] for test in tests if test["fault"] is not None],
        "tests": tests,
    }
    # Each whole or not at all.
    with open(results / "campaign.csv.part", "w", newline="") as file:
        merge(tables, file)
    with open(results / "campaign.json.part", "w") as file:
        json.dump(summary, file, indent=1, ensure_ascii=False)
        file.write("\n")
    for name in ("campaign.csv", "campaign.json"):
        os.replace(results / f"{name}.part", results / name)


if __name__ == "__main__":
    main()
