#!/usr/bin/env python3
"""Makes the tables of the pages from the library's own tables.

    library_tables.py --tables build/dev/tests/docs/library_tables              are they current?
    library_tables.py --tables build/dev/tests/docs/library_tables --update     rewrites them

A page has `<!-- generated: NAME ARGUMENTS -->`, what is generated, and `<!-- end -->`. Of a table the
library has the rows and what it knows of each; cells that it does not know are those of the page,
kept by the row's first cell, and a row that lacks one is refused.
"""

import argparse
import difflib
import json
import pathlib
import re
import subprocess
import sys
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"(<!-- generated: (.*?) -->\n)(.*?)(<!-- end -->)", re.DOTALL)

# --- tables of the pages -------------------------------------------------------------------------


def cell(text):
    """Text as a table of Markdown takes it; what stands between backticks stays."""
    parts = text.split("`")
    parts[::2] = [part.replace("*", "\\*") for part in parts[::2]]
    return "`".join(parts).replace("|", "\\|")


def code(text):
    return f"`{text}`" if text else ""


def table(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


class Kept:
    """The cells of a page's table, by the row's first cell and the column's head."""

    def __init__(self, text):
        lines = [re.split(r"(?<!\\) ?\| ?", line)[1:-1] for line in text.splitlines()
                 if line.startswith("|")]
        self.head = lines[0] if lines else []
        self.cells = {row[0]: dict(zip(lines[0], row)) for row in lines[2:]}
        self.missing = []

    def row(self, first, *columns):
        found = self.cells.get(first, {})
        self.missing += [f"{first}: write its '{column}' into the table"
                         for column in columns if column not in found]
        return [found.get(column, "") for column in columns]


def in_page_order(rows, kept):
    """Rows as the page has them, which may say "likewise", and those that are new to it after them."""
    order = {first: place for place, first in enumerate(kept.cells)}
    return sorted(rows, key=lambda row: order.get(row[0], len(order)))


def fields_of(node, path):
    """What the schema of a fit describes."""
    if path and "description" in node:
        yield [code(path), node.get("unit", ""), cell(node["description"])]
    for name, member in node.get("properties", {}).items():
        yield from fields_of(member, f"{path}.{name}" if path else name)


def fields_table(*_):
    schema = json.loads((ROOT / "docs/schema/fit.json").read_text())
    return table(["key", "unit", "what it is"], fields_of(schema, ""))


def terms_table(tables, _, __):
    presences = {"always": "always", "offsets": "with offsets, else 0", "load_series": "loads that differ",
                 "never": "`--terms displacement_drift` with `--noise-in displacement`"}
    rows = []
    for term in tables["terms"]:
        option = "--terms " + term["option"] if term["option"] else "--covariate COL"
        fitted = presences.get(term["presence"], code(option))
        if term["presence"] == "reported":
            fitted += ", else 0"
        meaning = term["meaning"] + ("; needs a time column" if term["needs_time"] else "")
        rows.append([code(term["name"]), term["unit"], "record" if term["is_of_record"] else "contact",
                     "linear" if term["is_linear"] else "law", fitted, cell(meaning)])
    return table(["name", "unit", "of", "enters", "fitted", "what it is"], rows)


def thresholds_table(*_):
    header = (ROOT / "include/mindahl/identification/thresholds.h").read_text()
    rows = []
    for comment, name, value in re.findall(r"((?: *///.*\n)+) *double (\w+) = (.*);", header):
        unit, decides, why = re.match(r"\[(.*?)\] (.*?)\. (.*)\.$",
                                      " ".join(re.findall(r"/// (.*)", comment))).groups()
        rows.append([code(name), f"{float(value):g}", cell(unit), cell(decides), cell(why)])
    return table(["name", "value", "of what", "what it decides", "why there"], rows)


def findings_table(tables, kind, kept):
    rows = []
    for row in tables["findings"]:
        if row["is_note"] == (kind == ["notes"]):
            verdict = "" if row["verdict"] == "identifiable" else code(row["verdict"])
            meaning, advice = kept.row(code(row["code"]), "meaning", "what to do")
            rows.append([code(row["code"]), meaning, verdict, advice])
    return table(["`code`", "meaning", "verdict", "what to do"], in_page_order(rows, kept))


def causes_table(tables, _, kept):
    rows = []
    for row in tables["causes"]:
        what, advice = kept.row(code(row["code"]), "what it is", "what to do")
        rows.append([code(row["code"]), what, code(row["option"]), advice])
    return table(["`causes[].code`", "what it is", "`term`", "what to do"],
                 in_page_order(rows, kept))


def flags_table(tables, _, __):
    return table(["flag", "meaning"], [[code(row["name"]), cell(row["meaning"])] for row in tables["flags"]])


def columns_list(tables, command, _):
    return textwrap.fill(", ".join(map(code, tables["columns"][command[0]])), 116, break_long_words=False,
                         break_on_hyphens=False) + "\n"


TABLES = {"fields": fields_table, "flags": flags_table, "columns": columns_list, "terms": terms_table, "thresholds": thresholds_table,
          "findings": findings_table, "causes": causes_table}

# --- pages, against the library -------------------------------------------------------


def page_of(text, tables, problems):
    def fresh(match):
        name, *words = match[2].split()
        kept = Kept(match[3])
        made = TABLES[name](tables, words, kept)
        problems.extend(kept.missing)
        return f"{match[1]}{made}{match[4]}"
    return BLOCK.sub(fresh, text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tables", required=True, type=pathlib.Path, help="the program library_tables")
    parser.add_argument("--update", action="store_true")
    arguments = parser.parse_args()
    tables = json.loads(subprocess.run([arguments.tables.resolve()], check=True, capture_output=True,
                                       encoding="utf-8").stdout)
    problems = []
    wanted = {path: page_of(path.read_text(), tables, problems)
              for path in sorted(ROOT.glob("docs/*.md"))}
    for path, text in wanted.items():
        if text == path.read_text():
            continue
        if arguments.update:
            path.write_text(text)
            continue
        name = str(path.relative_to(ROOT))
        problems += difflib.unified_diff(path.read_text().splitlines(), text.splitlines(), name,
                                         "the library's", lineterm="", n=0)
        problems.append(f"{name} is not current: tests/docs/library_tables.py --tables PROGRAM --update")
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
