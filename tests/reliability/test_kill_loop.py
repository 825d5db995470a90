"""kill -9 for workers and supervisor at random instants and at chosen ones, again and again.

Against a ledger of the episodes that the command acknowledged: none is ever lost or damaged, and
the dataset ends up with the bytes of an undisturbed run. `make soak` does the long form.
"""

from __future__ import annotations

import contextlib
import os
import random  # rule-ok: decides when to kill; no data depends on it
import signal
import subprocess
import sys
import time
from pathlib import Path

import figures
import pytest
from ledger import BUILD
from storm import Storm

import robocell

# How a command dies. `inside`: a worker kills itself at its n-th change of the dataset.
WAYS = ["worker", "supervisor", "both", "inside"]
CHANGES_OF_AN_EPISODE = 90
ATTEMPTS_PER_KILL = 3  # the command may end before its time has come


def workers_of(command: subprocess.Popen[str]) -> list[int]:
    """Its child processes."""
    with contextlib.suppress(FileNotFoundError, ProcessLookupError):
        path = Path(f"/proc/{command.pid}/task/{command.pid}/children")
        return [int(child) for child in path.read_text().split()]
    return []


def kill(pid: int) -> bool:
    """Whether there was something to kill."""
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)
        return True
    return False


def strike(storm: Storm, chance: random.Random) -> None:
    """One run of the command that dies in one of the ways, if it lives long enough."""
    way = chance.choice(WAYS)
    inside = {
        "LD_PRELOAD": str(BUILD / "libfault_io.so"),
        "FAULT_PROGRAM": Path(sys.executable).name,
        "FAULT_UNDER": f"{storm.dataset}/.s",  # hidden folders of episodes, not the lock
        "FAULT_AT": str(chance.randint(1, 3 * CHANGES_OF_AN_EPISODE)),
        "FAULT_DO": chance.choice(["kill_before", "kill_after"]),
    }
    command = storm.start(chance.choice([1, 2, 3]), **(inside if way == "inside" else {}))
    killed = False
    if way != "inside":
        time.sleep(chance.uniform(0.3, 4.0))
        victims = workers_of(command) if way != "supervisor" else []
        if way == "worker":
            victims = [chance.choice(victims)] if victims else []
        if way != "worker" and command.poll() is None:
            victims.append(command.pid)
        killed = sum(kill(pid) for pid in victims) > 0  # all of them, not only the first
    if way == "worker" and killed:  # the supervisor goes on; enough seen after a while
        time.sleep(chance.uniform(0.0, 2.0))
        command.terminate()
    try:
        events, said = command.communicate(timeout=240)
    finally:
        command.kill()
    killed |= "fault: " in said or "SIGKILL" in events
    storm.kills[way] += killed
    storm.take(events)
    storm.require_nothing_lost()


def survive(tmp_path: Path, kills: int, episodes: int, seed: int) -> Storm:
    """The whole story: a calm run, a stormy one, and the comparison."""
    calm = Storm(tmp_path / "calm", episodes)
    calm.folder.mkdir()
    calm.finish()
    storm = Storm(tmp_path / "storm", episodes)
    storm.folder.mkdir()
    chance = random.Random(seed)
    for _ in range(ATTEMPTS_PER_KILL * kills):
        if storm.kills.total() >= kills:
            break
        strike(storm, chance)
        if len(robocell.Dataset(storm.dataset).ids if storm.dataset.exists() else []) == episodes:
            assert storm.contents() == calm.contents()
            for folder in storm.dataset.glob("s*"):  # all made: begin again
                for file in folder.iterdir():
                    file.unlink()
                folder.rmdir()
            storm.acknowledged.clear()
    assert storm.kills.total() >= kills, storm.kills
    storm.finish()
    assert storm.contents() == calm.contents()
    figures.note("kills", **storm.kills)
    return storm


def test_a_dozen_deaths_lose_nothing(tmp_path: Path):
    survive(tmp_path, kills=12, episodes=8, seed=1)


@pytest.mark.soak
def test_two_hundred_deaths_lose_nothing(tmp_path: Path):
    storm = survive(tmp_path, kills=200, episodes=12, seed=2)
    assert set(storm.kills) == set(WAYS)
