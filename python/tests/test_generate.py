"""Generating for real: two tiny episodes, made in every way there is, have the same bytes."""

from __future__ import annotations

import contextlib
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import robocell
from command_line import RUN, refused, robocell_command, write_run
from contents import contents, of_episodes
from made_once import made_once
from robocell._generation import report as reports
from robocell._generation.items import ItemRecord
from robocell._generation.procfs import children
from robocell._generation.resume import result_of

IDS = ["s0000_e0000", "s0000_e0001"]
# One for each of seven workers; so far away that not every first start is in reach.
STREAM = {"name": "wrist", "camera": "wrist_camera", "depth": True}
LONGER = {
    "episodes_per_scene": 7,
    "start": {**RUN["start"], "base_distance": [0.4, 0.62]},
    "cameras": {**RUN["cameras"], "streams": [STREAM]},
}


def generate(run: Path, output: Path, *options: object) -> list[dict[str, Any]]:
    """The events of a run that must succeed."""
    arguments = ("generate", run, "--output", output, "--progress", "jsonl", *options)
    result = robocell_command(*arguments)
    assert result.returncode == 0, result.stderr
    return [json.loads(line) for line in result.stdout.splitlines()]


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Made by one worker."""

    def make(folder: Path) -> None:
        events = generate(write_run(folder), folder / "out", "--workers", 1)
        assert [event["event"] for event in events] == ["started", "episode", "episode", "finished"]
        totals = events[-1]["totals"]
        assert (totals["planned"], totals["made"], totals["unmade"]) == (2, 2, 0)

    return made_once(tmp_path_factory, "reference", make) / "out"


def test_the_dataset_is_complete_and_intact(reference: Path):
    dataset = robocell.Dataset(reference)
    assert dataset.ids == IDS
    assert robocell.data.verify(reference, decode_videos=True).ok
    for episode in (dataset[name] for name in IDS):
        assert episode.success
        assert episode.frames("wrist").shape == (len(episode), 48, 64, 3)
    files = contents(reference)
    assert len(of_episodes(files)) == 2 * 3
    assert "dataset.json" in files
    assert any(name.startswith("models/rc7-") for name in files)


@pytest.fixture(scope="module")
def longer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Made by one worker: enough for several to do, and not every first attempt succeeds."""

    def make(folder: Path) -> None:
        generate(write_run(folder, **LONGER), folder / "out", "--workers", 1)

    out = made_once(tmp_path_factory, "longer", make) / "out"
    episodes = list(robocell.Dataset(out))
    assert len(episodes) == LONGER["episodes_per_scene"]
    assert any(episode.metadata["attempt"] > 0 for episode in episodes)
    assert len(processes(out)) == 1
    assert sum(name.endswith(".depth.mov") for name in contents(out)) == len(episodes)
    return out


@pytest.mark.proof
def test_results_on_disk_match_the_worker_reports(longer: Path):
    """It does where the worker died before it could."""
    run = robocell.RunConfig.load(longer.parent / "run.yaml", [f"output={longer}"])
    told = reports.load(longer / "report.json").episodes
    for item in robocell.generate.make_plan(run):
        # Times and places are in no episode.
        found = result_of(run, item)
        assert found == replace(told[item.id], seconds={}, redrawn={})
        assert ItemRecord.from_json(json.loads(json.dumps(found.to_json()))) == found
    assert sum(result.attempts > result.accepted for result in told.values()) > 0


def processes(dataset: Path) -> set[int]:
    """Who made the episodes."""
    return {episode.json["run"]["process"] for episode in robocell.Dataset(dataset)}


@pytest.mark.parametrize("workers", [pytest.param(1, marks=pytest.mark.proof), 2])
def test_images_rendered_afterwards_have_the_same_bytes(longer: Path, tmp_path: Path, workers: int):
    run = write_run(tmp_path, **LONGER)
    generate(run, tmp_path / "out", "--workers", workers, "--render-kept")
    made, always = contents(tmp_path / "out"), contents(longer)
    begun, expected = (json.loads(files.pop("dataset.json")) for files in (made, always))
    assert begun["render"] == "kept", "for commands that say nothing of it"
    assert begun["identity"] == expected["identity"]
    assert made == always
    field = tmp_path / "field.yaml"
    field.write_text(run.read_text() + "render: kept\n")
    again = generate(field, tmp_path / "out", "--workers", workers)
    assert [event["event"] for event in again] == ["started", "finished"], "nothing is made again"


@pytest.mark.proof
def test_seven_workers_produce_the_same_bytes(longer: Path, tmp_path: Path):
    run = write_run(tmp_path, **LONGER)
    generate(run, tmp_path / "out", "--workers", 7)
    assert len(processes(tmp_path / "out")) >= 3
    assert contents(tmp_path / "out") == contents(longer)


def test_all_processes_together_query_the_ffmpeg_version_once(tmp_path: Path):
    asked, program = tmp_path / "asked", tmp_path / "ffmpeg"
    real = os.environ.get("ROBOCELL_FFMPEG") or shutil.which("ffmpeg")
    program.write_text(f"""#!/bin/sh
case "$*" in *-version*) echo once >> '{asked}';; esac
exec '{real}' "$@"
""")
    program.chmod(0o755)
    command = ("generate", write_run(tmp_path), "--output", tmp_path / "out", "--workers", 2)
    result = robocell_command(*command, environment={"ROBOCELL_FFMPEG": program})
    assert result.returncode == 0, result.stderr
    assert asked.read_text() == "once\n"
    versions = [episode.json["versions"] for episode in robocell.Dataset(tmp_path / "out")]
    assert len(versions) == 2
    assert all(each["ffmpeg"].startswith("ffmpeg version ") for each in versions)


@contextlib.contextmanager
def going_on(run: Path, output: Path, *options: object) -> Iterator[subprocess.Popen[str]]:
    """A run that has begun, and is ended at last."""
    command = [sys.executable, "-m", "robocell", "generate", run, "--output", output, *options]
    with subprocess.Popen(
        [str(word) for word in [*command, "--progress", "jsonl"]],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            assert process.stdout is not None
            assert json.loads(process.stdout.readline())["event"] == "started"
            yield process
        finally:
            process.kill()


@pytest.mark.proof
def test_workers_that_pause_produce_the_same_bytes(longer: Path, tmp_path: Path):
    run, out, chance = write_run(tmp_path, **LONGER), tmp_path / "out", random.Random(4)
    stops = 0
    with going_on(run, out, "--workers", 3) as process:
        while process.poll() is None:
            time.sleep(chance.uniform(0, 0.05))
            workers = children(process.pid)
            if not workers:
                continue
            still = chance.choice(workers)
            with contextlib.suppress(ProcessLookupError):
                os.kill(still, signal.SIGSTOP)
                time.sleep(chance.uniform(0.01, 0.1))
                os.kill(still, signal.SIGCONT)
                stops += 1
        assert process.returncode == 0
    assert stops > 10
    assert len(processes(out)) > 1
    assert contents(out) == contents(longer)


def test_two_shards_produce_the_same_bytes_in_one_folder(reference: Path, tmp_path: Path):
    run = write_run(tmp_path)
    (tmp_path / "out/.s0000_e0000.7.1.partial").mkdir(parents=True)  # of a killed one
    for shard in ("0/2", "1/2"):
        events = generate(run, tmp_path / "out", "--shard", shard)
        assert events[-1]["totals"]["planned"] == 1
    assert contents(tmp_path / "out") == contents(reference)
    assert robocell.data.verify(tmp_path / "out").leftovers == []


@pytest.fixture(scope="module")
def other_seed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same run with another seed."""

    def make(folder: Path) -> None:
        generate(write_run(folder), folder / "out", "--seed", 1)

    return made_once(tmp_path_factory, "other_seed", make) / "out"


@pytest.mark.proof
def test_an_episode_of_another_run_is_reported_and_not_counted(
    reference: Path, other_seed: Path, tmp_path: Path
):
    run, out = write_run(tmp_path), tmp_path / "out"
    shutil.copytree(reference, out)
    shutil.rmtree(out / IDS[0])
    shutil.copytree(other_seed / IDS[0], out / IDS[0])
    refusal = refused("generate", run, code=3)
    assert f"'{out / IDS[0]}' is an episode of another run (seed: 1 then, 0 now)" in refusal
    assert IDS[1] not in refusal


def test_another_seed_produces_other_bytes(reference: Path, other_seed: Path):
    other, first = (of_episodes(contents(folder)) for folder in (other_seed, reference))
    assert other.keys() == first.keys()
    assert not set(other.values()) & set(first.values())


def test_repeating_the_command_generates_only_missing_episodes(reference: Path, tmp_path: Path):
    run = write_run(tmp_path)
    generate(run, tmp_path / "out", "--episodes", 1)
    before = (tmp_path / "out" / IDS[0] / "episode.json").stat()
    events = generate(run, tmp_path / "out")
    assert events[0]["totals"]["already"] == 1
    assert events[-1]["totals"]["made"] == 1
    assert (tmp_path / "out" / IDS[0] / "episode.json").stat() == before
    assert contents(tmp_path / "out") == contents(reference)
    again = robocell_command("generate", run)
    assert again.returncode == 0
    assert "2 of 2 (2 made before)" in again.stdout


def test_the_summary_names_results_and_the_dataset(tmp_path: Path):
    run = write_run(tmp_path, episodes_per_scene=1)
    result = robocell_command("generate", run)
    assert result.returncode == 0, result.stderr
    for text in ("1 of 1", "rollout", "sampled", "episodes/h", "acting", str(tmp_path / "out")):
        assert text in result.stdout
    assert "1/1 episodes" in result.stderr, "plain lines without a terminal"
    assert "\x1b" not in result.stdout + result.stderr


def test_episodes_that_fail_are_listed_and_the_exit_code_is_1(tmp_path: Path):
    run = write_run(tmp_path, episodes_per_scene=1, max_attempts=1)
    limits = ["--set", "rates.max_steps=3"]  # three actions lift nothing
    result = robocell_command("generate", run, *limits)
    assert result.returncode == 1
    assert "s0000_e0000 could not be made: robot 'rc7', object '" in result.stderr
    assert "': no success in 1 attempt: " in result.stderr
    assert "try it alone: robocell generate" in result.stderr
    assert "--shard 0/1" in result.stderr
    assert "0 of 1" in result.stdout


def test_keep_all_keeps_failures_and_does_not_repeat_them(tmp_path: Path):
    run = write_run(tmp_path, episodes_per_scene=1, max_attempts=2, keep="all")
    limits = ["--set", "rates.max_steps=3"]  # three actions lift nothing
    assert robocell_command("generate", run, *limits).returncode == 1
    dataset = robocell.Dataset(tmp_path / "out")
    assert dataset.ids == ["s0000_e0000_a00", "s0000_e0000_a01"]
    assert [dataset[name].success for name in dataset.ids] == [False, False]
    before = contents(tmp_path / "out")
    again = robocell_command("generate", run, *limits)
    assert again.returncode == 1
    assert "its attempts were used up before" in again.stderr
    assert contents(tmp_path / "out") == before


def interrupt(run: Path, number: signal.Signals) -> subprocess.CompletedProcess[str]:
    """Signals a long run after its first episode."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    # A test run in the background may have SIGINT ignored, which children inherit.
    code = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    code += "; from robocell._cli import main; main()"
    command = [sys.executable, "-c", code, "generate", str(run), "--workers", "1"]
    child = subprocess.Popen(
        [*command, "--episodes", "50", "--set", "episodes_per_scene=50"],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    first = run.parent / "out" / IDS[0]
    end = time.monotonic() + 60
    while not first.is_dir():
        assert time.monotonic() < end
        assert child.poll() is None, child.communicate()
        time.sleep(0.02)
    if number is signal.SIGKILL:
        child.kill()
    else:
        os.killpg(child.pid, number)
    begin = time.monotonic()
    out, err = child.communicate(timeout=30)
    assert time.monotonic() - begin < 15
    return subprocess.CompletedProcess(command, child.returncode, out, err)


@pytest.mark.parametrize(
    "number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.proof)]
)
def test_an_interrupted_run_keeps_episodes_and_prints_how_to_resume(
    reference: Path, tmp_path: Path, number: signal.Signals
):
    run = write_run(tmp_path)
    result = interrupt(run, number)
    assert result.returncode == 130
    assert "Traceback" not in result.stderr
    assert re.search("of 50 episodes (is|are) on the disk", result.stderr)
    assert f"robocell generate {run}" in result.stderr
    result = robocell.data.verify(tmp_path / "out")
    assert result.ok
    assert result.leftovers == [], "nothing half-made stays"
    made = contents(tmp_path / "out")
    steps = f"{IDS[0]}/steps.h5"
    assert made[steps] == contents(reference)[steps]


def test_a_killed_run_can_resume(reference: Path, tmp_path: Path):
    run = write_run(tmp_path)
    assert interrupt(run, signal.SIGKILL).returncode == -signal.SIGKILL
    generate(run, tmp_path / "out")
    result = robocell.data.verify(tmp_path / "out")
    assert result.ok
    assert result.leftovers == [], "what the killed workers were writing is gone"
    made = contents(tmp_path / "out")
    assert {name: made[name] for name in contents(reference)} == contents(reference)


def test_rejects_a_second_run_and_the_first_completes(reference: Path, tmp_path: Path):
    run, out = write_run(tmp_path), tmp_path / "out"
    with going_on(run, out, "--workers", 1) as first:
        first.send_signal(signal.SIGSTOP)  # so that it is there still
        refusal = " ".join(refused("generate", run, "--output", out, code=3).split())
        assert f"process {first.pid} on" in refusal
        assert str(out) in refusal
        first.send_signal(signal.SIGCONT)
        _, told = first.communicate(timeout=120)
        assert first.returncode == 0, told
    assert contents(out) == contents(reference)


@pytest.mark.proof
def test_another_shard_can_run_concurrently_but_not_the_same(reference: Path, tmp_path: Path):
    run, out = write_run(tmp_path), tmp_path / "out"
    with going_on(run, out, "--shard", "0/2", "--workers", 1) as first:
        first.send_signal(signal.SIGSTOP)
        generate(run, out, "--shard", "1/2", "--workers", 1)
        refusal = refused("generate", run, "--output", out, "--shard", "0/2", code=3)
        assert f"process {first.pid} on" in " ".join(refusal.split())
        first.send_signal(signal.SIGCONT)
        _, told = first.communicate(timeout=120)
        assert first.returncode == 0, told
    assert contents(out) == contents(reference)
