"""Writes what type checkers know of the sections of a fit, from the schema of its JSON.

usage: sections.py docs/schema/fit.json _sections.pyi
"""
import json
import sys

TYPES = {"string": "str", "integer": "int", "number": "float", "boolean": "bool"}


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        schema = json.load(file)
    classes = {}

    def type_of(node, name):
        node = schema["$defs"][node["$ref"].rsplit("/")[-1]] if "$ref" in node else node
        choices = node.get("anyOf", [{**node, "type": kind} for kind in node["type"]]
                           if isinstance(node.get("type"), list) else [])
        if choices:
            kind, = (type_of(choice, name) for choice in choices if choice["type"] != "null")
            return f"Optional[{kind}]"
        if "enum" in node:
            return "Optional[str]" if None in node["enum"] else "str"
        if node["type"] == "array":
            return f"tuple[{type_of(node['items'], name)}, ...]"
        if node["type"] != "object":
            return TYPES[node["type"]]
        members = node.get("properties") or {
            key: node["additionalProperties"] for key in node.get("propertyNames", {}).get("enum", [])}
        if not members:
            return "AnySection"
        classes[name] = [f"    {key}: {type_of(value, f'{name}_{key}')}" for key, value in members.items()]
        return name

    for name, node in schema["properties"].items():
        if node.get("type") in ("object", "array") or "anyOf" in node:
            type_of(node, name)
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write("from typing import Optional\n\nfrom ._result import AnySection, Section\n")
        for name, lines in classes.items():
            file.write("\n".join([f"\nclass {name}(Section):", *lines, ""]))


if __name__ == "__main__":
    main()
