"""Processes of our own: their command, and those that do one thing and end with whoever asked.

    subprocess.Popen([*own_process("robocell.generate.work"), "--", "run.yaml"])
    done = ask_process("robocell.generate.check", ["--", "run.yaml"], longest_s=60)

`python -m` would look for modules in the working folder first, so that somebody's `robocell.py` or
`json.py` there were taken for ours.
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

import robocell

# The folder that holds this package is usually known already; not when it was the working folder.
RUN = (
    "import sys; from runpy import run_module; _, folder = sys.argv.pop(0), sys.argv.pop(0); "
    "folder in sys.path or sys.path.insert(0, folder); "
    "run_module(sys.argv[0], run_name='__main__', alter_sys=True)"
)


def own_process(module: str) -> list[str]:
    """Runs a module of this package; its arguments are to follow."""
    return [sys.executable, "-P", "-c", RUN, str(Path(robocell.__file__).parents[1]), module]


def ask_process(
    module: str, arguments: Sequence[str], longest_s: float
) -> subprocess.CompletedProcess[str]:
    """Runs a module to its end and gives what it said; TimeoutExpired after `longest_s` seconds.

    It ends with this function, and with this process, however that ends: the module calls
    `end_with_asker`. Ctrl-C in the terminal is this process's business and passes it by.
    """
    held_by_it, held_here = os.pipe()
    try:
        try:
            process = subprocess.Popen(
                [*own_process(module), *arguments],
                stdin=held_by_it,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                process_group=0,
            )
        finally:
            os.close(held_by_it)
        with process:
            try:
                out, err = process.communicate(timeout=longest_s)
            except BaseException:
                process.kill()
                raise
    finally:
        os.close(held_here)
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)


def end_with_asker() -> None:
    """Lets this process end as soon as nobody holds the other end of its standard input."""
    threading.Thread(target=_end_at_end_of_input, name="asker", daemon=True).start()


def _end_at_end_of_input() -> NoReturn:
    while os.read(0, 4096):
        pass
    os._exit(1)
