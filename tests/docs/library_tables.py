#!/usr/bin/env python3
"""Makes the tables of the pages and the schema of a report from the library's own tables.

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
SCHEMA = ROOT / "docs/schema/fit.json"

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


def type_in_words(row):
    kind = row["type"].get("type", "text" if "enum" in row["type"] else "object")
    if row["is_list"]:
        kind = "list"
    return {"string": "text", "array": "list", "boolean": "true, false"}.get(kind, kind) + (
        ", null" if row["may_be_null"] else "")


def fields_table(tables, subjects, _):
    rows = [row for row in tables["fields"] if row["subject"] in subjects]
    return table(["key", "type", "unit", "what it is"],
                 [[code(row["path"]), type_in_words(row), row["unit"], cell(row["label"])] for row in rows])


def terms_table(tables, _, __):
    presences = {"always": "always", "offsets": "with offsets, else 0", "load_series": "loads that differ",
                 "never": "`--drift` beside `--noise-in displacement`"}
    rows = []
    for term in tables["terms"]:
        option = code(term["option"])
        if not option and term["name"].startswith("drag_"):
            option = "`--terms drag`"
        fitted = presences.get(term["presence"], option or "with the row above")
        if term["presence"] == "reported":
            fitted += ", else 0"
        meaning = term["meaning"] + ("; needs a time column" if term["needs_time"] else "")
        rows.append([code(term["name"]), term["unit"], "record" if term["is_of_record"] else "contact",
                     "linear" if term["is_linear"] else "law", fitted, cell(meaning)])
    return table(["name", "unit", "of", "enters", "fitted", "what it is"], rows)


def thresholds_table(tables, _, __):
    return table(["name", "value", "of what", "what it decides", "why there"],
                 [[code(row["name"]), f"{row['value']:g}", cell(row["unit"]), cell(row["meaning"]),
                   cell(row["reason"])] for row in tables["thresholds"]])


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
        unit = row["unit"]
        if row["unit_by_sample"] not in ("", unit):
            unit += f"; {row['unit_by_sample']}"
        rows.append([code(row["code"]), what, unit, cell(row["meaning"]), code(row["option"]), advice])
    return table(["`causes[].code`", "what it is", "unit", "what its size is", "`try`", "what to do"],
                 in_page_order(rows, kept))


def words_table(tables, path, kept):
    """The words that a text of the report may be."""
    words = [code(word) for word in words_of(path[0], tables)]
    return table(kept.head, in_page_order([[word, *kept.row(word, *kept.head[1:])] for word in words], kept))


def flags_table(tables, _, __):
    return table(["flag", "meaning"], [[code(row["name"]), cell(row["meaning"])] for row in tables["flags"]])


def columns_list(tables, command, _):
    return textwrap.fill(", ".join(map(code, tables["columns"][command[0]])), 116, break_long_words=False,
                         break_on_hyphens=False) + "\n"


TABLES = {"fields": fields_table, "flags": flags_table, "columns": columns_list, "words": words_table, "terms": terms_table, "thresholds": thresholds_table,
          "findings": findings_table, "causes": causes_table}

# --- the schema of a report ----------------------------------------------------------------------

NAMES_OF_LAW = ["sigma", "alpha", "slip_force"]
LAWS_OF_LOAD = ["sphere", "elements", "cone", "flat_punch", "rough"]

# What the types of the library's rows do not say, by the path. Words that a text may be:
WORDS = {
    r"\.schema": ["mindahl.fit/1"],
    r"^\.initial_state": ["virgin", "steady", "mixed"],
    r"\.force_sign": ["same", "opposite"],
    r"trimmed\[\]\.reason": ["rest"],
    r"regions\[\]\.parameters\[0\]": NAMES_OF_LAW,
    r"\.direction": ["up", "down"],
    r"\.mode": ["auto"],
    r"\.obstacle": ["", "confounded", "rate_dependent", "unphysical", "same_channel"],
    r"\.solver\.solver": ["tiny_solver", "solve", "none"],
    r"\.from": ["grid", "seed"],
    r"\.compliance_unit": ["1/Pa"],
    r"\.branch": ["virgin", "unloading", "reloading"],
    r"\.radius": ["hertz", "given"],
    r"stiffness_tests\[\]\.unit": ["-"],
    r"load_series\.\w+\[\]\.name": LAWS_OF_LOAD,
}
# Numbers and other texts:
FRACTION = {"minimum": 0, "maximum": 1}
LIMITS = {
    r"\.confidence": {"exclusiveMinimum": 0, "exclusiveMaximum": 1},
    r".*(p_value|\.p|\.from_fit|\.from_inputs|sliding_fraction|akaike_weight|stick_radius_ratio|\.position)":
        FRACTION,
    r".*(_error|_deviation|_noise|rms|max_abs|gate|_cost|misfit_\w+|\.moves|path_ratio|asymmetry|\.iterations"
    r"|models\[\]\.delta_aicc|effective_samples|tests\[\]\.size|with_rig_stiffness|points\[\]\.displacement"
    r"|cycles\[\]\.amplitude|loop\.amplitude|peak_force|loop\.gross_slip_displacement)": {"minimum": 0},
    r".*(measured\.backlash|prior\.standard_uncertainty)": {"exclusiveMinimum": 0},
    r".*(r_squared|\.gain)": {"maximum": 1},
    r".*durbin_watson": {"minimum": 0, "maximum": 4},
    r"\.correlation\.NAME\.NAME": {"minimum": -1.000001, "maximum": 1.000001},
    r".*trimmed\[\]\.(first_line|last_line|samples)": {"minimum": 1},
    r"\.terms\.fits": {"minimum": 1, "maximum": 15},
    r"\.version": {"pattern": r"^[0-9]+\.[0-9]+\.[0-9]+$"},
    r".*\.code": {"pattern": "^[a-z0-9_]+$"},
    r".*\.try": {"pattern": "^--"},
    r".*(\.unit|input\.units\.\w+|\.message|nulls\[\]\.\w+)": {"minLength": 1},
}
# Objects and lists:
ALSO = {
    "input": {"dependentRequired": {"load_pieces": ["between_loads"], "between_loads": ["load_pieces"]}},
    "reversals": {"if": {"properties": {"certain": {"const": True}}},
                  "then": {"properties": {"other_count": False, "other_gate": False}},
                  "else": {"required": ["other_count", "other_gate"]}},
    "parameters": {"required": NAMES_OF_LAW,
                   "propertyNames": {"pattern": "^([a-z_]+(_[0-9]+)?|covariate_.+)$"}},
    "load_series.laws[].quantities": {"propertyNames": {"enum": [
        "contact_radius", "equivalent_radius", "compliance", "effective_modulus", "youngs_modulus", "slope",
        "load_over_stiffness", "profile_exponent"]}},
    **dict.fromkeys(["input.files", "input.reversal_gate", "input.displacement_noise", "input.initial_state",
                     "input.response_noise", "model_selection.models"], {"minItems": 1}),
    **dict.fromkeys(["input.load_pieces", "load_series.records"], {"minItems": 2}),
    "law.alternatives": {"maxItems": 1},
    "residual_structure[].directions": {"minItems": 2, "maxItems": 2},
    "regions[].boundary": {"minItems": 3},
}


class Node:
    """A place of the document, with what the rows say of it and of what it contains."""

    def __init__(self):
        self.row = None
        self.members = {}   # by key
        self.named = None   # of an object with any keys
        self.element = None  # of a list
        self.places = {}    # of a list of so many

    def at(self, step):
        if step == "[]":
            self.element = self.element or Node()
            return self.element
        if step == "NAME":
            self.named = self.named or Node()
            return self.named
        return (self.places if step.startswith("[") else self.members).setdefault(step, Node())

    def below(self):
        parts = [*self.members.values(), *self.places.values(), self.named, self.element]
        return [part for part in parts if part is not None]

    def may_be_absent(self):
        """An object all of whose members may be absent is itself absent, or whole."""
        if self.row is not None:
            return self.row["may_be_absent"]
        return all(part.may_be_absent() for part in self.below())

    def rows(self):
        """In the order of the document."""
        if self.row is not None:
            yield self.row
        for part in self.below():
            yield from part.rows()


def steps_of(path):
    return re.findall(r"\[\d*\]|[^.\[\]]+", path)


def tree_of(rows):
    root = Node()
    for row in rows:
        node = root
        for step in steps_of(row["path"]):
            node = node.at(step)
        if node.row or not row["label"]:
            raise SystemExit(f"{row['path']}: has two rows, or one without a meaning")
        node.row = row
    return root


def or_null(schema):
    if "enum" in schema:
        return {**schema, "enum": [*schema["enum"], None]}
    return {**schema, "type": [schema["type"], "null"]}


def of_type(kind):
    """Of a leaf. "null" says of a list's elements that they may be null."""
    schema = {key: value for key, value in kind.items() if key != "null"}
    if "items" in schema:
        schema["items"] = of_type(schema["items"])
    return or_null(schema) if kind.get("null") else schema


def limited(schema, path, tables):
    """A leaf with what its type does not say."""
    if "items" in schema:
        return {**schema, "items": limited(schema["items"], path, tables)}
    for pattern, words in {**WORDS, r"\.(model|law|preferred)": tables["models"]}.items():
        if schema == {"type": "string"} and re.search(pattern + "$", path):
            return {"enum": words}
    for pattern, limits in LIMITS.items():
        if "type" in schema and re.fullmatch(pattern, path):
            schema = {**schema, **limits}
    return schema


def described(row):
    unit = f" [{row['unit']}]" if row["unit"] not in ("", "-") else ""
    return {"description": row["label"] + unit}


def words_of(path, tables):
    row = next(row for row in tables["fields"] if row["path"] == path)
    return limited(of_type(row["type"]), "." + path, tables)["enum"]


def schema_of(node, tables, path=""):
    row = node.row
    schema = described(row) if row else {}
    if row and row["type"] == {"type": "quantity"}:
        quantity = {"$ref": "#/$defs/quantity"}
        return {**schema, **({"anyOf": [quantity, {"type": "null"}]} if row["may_be_null"] else quantity)}
    if node.members:
        is_whole = row is None and node.may_be_absent()
        for part in node.members.values():
            first = next(part.rows())
            if part.may_be_absent() and not is_whole and "absent" not in first["label"]:
                raise SystemExit(f"{first['path']}: its meaning does not say when it is absent")
        schema.update({
            "type": "object",
            "properties": {key: schema_of(part, tables, f"{path}.{key}") for key, part in node.members.items()},
            "required": [key for key, part in node.members.items() if is_whole or not part.may_be_absent()],
            "additionalProperties": False})
    elif node.named:
        schema.update({"type": "object",
                       "additionalProperties": schema_of(node.named, tables, f"{path}.NAME")})
    elif node.element:
        schema.update({"type": "array", "items": schema_of(node.element, tables, f"{path}[]")})
    elif node.places:
        first = schema_of(node.places["[0]"], tables, f"{path}[0]")
        first["description"] = "; ".join(described(part.row)["description"] for part in node.places.values())
        schema.update({"type": "array", "items": first, "minItems": len(node.places),
                       "maxItems": len(node.places)})
    else:
        schema.update(limited(of_type(row["type"]), path, tables))
    schema.update(ALSO.get(path[1:], {}))
    return or_null(schema) if row and row["may_be_null"] else schema


def report_schema(tables):
    rows = tables["fields"]
    mark = "contact.QUANTITY."
    quantity = tree_of([{**row, "path": row["path"][len(mark):]} for row in rows if row["path"].startswith(mark)])
    root = tree_of([row for row in rows if not row["path"].startswith(mark)])
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "What `mindahl fit --json` writes",
        "description": "Made from the library's tables by tests/docs/library_tables.py, as is docs/contract.md; "
                       "numbers are in SI. A null has one entry in `nulls`, which says why. Complete for this "
                       "version: a later one may add keys."}
    schema.update(schema_of(root, tables))
    schema["$defs"] = {"quantity": schema_of(quantity, tables, ".contact.QUANTITY")}
    return "\n".join(lines_of(schema)) + "\n"


def is_branch(schema):
    """Whether a schema, or that of its elements, has members of its own."""
    return "properties" in schema or any(is_branch(schema[key]) for key in ("items", "additionalProperties")
                                         if isinstance(schema.get(key), dict))


def lines_of(schema, head="", indent="", tail=""):
    """JSON with a line for each leaf, and one for what a branch says of itself."""
    if not is_branch(schema):
        yield indent + head + json.dumps(schema, ensure_ascii=False) + tail
        return
    inner = next(key for key in ("properties", "items", "additionalProperties")
                 if key == "properties" and key in schema or key != "properties" and is_branch(schema.get(key, {})))
    own = json.dumps({key: part for key, part in schema.items() if key != inner}, ensure_ascii=False)
    begin = f"{head}{own[:-1]}{', ' if own != '{}' else ''}{json.dumps(inner)}: "
    if inner != "properties":
        yield from lines_of(schema[inner], begin, indent, "}" + tail)
        return
    yield indent + begin + "{"
    *most, last = schema[inner]
    for key in most:
        yield from lines_of(schema[inner][key], json.dumps(key) + ": ", indent + "  ", ",")
    yield from lines_of(schema[inner][last], json.dumps(last) + ": ", indent + "  ")
    yield indent + "}}" + tail


# --- pages and schema, against the library -------------------------------------------------------


def prepared(tables):
    """Rows in the order of the document: a list's elements after the list."""
    fields = list(tree_of(tables["fields"]).rows())
    lists = {re.match(r"(.*)\[\d*\]", row["path"]).group(1) for row in fields if "[" in row["path"]}
    lists |= {path[:path.rindex("[")] for path in lists if "[" in path}
    for row in fields:
        row["subject"] = steps_of(row["path"])[0]
        row["is_list"] = row["path"] in lists
    return {**tables, "fields": fields}


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
    tables = prepared(json.loads(subprocess.run([arguments.tables.resolve()], check=True,
                                                capture_output=True, encoding="utf-8").stdout))
    problems = []
    wanted = {path: page_of(path.read_text(), tables, problems)
              for path in sorted(ROOT.glob("docs/*.md"))}
    contract = wanted[ROOT / "docs/contract.md"]
    problems += [f"docs/contract.md lacks {row['path']}: name its subject in a block"
                 for row in tables["fields"] if f"\n| `{row['path']}` |" not in contract]
    wanted[SCHEMA] = report_schema(tables)
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
