"""A worker that stands still past its time, and goes on when its episode is another's.

It is stopped with everything written and only the renaming to be done, which is the worst instant:
what it does when it goes on is the commit. See docs/decisions/007-locks-instead-of-leases.md.
"""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from ledger import BUILD
from processes import program
from storm import EPISODES, Storm, marks

import robocell

COMMIT = "rename */out/s0*"
SOON_S = 120
# The time for an item and a worker's start, which takes longest on a busy machine.
TIMEOUT_S = 8


class Stop:
    """Stops the first worker that is about to commit an episode.

    Attributes:
        environment: For the command.
    """

    def __init__(self, storm: Storm, name: str) -> None:
        self._said = storm.folder / name
        self.environment = {
            "LD_PRELOAD": str(BUILD / "libfault_io.so"),
            "FAULT_PROGRAM": Path(sys.executable).name,
            "FAULT_UNDER": str(storm.dataset),
            "FAULT_AT": COMMIT,
            "FAULT_DO": "stop",
            "FAULT_ONCE": str(self._said),
        }

    def wait(self) -> int:
        """The worker, when it stands still."""
        wait_for(lambda: self._said.exists() and self._said.read_text().endswith("\n"))
        pid = int(self._said.read_text())
        wait_for(lambda: state_of(pid) == "T")
        return pid


@pytest.fixture
def storm(tmp_path: Path) -> Iterator[Storm]:
    """An empty dataset; whoever still stands still at the end is ended."""
    yield Storm(tmp_path)
    for file in tmp_path.glob("stopped*"):
        pid = int(file.read_text())
        if "robocell._generation.work\0" in program(pid):
            os.kill(pid, signal.SIGKILL)


@pytest.fixture
def adopted() -> Iterator[None]:
    """Workers whose supervisor dies become children of this process.

    Else the kernel ends one that stands still then (SIGHUP for an orphaned group of processes): it
    is late only where the first process of a container or a session adopts it.
    """
    set_subreaper = 36  # prctl(2): PR_SET_CHILD_SUBREAPER
    prctl = ctypes.CDLL(None, use_errno=True).prctl
    assert prctl(set_subreaper, 1, 0, 0, 0) == 0
    yield
    assert prctl(set_subreaper, 0, 0, 0, 0) == 0


def wait_for(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + SOON_S
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)


def state_of(pid: int) -> str:
    """'T' when it stands still; '' when there is none."""
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    return ""


def go_on(pid: int) -> int:
    """Continues a process that was adopted; its exit code."""
    assert state_of(pid) == "T", "it still stands still"
    os.kill(pid, signal.SIGCONT)
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])


def end_of(command: subprocess.Popen[str]) -> list[dict[str, object]]:
    """What a command that made everything told, each episode once."""
    events, said = command.communicate(timeout=2 * SOON_S)
    assert command.returncode == 0, said
    told = [json.loads(line) for line in events.splitlines()]
    ids = [event["result"]["id"] for event in told if event["event"] == "episode"]
    assert len(ids) == len(set(ids)), "an episode counts once"
    return told


def require_whole(storm: Storm, calm: Storm) -> None:
    """All episodes are there, with the bytes of an undisturbed run, and nothing else."""
    result = robocell.data.verify(storm.dataset)
    assert result.ok, str(result)
    assert len(result.good) == EPISODES
    assert (result.leftovers, result.being_written) == ([], [])
    assert storm.contents() == calm.contents()


@pytest.mark.proof  # it takes the time of an item; another that hangs is in test_supervisor.py
def test_a_stalled_worker_cannot_commit_late(storm: Storm, calm: Storm):
    """Its end is waited for before another one gets the item, so no commit of it can come."""
    stop = Stop(storm, "stopped")
    patience = ["--item-timeout", str(TIMEOUT_S)]
    command = storm.start(1, stop.environment, wrap=lambda words: [*words, *patience])
    stopped = stop.wait()
    told = end_of(command)
    (retry,) = [event for event in told if event["event"] == "retry"]
    assert f"took more than {TIMEOUT_S} s" in str(retry["reason"])
    with pytest.raises(ProcessLookupError):
        os.kill(stopped, signal.SIGCONT)
    report = json.loads((storm.dataset / "report.json").read_text())
    (death,) = report["commands"][0]["totals"]["deaths"]
    assert death["pid"] == stopped
    require_whole(storm, calm)


@pytest.mark.usefixtures("adopted")
@pytest.mark.proof
def test_a_commit_after_another_command_made_the_episode_is_dropped(storm: Storm, calm: Storm):
    """The supervisor died meanwhile, so that nobody ends the worker: a new one runs beside it."""
    stop = Stop(storm, "stopped")
    command = storm.start(1, stop.environment)
    late = stop.wait()
    command.kill()
    command.communicate()
    unfinished = robocell.data.verify(storm.dataset).being_written
    assert len(unfinished) == 1
    assert robocell.Dataset(storm.dataset).ids == []

    end_of(storm.start(2))
    assert robocell.data.verify(storm.dataset).being_written == unfinished, "its folder is locked"
    with pytest.raises(robocell.IoError, match="in use by writers of episodes"):
        robocell.data.repair(storm.dataset)
    before = marks(storm)
    assert go_on(late) == 1
    assert marks(storm) == before, "no byte of the newer one was touched"
    require_whole(storm, calm)
    logs = "".join(log.read_text() for log in storm.dataset.glob(".logs/*.log"))
    name = unfinished[0].split(".")[1]
    assert f"cannot commit to '{storm.dataset / name}': File exists" in logs, "it is recognised"


@pytest.mark.proof
@pytest.mark.usefixtures("adopted")
def test_a_commit_concurrent_with_another_worker_counts_once(storm: Storm, calm: Storm):
    """The late one is quicker after all; the other one finds its episode there."""
    first, second = Stop(storm, "stopped"), Stop(storm, "stopped-too")
    command = storm.start(1, first.environment)
    late = first.wait()
    command.kill()
    command.communicate()

    command = storm.start(1, second.environment)
    other = second.wait()
    go_on(late)
    (there,) = robocell.Dataset(storm.dataset).ids
    before = marks(storm)
    os.kill(other, signal.SIGCONT)
    told = end_of(command)
    assert before.items() <= marks(storm).items(), "the one that is there stays"
    warnings = [str(event) for event in told if event["event"] == "warning"]
    assert any(f"{there} is there" in text and "File exists" in text for text in warnings), warnings
    totals = told[-1]["totals"]
    assert isinstance(totals, dict)
    assert (totals["made"], totals["deaths"]) == (EPISODES, 0), totals
    require_whole(storm, calm)
