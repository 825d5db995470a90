"""Stacks of a worker that crashed or hangs: written to its log, and the place in a user's code.

The worker calls `write_on_request`; then a fatal signal, or `ask`, writes the stacks of all its
threads to its standard error, even while C++ is busy.
"""

from __future__ import annotations

import faulthandler
import os
import re
import signal
import time
from collections.abc import Iterator
from pathlib import Path

from robocell._own_code import is_own

# The signals after which a process writes its stacks.
FATAL = frozenset({signal.SIGSEGV, signal.SIGBUS, signal.SIGABRT, signal.SIGFPE, signal.SIGILL})
LONGEST_S = 3.0  # for writing them
STILL_S = 0.2  # after which an unfinished text is taken as it is
LAST_FRAME = b" in <module>\n"
_LOG = 2  # standard error

_HEAD = re.compile(r"^(Current thread|Thread) 0x[0-9a-f]+.*\(most recent call first\):$")
_FRAME = re.compile(r'^  File "(.+)", line (\d+) in (.+)$')
_INSIDE = re.compile(r"^(  .*|Extension modules: .*|)$")
_FATAL = re.compile(r"^Fatal Python error: ")


def write_on_request() -> None:
    """Makes this process write its stacks at a fatal signal, and at `ask`."""
    faulthandler.enable(_LOG)
    faulthandler.register(signal.SIGUSR1, _LOG)


def ask(pid: int, log: Path) -> None:
    """Asks a process for its stacks and waits until they are in its log.

    It is about to be killed: one that has not called `write_on_request` yet ends.
    """
    try:
        before = size = os.path.getsize(log)
        os.kill(pid, signal.SIGUSR1)
        now = grown = time.monotonic()
        end = now + LONGEST_S
        while now < end and not (size > before and (_is_whole(log) or now - grown > STILL_S)):
            time.sleep(0.01)
            last, size, now = size, os.path.getsize(log), time.monotonic()
            grown = now if size != last else grown
    except OSError:  # it has just ended, or somebody tidied the logs up
        return


def _is_whole(log: Path) -> bool:
    """Returns True if a log ends with the last frame of the main thread, which comes last."""
    with log.open("rb") as file:
        file.seek(max(0, os.path.getsize(log) - len(LAST_FRAME)))
        return file.read() == LAST_FRAME


def place_in(log: str) -> str:
    """Returns ' (tasks.py:12, in judge)', the innermost of a user's frames in the last stacks.

    The thread that crashed comes first, then the main one, which makes the episodes. Returns "" if
    no frame is the user's.
    """
    threads = _last_stacks(log)
    for crashed in (True, False):
        for is_current, frames in reversed(threads):
            if crashed and not is_current:
                continue
            for file, line, name in frames:
                if not file.startswith("<") and is_own(Path(file)):
                    return f" ({file}:{line}, in {name})"
    return ""


def without_stacks(log: str) -> str:
    """Returns a log's text without stacks, whose frames are mostly robocell's own."""
    lines = log.splitlines()
    return "\n".join(
        line for line, is_stack in zip(lines, _is_stack(lines), strict=True) if not is_stack
    )


def _is_stack(lines: list[str]) -> Iterator[bool]:
    """Yields for each line whether it belongs to stacks, with the empty lines between them."""
    inside = False
    for line in lines:
        starts = _HEAD.match(line) or _FATAL.match(line)
        inside = bool(starts) or (inside and _INSIDE.match(line) is not None)
        yield inside


def _last_stacks(log: str) -> list[tuple[bool, list[tuple[str, str, str]]]]:
    """Returns the threads of the last stacks: whether it is the current one, and its frames."""
    threads: list[tuple[bool, list[tuple[str, str, str]]]] = []
    lines = log.splitlines()
    for line, is_stack in zip(lines, _is_stack(lines), strict=True):
        if not is_stack or _FATAL.match(line):
            threads = threads if not _FATAL.match(line) else []
        elif head := _HEAD.match(line):
            threads.append((head[1] == "Current thread", []))
        elif threads and (frame := _FRAME.match(line)):
            threads[-1][1].append((frame[1], frame[2], frame[3]))
    return threads
