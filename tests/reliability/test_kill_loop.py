"""kill -9 for workers and supervisor at random instants and at chosen ones, again and again.

Against a ledger of the episodes that the command acknowledged: none is ever lost or damaged, and
the dataset ends up with the bytes of an undisturbed run. `make test` does it in two ways, `make
check` in every way, `make soak` for two hundred times.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import random  # rule-ok: decides when to kill; no data depends on it
import shutil
import signal
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import figures
import pytest
from ledger import BUILD
from processes import workers_of
from storm import EPISODES, Storm

import robocell

# How a command dies. Somebody kills it:
OUTSIDE = ["worker", "supervisor", "both"]
# Or one of its processes kills itself before or after a call. Death at each call that there is, is
# for test_failing_disk.py.
POINTS = {
    "inside a write": ("pwrite */steps.h5", "kill_before"),
    "with all files closed": ("write */episode.json", "kill_before"),
    "before the rename": ("rename */out/s0*", "kill_before"),
    "between rename and sync": ("rename */out/s0*", "kill_after"),
    "with the writers' lock": ("mkdir */out/.s0*", "kill_after"),
    "with the lock": ("write */.lock", "kill_before"),
    "in the report": ("rename */report.json", "kill_before"),
}
ANY_CALL = "at any call"
WAYS = [*OUTSIDE, *POINTS, ANY_CALL]
# From outside, and inside at the instant that counts.
FEW = ["worker", "between rename and sync"]
CHANGES_OF_AN_EPISODE = 90
ATTEMPTS_PER_KILL = 3  # the command may end before its time has come


def kill(pid: int) -> bool:
    """Whether there was something to kill."""
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)
        return True
    return False


def strike(storm: Storm, chance: random.Random, way: str, workers: int) -> None:
    """One run of the command that dies in this way, if it lives long enough."""
    if way in OUTSIDE:
        died = be_killed(storm, workers, chance, way)
    else:
        died = die_inside(storm, workers, chance, way)
    storm.kills[way] += died
    storm.require_nothing_lost()


def be_killed(storm: Storm, workers: int, chance: random.Random, way: str) -> bool:
    """Whether there was something to kill."""
    command = storm.start(workers)
    time.sleep(chance.uniform(0.3, 2.5))  # six episodes take two to three seconds
    victims = workers_of(command) if way != "supervisor" else []
    while way == "worker" and not victims and command.poll() is None:  # there are none yet
        time.sleep(0.01)
        victims = workers_of(command)
    if way == "worker":
        victims = [chance.choice(victims)] if victims else []
    if way != "worker" and command.poll() is None:
        victims.append(command.pid)
    killed = sum(kill(pid) for pid in victims) > 0  # all of them, not only the first
    if way == "worker" and killed:  # the supervisor goes on; enough seen after a while
        time.sleep(chance.uniform(0.0, 2.0))
        command.terminate()
    try:
        events, _ = command.communicate(timeout=240)
    finally:
        command.kill()
    storm.take(events)
    return killed


def die_inside(storm: Storm, workers: int, chance: random.Random, point: str) -> bool:
    """Whether the point was met."""
    at, do = POINTS.get(
        point,
        (
            str(chance.randint(1, CHANGES_OF_AN_EPISODE)),
            chance.choice(["kill_before", "kill_after"]),
        ),
    )
    fault = {
        "LD_PRELOAD": str(BUILD / "libfault_io.so"),
        "FAULT_PROGRAM": Path(sys.executable).name,
        "FAULT_UNDER": str(storm.dataset),
        "FAULT_AT": at,
        "FAULT_DO": do,
    }
    before = told(storm)
    command = storm.start(workers, fault)
    assert command.stdout is not None
    events = ""
    try:
        for line in command.stdout:  # every worker dies so: one is enough
            events += line
            if "SIGKILL" in line or '"event": "episode"' in line:
                command.terminate()
        command.wait(240)
    finally:
        command.kill()
        _, said = command.communicate()
    storm.take(events)
    return "fault: " in said or told(storm) > before


def told(storm: Storm) -> int:
    """How often workers said that they kill themselves."""
    logs = storm.dataset.glob(".logs/*.log")
    return sum(log.read_text(errors="replace").count("fault: ") for log in logs)


def survive(
    storm: Storm, calm: Storm, ways: Sequence[str], kills: int, workers: Sequence[int], seed: int
) -> None:
    """A stormy run in which each of these ways has its turn, and the comparison with a calm one."""
    chance = random.Random(seed)
    for _, way in zip(range(ATTEMPTS_PER_KILL * kills), itertools.cycle(ways), strict=False):
        if storm.kills.total() >= kills:
            break
        strike(storm, chance, way, chance.choice(workers))
        if len(robocell.Dataset(storm.dataset).ids if storm.dataset.exists() else []) == EPISODES:
            assert storm.contents() == calm.contents()
            shutil.rmtree(storm.dataset)  # all made: begin again
            storm.acknowledged.clear()
    assert storm.kills.total() >= kills, storm.kills
    storm.finish()
    assert storm.contents() == calm.contents()
    figures.note("kills", **storm.kills)


@pytest.mark.parametrize(
    "ways", [FEW, pytest.param(WAYS, marks=pytest.mark.proof)], ids=["two", "every"]
)
def test_every_kind_of_death_loses_nothing(ways: Sequence[str], tmp_path: Path, calm: Storm):
    storm = Storm(tmp_path)
    survive(storm, calm, ways, kills=len(ways), workers=[1, 2], seed=1)
    points = [way for way in ways if way in POINTS]
    assert [point for point in points if not storm.kills[point]] == [], "never met"


@pytest.mark.soak
def test_two_hundred_deaths_lose_nothing(tmp_path: Path, calm: Storm):
    storm = Storm(tmp_path)
    survive(storm, calm, WAYS, kills=200, workers=[1, 2, 3, 7], seed=2)
    assert {way for way, count in storm.kills.items() if count} == set(WAYS)
