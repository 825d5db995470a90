"""Places in a user's code that are read from the stacks of a crashed or hanging worker."""

from __future__ import annotations

import json
from pathlib import Path

import robocell
from robocell._generation.stacks import place_in, without_stacks

OWN, MORE = "/mine/tasks.py", "/mine/helper.py"
ROBOCELL, PYTHON = Path(robocell.__file__).parent / "generate" / "work.py", json.__file__


def thread(*frames: tuple[object, int, str], current: bool = False) -> str:
    """Formats a thread as `faulthandler` does."""
    head = "Current thread" if current else "Thread"
    lines = [f'  File "{file}", line {line} in {name}\n' for file, line, name in frames]
    return f"{head} 0x00007f7701e39740 (most recent call first):\n{''.join(lines)}"


LISTENER = thread((PYTHON, 12, "select"), (ROBOCELL, 9, "_hear"))


def test_the_innermost_frame_of_a_user_counts():
    main = thread(
        (PYTHON, 3, "loads"), (MORE, 7, "read"), (OWN, 12, "judge"), (ROBOCELL, 9, "make")
    )
    assert place_in(f"hello\n{LISTENER}\n{main}") == f" ({MORE}:7, in read)"
    assert place_in(f"{LISTENER}\n{thread((ROBOCELL, 9, 'make'))}") == ""
    assert place_in("Thread 0x1 is mine\n") == ""


def test_the_thread_that_crashed_comes_first_and_the_last_stacks_count():
    crash = "Fatal Python error: Segmentation fault\n\n"
    old = crash + thread((MORE, 1, "old"), current=True)
    mine = thread((OWN, 5, "load"), current=True)
    main = thread((OWN, 12, "judge"))
    assert place_in(f"{old}\ntext\n{crash}{mine}\n{main}") == f" ({OWN}:5, in load)"
    current = LISTENER.replace("Thread", "Current thread")
    assert place_in(f"{current}\n{main}") == f" ({OWN}:12, in judge)"


def test_a_log_without_stacks_keeps_what_a_library_wrote():
    crash = "Fatal Python error: Aborted\n\n"
    stacks = f"{crash}{LISTENER}\n{thread((OWN, 5, 'load'), current=True)}\n"
    log = f"hello\n{stacks}Extension modules: numpy (total: 1)\nlast words\n"
    assert without_stacks(log) == "hello\nlast words"
    assert without_stacks("a\n\n  b\n") == "a\n\n  b"
