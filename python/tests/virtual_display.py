"""A display in memory (Xvfb), and a user at it (xdotool)."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest


class Display:
    """A virtual display; programs that are started on it open their windows there."""

    def __init__(self, name: str) -> None:
        self.environment = os.environ | {"DISPLAY": name, "WAYLAND_DISPLAY": ""}

    def xdotool(self, *words: object) -> str:
        """Runs a command of xdotool and returns what it printed."""
        done = subprocess.run(
            ["xdotool", *map(str, words)],
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=60,
            check=True,
        )
        return done.stdout.strip()

    def window(self, title: str) -> str:
        """Waits for a window and gives it the keyboard."""
        window = self.xdotool("search", "--sync", "--name", f"^{title}$").split()[0]
        self.xdotool("windowfocus", "--sync", window)
        return window

    def start(self, program: str, folder: Path) -> subprocess.Popen[str]:
        """Starts a Python program, whose lines can be read and written."""
        return subprocess.Popen(
            [sys.executable, "-c", program],
            env=self.environment,
            cwd=folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            bufsize=1,
        )


@contextmanager
def virtual_display(width: int = 1024, height: int = 768) -> Iterator[Display]:
    """A display as long as the block lasts; the test is skipped where there can be none."""
    for tool, package in (("Xvfb", "xvfb"), ("xdotool", "xdotool")):
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed (Debian, Ubuntu: sudo apt install {package})")
    reading, writing = os.pipe()
    server = subprocess.Popen(
        [
            "Xvfb",
            "-displayfd",
            str(writing),
            "-screen",
            "0",
            f"{width}x{height}x24",
            "-nolisten",
            "tcp",
        ],
        pass_fds=(writing,),
        stderr=subprocess.DEVNULL,
    )
    os.close(writing)
    try:
        with os.fdopen(reading) as numbers:
            number = numbers.readline().strip()
        if not number:
            pytest.skip("Xvfb does not start")
        yield Display(f":{number}")
    finally:
        server.terminate()
        server.wait()
