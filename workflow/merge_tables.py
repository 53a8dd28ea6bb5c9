#!/usr/bin/env python3
"""Makes one table of those of the shards of `mindahl track --separate`, and one summary of theirs.
Memory does not grow with the tables.

usage: merge_tables.py TABLE SUMMARY SHARD.csv...
Beside each SHARD.csv is its summary, SHARD.json.
"""
import json
import os
import shutil
import sys
from pathlib import Path


def merge(tables, table):
    """Rows of all tables, in the order of their names on the command line."""
    header = None
    for path in tables:
        with open(path, "rb") as rows:
            first = rows.readline()
            if header is None:
                header = first
                table.write(header)
            if first != header:
                sys.exit(f"merge_tables: {path} has other columns than {tables[0]}")
            shutil.copyfileobj(rows, table)


def summarise(tables):
    """What all tests make together, and of each what its own run said."""
    shards = [json.loads(path.with_suffix(".json").read_text()) for path in tables]
    tests = [test for shard in shards for test in shard["tests"]]
    return {
        "schema": "mindahl.campaign/1",
        "version": shards[0]["version"],
        "fits": sum(shard["fits"] for shard in shards),
        "flagged": sum(shard["flagged"] for shard in shards),
        "accumulated_energy": sum(shard["accumulated_energy"] for shard in shards),
        "failed": [test["file"] for test in tests if test["fault"] is not None],
        "tests": tests,
    }


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    table, summary, *tables = map(Path, sys.argv[1:])
    # Each whole or not at all.
    with open(f"{table}.part", "wb") as file:
        merge(tables, file)
    with open(f"{summary}.part", "w") as file:
        json.dump(summarise(tables), file, indent=1, ensure_ascii=False)
        file.write("\n")
    os.replace(f"{table}.part", table)
    os.replace(f"{summary}.part", summary)


if __name__ == "__main__":
    main()
