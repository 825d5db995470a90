"""Processes of tests: their environment, and the workers of a `robocell generate`.

No test in itself.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from pathlib import Path

from robocell._generation.procfs import children


def bare_environment() -> dict[str, str]:
    """Little: where modules and programs are, and which build of robocell is tested."""
    build = {name: os.environ[name] for name in ("ROBOCELL_BUILD",) if name in os.environ}
    return {"PYTHONPATH": os.pathsep.join(sys.path), "PATH": "/usr/bin:/bin", **build}


def program(pid: int) -> str:
    """What the process runs, with its arguments; empty when it has ended, a zombie included."""
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/cmdline").read_text()
    return ""


def workers_of(command: subprocess.Popen[str]) -> list[int]:
    """Its workers; the process that looks the run through before there are any is none."""
    return [
        child for child in children(command.pid) if "robocell._generation.work\0" in program(child)
    ]
