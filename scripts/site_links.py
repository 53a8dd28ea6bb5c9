"""Hooks of mkdocs: links to files of the tree that are no pages, ../examples/fit_record.cc, become
text; the C++ reference is made by Doxygen, where it is there; no link leads nowhere."""
import os
import pathlib
import re
import shutil
import subprocess

from mkdocs.exceptions import BuildError
from mkdocs.structure.nav import Link

REFERENCE = "api/html/index.html"


def on_page_markdown(markdown, **_):
    return re.sub(r"\[([^\]]*)\]\(\.\./[^)]*\)", r"\1", markdown)


def on_nav(nav, **_):
    if shutil.which("doxygen"):
        nav.items.append(Link("C++ reference", REFERENCE))
    return nav


def on_post_build(config, **_):
    site = pathlib.Path(config["site_dir"])
    if shutil.which("doxygen"):
        (site / "api").mkdir(exist_ok=True)
        subprocess.run(["doxygen"], cwd=pathlib.Path(config["docs_dir"]).parent, check=True,
                       env={**os.environ, "MINDAHL_API": str(site / "api")})
    for page in site.glob("*.html"):
        for link in re.findall(r'(?:src|href)="([^"#?:]+)["#?]', page.read_text(encoding="utf-8")):
            place = site / link.lstrip("/") if link.startswith("/") else page.parent / link
            if not place.exists():
                raise BuildError(f"{page.name}: {link} leads nowhere")
