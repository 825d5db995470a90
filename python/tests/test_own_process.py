"""Processes of our own take our modules, whatever lies in the working folder."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import robocell
from robocell._generation import own_process as processes
from robocell._generation.own_process import ask_process, own_environment, own_process


def test_files_in_the_working_folder_do_not_shadow_modules(tmp_path: Path):
    for name in ("robocell.py", "json.py", "numpy.py", "argparse.py"):
        (tmp_path / name).write_text("raise SystemExit('the wrong file')")
    for variables in (os.environ, {"PATH": os.environ["PATH"]}):  # also not found by a variable
        command = [*own_process("robocell._generation.work"), "--help"]
        done = subprocess.run(
            command, cwd=tmp_path, env=variables, capture_output=True, text=True, check=False
        )
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.startswith("usage: robocell._generation.work ")


def test_threads_share_a_heap_unless_the_environment_says_otherwise(
    monkeypatch: pytest.MonkeyPatch,
):
    monkeypatch.delenv("MALLOC_ARENA_MAX", raising=False)
    assert own_environment() == {**os.environ, "MALLOC_ARENA_MAX": "1"}
    monkeypatch.setenv("MALLOC_ARENA_MAX", "4")
    assert own_environment() == dict(os.environ)


def test_arguments_are_passed_unchanged():
    folder = Path(robocell.__file__).parents[1]
    command = own_process("robocell._generation.work")
    assert command[:3] == [sys.executable, "-P", "-c"]
    assert command[-2:] == [str(folder), "robocell._generation.work"]


PRINTS = """
import atexit, os, subprocess, sys
from robocell._generation.own_process import Asker
print("before", file=sys.stderr)
asker = Asker()
atexit.register(print, "bye")
print("hello", flush=True)
subprocess.run(["sh", "-c", "echo a child; cat"], check=True, timeout=60)
assert sys.stdin.read() == ""
os.write(2, b"\\xff\\n")
asker.answer({"number": 1})
print("{}", flush=True)
"""


def test_only_the_answer_of_an_asked_process_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    script = tmp_path / "prints.py"
    script.write_text(PRINTS)
    monkeypatch.setattr(processes, "own_process", lambda module: [sys.executable, str(script)])
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(sys.path))
    monkeypatch.setenv("LC_ALL", "C.UTF-8")
    done = ask_process("prints", [], longest_s=60)
    assert (done.returncode, done.stdout) == (0, '{"number": 1}\n')
    assert done.stderr == "before\n\ufffd\n"
