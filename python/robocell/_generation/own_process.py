"""robocell's child processes: their command, and those that run one job and end with the caller.

    subprocess.Popen([*own_process("robocell._generation.work"), "--", "run.yaml"])
    done = ask_process("robocell._generation.check", ["--", "run.yaml"], longest_s=60)

`python -m` would look for modules in the working folder first, and would import a user's
`robocell.py` or `json.py` there.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

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


def own_environment() -> dict[str, str]:
    """Returns the environment variables of such a process.

    Its threads share one heap, unless the caller's environment says otherwise. glibc would give
    each thread one, and a worker whose threads draw would hold 30 % more memory.
    """
    return {"MALLOC_ARENA_MAX": "1", **os.environ}


def ask_process(
    module: str, arguments: Sequence[str], longest_s: float
) -> subprocess.CompletedProcess[str]:
    """Runs a module to its end and returns its answer, as standard output, and its errors.

    Raises TimeoutExpired after `longest_s` seconds. The module makes an `Asker`, with which it
    answers: the child never outlives this function or process. It ignores Ctrl-C in the terminal,
    which only this process handles.
    """
    held_by_it, held_here = os.pipe()
    try:
        try:
            process = subprocess.Popen(
                [*own_process(module), *arguments],
                env=own_environment(),
                stdin=held_by_it,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                errors="replace",  # a user's code may print any bytes
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


def take_stream(fd: int, instead: int | None = None) -> int:
    """Returns a private copy of standard input or output, which no other program inherits.

    The stream itself becomes a copy of `instead`, or is empty: a user's code and the programs that
    it starts may read and write it.
    """
    private = os.dup(fd)
    if instead is None:
        nowhere = os.open(os.devnull, os.O_RDWR)
        os.dup2(nowhere, fd)
        os.close(nowhere)
    else:
        os.dup2(instead, fd)
    to_close = [private]  # once: a child's child may have given the number to another file

    def close() -> None:
        while to_close:
            os.close(to_close.pop())

    # A process that a user's code forks would keep the pipe open, and hide this one's death.
    os.register_at_fork(after_in_child=close)
    return private


def write_all(fd: int, data: bytes) -> None:
    """Writes all bytes."""
    while data:
        data = data[os.write(fd, data) :]


class Asker:
    """The process that asked this one with `ask_process`, which ends once the asker is gone.

    Standard input and output are empty from here on: what a user's code prints is no answer.
    """

    def __init__(self) -> None:
        self._answers = take_stream(1)
        asker = take_stream(0)
        threading.Thread(target=_end_at_end_of, args=(asker,), name="asker", daemon=True).start()

    def answer(self, content: Mapping[str, Any]) -> None:
        """Sends the answer, a JSON object."""
        write_all(self._answers, json.dumps(content).encode() + b"\n")


def _end_at_end_of(fd: int) -> NoReturn:
    while os.read(fd, 4096):
        pass
    os._exit(1)
