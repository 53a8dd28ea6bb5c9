#!/usr/bin/env python3
"""Opens the pages that the program writes in headless Chromium, wide and narrow, light and dark.

    browser_test.py --program build/ci/src/mindahl [--quick]

--quick: of two of the pages, wide and light, narrow and dark.

Exit status 77, skipped, where there is no chromium. Of each page: no message of the console and no
request, which the page's own policy would make a message; every figure has an area and lies within
the page; nothing scrolls sideways at 1366 nor at 400 px; text has a contrast of 4.5 to its ground,
in the light and in the dark scheme; headings are in order, and names of files are text. As it is printed, by a reader whose scheme is dark: on white,
with the same contrast, as wide as the paper, no figure parted, and on few sheets.
"""

import argparse
import html
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = ROOT / "data"
WIDTHS = (1366, 400)
LEAST_CONTRAST = 4.5  # WCAG 2.2, 1.4.3, of text of the usual size
LEAST_SIDE = 40       # px: a figure less wide or high than that shows nothing
MOST_BYTES = 2_000_000
PAPER = 718           # px: A4 between margins of 1 cm, at 96 px an inch
MOST_SHEETS = 5       # of A4
FIRST_SCREEN = 768    # px: what a laptop shows of a page of 1366 px without scrolling

# Put into a copy of the page, whose policy then allows scripts: it writes what it finds as text.
PROBE = r"""
<script>
addEventListener('load', () => {
  const found = {};
  found.scroll = document.documentElement.scrollWidth;
  found.width = innerWidth;
  found.figures = [...document.querySelectorAll('figure')].map(figure => {
    const drawn = figure.querySelector('svg.plot');
    const box = drawn.getBoundingClientRect();
    const marks = drawn.querySelectorAll('.line,.dots,.bars,.marker,.area,.interval');
    const ids = (drawn.getAttribute('aria-labelledby') || '').split(' ');
    return {id: figure.id, width: box.width, height: box.height, left: box.left, right: box.right,
            marks: marks.length, inked: [...marks].some(mark => {
              const inked = mark.getBoundingClientRect(); return inked.width + inked.height > 4;}),
            named: ids.length > 1 && ids.every(id => document.getElementById(id)?.textContent)};
  });
  const channels = text => text.match(/[\d.]+/g).map(Number);
  const luminance = ([r, g, b]) => [r, g, b].map(c => c / 255)
      .map(c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
      .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  const ground = element => {
    for (; element; element = element.parentElement) {
      const colour = channels(getComputedStyle(element).backgroundColor);
      if (colour.length === 3 || colour[3] === 1) return colour;
    }
    return [255, 255, 255];
  };
  found.contrasts = [...document.querySelectorAll('body *')].filter(element =>
      !['title', 'desc'].includes(element.tagName) &&
      [...element.childNodes].some(node => node.nodeType === 3 && node.data.trim())).map(element => {
    const style = getComputedStyle(element);
    const colour = element instanceof SVGElement ? style.fill : style.color;
    const [a, b] = [luminance(channels(colour)), luminance(ground(element))].sort((x, y) => y - x);
    return [(a + 0.05) / (b + 0.05), element.tagName + ' ' + element.textContent.slice(0, 30)];
  }).sort((a, b) => a[0] - b[0]).slice(0, 3);
  found.headings = [...document.querySelectorAll('h1,h2,h3')].map(heading => +heading.tagName[1]);
  const bottom = id => document.getElementById(id)?.getBoundingClientRect().bottom ?? 0;
  found.first = Math.max(bottom('intervals'),
                         document.querySelector('.verdict')?.getBoundingClientRect().bottom ?? 0);
  found.scripts = document.querySelectorAll('script').length;
  found.cells = [...document.querySelectorAll('th')].every(cell => cell.scope);
  found.ground = getComputedStyle(document.body).backgroundColor;
  found.parted = [...document.querySelectorAll('figure,tr,pre')].filter(element =>
      getComputedStyle(element).breakInside !== 'avoid').length;
  const said = document.createElement('pre');
  said.id = 'found';
  said.textContent = JSON.stringify(found);
  document.body.append(said);
});
</script>
"""


class Failure(Exception):
    pass


def require(condition, message):
    if not condition:
        raise Failure(message)


def run_program(program, *arguments, statuses=(0,)):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    require(done.returncode in statuses, f"mindahl {' '.join(map(str, arguments))}: "
            f"status {done.returncode}: {done.stderr}")


def chromium(browser, scratch, *flags):
    """What it writes to standard output and to standard error."""
    profile = tempfile.mkdtemp(dir=scratch)
    done = subprocess.run(
        [browser, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
         "--no-first-run", "--disable-background-networking", "--hide-scrollbars",
         f"--user-data-dir={profile}", "--enable-logging=stderr", "--v=0", *flags],
        capture_output=True, text=True, check=False, timeout=120)
    shutil.rmtree(profile, ignore_errors=True)
    return done.stdout, done.stderr


def console_messages(log):
    return [line for line in log.splitlines() if "CONSOLE" in line]


def flags_of(width, dark):
    # Chromium has no window narrower than 500 px; a frame of the width stands for the phone.
    return [f"--window-size={max(width, 500)},900",
            *(["--blink-settings=preferredColorScheme=0"] if dark else [])]


def framed(page, width, scratch):
    """The page in a frame of that width, where the window cannot be as narrow."""
    frame = scratch / f"frame-{page.name}"
    frame.write_text(f'<!DOCTYPE html><title>frame</title><body style="margin:0"><iframe '
                     f'src="{page.name}" style="border:0;width:{width}px;height:30000px"></iframe>',
                     encoding="utf-8")
    return frame


def probe(browser, page, width, dark, scratch, printed=False):
    text = page.read_text(encoding="utf-8")
    if printed:
        require("@media print{" in text, f"{page.name}: says nothing of print")
        # Of paper no rule of a screen holds.
        text = text.replace("@media print{", "@media all{").replace("@media screen and", "@media not all and")
    policy = re.search(r'content="(default-src[^"]*)"', text)
    require(policy and "default-src 'none'" in policy.group(1), f"{page.name}: no policy")
    probed = scratch / f"probe-{page.stem.replace('<', '_').replace('>', '_')}.html"
    said = PROBE
    if width < 500:
        said = said.replace("document.body.append(said);",
                            "document.body.append(said); parent.postMessage(said.textContent, '*');")
    probed.write_text(text.replace(policy.group(1), policy.group(1) + "; script-src 'unsafe-inline'")
                      .replace("</head>", said + "</head>"), encoding="utf-8")
    target = probed
    if width < 500:
        target = framed(probed, width, scratch)
        listener = ("<script>addEventListener('message', event => {const said = "
                    "document.createElement('pre'); said.id = 'found'; said.textContent = "
                    "event.data; document.body.append(said);});</script>")
        target.write_text(target.read_text(encoding="utf-8").replace("<body", listener + "<body"),
                          encoding="utf-8")
    out, log = chromium(browser, scratch, *flags_of(width, dark), "--virtual-time-budget=3000",
                        "--dump-dom", target.as_uri())
    require(not console_messages(log), f"{page.name}: {console_messages(log)}")
    found = re.search(r'<pre id="found">(.*?)</pre>', out, re.DOTALL)
    require(found, f"{page.name} at {width} px: the probe said nothing")
    return json.loads(html.unescape(found.group(1)))


def check_print(browser, page, scratch):
    found = probe(browser, page, PAPER, True, scratch, printed=True)
    where = f"{page.name} in print"
    require(found["ground"] == "rgb(255, 255, 255)", f"{where}: on {found['ground']}")
    require(found["scroll"] <= PAPER, f"{where}: {found['scroll']} px wide")
    require(found["contrasts"][0][0] >= LEAST_CONTRAST, f"{where}: {found['contrasts'][0]}")
    require(found["parted"] == 0, f"{where}: {found['parted']} figures, rows or commands may be parted")
    paper = scratch / f"{page.stem.replace('<', '_').replace('>', '_')}.pdf"
    chromium(browser, scratch, *flags_of(1366, True), "--no-pdf-header-footer",
             f"--print-to-pdf={paper}", page.as_uri())
    sheets = len(re.findall(rb"/Type\s*/Page\b", paper.read_bytes()))
    require(0 < sheets <= MOST_SHEETS, f"{where}: {sheets} sheets")


def check(browser, page, figures, scratch, looks):
    require(page.stat().st_size < MOST_BYTES, f"{page.name}: {page.stat().st_size} bytes")
    text = page.read_text(encoding="utf-8")
    require("<script" not in text, f"{page.name}: has a script")
    require(not re.search(r'(?:src|href)="(?!data:|[\w.%-]+\.html")', text),
            f"{page.name}: loads something")
    grounds = set()
    for width in WIDTHS:
        for dark in (False, True):
            if (width, dark) not in looks:
                continue
            found = probe(browser, page, width, dark, scratch)
            where = f"{page.name} at {width} px, {'dark' if dark else 'light'}"
            require(found["width"] == width, f"{where}: is {found['width']} px wide")
            require(found["scroll"] <= width, f"{where}: scrolls to {found['scroll']} px")
            ids = {figure["id"] for figure in found["figures"]}
            require(width < 500 or found["first"] <= FIRST_SCREEN, f"{where}: intervals end at {found['first']} px")
            require(figures <= ids, f"{where}: no figure {figures - ids}")
            for figure in found["figures"]:
                require(min(figure["width"], figure["height"]) >= LEAST_SIDE and figure["inked"]
                        and figure["left"] >= 0 and figure["right"] <= width and figure["named"],
                        f"{where}: {figure}")
            contrast, what = found["contrasts"][0]
            require(contrast >= LEAST_CONTRAST, f"{where}: contrast {contrast:.2f} of '{what}'")
            levels = found["headings"]
            require(levels[0] == 1 and levels.count(1) == 1 and
                    all(b <= a + 1 for a, b in zip(levels, levels[1:])), f"{where}: {levels}")
            require(found["cells"], f"{where}: a header cell without scope")
            require(found["scripts"] == 1, f"{where}: {found['scripts']} scripts, one is the test's")
            grounds.add((dark, found["ground"]))
    require(len(grounds) == 2, f"{page.name}: {grounds}")
    check_print(browser, page, scratch)
    print(f"{page.name}: {len(found['figures'])} figures")


def make_pages(program, scratch):
    """Pages with the figures that each must have."""
    always = {"loop", "residual", "intervals"}
    pages = []

    def fit(name, figures, *arguments, statuses=(0,)):
        page = scratch / f"{name}.html"
        run_program(program, "fit", *arguments, "--report", page, statuses=statuses)
        pages.append((page, always | figures))
        return page

    hostile = scratch / "<script>alert(1)<b>&.csv"
    shutil.copy(DATA / "mindlin_sphere_on_plane.csv", hostile)
    page = fit("contact", set(), hostile, "--normal-load", 50, "--youngs-modulus-1", "210e9",
               "--poisson-1", 0.3, "--radius-1", 0.01, "--youngs-modulus-2", "210e9",
               "--poisson-2", 0.3, "--radius-2", "inf")
    text = page.read_text(encoding="utf-8")
    require("&lt;script&gt;alert(1)&lt;b&gt;&amp;.csv" in text, "the name of the file is not there")
    fit("far_from_slip", set(), DATA / "far_from_slip.csv")
    fit("load_series", set(), *(DATA / f"load_series_{load}N.csv" for load in (20, 50, 120)),
        "--normal-load", "20,50,120", "--model", "mindlin")
    fit("compared", set(), DATA / "partial_slip.csv", "--compare")

    cycles = scratch / "cycles.csv"
    worn = scratch / "worn.csv"
    for path, slip_force, seed in ((cycles, 60, 1), (worn, 50, 2)):
        run_program(program, "simulate", "--sigma", "5e7", "--slip-force", slip_force, "--amplitude",
                    "2.5e-6", "--cycles", 60, "--samples-per-cycle", 100, "--noise-force", 0.5,
                    "--seed", seed, "-o", path)
    page = scratch / "track.html"
    run_program(program, "track", cycles, worn, "--output", scratch / "table.csv", "--normal-load",
                120, "--report", page)
    pages.append((page, {"loops"} | {f"evolution-{k}" for k in range(1, 6)}))

    broken = scratch / "broken.csv"
    broken.write_text("displacement [m],force [N]\n0,0\n1e-6,none\n", encoding="utf-8")
    directory = scratch / "batch"
    run_program(program, "batch", DATA / "mindlin_sphere_on_plane.csv", DATA / "far_from_slip.csv",
                hostile, broken, "--output", scratch / "batch.csv", "--report", directory,
                statuses=(3,))
    pages.append((directory / "index.html", set()))
    text = (directory / "index.html").read_text(encoding="utf-8")
    addresses = re.findall(r'href="([^"]+\.html)"', text)
    require(len(addresses) == 3, f"the index leads to {addresses}")
    for address in addresses:
        name = urllib.parse.unquote(address)
        require((directory / name).is_file(), f"the index leads to {name}, which is not there")
    return pages


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    if browser is None:
        print("skipped: there is no chromium")
        return 77
    program = os.path.abspath(options.program)
    with tempfile.TemporaryDirectory() as directory:
        scratch = pathlib.Path(directory)
        try:
            looks = {(width, dark) for width in WIDTHS for dark in (False, True)}
            pages = make_pages(program, scratch)
            if options.quick:
                looks = {(WIDTHS[0], False), (WIDTHS[1], True)}
                pages = [page for page in pages if page[0].stem in ("contact", "track")]
            for page, figures in pages:
                check(browser, page, figures, page.parent, looks)
        except Failure as failure:
            print(f"FAILED: {failure}")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
