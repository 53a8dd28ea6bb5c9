#!/usr/bin/env python3
"""The workflow on a small campaign: what it merges is what `mindahl track` says of each record, also
where a job fails once and where the run is killed in the middle. Other options and another version fit
anew, one more record alone; paths may have spaces.

usage: campaign_test.py --program PATH --workflow FOLDER
Ends with 77 where snakemake is not installed.
"""
import argparse
import csv
import io
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

# More than two batches of 64, less than one, more than one; and one whose record breaks off.
CYCLES = {"new": 140, "old": 3, "worn": 70, "zero": 9}


def run(*words, **options):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True,
                          **options)


def make_records(program, folder):
    folder.mkdir()
    for seed, (name, cycles) in enumerate(CYCLES.items()):
        run(program, "simulate", "--sigma", "5e7", "--slip-force", 60 - 3 * seed, "--amplitude",
            "2.5e-6", "--cycles", cycles, "--noise-force", "0.5", "--seed", seed, "-o",
            folder / f"{name}.csv")
    with open(folder / "zero.csv", "a") as file:
        file.write("0,nothing,0,0\n0,0,0\n")


def write_program(path, text):
    path.write_text("#!/bin/sh\n" + text)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)


class Campaign:
    def __init__(self, snakemake, workflow, folder, results, records="records"):
        self.command = [snakemake, "--snakefile", workflow / "Snakefile", "--cores", "2", "--quiet",
                        "--config", f"records={folder / records}", f"results={results}"]
        self.folder = folder
        self.results = folder / results
        # Its locks and its caches belong to this test alone.
        self.environment = {**os.environ, "HOME": str(folder), "XDG_CACHE_HOME": str(folder)}

    def start(self, program, options=""):
        words = [str(word) for word in [*self.command, f"program={program}", f"options={options}"]]
        return subprocess.Popen(words, cwd=self.folder, env=self.environment,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                start_new_session=True)

    def run(self, program, options=""):
        process = self.start(program, options)
        output, _ = process.communicate()
        assert process.returncode == 0, output
        return output

    def table(self):
        return (self.results / "campaign.csv").read_bytes()


def check_tables(campaign, expected, what):
    assert campaign.table() == expected, f"{what}: the table is not that of mindahl track"
    with open(campaign.results / "campaign.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    counts = {name: sum(row["test"] == f"{name}.csv" for row in rows) for name in CYCLES}
    # A cycle is what lies between the first turning point and the last.
    whole = {name: cycles - 1 for name, cycles in CYCLES.items() if name != "zero"}
    assert {name: counts[name] for name in whole} == whole, (what, counts)
    summary = json.loads((campaign.results / "campaign.json").read_text())
    assert summary["fits"] == sum(whole.values()), what
    assert summary["failed"] == ["zero.csv"], (what, summary["failed"])
    fault = next(test["fault"] for test in summary["tests"] if test["fault"])
    assert "zero.csv" in fault, fault
    assert not list((campaign.results / "begun").rglob("*.csv")), f"{what}: something was left behind"


def check_key(snakemake, workflow, folder, program):
    """What is fitted again, in folders with spaces: all with other options or another version, of one
    more record that alone, and nothing without a change."""
    records = folder / "two records"
    records.mkdir()
    for name in ("b old", "c new"):
        shutil.copy(folder / "records" / "old.csv", records / f"{name}.csv")
    asked = folder / "asked.txt"
    versioned = folder / "the program"

    def make(version):
        write_program(versioned, f'''
if [ "$1" = --version ]; then echo "{version}"; exit; fi
echo "$2" >> "{asked}"
exec "{program}" "$@"
''')

    def fitted(options=""):
        asked.write_text("")
        campaign.run(versioned, options)
        return sorted(Path(line).name.split(".")[0] for line in asked.read_text().splitlines())

    make("1.0")
    campaign = Campaign(snakemake, workflow, folder, "its results", records=records.name)
    assert fitted() == ["b old", "c new"]
    first = campaign.table()
    assert fitted() == []
    assert fitted("--model jenkins") == ["b old", "c new"]
    assert campaign.table() != first, "other options give the old table"
    assert fitted() == ["b old", "c new"]
    shutil.copy(folder / "records" / "old.csv", records / "a first.csv")
    assert fitted() == ["a first"]
    with open(campaign.results / "campaign.csv", newline="") as file:
        tests = [Path(row["test"]).stem for row in csv.DictReader(file)]
    assert list(dict.fromkeys(tests)) == ["a first", "b old", "c new"], tests
    make("1.1")
    assert fitted() == ["a first", "b old", "c new"]


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
        tables = []
        for name in sorted(CYCLES):
            table = folder / f"{name}.csv"
            done = subprocess.run([program, "track", folder / "records" / f"{name}.csv", "--output",
                                   table], capture_output=True, text=True)
            assert done.returncode == (2 if name == "zero" else 0), done.stderr  # which breaks off
            with open(table, newline="") as file:
                tables.append((f"{name}.csv", list(csv.reader(file))))
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(["test", *tables[0][1][0]])
        for name, rows in tables:
            writer.writerows([name, *row] for row in rows[1:])
        expected = text.getvalue().encode()

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
        run(*campaign.command, f"program={program}", "--unlock", cwd=folder, env=campaign.environment)
        campaign.command.insert(1, "--rerun-incomplete")
        campaign.run(program)
        check_tables(campaign, expected, "a run that was killed")
        again = campaign.run(program)
        assert campaign.table() == expected, again

        check_key(snakemake, arguments.workflow.resolve(), folder, program)
    print("the workflow's table is that of mindahl track: a failed record, a killed run, what "
          "is fitted again")


if __name__ == "__main__":
    main()
