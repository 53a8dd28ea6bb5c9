#!/usr/bin/env python3
"""Finds docstrings without a verb and words that only this project's authors understand.

    scripts/check-words.py           fails if there are more of them than the limits below allow
    scripts/check-words.py --all     lists every one, also within the limits
    scripts/check-words.py --count   prints the number and the limit of each

A docstring (/// or //!) is a sentence that begins with its verb: "Returns", "Fits", "True if". The
words, and what to write instead, are in the table "Words" of CONTRIBUTING.md; this file has their
spellings and their standard uses, which are not counted. Each limit is the number that is left,
rounded up to the next multiple of five: lower it when that allows it, never raise it.
"""
import argparse
import collections
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

# The first words of a fragment. The eight of VERBLESS have one limit together; what trails a member
# may begin with one of OTHER_OPENERS.
VERBLESS = {"of", "what", "does", "is", "as", "by", "where", "that"}
VERBLESS_LIMIT = 5
OTHER_OPENERS = {"likewise", "and", "or", "from", "with", "than"}
OTHER_OPENERS_LIMIT = 5

# Each word of the table in CONTRIBUTING.md: its spellings, its standard uses with the words around
# it, which are not counted, and the limit.
Word = collections.namedtuple("Word", "spelling allowed limit")
WORDS = {
    "departure": Word(r"departures?", r"", 5),
    "cause": Word(r"causes?(?= (?:of|that|which) (?:departure|misfit|discrepanc))", r"", 5),
    "irregularity": Word(r"irregularit(?:y|ies)", r"", 5),
    "the past": Word(r"(?:the|its|their|a|no|virgin|unknown|undecided) pasts?",
                     r"in the past", 5),
    "rival": Word(r"rivals?", r"", 5),
    # The origin of a branch, the place where it begins, and a contact under no force are standard.
    "origin": Word(r"(?:its|the) origin",
                   r"(?:through|at|about|to|from|near|of|in|on which|and) (?:its|the) origin"
                   r"|the origins? of (?:a|the|each) branch", 5),
    "unloaded": Word(r"unloaded",
                     r"unloaded (?:and|or|then|to|from|by|at|under|contact)"
                     r"|(?:contact|elements?) (?:taken as |that )?unloaded|unloaded displacement"
                     r"|(?:is|was|are|be|an|starts?|started|had been) (?:not )?unloaded",
                     5),
    "share": Word(r"(?:a|the|its|this|largest|smallest|least|that|what) share|shares? of",
                  r"", 5),
    "course": Word(r"courses?", r"of course", 5),
    "stretch": Word(r"stretch(?:es)?", r"", 5),
    "tell": Word(r"tells?|told|untold|telling", r"tells? (?:the user|users|CMake|git)", 35),
    "sense": Word(r"senses?", r"makes? (?:no )?sense", 20),
    "mend": Word(r"mend(?:s|ed|ing)?", r"", 5),
    "the way": Word(r"the way(?: (?:between|from|to|of|gone|that)\b)|way between samples",
                    r"", 10),
    "beside": Word(r"beside", r"", 35),
    "gives way": Word(r"(?:gives?|gave|giving) way", r"", 10),
    "goes by": Word(r"(?:goes|go|went|gone|going) by", r"", 5),
    "no account of": Word(r"no account of", r"", 5),
    "remark": Word(r"remarks?", r"", 5),
    "widening": Word(r"widening|covering", r"", 5),
    "free of": Word(r"free of(?= (?:the |these |those )?(?:columns?|model|others?))", r"", 5),
}

TOKEN = re.compile(
    r'//(?P<comment>[^\n]*)|/\*(?P<block>.*?)\*/|R"(?P<mark>\w*)\((?P<raw>.*?)\)(?P=mark)"'
    r'''|"(?P<string>(?:\\.|[^"\\\n])*)"|'(?:\\.|[^'\\\n])+\'''', re.S)


def tracked(*patterns):
    """Returns the project's files that match the patterns of git, as paths relative to its root."""
    listed = subprocess.run(["git", "ls-files", "-z", *patterns], cwd=ROOT, check=True,
                            stdout=subprocess.PIPE).stdout.decode()
    return [name for name in listed.split("\0") if name]


def remedies():
    """Returns what to write instead of each word, from the table of CONTRIBUTING.md."""
    rows = {}
    inside = False
    for line in (ROOT / "CONTRIBUTING.md").read_text().splitlines():
        if line.startswith("| instead of"):
            inside = True
        elif inside and not line.startswith("|"):
            break
        elif inside and not line.startswith("|---"):
            words, remedy = [cell.strip() for cell in line.strip("|").split("|")]
            for word in words.split(", "):
                rows[word] = remedy
    return rows


def docstrings(lines):
    """Yields line number and text of each docstring's first line, and if it trails a member."""
    continued = ""
    for number, line in enumerate(lines, 1):
        found = re.match(r"(?P<code>.*?)(?<![/:])//[/!](?P<trailing><?)(?:\s+(?P<text>.*))?$", line)
        if not found:
            continued = ""
            continue
        kind = "<" if found["trailing"] else "/"
        if found["code"].strip() or kind != continued:
            yield number, found["text"] or "", kind == "<"
        continued = kind


def prose_of_source(text):
    """Yields offset and text of each comment and of each string literal of more than one word."""
    for token in TOKEN.finditer(text):
        for group in ("comment", "block", "raw", "string"):
            found = token[group]
            if found and (group in ("comment", "block") or " " in found.strip()):
                yield token.start(group), re.sub(r"`[^`\n]*`", lambda m: " " * len(m[0]), found)


def prose_of_page(text):
    """Yields the text of a page of docs with its code, and the table of words itself, blanked."""
    def blank(found):
        return re.sub(r"[^\n]", " ", found[0])

    text = re.sub(r"^\| instead of.*?(?=^[^|])", blank, text, flags=re.S | re.M)
    text = re.sub(r"^```.*?^```", blank, text, flags=re.S | re.M)
    text = re.sub(r"^    .*$", blank, text, flags=re.M)
    yield 0, re.sub(r"`[^`\n]*`", blank, text)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--all", action="store_true", help="list also what is within the limits")
    parser.add_argument("--count", action="store_true", help="print the counts and limits only")
    options = parser.parse_args()

    remedy = remedies()
    if set(remedy) != set(WORDS):
        sys.exit("CONTRIBUTING.md and scripts/check-words.py differ in the words "
                 + ", ".join(sorted(set(remedy) ^ set(WORDS))))
    patterns = {word: (re.compile(rf"(?<![\w-])(?:{entry.spelling})(?![\w-])", re.I),
                       re.compile(rf"(?<![\w-])(?:{entry.allowed})(?![\w-])", re.I)
                       if entry.allowed else None)
                for word, entry in WORDS.items()}
    any_word = re.compile("|".join(rf"(?:{entry.spelling})" for entry in WORDS.values()), re.I)

    hits = collections.defaultdict(list)
    sources = tracked("include/*.h", "src/*.h", "src/*.cc")
    pages = [page for page in tracked("*.md") if page != "CHANGELOG.md"]
    for name in sources + pages:
        text = (ROOT / name).read_text()
        if name in sources:
            for number, sentence, is_trailing in docstrings(text.split("\n")):
                first = re.match(r"(?:\[[^]]*\])?\W*(\w+)", sentence)  # behind a unit in brackets
                opener = first[1].lower() if first else ""
                if opener in VERBLESS:
                    hits["docstring without a verb"].append((name, number, first[1]))
                elif opener in OTHER_OPENERS and not is_trailing:
                    hits["docstring that continues another"].append((name, number, first[1]))
        for offset, prose in prose_of_source(text) if name in sources else prose_of_page(text):
            if not any_word.search(prose):
                continue
            for word, (spelling, allowed) in patterns.items():
                standard = [m.span() for m in allowed.finditer(prose)] if allowed else []
                for found in spelling.finditer(prose):
                    if not any(a < found.end() and found.start() < b for a, b in standard):
                        number = text.count("\n", 0, offset + found.start()) + 1
                        hits[word].append((name, number, found[0]))

    limits = {"docstring without a verb": VERBLESS_LIMIT,
              "docstring that continues another": OTHER_OPENERS_LIMIT,
              **{word: entry.limit for word, entry in WORDS.items()}}
    remedy["docstring without a verb"] = 'begin with a verb: "Returns", "Fits", "True if"'
    remedy["docstring that continues another"] = "say it in a sentence of its own"
    failed = False
    for kind, limit in limits.items():
        over = len(hits[kind]) > limit
        failed |= over
        if options.count:
            print(f"{len(hits[kind]):5} of at most {limit:5}  {kind}")
        elif options.all or over:
            for name, number, found in hits[kind]:
                print(f"{name}:{number}: {' '.join(found.split())}: {remedy[kind]}")
            if over:
                print(f"{kind}: {len(hits[kind])}, at most {limit} are allowed", file=sys.stderr)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
