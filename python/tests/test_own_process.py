"""Processes of our own take our modules, whatever lies in the working folder."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import robocell
from robocell.generate.own_process import own_process


def test_files_of_the_working_folder_are_not_taken_for_modules(tmp_path: Path):
    for name in ("robocell.py", "json.py", "numpy.py", "argparse.py"):
        (tmp_path / name).write_text("raise SystemExit('the wrong file')")
    for variables in (os.environ, {"PATH": os.environ["PATH"]}):  # also not found by a variable
        command = [*own_process("robocell.generate.work"), "--help"]
        done = subprocess.run(
            command, cwd=tmp_path, env=variables, capture_output=True, text=True, check=False
        )
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.startswith("usage: robocell.generate.work ")


def test_arguments_come_through_as_they_are():
    folder = Path(robocell.__file__).parents[1]
    command = own_process("robocell.generate.work")
    assert command[:3] == [sys.executable, "-P", "-c"]
    assert command[-2:] == [str(folder), "robocell.generate.work"]
