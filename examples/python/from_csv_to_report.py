"""From a CSV file to a report: python3 from_csv_to_report.py LOOP.csv REPORT.html

Reads a loop, fits it, prints what was found and saves the page that a notebook shows.
"""

import sys
import warnings
from pathlib import Path

import mindahl


def main(loop: str, report: str) -> None:
    record = mindahl.read_csv(loop)
    print(f"{len(record)} samples, displacement from {record.columns['displacement']['name']}")
    for note in record.notes:
        print(f"note: {note}")

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mindahl.FitWarning)  # printed below, with their codes
        result = mindahl.fit(record, normal_load=(50, 0.5))
    print(f"the model is {result.adequacy.verdict}")
    for name in ("sigma", "alpha", "slip_force"):
        parameter = result.parameters[name]
        if parameter.identifiability != "identifiable":
            print(f"{name}: {parameter.identifiability}")
            continue
        print(f"{name} = {parameter.value:.5g} +- {parameter.standard_error:.2g} "
              f"{parameter.unit.replace('-', '')}".rstrip())
    friction = result.contact.friction_coefficient
    print("friction coefficient = {:.3f} ({:.3f} ... {:.3f})".format(friction.value, *friction.ci95))
    for warning in result.warnings:
        print(f"{warning.code}: {warning.message}")

    Path(report).write_text(result.page(), encoding="utf-8")
    print(f"report in {Path(report).name}")


if __name__ == "__main__":
    main(*sys.argv[1:])
