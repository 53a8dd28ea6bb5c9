#!/usr/bin/env python3
"""Colours are for terminals that have them: asked of the program on a pseudo-terminal and in a pipe.

usage: colours.py --program PATH --record FILE

Exits with 77 where no pseudo-terminal is mounted.
"""
import argparse
import os
import pty
import subprocess
import sys

SKIPPED = 77

ESCAPE = b"\x1b["


def on_terminal(command, **changed):
    """What the program writes to a terminal."""
    environment = {key: value for key, value in os.environ.items() if key != "NO_COLOR"}
    environment.update(TERM="xterm")
    environment.update(changed)
    ours, its = pty.openpty()
    process = subprocess.Popen(command, stdout=its, stderr=subprocess.DEVNULL, env=environment)
    os.close(its)
    written = b""
    try:
        while piece := os.read(ours, 65536):
            written += piece
    except OSError:  # the program has ended
        pass
    os.close(ours)
    assert process.wait() == 0
    return written


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True)
    parser.add_argument("--record", required=True)
    arguments = parser.parse_args()
    command = [arguments.program, "fit", arguments.record]
    try:
        for end in pty.openpty():
            os.close(end)
    except OSError as error:
        print(f"skipped: this machine has no pseudo-terminal mounted (/dev/pts): {error}")
        sys.exit(SKIPPED)
    plain = subprocess.run(command, check=True, stdout=subprocess.PIPE,
                           stderr=subprocess.DEVNULL).stdout
    assert ESCAPE not in plain, "colours in a pipe"
    assert ESCAPE in on_terminal(command), "no colours on a terminal"
    for changed in ({"NO_COLOR": "1"}, {"TERM": "dumb"}):
        written = on_terminal(command, **changed)
        assert ESCAPE not in written, f"colours in spite of {changed}"
        assert written.replace(b"\r\n", b"\n") == plain, f"another text with {changed}"


if __name__ == "__main__":
    main()
