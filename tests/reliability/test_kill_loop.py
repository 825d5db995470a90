"""kill -9 for workers and supervisor at random instants and at chosen ones, again and again.

Against a ledger of the episodes that the command acknowledged: none is ever lost or damaged, and
the dataset ends up with the bytes of an undisturbed run. `make soak` does the long form.
"""

from __future__ import annotations

import contextlib
import json
import os
import random  # rule-ok: decides when to kill; no data depends on it
import signal
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import pytest
import yaml
from ledger import BUILD

import robocell

RUN = {
    "run": "storm",
    "robot": str(robocell.models.robot_file("rc7")),
    "task": {
        "kind": "pick",
        "base_distance": [0.3, 0.55],
        "base_height_offset": -0.25,
        "base_height_noise": [-0.15, 0.1],
    },
    "scenes": {"source": "tabletop"},
    "cameras": {"resolution": [32, 24], "streams": [{"name": "wrist", "camera": "wrist_camera"}]},
}
# How a command dies. `inside`: a worker kills itself at its n-th change of the dataset.
WAYS = ["worker", "supervisor", "both", "inside"]
CHANGES_OF_AN_EPISODE = 90
ATTEMPTS_PER_KILL = 3  # the command may end before its time has come


@dataclass
class Storm:
    """A dataset, and what happened to it.

    Attributes:
        folder: Holds the run file and the dataset.
        episodes: How many the run has.
        acknowledged: Ids that the command said were made.
        kills: Way -> how many.
    """

    folder: Path
    episodes: int
    acknowledged: set[str] = field(default_factory=set)
    kills: Counter[str] = field(default_factory=Counter)

    @property
    def dataset(self) -> Path:
        """Where the episodes are."""
        return self.folder / "out"

    def start(self, workers: int, **environment: str) -> subprocess.Popen[str]:
        """Starts the command, in a session of its own."""
        file = self.folder / "run.yaml"
        run = {**RUN, "episodes_per_scene": self.episodes, "output": str(self.dataset)}
        file.write_text(yaml.safe_dump(run))
        options = ["--workers", str(workers), "--progress", "jsonl"]
        return subprocess.Popen(
            [sys.executable, "-m", "robocell", "generate", str(file), *options],
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **environment},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def take(self, events: str) -> None:
        """Adds what the command acknowledged to the ledger."""
        for line in events.splitlines():
            with contextlib.suppress(json.JSONDecodeError):  # the last line may be cut
                event = json.loads(line)
                if event["event"] == "episode" and event["report"]["success"]:
                    self.acknowledged.add(event["report"]["id"])

    def require_nothing_lost(self) -> None:
        """What was acknowledged is on the disk, and what is on the disk is intact."""
        if not self.dataset.exists():
            assert not self.acknowledged
            return
        report = robocell.verify(self.dataset)
        assert report.bad == [], str(report)
        assert self.acknowledged <= set(report.good)

    def contents(self) -> dict[str, bytes]:
        """What must be the same however often the command died."""
        files = [*self.dataset.glob("s*/steps.h5"), *self.dataset.glob("s*/*.mp4")]
        return {str(file.relative_to(self.dataset)): file.read_bytes() for file in files}


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


def finish(storm: Storm) -> None:
    """Lets the command finish its work."""
    command = storm.start(2)
    events, said = command.communicate(timeout=600)
    assert command.returncode == 0, said
    storm.take(events)
    storm.require_nothing_lost()
    report = robocell.verify(storm.dataset)
    assert len(report.good) == storm.episodes
    assert report.leftovers == [], "what the dead were writing is gone"


def survive(tmp_path: Path, kills: int, episodes: int, seed: int) -> Storm:
    """The whole story: a calm run, a stormy one, and the comparison."""
    calm = Storm(tmp_path / "calm", episodes)
    calm.folder.mkdir()
    finish(calm)
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
    finish(storm)
    assert storm.contents() == calm.contents()
    return storm


def test_a_dozen_deaths_lose_nothing(tmp_path: Path):
    survive(tmp_path, kills=12, episodes=8, seed=1)


@pytest.mark.soak
def test_two_hundred_deaths_lose_nothing(tmp_path: Path):
    storm = survive(tmp_path, kills=200, episodes=12, seed=2)
    assert set(storm.kills) == set(WAYS)
    print(f"killed: {dict(storm.kills)}")
