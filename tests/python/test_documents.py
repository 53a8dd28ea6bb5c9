"""The examples of docs/python.md print what the page shows, and that of examples/python works.

Blocks of ```python run one after the other, in one namespace, beside a copy of data/; what follows
in ```text is all that they print.
To write what is printed today into the page: MINDAHL_UPDATE_DOCS=1, and review the diff.
"""

import contextlib
import io
import os
import re
import shutil
import subprocess
import sys

import matplotlib

from conftest import SOURCE

matplotlib.use("Agg")
PAGE = SOURCE / "docs" / "python.md"
BLOCK = re.compile(r"```(python|text)\n(.*?)```\n", re.S)


def run_page(text):
    """The page with what its examples print, and how many examples it has."""
    namespace = {}
    printed = ""
    count = 0

    def run(block):
        nonlocal printed, count
        kind, body = block.groups()
        if kind == "text":
            return f"```text\n{printed}```\n"
        count += 1
        with contextlib.redirect_stdout(io.StringIO()) as stream:
            exec(compile(body, f"{PAGE.name}, example {count}", "exec"), namespace)
        printed = stream.getvalue()
        return block.group(0)

    return BLOCK.sub(run, text), count


def test_examples_print_what_the_page_shows(tmp_path, monkeypatch):
    shutil.copytree(SOURCE / "data", tmp_path / "data")
    monkeypatch.chdir(tmp_path)
    shown = PAGE.read_text(encoding="utf-8")
    page, count = run_page(shown)
    if os.environ.get("MINDAHL_UPDATE_DOCS"):
        PAGE.write_text(page, encoding="utf-8")
    assert count >= 8
    assert page == shown


def test_example_writes_a_report(tmp_path):
    words = [sys.executable, str(SOURCE / "examples" / "python" / "from_csv_to_report.py"),
             str(SOURCE / "data" / "mindlin_sphere_on_plane.csv"), str(tmp_path / "report.html")]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "the model is adequate" in done.stdout
    assert "<figure" in (tmp_path / "report.html").read_text(encoding="utf-8")
