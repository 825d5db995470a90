"""Locks on a network file system, by a shim that applies its rules to flock(2)."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from ledger import BUILD

# Two commands on one folder, and a sweep of what nobody holds.
WITHOUT_LOCKS = """
import sys
import robocell as rc

with rc.data.DatasetLock(sys.argv[1]), rc.data.DatasetLock(sys.argv[1]):
    print(rc.data.remove_leftovers(sys.argv[1]))
"""


def run(*command: object, **environment: str) -> subprocess.CompletedProcess[str]:
    """Runs a program under the shim."""
    shim = {"LD_PRELOAD": str(BUILD / "libnetwork_locks.so"), **environment}
    return subprocess.run(
        list(map(str, command)),
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **shim},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


LOCKS = "--gtest_filter=DatasetLock.*:RemoveLeftovers.*"


# Those that start many processes at once take ten of the eleven seconds.
@pytest.mark.parametrize(
    ("tests", "one"),
    [
        (f"{LOCKS}-*.*Concurrent*:*.*Starting*", "KeepsTheFolderOfALiveWriter"),
        pytest.param(LOCKS, "DoesNotDisturbStartingWriters", marks=pytest.mark.proof),
    ],
    ids=["quick", "all"],
)
def test_locks_work_on_a_network_disk(tests: str, one: str):
    """Two runs in one folder are refused, and no sweep takes the folder of a living writer."""
    done = run(BUILD / "data_test", tests)
    assert done.returncode == 0, done.stdout
    assert "DatasetLock.IsHeldByOneAtATimeAndNamesItsOwner" in done.stdout
    assert f"RemoveLeftovers.{one}" in done.stdout


def test_without_locks_a_warning_is_given_and_no_folder_is_swept(tmp_path: Path):
    leftover = tmp_path / ".e0.7.1.partial"
    leftover.mkdir()
    done = run(sys.executable, "-c", WITHOUT_LOCKS, tmp_path, NO_LOCKS="1")
    assert done.stdout == "[]\n", done.stderr
    assert done.stderr.count("cannot be locked (No locks available): two runs in one folder") == 1
    assert leftover.is_dir()
