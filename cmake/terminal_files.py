#!/usr/bin/env python3
"""Writes the manual page and the completions of bash and zsh from the program's own help.

    terminal_files.py --program build/dev/src/mindahl --directory DIRECTORY

makes mindahl.1, mindahl.1.gz, mindahl.bash and _mindahl there.
"""

import argparse
import gzip
import pathlib
import re
import subprocess
import textwrap

import command_help


# --- manual page ---------------------------------------------------------------------------------

def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^([.'])", r"\\&\1", text)


def roff_paragraphs(lines):
    return [roff(line) for line in textwrap.wrap(" ".join(lines), 90, break_on_hyphens=False,
                                                 break_long_words=False)]


def roff_option(option):
    names = ", ".join(f"\\fB{roff(name)}\\fR" for name in (option.short, option.name) if name)
    argument = f" \\fI{roff(option.argument)}\\fR" if option.argument else ""
    page = [".TP", names + argument, *roff_paragraphs(option.description)]
    remarks = []
    if option.choices:
        remarks.append(f"One of {', '.join(option.choices)}.")
    if option.default:
        remarks.append(f"Default {option.default}.")
    if option.is_required:
        remarks.append("Needed.")
    if option.is_repeatable:
        remarks.append("May be given more than once.")
    return page + ([".br", *roff_paragraphs(remarks)] if remarks else [])


def roff_example(command):
    """Unfilled; long ones broken where an option begins."""
    lines = [""]
    for word in re.split(r" (?=-)", command):
        if lines[-1] and len(lines[-1]) + len(word) > 66:
            lines[-1] += " \\"
            lines.append("    " + word)
        else:
            lines[-1] += (" " if lines[-1] else "") + word
    return [".PP", ".nf", ".RS 4", *map(roff, lines), ".RE", ".fi"]


def manual_page(helps, version):
    program, commands = helps[0], helps[1:]
    page = [
        f'.TH MINDAHL 1 "" "mindahl {version}" "User Commands"',
        ".SH NAME",
        roff("mindahl - friction parameters of a contact from its measured hysteresis loop"),
        ".SH SYNOPSIS",
        "\\fBmindahl\\fR \\fICOMMAND\\fR [\\fIOPTION\\fR]... [\\fIFILE\\fR]...",
        ".SH DESCRIPTION",
        *roff_paragraphs(program.description),
        ".SH COMMANDS",
    ]
    for command in commands:
        page += [".TP", f"\\fBmindahl {command.command}\\fR", *roff_paragraphs(command.description)]
    page += [".SH OPTIONS OF EVERY COMMAND"]
    for option in program.options:
        page += roff_option(option)
    for command in commands:
        page += [f".SH MINDAHL {command.command.upper()}",
                 f"\\fBmindahl {command.command}\\fR [\\fIOPTION\\fR]..."
                 + (" \\fIFILE\\fR..." if command.takes_files else ""),
                 ".PP", *roff_paragraphs(command.description)]
        for title, options in command.groups:
            options = [option for option in options if option.name != "--help"]
            if not options:
                continue
            if title != "Options":
                page.append(f'.SS "{roff(title)}"')
            for option in options:
                page += roff_option(option)
        page += ['.SS "Examples"']
        for example in command.examples:
            page += roff_example(example)
    page += [".SH CONFIGURATION", *roff_paragraphs(program.closing[:1])]
    page += [".SH EXIT STATUS"]
    for status, meaning in [
            ("0", "done"), ("1", "internal error: please report it"),
            ("2", "bad usage or bad input; one line says what and where"),
            ("3", "ran, but not established: not converged, not identifiable with --strict, a "
                  "validation that failed, or nothing that meets what is asked")]:
        page += [".TP", f"\\fB{status}\\fR", *roff_paragraphs([meaning])]
    return "\n".join(page) + "\n"


# --- bash ----------------------------------------------------------------------------------------

def bash_completion(helps):
    program = helps[0]
    shared = [option for option in program.options if option.name != "--version"]
    files, choices, others, names = [], [], [], []  # others: a value of which nothing is known
    for found in helps:
        options = found.options + (shared if found.command else [])
        place = found.command or "-"
        listed = dict.fromkeys(name for option in options for name in (option.short, option.name)
                               if name)
        names.append((place, " ".join(listed)))
        for option in dict((option.name, option) for option in options).values():
            for name in filter(None, (option.short, option.name)):
                if option.choices:
                    choices.append((f"{place}:{name}", " ".join(option.choices)))
                elif option.takes_file:
                    files.append(f"{place}:{name}")
                elif option.argument:
                    others.append(f"{place}:{name}")
    takers = [found.command for found in helps if found.takes_files]
    either = " | \\\n      "
    rows = "\n".join(f"    {key}) words='{words}' ;;" for key, words in choices)
    tables = "\n".join(f"    {place}) words='{words}' ;;" for place, words in names)
    return f"""# Completion of mindahl for bash, made from the program's own help.

_mindahl()
{{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}}
  local command=- words='' i
  COMPREPLY=()
  # --option=value arrives as three words.
  if [[ $current == = ]]; then
    current=''
  elif [[ $previous == = ]]; then
    previous=${{COMP_WORDS[COMP_CWORD-2]}}
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case ${{COMP_WORDS[i]}} in
      --config) ((++i)) ;;
      -*) ;;
      *) command=${{COMP_WORDS[i]}}; break ;;
    esac
  done
  case "$command:$previous" in
{rows}
    {either.join(files)})
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -f -- "$current")
      return ;;
    {either.join(others)})
      return ;;
  esac
  if [[ -z $words && $current == -* ]]; then
    case $command in
{textwrap.indent(tables, '  ')}
    esac
  elif [[ -z $words && $command == - ]]; then
    words='{' '.join(program.commands)}'
  elif [[ -z $words ]]; then
    case $command in
      {' | '.join(takers)})
        compopt -o filenames 2>/dev/null
        mapfile -t COMPREPLY < <(compgen -f -- "$current") ;;
    esac
    return
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}}

complete -F _mindahl mindahl
"""


# --- zsh -----------------------------------------------------------------------------------------

def zsh_quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def zsh_text(lines, longest=70):
    """One line of a description, without what _arguments reads as its own."""
    text = textwrap.shorten(" ".join(lines), longest, placeholder=" ...")
    return re.sub(r"([\[\]\\:])", r"\\\1", text)


def zsh_option(option):
    if option.choices:
        action = f":{option.argument.lower()}:({' '.join(option.choices)})"
    elif option.takes_file:
        action = f":{option.argument.lower()}:_files"
    elif option.argument:
        action = f":{zsh_text([option.argument])}: "
    else:
        action = ""
    repeat = "*" if option.is_repeatable else ""
    return [zsh_quoted(f"{repeat}{name}[{zsh_text(option.description)}]{action}")
            for name in (option.short, option.name) if name]


def zsh_completion(helps):
    program, commands = helps[0], helps[1:]
    shared = [spec for option in program.options if option.name == "--config"
              for spec in zsh_option(option)]
    listed = "\n".join("    " + zsh_quoted(f"{command.command}:{zsh_text(command.description)}")
                       for command in commands)
    cases = []
    for command in commands:
        specs = [spec for option in command.options for spec in zsh_option(option)] + shared
        if command.takes_files:
            specs.append(zsh_quoted("*:record:_files"))
        cases.append(f"    {command.command})\n      _arguments \\\n        "
                     + " \\\n        ".join(specs) + " ;;")
    newline = "\n"
    return f"""#compdef mindahl
# Completion of mindahl for zsh, made from the program's own help.

_mindahl() {{
  local curcontext="$curcontext" state line
  local -a commands
  commands=(
{listed}
  )
  _arguments -C \\
    {(' ' + chr(92) + newline + '    ').join(spec for option in program.options
                                             for spec in zsh_option(option))} \\
    '1:command:->command' \\
    '*::argument:->argument' && return
  if [[ $state == command ]]; then
    _describe -t commands command commands
    return
  fi
  case $words[1] in
{newline.join(cases)}
  esac
}}

_mindahl "$@"
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--directory", required=True, type=pathlib.Path)
    arguments = parser.parse_args()
    helps = command_help.helps_of(arguments.program)
    version = subprocess.run([arguments.program, "--version"], check=True, capture_output=True,
                             text=True).stdout.strip()
    arguments.directory.mkdir(parents=True, exist_ok=True)
    page = manual_page(helps, version).encode()
    (arguments.directory / "mindahl.1").write_bytes(page)
    # Without name and time: the same help makes the same bytes.
    (arguments.directory / "mindahl.1.gz").write_bytes(gzip.compress(page, 9, mtime=0))
    (arguments.directory / "mindahl.bash").write_text(bash_completion(helps), encoding="utf-8")
    (arguments.directory / "_mindahl").write_text(zsh_completion(helps), encoding="utf-8")


if __name__ == "__main__":
    main()
