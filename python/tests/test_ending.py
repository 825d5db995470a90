"""Processes end in time, whatever a user's code leaves running."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from robocell._ending import code_of_exit

SCRIPT = """
import atexit, sys, threading, time
from robocell._ending import end_in_time

def upload():
    time.sleep(600)

print("work is done")
{leaves}
end_in_time(3, 0.5{options})
sys.exit(3)
"""
THREAD = "threading.Thread(target=upload, name='uploader').start()"
HANDLER = "atexit.register(upload)"


def ended(folder: Path, leaves: str, options: str = "") -> subprocess.CompletedProcess[str]:
    script = folder / "ends.py"
    script.write_text(SCRIPT.format(leaves=leaves, options=options))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.run(
        [sys.executable, script],
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


@pytest.mark.parametrize(
    ("leaves", "what"),
    [(THREAD, "thread 'uploader' (not a daemon)"), (HANDLER, "an exit handler")],
)
def test_warns_about_what_goes_on_and_ends(tmp_path: Path, leaves: str, what: str):
    done = ended(tmp_path, leaves)
    assert (done.returncode, done.stdout) == (3, "work is done\n")
    place = f"{tmp_path / 'ends.py'}:6, in upload"
    assert done.stderr == (
        f"warning: {what} still ran ({place}) 0.5 s after all work was done; the process ends "
        "without it\n"
    )
    done = ended(tmp_path, leaves, ", quiet=True")
    assert (done.returncode, done.stdout, done.stderr) == (3, "work is done\n", "")


def test_ends_at_once_without_a_word_otherwise(tmp_path: Path):
    done = ended(tmp_path, "atexit.register(print, 'handled')")
    assert (done.returncode, done.stdout, done.stderr) == (3, "work is done\nhandled\n", "")


def test_the_exit_code_is_that_of_python():
    assert [code_of_exit(code) for code in (None, 0, 3, "text")] == [0, 0, 3, 1]
