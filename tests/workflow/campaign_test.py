#!/usr/bin/env python3
"""The workflow on a small campaign: what it merges is what `mindahl track` says of each record, also
where a shard fails once, and where the run is killed in the middle.

usage: campaign_test.py --program PATH --workflow FOLDER
Ends with 77 where snakemake is not installed.
"""
import argparse
import csv
import json
import os
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CYCLES = {"new": 140, "worn": 70, "old": 3}  # more than two batches of 64, more than one, less


def run(*words, **options):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True,
                          **options)


def make_records(program, folder):
    folder.mkdir()
    for seed, (name, cycles) in enumerate(CYCLES.items()):
        run(program, "simulate", "--sigma", "5e7", "--slip-force", 60 - 3 * seed, "--amplitude",
            "2.5e-6", "--cycles", cycles, "--noise-force", "0.5", "--seed", seed, "-o",
            folder / f"{name}.csv")


def write_program(path, text):
    path.write_text("#!/bin/sh\n" + text)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)


class Campaign:
    def __init__(self, snakemake, workflow, folder, results):
        self.command = [snakemake, "--snakefile", workflow / "Snakefile", "--cores", "2", "--quiet",
                        "--config", f"records={folder / 'records'}", f"results={results}"]
        self.folder = folder
        self.results = folder / results
        # Its locks and its caches belong to this test alone.
        self.environment = {**os.environ, "HOME": str(folder), "XDG_CACHE_HOME": str(folder)}

    def start(self, program):
        words = [str(word) for word in [*self.command, f"program={program}"]]
        return subprocess.Popen(words, cwd=self.folder, env=self.environment,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                start_new_session=True)

    def run(self, program):
        process = self.start(program)
        output, _ = process.communicate()
        assert process.returncode == 0, output
        return output

    def tables(self):
        return {name: (self.results / "cycles" / f"{name}.csv").read_bytes() for name in CYCLES}


def check_tables(campaign, expected, what):
    assert campaign.tables() == expected, f"{what}: the tables are not those of mindahl track"
    with open(campaign.results / "campaign.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    counts = {name: sum(row["test"] == name for row in rows) for name in CYCLES}
    # A cycle is what lies between the first turning point and the last.
    assert counts == {name: cycles - 1 for name, cycles in CYCLES.items()}, (what, counts)
    summary = json.loads((campaign.results / "campaign.json").read_text())
    assert summary["fits"] == len(rows), what
    energy = sum(float(row["energy [J]"]) for row in rows)
    assert abs(summary["accumulated_energy"] - energy) < 1e-12 * energy, what
    assert not any((campaign.results / "begun").iterdir()), f"{what}: something was left behind"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--workflow", type=Path, required=True)
    arguments = parser.parse_args()
    snakemake = shutil.which("snakemake")
    if snakemake is None:
        print("skipped: snakemake is not installed (scripts/install-dependencies.sh --workflow)")
        sys.exit(77)
    program = arguments.program.resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make_records(program, folder / "records")
        expected = {}
        for test in CYCLES:
            table = folder / f"{test}.csv"
            run(program, "track", folder / "records" / f"{test}.csv", "--output", table)
            expected[test] = table.read_bytes()

        # One record fails at the first attempt, halfway: what it wrote is gone on with.
        broken = folder / "broken"
        write_program(broken, f'''
case "$2" in
  */worn.csv)
    if [ ! -e "{folder}/failed" ]; then
      touch "{folder}/failed"
      head -c 20000 "{folder}/worn.csv" > "$4"
      exit 1
    fi;;
esac
exec "{program}" "$@"
''')
        campaign = Campaign(snakemake, arguments.workflow.resolve(), folder, "once")
        output = campaign.run(broken)
        assert (folder / "failed").exists(), output
        check_tables(campaign, expected, "a record that failed once")

        # The whole run is killed while a record is being fitted, and started anew.
        stalled = folder / "stalled"
        write_program(stalled, f'''
case "$2" in
  */new.csv)
    head -c 30000 "{folder}/new.csv" > "$4"
    touch "{folder}/stalled_now"
    exec sleep 600;;
esac
exec "{program}" "$@"
''')
        campaign = Campaign(snakemake, arguments.workflow.resolve(), folder, "killed")
        process = campaign.start(stalled)
        while not (folder / "stalled_now").exists():
            assert process.poll() is None, process.communicate()[0]
            time.sleep(0.05)
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        assert not (campaign.results / "campaign.csv").exists()
        run(*campaign.command, "--unlock", cwd=folder, env=campaign.environment)
        campaign.command.insert(1, "--rerun-incomplete")
        campaign.run(program)
        check_tables(campaign, expected, "a run that was killed")
        again = campaign.run(program)
        assert campaign.tables() == expected, again
    print("the workflow's tables are those of mindahl track: a failed record, a killed run")


if __name__ == "__main__":
    main()
