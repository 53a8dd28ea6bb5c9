"""The options of mindahl and of each of its commands, read from their own help."""

import dataclasses
import re
import subprocess

COLUMN = 30  # where descriptions begin


@dataclasses.dataclass
class Option:
    name: str              # --model
    short: str = ""        # -m
    taken: str = ""        # "TEXT:{a,b}=a", "FILE", "" of a flag
    description: list = dataclasses.field(default_factory=list)  # lines

    @property
    def text(self):
        return " ".join(self.description)


@dataclasses.dataclass
class Help:
    command: str                       # "" of the program itself
    description: list                  # lines before the usage
    usage: str = ""
    takes_files: bool = False
    groups: list = dataclasses.field(default_factory=list)  # (title, options)
    commands: list = dataclasses.field(default_factory=list)  # names, of the program
    examples: list = dataclasses.field(default_factory=list)  # whole commands
    closing: list = dataclasses.field(default_factory=list)  # lines

    @property
    def options(self):
        return [option for _, options in self.groups for option in options]


def option_of(line):
    """The option that a line of help begins, or None."""
    match = re.match(r"  (?:(-\w),)?(--[a-z][a-z0-9-]*) ?(.*)", line)
    if not match:
        return None
    short, name, rest = match.groups()
    # A head that is too long for its column has the description on the next lines.
    related = re.search(r" ?\b(Excludes|Needs):( --[a-z0-9-]+)+", rest)
    if related:
        words = re.sub(r"^( ?(Excludes|Needs):( --[a-z0-9-]+)+)+", "", rest[related.start():])
        return Option(name, short or "", rest[:related.start()].strip(),
                      [words.strip()] if words.strip() else [])
    if len(line) > COLUMN and line[COLUMN - 1] == " " != line[COLUMN]:
        taken = line[:COLUMN].strip().partition(" ")[2]
        return Option(name, short or "", taken, [line[COLUMN:]])
    return Option(name, short or "", rest.strip())


def parse(command, text):
    lines = text.splitlines()
    begin = next(i for i, line in enumerate(lines) if line.startswith("Usage: "))
    found = Help(command, lines[:begin], lines[begin].removeprefix("Usage: "))
    title = None
    for line in lines[begin + 1:]:
        heading = re.fullmatch(r"([A-Z][^:]*):", line)
        if heading:
            title = heading.group(1)
            if title not in ("Positionals", "Subcommands", "Examples"):
                found.groups.append((title, []))
        elif not line:
            continue
        elif not line.startswith(" "):
            title = None
            found.closing.append(line)
        elif title == "Positionals":
            found.takes_files |= " FILE" in line
        elif title == "Subcommands":
            if line[2] != " ":
                found.commands.append(line.split()[0])
        elif title == "Examples":
            if line.startswith("  mindahl"):
                found.examples.append(line.strip())
            else:
                found.examples[-1] = found.examples[-1].removesuffix("\\") + line.strip()
        elif title is not None:
            option = option_of(line)
            if option:
                found.groups[-1][1].append(option)
            elif line.startswith(" " * COLUMN) and found.groups[-1][1]:
                found.groups[-1][1][-1].description.append(line.strip())
    found.groups = [(title, options) for title, options in found.groups if options]
    return found


def texts_of(program):
    """The help text of the program itself, under "", and of every command that it lists."""
    def run(*words):
        return subprocess.run([program, *words], check=True, capture_output=True,
                              encoding="utf-8").stdout
    texts = {"": run("--help")}
    for command in parse("", texts[""]).commands:
        texts[command] = run(command, "--help-all")
    return texts

