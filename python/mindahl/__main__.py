"""The program, as `mindahl` and `python -m mindahl`."""

import signal
import sys

from ._mindahl import run_program


def main() -> int:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # the program's own end
    return run_program(["mindahl", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
