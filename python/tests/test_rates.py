"""Rates in Hz: rows, times and videos of a run are exact, and replayed."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

import robocell
from command_line import RUN, refused, robocell_command, write_run

CAMERAS = {**RUN["cameras"], "streams": [{"name": "exo", "camera": "exo_camera"}]}


@pytest.mark.parametrize(
    ("rates", "fps"),
    [
        ("policy_hz: 7.5", (15, 2)),
        pytest.param("policy_hz: 6", (6, 1), marks=pytest.mark.proof),
    ],
)
def test_rows_times_and_frames_have_exactly_the_rate(
    tmp_path: Path, rates: str, fps: tuple[int, int]
):
    name, value = rates.split(": ")
    run = write_run(
        tmp_path,
        cameras=CAMERAS,
        rates={name: float(value), "sim_hz": 480, "max_steps": 500},
        episodes_per_scene=1,
    )
    result = robocell_command("generate", run)
    assert result.returncode == 0, result.stderr
    (episode,) = robocell.Dataset(tmp_path / "out")
    num, den = fps
    assert episode.metadata["rates"]["policy_hz"] == [num, den]
    assert episode.metadata["timestep"] == 1 / 480
    rows = np.arange(len(episode))
    np.testing.assert_allclose(episode["time"] - episode["time"][0], rows * den / num, atol=1e-9)
    with h5py.File(episode.folder / "steps.h5") as steps:
        attributes = steps["cameras/exo"].attrs
        assert (attributes["fps_num"], attributes["fps_den"]) == fps
    assert len(episode.frames("exo")) == len(episode)
    assert robocell.data.verify_replay(episode).ok


def test_a_rate_that_does_not_fit_names_the_nearest_and_the_timestep(tmp_path: Path):
    run = write_run(tmp_path, rates={"policy_ms": 33.3})
    text = " ".join(refused("generate", run, "--dry-run").split())
    assert "33.3 ms is not a multiple of control_ms (2 ms)" in text
    assert "the nearest are 32 ms (31.25 Hz) and 34 ms (500/17 Hz)" in text
    assert "For exactly 30 Hz set policy_hz: 30 and sim_hz: 480" in text


def test_rates_are_exact_in_python():
    rates = robocell.control.Rates(policy_hz=30, sim_hz=480)
    assert rates.policy_rate() == (30, 1)
    assert rates.timestep() == 1 / 480
    assert rates.policy_period() == pytest.approx(1 / 30, abs=1e-15)
    assert robocell.control.Rates().policy_rate() == (500, 33)
