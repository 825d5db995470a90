"""Faults while a dataset is generated: workers killed at any instant, a pipe that nobody reads."""

from __future__ import annotations

import json
import os
import random  # rule-ok: decides when to kill; no data depends on it
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
import storm
import yaml
from ledger import BUILD
from processes import program, workers_of
from storm import Storm

import robocell
from contents import contents
from robocell._generation.procfs import children

KILLS = 6


def start(
    folder: Path, *options: object, changes: Mapping[str, object] = {}
) -> subprocess.Popen[str]:
    """Starts the command; `changes` replace fields of the run."""
    run = folder / "run.yaml"
    run.write_text(yaml.safe_dump({**storm.RUN, "output": str(folder / "out"), **changes}))
    return subprocess.Popen(
        [sys.executable, "-m", "robocell", "generate", str(run), *map(str, options)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def kill_workers(command: subprocess.Popen[str], kills: int, killed: set[int]) -> None:
    """kill -9 for a random worker at random times, workers that are just starting included.

    `killed` gets their process numbers.
    """
    chance = random.Random(7)
    while kills and command.poll() is None:
        time.sleep(chance.uniform(0.1, 1.5))
        workers = workers_of(command)
        if workers and command.poll() is None:
            killed.add(victim := chance.choice(workers))
            os.kill(victim, signal.SIGKILL)
            kills -= 1


@pytest.mark.proof  # a few deaths are in test_kill_loop.py
@pytest.mark.parametrize("render", ["always", "kept"])
def test_killed_workers_lose_nothing_and_double_nothing(tmp_path: Path, calm: Storm, render: str):
    stormy = Storm(tmp_path, render=render)
    command = stormy.start(2)
    killed: set[int] = set()
    killer = threading.Thread(target=kill_workers, args=(command, KILLS, killed))
    killer.start()
    out, said = command.communicate(timeout=240)
    killer.join()
    events = [json.loads(line) for line in out.splitlines()]
    # One item may have been hit three times, or three workers in a row that were just starting: the
    # next run makes the rest.
    if command.returncode != 0:
        assert command.returncode == 1, said
        ends = {event["event"] for event in events} & {"unmade", "stopping"}
        assert ends == {"unmade"} or "before it could take an item" in said
    # A worker may be hit before it takes an item, or between two: then no item is retried.
    told = [event for event in events if event["event"] in ("retry", "unmade")]
    retried = [event for event in told if "killed by SIGKILL" in event["reason"]]
    deaths = last_totals(stormy)["deaths"]
    assert killed
    assert {death["pid"] for death in deaths} <= killed, "no other worker died"
    assert len(retried) <= sum(death["item"] is not None for death in deaths)
    stormy.finish()
    made, expected = stormy.contents(), calm.contents()
    if render != calm.render:  # the only file that differs
        del made["dataset.json"], expected["dataset.json"]
    assert made == expected
    assert counts(stormy) == counts(calm), "each attempt of each item once"


def last_totals(storm: Storm) -> dict[str, Any]:
    """Totals of the dataset's last command."""
    totals: dict[str, Any] = json.loads((storm.dataset / "report.json").read_text())["commands"][
        -1
    ]["totals"]
    return totals


def counts(storm: Storm) -> dict[str, Counter[str]]:
    """What the commands of a dataset counted of attempts, summed up."""
    sums: dict[str, Counter[str]] = {}
    for command in json.loads((storm.dataset / "report.json").read_text())["commands"]:
        told = command["totals"]["counts"]
        assert told["made"] <= told["accepted"] <= told["attempts"]
        numbers = {name: told[name] for name in ("made", "accepted", "attempts")}
        for name in ("refusals", "failures", "kinds", "rollouts"):
            sums.setdefault(name, Counter()).update(told[name])
        sums.setdefault("numbers", Counter()).update(numbers)
    return sums


def is_encoder(arguments: str) -> bool:
    """Whether these are of an encoder, and not of what waits to become one."""
    return "ffmpeg" in arguments and "rawvideo" in arguments


def encoders_of(command: subprocess.Popen[str]) -> tuple[int, set[int]]:
    """A worker of the command and the encoders that it has running, as soon as there are two."""
    end = time.monotonic() + 120
    while time.monotonic() < end:
        assert command.poll() is None, command.communicate()
        for worker in workers_of(command):
            started = {child for child in children(worker) if is_encoder(program(child))}
            if len(started) == 2:  # colour and depth
                return worker, started
        time.sleep(0.002)
    raise AssertionError("no encoder was seen")


def test_a_killed_encoder_loses_no_episode(tmp_path: Path, calm: Storm):
    command = start(tmp_path, "--workers", 1, "--episodes", 1, "--progress", "jsonl")
    _, encoders = encoders_of(command)
    os.kill(max(encoders), signal.SIGKILL)
    out, said = command.communicate(timeout=240)
    assert command.returncode == 0, said
    assert '"event": "retry"' not in out, "its worker lives on"
    made = contents(tmp_path / "out")
    assert {name: made[name] for name in made if name.startswith("s")} == {
        name: bytes for name, bytes in calm.contents().items() if name in made and name[0] == "s"
    }
    assert robocell.data.verify(tmp_path / "out").leftovers == []


def test_the_encoders_of_a_killed_worker_end_and_hold_nothing(tmp_path: Path):
    command = start(tmp_path, "--workers", 1, "--episodes", 1, "--progress", "jsonl")
    worker, encoders = encoders_of(command)
    groups = {os.getpgid(encoder) for encoder in encoders}
    os.killpg(worker, signal.SIGKILL)  # as the supervisor does
    assert worker not in groups, "they are not hit themselves"
    end = time.monotonic() + 10
    while any("ffmpeg" in program(encoder) for encoder in encoders):
        assert time.monotonic() < end, "an encoder is left over"
        time.sleep(0.01)
    out, said = command.communicate(timeout=240)
    assert command.returncode == 0, said
    assert '"event": "retry"' in out
    assert robocell.data.verify(tmp_path / "out").leftovers == []


@pytest.mark.proof
def test_editing_the_robot_ends_a_run_and_restoring_it_lets_it_resume(
    tmp_path: Path,
):
    robot = shutil.copytree(Path(str(storm.RUN["robot"])).parent, tmp_path / "robot")
    changes = {"robot": str(robot / "rc7.yaml"), "cameras": {}, "episodes_per_scene": 40}
    command = start(tmp_path, "--workers", 1, changes=changes)
    end = time.monotonic() + 120
    while not list((tmp_path / "out").glob("s*")):
        assert time.monotonic() < end, "no episode comes"
        time.sleep(0.005)
    model = robot / "rc7.xml"
    before = model.read_text()
    model.write_text(before + "<!-- another -->")
    _, said = command.communicate(timeout=240)
    assert command.returncode == 2, said
    assert f"'{model}' changed during the run into the dataset '{tmp_path / 'out'}'" in said
    assert "model file robot/rc7.xml: changed since then\nChange these back to go on" in said
    assert "could not be made" not in said, "nothing is wrong with the item"
    model.write_text(before)
    made = robocell.data.verify(tmp_path / "out").good
    command = start(tmp_path, "--episodes", len(made) + 1, changes=changes)
    _, said = command.communicate(timeout=240)
    assert command.returncode == 0, said
    assert robocell.data.verify(tmp_path / "out").ok


@pytest.mark.proof  # its terminal closes in test_streams.py
def test_a_run_continues_when_its_progress_pipe_closes(tmp_path: Path):
    command = start(tmp_path, "--workers", 1, "--episodes", 2, "--progress", "jsonl")
    assert command.stdout is not None
    assert command.stderr is not None
    while json.loads(command.stdout.readline())["event"] != "started":
        pass  # warnings
    command.stdout.close()
    said = command.stderr.read()
    assert command.wait(timeout=240) == 0, said
    assert "progress cannot be shown any more" in said
    assert len(robocell.data.verify(tmp_path / "out").good) == 2


def test_an_episode_that_is_not_brought_to_the_disk_is_not_acknowledged(
    tmp_path: Path, calm: Storm
):
    """The flush of the dataset's folder fails in the worker, and again in the command."""
    stormy = Storm(tmp_path)
    shutil.copytree(calm.dataset, stormy.dataset)
    last = robocell.Dataset(stormy.dataset).ids[-1]
    shutil.rmtree(stormy.dataset / last)
    fault = {
        "LD_PRELOAD": str(BUILD / "libfault_io.so"),
        "FAULT_PROGRAM": Path(sys.executable).name,
        "FAULT_UNDER": str(stormy.dataset),
        "FAULT_AT": f"fsync {stormy.dataset}",
        "FAULT_DO": "fail",
    }
    command = stormy.start(1, fault)
    events, said = command.communicate(timeout=240)
    assert command.returncode == 3, said
    assert "is in place, but a power cut may still undo that" in said
    assert f"cannot flush '{stormy.dataset}': Input/output error" in said
    stormy.take(events)
    assert stormy.acknowledged == set()
    stormy.finish()
    assert stormy.contents() == calm.contents()
