"""Ctrl-C while the command `robocell` is being loaded ends it at once, without a traceback.

Loading takes tenths of a second, and nothing has been begun then. Only for the command: a program
that imports robocell keeps its own handling. `__main__` switches back.

The command looks for modules in the working folder last, since it needs many of them itself.
"""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

_quiet = False


def is_command(arguments: list[str]) -> bool:
    """Whether this process is `robocell ...` or `python -m robocell ...`, by its command line."""
    rest = iter(arguments)
    if Path(next(rest, "")).name == "robocell":
        return True
    # The interpreter's options come before what it runs: -m and a module, -c, or a script.
    for argument in rest:
        if argument == "-m":
            return next(rest, "") == "robocell"
        if argument in ("-X", "-W"):
            next(rest, "")
        elif not argument.startswith("-"):
            return Path(argument).name == "robocell"
    return False


def be_quiet() -> None:
    """From now on Ctrl-C ends the process."""
    global _quiet
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        _quiet = True


def hear_again() -> None:
    """From now on Ctrl-C is a KeyboardInterrupt again."""
    global _quiet
    if _quiet:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        _quiet = False


def look_here_last() -> None:
    """Moves the working folder to the end of the path.

    `python -m robocell` puts it first, where a `random.py` would be taken for Python's.
    """
    try:
        here = os.getcwd()
    except OSError:  # the folder was deleted
        here = ""
    if sys.path and sys.path[0] in ("", here):
        sys.path.append(sys.path.pop(0))


if is_command(sys.orig_argv):
    be_quiet()
    look_here_last()
