"""What draws on this machine, and how one is told when nothing does."""

from __future__ import annotations

import subprocess
import sys

import pytest

import robocell as rc
from robocell.cli import probes
from robocell.cli.probes import State


def describe(**environment: str) -> subprocess.CompletedProcess[str]:
    """`describe_gl()` in a process of its own."""
    code = "import robocell; print('draws:', robocell.describe_gl())"
    return subprocess.run(
        [sys.executable, "-c", code],
        env={"PYTHONPATH": ":".join(sys.path), **environment},
        capture_output=True,
        text=True,
        check=False,
    )


def test_it_is_described():
    said = describe().stdout
    assert said.startswith(("draws: egl: ", "draws: osmesa: "))


def test_an_error_says_what_was_tried_when_nothing_draws():
    result = describe(ROBOCELL_GL="egl", __EGL_VENDOR_LIBRARY_FILENAMES="/no")
    assert result.returncode == 1
    assert "draws" not in result.stdout
    assert "Error: no OpenGL for off-screen rendering. Tried:\n  egl: " in result.stderr


def test_the_doctor_does_not_take_an_error_for_a_description(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/no")
    monkeypatch.setenv("PYTHONPATH", ":".join(sys.path))
    egl = next(finding for finding in probes.graphics() if finding.what == "graphics: egl")
    assert egl.state is not State.OK
    assert egl.detail.startswith("egl: ")


def test_a_misspelt_back_end_is_named():
    result = describe(ROBOCELL_GL="elg")
    assert result.returncode == 1
    assert "environment variable ROBOCELL_GL: no GL back end 'elg'" in result.stderr
    assert issubclass(rc.NotFoundError, rc.Error)
