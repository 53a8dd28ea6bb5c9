#!/usr/bin/env python3
"""Checks that the C++ of a page is that of the examples, which are compiled and run.

    snippets.py docs/library.md

Each fenced block of `cpp` must be consecutive lines of one file of examples/, but for indentation.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def stripped(text):
    return [line.strip() for line in text.strip("\n").splitlines()]


def is_part(lines, of):
    return any(of[k:k + len(lines)] == lines for k in range(len(of) - len(lines) + 1))


def main():
    examples = [stripped(path.read_text()) for path in sorted((ROOT / "examples").glob("*.cc"))]
    failed = 0
    for page in sys.argv[1:]:
        text = (ROOT / page).read_text()
        blocks = re.findall(r"^```cpp\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
        for block in blocks:
            if not any(is_part(stripped(block), example) for example in examples):
                print(f"{page}: in no example:\n{block}")
                failed += 1
        for name in re.findall(r"\]\(\.\./(examples/\w+\.cc)\)", text):
            if not (ROOT / name).exists():
                print(f"{page}: there is no {name}")
                failed += 1
        listed = set(re.findall(r"examples/(\w+\.cc)", text))
        for path in (ROOT / "examples").glob("*.cc"):
            if path.name not in listed:
                print(f"{page}: does not list examples/{path.name}")
                failed += 1
        print(f"{page}: {len(blocks)} snippets")
        if not blocks:
            failed += 1
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
