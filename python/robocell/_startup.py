"""Ctrl-C while the command `robocell` is being loaded ends it at once, without a traceback.

Loading takes tenths of a second, and nothing has been begun then. Only for the command: a program
that imports robocell keeps its own handling. `__main__` switches back.

The command looks for modules in the working folder last, since it needs many of them itself. What
the shell closed of its standard streams (`2>&-`) is opened on nothing, or the next file that is
opened would take its place.

`python -m robocell.generate` is an error: modules do nothing by themselves, but for the tools of
robocell.compat.
"""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

COMMANDS_OF_MODULES = {
    "benchmark": "benchmark",
    "evaluate": "evaluate",
    "export": "export",
    "generate": "generate",
    "importer": "import",
}
_quiet = False


def is_command(arguments: list[str]) -> bool:
    """Returns True if this process is `robocell ...` or `python -m robocell ...`."""
    if Path(arguments[0] if arguments else "").name == "robocell":
        return True
    module, script = _what_runs(arguments)
    return module == "robocell" or Path(script).name == "robocell"


def refusal_of_module(arguments: list[str]) -> str:
    """Returns the error for `python -m robocell.generate`, and "" for all other processes."""
    name, _ = _what_runs(arguments)
    first, *parts = name.split(".")
    if first != "robocell" or not parts or any(each.startswith("_") for each in parts):
        return ""
    folder = Path(__file__).parent
    path = folder.joinpath(*parts)
    file = path.with_name(f"{path.name}.py")
    if not (path.is_dir() or file.is_file()) or _is_program(file):
        return ""
    known = COMMANDS_OF_MODULES.get(".".join(parts))
    remedy = f"Run `robocell {known}`" if known else "`robocell --help` lists the commands"
    return f"error: '{name}' is a module to import, and does nothing by itself. {remedy}"


def _is_program(file: Path) -> bool:
    """Returns True for a module that does something by itself, as the tools of robocell.compat."""
    return file.is_file() and 'if __name__ == "__main__":' in file.read_text(encoding="utf-8")


def _what_runs(arguments: list[str]) -> tuple[str, str]:
    """Returns the module or the script of a command line of Python; "" for what it has not."""
    rest = iter(arguments[1:])
    # The interpreter's options come before what it runs: -m and a module, -c, or a script.
    for argument in rest:
        if argument == "-m":
            return next(rest, ""), ""
        if argument == "-c":
            break
        if argument in ("-X", "-W"):
            next(rest, "")
        elif not argument.startswith("-"):
            return "", argument
    return "", ""


def be_quiet() -> None:
    """Makes Ctrl-C end the process."""
    global _quiet
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        _quiet = True


def hear_again() -> None:
    """Makes Ctrl-C raise KeyboardInterrupt again."""
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


def open_closed_streams() -> None:
    """Opens what is closed of the descriptors 0, 1 and 2, for this process and those it starts."""
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free number
            os.set_inheritable(descriptor, True)
    # Python has no stream for a descriptor that was closed when it started.
    sys.stdin = sys.stdin or os.fdopen(0, closefd=False)
    sys.stdout = sys.stdout or os.fdopen(1, "w", closefd=False)
    sys.stderr = sys.stderr or os.fdopen(2, "w", closefd=False)


if refusal := refusal_of_module(sys.orig_argv):
    print(refusal, file=sys.stderr)
    sys.exit(2)
if is_command(sys.orig_argv):
    open_closed_streams()
    be_quiet()
    look_here_last()
