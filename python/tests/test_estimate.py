"""What a few episodes say about many."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import robocell
from command_line import refused, robocell_command, write_run
from menagerie import Menagerie
from robocell._generation.estimate import Estimate, scaled
from robocell._generation.probe import Probe, Sample, spread


def sample(rows: int, *, frames: int = 0, extra: int = 0, **times: float) -> Sample:
    """An item with one episode: 1000 bytes a row, 500 a frame, and 1 MB for itself."""
    video = 500 * frames
    return Sample(
        success=True,
        kept=1,
        rollouts=1,
        rows=rows,
        frames=frames,
        bytes=1_000_000 + 1000 * rows + video + extra,
        video_bytes=video,
        files=4 if frames else 2,
        **{"seconds": 1.0, "cpu_seconds": 1.0, **times},
    )


def probe(blind: list[Sample], seeing: list[Sample]) -> Probe:
    return Probe(blind, seeing, start_s=2.0, worker_bytes=100, encoder_bytes=20)


def test_samples_are_spread_over_the_plan():
    assert spread(3, 24) == [0, 1, 2]
    assert spread(100, 4) == [0, 25, 50, 75]
    assert spread(7, 5) == [0, 1, 2, 4, 5]
    assert len(set(spread(25, 24))) == 24


def test_the_cost_of_cameras_scales_with_rows_and_episodes():
    blind = [sample(40), sample(60), sample(80), sample(60)]
    seeing = [sample(40, frames=80, extra=3000, seconds=5.0)]
    found = scaled(probe(blind, seeing), items=400, workers=3, cores=2, before_s=3.0, own_bytes=50)
    assert found == Estimate(
        items=400,
        episodes=400,
        successes=400,
        rows=24_000,
        frames=48_000,
        bytes=400 * (1_000_000 + 3000) + 24_000 * 1000 + 48_000 * 500,
        seconds=3.0 + 2.0 + 400 * (1.0 + 4.0) / 2,  # two cores, whatever the workers
        workers=3,
        memory_bytes=50 + 3 * (100 + 20),
        tried=4,
        seen=1,
        files=400 * (2 + 2),
        per_core_hour=3600.0,
        cores=2,
    )
    assert found.rows_of_text()["size"].endswith(" in 1600 files, 1.12 MB per episode")
    assert found.rows_of_text()["rate"] == "3600 episodes/h per core"
    assert found.rows_of_text()["time"].endswith("on 3 workers and 2 cores")
    assert "reasons" not in found.rows_of_text()


def test_workers_that_use_several_cores_each_share_them():
    # With cameras an item keeps a core and a half busy: a third worker finds nothing to do.
    blind, seeing = [sample(60)], [sample(60, seconds=2.0, cpu_seconds=3.0)]
    times = [
        scaled(probe(blind, seeing), items=100, workers=workers, cores=2).seconds
        for workers in (1, 2, 3)
    ]
    assert times == [2.0 + 100 * 2.0, 2.0 + 100 * 3.0 / 2, 2.0 + 100 * 3.0 / 2]


def test_failed_items_cost_time_and_leave_nothing():
    failed = Sample(
        success=False,
        kept=0,
        rollouts=1,
        rows=0,
        frames=0,
        bytes=0,
        video_bytes=0,
        seconds=1.0,
        cpu_seconds=1.0,
        reasons={"timeout": 2, "no grasp": 3},
    )
    blind = [sample(60), failed]
    found = scaled(probe(blind, [sample(60, frames=60)]), items=10, workers=1)
    assert (found.episodes, found.successes, found.frames) == (5, 5, 300)
    assert found.rows_of_text()["episodes"] == "5 (5 of 10 items succeed)"
    assert found.rows_of_text()["reasons"] == "no grasp 3, timeout 2"
    nothing = scaled(probe([failed], [failed]), items=10, workers=1)
    assert (nothing.episodes, nothing.frames, nothing.bytes) == (0, 0, 0)


@pytest.mark.proof
def test_an_estimate_is_close_to_the_cost_of_two_episodes(tmp_path: Path):
    run = write_run(tmp_path)
    result = robocell_command("generate", run, "--dry-run", "--progress", "jsonl")
    assert result.returncode == 0, result.stderr
    expected = json.loads(result.stdout)
    assert expected["event"] == "estimate"
    assert not (tmp_path / "out").exists()
    assert robocell_command("generate", run).returncode == 0
    dataset = robocell.Dataset(tmp_path / "out")
    assert expected["rows"] == expected["frames"] == sum(len(episode) for episode in dataset)
    stored = sum(file.stat().st_size for file in (tmp_path / "out").glob("s*/*"))
    assert expected["bytes"] == pytest.approx(stored, rel=0.02)
    assert expected["files"] == len(list((tmp_path / "out").glob("s*/*")))
    again = robocell_command("generate", run, "--dry-run").stdout
    assert "episodes: 2 planned, 2 on the disk, 0 to make" in again
    assert "estimate (from" not in again


@pytest.mark.proof
def test_a_dry_run_reports_that_no_episode_can_succeed(tmp_path: Path):
    # Everything is right about the run but that nothing encodes.
    run = write_run(tmp_path)
    environment = {"ROBOCELL_FFMPEG": tmp_path / "none"}
    result = robocell_command("generate", run, "--dry-run", environment=environment)
    assert result.returncode == 3
    assert "records 1 camera stream, on this machine that fails: ROBOCELL_FFMPEG" in result.stderr
    few = ("--set", "rates.max_steps=3", "--set", "max_attempts=3")
    hasty = robocell_command("generate", run, "--dry-run", *few)
    assert hasty.returncode == 1
    assert "episodes: 0 (0 of 2 items succeed)" in hasty.stdout
    assert "reasons:  timeout 6" in hasty.stdout
    assert "none of the 2 trials succeeded: see the reasons" in hasty.stderr
    assert "no kind" in refused("generate", run, "--dry-run", "--set", "task.objects=[mgu]")


@pytest.mark.proof
def test_the_memory_of_a_worker_with_two_cameras_on_the_panda_is_bounded(
    tmp_path: Path, menagerie: Menagerie
):
    """The figure of docs/render.md: the command, one worker and its encoders, together."""
    result = robocell_command(
        "generate",
        Path(__file__).parents[2] / "examples" / "panda_pick.yaml",
        *("--dry-run", "--progress", "jsonl", "--workers", 1, "--episodes", 1),
        *("--output", tmp_path / "out", "--set", "cameras.resolution=[640,480]"),
        *("--set", "cameras.renderer={backend: soft, quality: standard}"),
    )
    assert result.returncode == 0, result.stderr
    (estimate,) = (
        event
        for line in result.stdout.splitlines()
        if (event := json.loads(line))["event"] == "estimate"
    )
    assert estimate["frames"] > 0
    assert 200e6 < estimate["memory_bytes"] < 700e6
