"""Faults while a dataset is generated: workers killed at any instant, a disk that takes no more."""

from __future__ import annotations

import contextlib
import json
import os
import random  # rule-ok: decides when to kill; no data depends on it
import resource
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import storm
import yaml

import robocell
from contents import contents

EPISODES = 6
KILLS = 6
# Less than a steps.h5 needs; logs and probes fit.
FILE_LIMIT_BYTES = 80_000

RUN = {**storm.RUN, "run": "faults", "episodes_per_scene": EPISODES}


def start(folder: Path, *options: object, limit: int | None = None) -> subprocess.Popen[str]:
    """Starts the command; `limit`: the largest file it and its children may write, bytes."""
    run = folder / "run.yaml"
    run.write_text(yaml.safe_dump({**RUN, "output": str(folder / "out")}))
    code = "from robocell.cli import main; main()"
    if limit is not None:  # Python ignores SIGXFSZ, so that writing fails instead
        code = (
            f"import resource; resource.setrlimit({resource.RLIMIT_FSIZE}, ({limit},) * 2); {code}"
        )
    return subprocess.Popen(
        [sys.executable, "-c", code, "generate", str(run), *map(str, options)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def children(pid: int) -> list[int]:
    """Processes that the main thread of a process has started."""
    with contextlib.suppress(OSError):  # it has ended
        path = Path(f"/proc/{pid}/task/{pid}/children")
        return [int(child) for child in path.read_text().split()]
    return []


def program(pid: int) -> str:
    """What the process runs, with its arguments; empty when it has ended, a zombie included."""
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/cmdline").read_text()
    return ""


def workers_of(command: subprocess.Popen[str]) -> list[int]:
    """Its worker processes; the one that looks the run through before is none."""
    return [
        child for child in children(command.pid) if "robocell.generate.work\0" in program(child)
    ]


def kill_workers(command: subprocess.Popen[str], kills: int) -> None:
    """kill -9 for a random worker at random times, workers that are just starting included."""
    chance = random.Random(7)
    while kills and command.poll() is None:
        time.sleep(chance.uniform(0.1, 1.5))
        workers = workers_of(command)
        if workers and command.poll() is None:
            os.kill(chance.choice(workers), signal.SIGKILL)
            kills -= 1


def test_killed_workers_lose_nothing_and_double_nothing(tmp_path: Path):
    calm, stormy = tmp_path / "calm", tmp_path / "stormy"
    calm.mkdir()
    stormy.mkdir()
    command = start(calm, "--workers", 2)
    _, said = command.communicate(timeout=240)
    assert command.returncode == 0, said

    command = start(stormy, "--workers", 2, "--progress", "jsonl")
    killer = threading.Thread(target=kill_workers, args=(command, KILLS))
    killer.start()
    out, said = command.communicate(timeout=240)
    killer.join()
    events = [json.loads(line) for line in out.splitlines()]
    if command.returncode != 0:  # one item may have been hit three times: the next run makes it
        assert command.returncode == 1, said
        assert any(event["event"] == "unmade" for event in events)
        again = start(stormy)
        _, said = again.communicate(timeout=240)
        assert again.returncode == 0, said
    assert any("killed by SIGKILL" in event.get("reason", "") for event in events)
    report = robocell.verify(stormy / "out")
    assert report.ok, str(report)
    assert report.leftovers == [], "what the dead were writing is gone"
    assert len(report.good) == EPISODES
    assert contents(stormy / "out") == contents(calm / "out")


def encoders_of(command: subprocess.Popen[str]) -> tuple[int, set[int]]:
    """A worker of the command and the encoders that it has running, as soon as there are two."""
    end = time.monotonic() + 120
    while time.monotonic() < end:
        assert command.poll() is None, command.communicate()
        for worker in workers_of(command):
            started = {child for child in children(worker) if "ffmpeg" in program(child)}
            if len(started) == 2:  # colour and depth
                return worker, started
        time.sleep(0.002)
    raise AssertionError("no encoder was seen")


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
    assert robocell.verify(tmp_path / "out").leftovers == []


def test_a_disk_that_takes_no_more_ends_the_run_with_the_reason(tmp_path: Path):
    command = start(tmp_path, "--workers", 1, "--episodes", 1, limit=FILE_LIMIT_BYTES)
    _, said = command.communicate(timeout=240)
    assert command.returncode == 3, said
    assert "Traceback" not in said
    assert str(tmp_path / "out") in said
    assert "steps.h5" in said or "mp4" in said
    assert robocell.Dataset(tmp_path / "out").ids == []
    assert robocell.verify(tmp_path / "out").leftovers == [], "the half episode is gone"


def test_a_run_goes_on_when_nobody_reads_its_progress(tmp_path: Path):
    command = start(tmp_path, "--workers", 1, "--episodes", 2, "--progress", "jsonl")
    assert command.stdout is not None
    assert command.stderr is not None
    assert json.loads(command.stdout.readline())["event"] == "started"
    command.stdout.close()
    said = command.stderr.read()
    assert command.wait(timeout=240) == 0, said
    assert "progress cannot be shown any more" in said
    assert len(robocell.verify(tmp_path / "out").good) == 2
