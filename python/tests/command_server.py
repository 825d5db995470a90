"""The command `robocell`, in a fork for each call: its start takes longer than most calls.

Started by `command_line`. A request is a line of JSON with what a new process would be given:
{"arguments": ["doctor"], "environment": {...}, "folder": "/tmp", "out": "...", "err": "...",
"timeout_s": 60}; the answer, another line, is the exit code, negative for a signal.

Not for: what Python does at its end. A fork leaves that out, which is most of its time.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import json
import os
import signal
import sys
import traceback
from typing import Any, NoReturn

from robocell._cli import load, main

# The commands load these modules when they need them; none starts a thread.
LOADED_LATER = ("numpy", "mujoco", "rich.table", "rich.progress", "typer.rich_utils")


def preload() -> None:
    """Loads all that the commands load, and of typer what it loads for a command line."""
    load([])
    for module in LOADED_LATER:
        importlib.import_module(module)
    with contextlib.suppress(ImportError):  # not every version has it
        importlib.import_module("typer._adapters")
    gc.freeze()  # forks share it


def be_the_command(request: dict[str, Any]) -> NoReturn:
    """In the fork: with what a new process finds."""
    os.environ.clear()
    os.environ.update(request["environment"])
    os.chdir(request["folder"])
    for fd, path, how in (
        (0, os.devnull, os.O_RDONLY),
        (1, request["out"], os.O_WRONLY | os.O_APPEND),  # both may be the same file
        (2, request["err"], os.O_WRONLY | os.O_APPEND),
    ):
        opened = os.open(path, how)
        os.dup2(opened, fd)
        os.close(opened)
    sys.argv = ["robocell", *request["arguments"]]
    signal.setitimer(signal.ITIMER_REAL, request["timeout_s"])  # the signal ends it
    code = exit_code()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


def exit_code() -> int:
    """Runs the command, which prints its own messages, and returns its exit code."""
    try:
        main()
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            return end.code or 0
        print(end.code, file=sys.stderr)  # as Python does
        return 1
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


def serve() -> None:
    """Answers requests until there are no more."""
    while line := sys.stdin.readline():
        child = os.fork()
        if child == 0:
            be_the_command(json.loads(line))
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)


if __name__ == "__main__":
    preload()
    serve()
    os._exit(0)  # what is frozen is still alive, and nanobind would report it
