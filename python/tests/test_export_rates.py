"""Exports need evenly spaced rows, unless the format stores their times; others are resampled."""

from __future__ import annotations

import json
import math
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import numpy as np
import pyarrow.parquet as pq
import pytest
import zarr
from mcap.reader import make_reader

import robocell as rc
from command_line import refused, robocell_command
from exported import hashes, psnr, three_episodes
from robocell.data import EnvRecorder
from robocell.export import FORMATS, export_dataset
from robocell.export._rates import rate_of
from robocell.export._resampled import ResampledEpisode

WITHOUT_TIMES = [name for name, form in FORMATS.items() if not form.stores_times]


def record(folder: Path, **sim: Any) -> rc.Dataset:
    """Two episodes of an arm whose steps differ in length, as far as `sim` lets them."""
    config = rc.EnvConfig(
        robots={"robot": rc.models.robot_file("rc7")},
        root_frame_objects={"cube": ("green_cube", rc.Pose(translation=[0.45, 0, 0.02]))},
        task={"kind": "pick", "object": "cube"},
        control_mode="cartesian_tquat",
        relative_to="last_step",
        sim=sim,
    )
    env = rc.Env(config)
    with EnvRecorder(env, folder):
        for seed in (1, 2):
            env.reset(seed=seed)
            for z in (-0.04, -0.001 * seed, 0.03):
                env.step({"robot": {"tquat": [0, 0, z, 0, 0, 0, 1], "gripper": 1}})
    env.close()
    return rc.Dataset(folder)


@pytest.fixture(scope="module")
def uneven(tmp_path_factory: pytest.TempPathFactory) -> rc.Dataset:
    return record(tmp_path_factory.mktemp("uneven") / "out")


@pytest.mark.parametrize("format", WITHOUT_TIMES)
def test_formats_without_times_reject_rows_that_are_not_even(
    uneven: rc.Dataset, tmp_path: Path, format: str
):
    assert len(set(np.diff(uneven[0]["time"]).round(4))) > 1
    out = tmp_path / "export"
    text = " ".join(refused("export", uneven.folder, out, "--format", format).split())
    assert f"episode '{uneven[0].folder}': its rows are not evenly spaced: from " in text
    assert "Resample with --rate HZ, record environments with `sim: {async_control: true}`" in text
    assert not list(tmp_path.iterdir())


def test_a_log_has_the_times_of_uneven_rows(uneven: rc.Dataset, tmp_path: Path):
    out = tmp_path / "log"
    done = robocell_command("export", uneven.folder, out, "--format", "mcap")
    assert done.returncode == 0, done.stderr
    assert "MCAP: 2 episodes, 6 frames at uneven times, 0 cameras" in done.stdout
    assert (
        "Rows are not evenly spaced; every row has its own time." in (out / "README.md").read_text()
    )
    for episode in uneven:
        with (out / f"{episode.id}.mcap").open("rb") as file:
            messages = make_reader(file).iter_messages(topics=["/joint_states"])
            times = [message.log_time for _, _, message in messages]
        np.testing.assert_allclose(np.array(times) / 1e9, episode["time"], atol=1e-9)


@pytest.mark.parametrize("frequency", [20, 30])
def test_steps_of_one_length_are_even(tmp_path: Path, frequency: int):
    # A frame of 1/30 s is 16 or 17 steps of the engine of 2 ms.
    dataset = record(tmp_path / "out", async_control=True, frequency=frequency)
    made = export_dataset(dataset, tmp_path / "export", "robomimic")
    assert made.is_even
    assert made.rate == frequency


@pytest.mark.parametrize(
    ("late", "is_even"), [(0.0, True), (0.0019, True), (-0.0019, True), (0.003, False)]
)
def test_rows_within_half_a_step_of_even_times_are_even(late: float, is_even: bool):
    time = 0.7 + 0.05 * np.arange(8)
    time[3] += late
    episode: Any = Times(time)
    if is_even:
        assert rate_of(episode, []) == 20
        return
    with pytest.raises(rc.ArgumentError, match=r"from 0.047 to 0.053 s apart, where 0.05 s were"):
        rate_of(episode, [])


def test_a_drift_is_uneven():
    episode: Any = Times(np.arange(200) * 0.0501)
    with pytest.raises(rc.ArgumentError, match="not evenly spaced"):
        rate_of(episode, [])


class Times(SimpleNamespace):
    """As much of an episode as a rate depends on, at 20 Hz and with an engine step of 2 ms."""

    def __init__(self, time: np.ndarray) -> None:
        rates = {"policy_hz": [20, 1], "sim_ms": 2.0}
        super().__init__(json={}, metadata={"rates": rates}, folder="out/e0", time=time)

    def __len__(self) -> int:
        return len(self.time)

    def __contains__(self, name: str) -> bool:
        return name == "time"

    def __getitem__(self, name: str) -> np.ndarray:
        assert name == "time"
        return self.time


# ---- other rates, on request ---------------------------------------------------------------------


@pytest.fixture(scope="module")
def even(tmp_path_factory: pytest.TempPathFactory) -> rc.Dataset:
    return three_episodes(tmp_path_factory)


def held_rows(episode: Any, rate: float) -> np.ndarray:
    """The last row at or before each moment, by the recorded times."""
    period = 0.132
    count = math.ceil(round(len(episode) * period * rate, 9))
    starts = np.arange(len(episode)) * period
    return np.array([np.flatnonzero(starts <= k / rate + 1e-9)[-1] for k in range(count)])


@pytest.mark.parametrize("rate", [4, pytest.param(15, marks=pytest.mark.proof)])
def test_rows_at_another_rate_are_the_nearest_before(even: rc.Dataset, tmp_path: Path, rate: int):
    made = export_dataset(even, tmp_path / "out", "zarr", rate=rate)
    assert (made.rate, made.is_even) == (rate, True)
    group = zarr.open_group(str(tmp_path / "out" / "replay_buffer.zarr"), mode="r")
    ends = [0, *group["meta/episode_ends"][:]]
    robot = "robots/rc7"
    for episode, first, last in zip(even, ends[:-1], ends[1:], strict=True):
        rows = held_rows(episode, rate)
        assert last - first == len(rows)
        state = np.column_stack([episode[f"{robot}/arm/qpos"], episode[f"{robot}/opening"]])
        np.testing.assert_array_equal(group["data/state"][first:last], state.astype("f4")[rows])
        images = group["data/exo_image"][first:last]
        recorded = episode.frames("exo")
        assert min(map(psnr, images, recorded[rows])) > 30, "image i is that of row i"
        if rate < 7:
            assert max(map(psnr, images[1:], recorded[rows[:-1]])) < 99


def test_relative_actions_lead_from_one_held_target_to_the_next(even: rc.Dataset):
    episode, arm = even[0], "robots/rc7/action/arm"
    rows = held_rows(episode, 3)
    view: Any = ResampledEpisode(episode, rows, Fraction(3))
    before = episode[arm][0] - episode[f"{arm}_relative"][0]
    np.testing.assert_allclose(
        before + np.cumsum(view[f"{arm}_relative"], axis=0), episode[arm][rows], atol=1e-12
    )
    np.testing.assert_array_equal(view[arm], episode[arm][rows])


@pytest.mark.parametrize("rate", [3, 20])
def test_rewards_and_ends_are_neither_lost_nor_repeated(even: rc.Dataset, rate: int):
    episode = even[0]
    view: Any = ResampledEpisode(episode, held_rows(episode, rate), Fraction(rate))
    assert view["reward"].sum() == pytest.approx(episode["reward"].sum())
    for name in ("terminated", "truncated", "success"):
        assert view[name].any() == episode[name].any()
        assert view[name][-1] == episode[name][-1]
    np.testing.assert_allclose(np.diff(view["time"]), 1 / rate)
    assert len(view["control/ctrl"]) == len(episode["control/ctrl"]), "another table"


def test_states_of_robomimic_are_those_of_their_rows(even: rc.Dataset, tmp_path: Path):
    for name, rate in (("own", None), ("slow", "100/33")):
        export_dataset(even, tmp_path / name, "robomimic", rate=rate, episodes=["0"], cameras=[])
    rows = held_rows(even[0], 100 / 33)
    with (
        h5py.File(tmp_path / "own" / "dataset.hdf5") as own,
        h5py.File(tmp_path / "slow" / "dataset.hdf5") as slow,
    ):
        np.testing.assert_array_equal(
            slow["data/demo_0/states"][:], own["data/demo_0/states"][:][rows]
        )


def test_a_resampled_lerobot_dataset_has_exact_times(even: rc.Dataset, tmp_path: Path):
    out = tmp_path / "out"
    done = robocell_command("export", even.folder, out, "--fps", 10, "--episodes", 0)
    assert done.returncode == 0, done.stderr
    assert "was encoded again: at 10 frames per second" in done.stdout
    assert "No row was added" not in done.stdout + done.stderr
    card = " ".join((out / "README.md").read_text().split())
    assert "A row is 1/10 s. The episodes were recorded at another rate and resampled" in card
    info = json.loads((out / "meta/info.json").read_text())
    rows = held_rows(even[0], 10)
    assert (info["fps"], info["total_frames"]) == (10, len(rows))
    table = pq.read_table(next((out / "data").rglob("*.parquet")))
    stamps = np.array(table["timestamp"])
    np.testing.assert_allclose(stamps, np.arange(len(rows)) / 10, atol=1e-6)


def test_a_rate_that_is_the_own_one_copies(even: rc.Dataset, tmp_path: Path):
    for name, rate in (("plain", None), ("same", "250/33")):
        export_dataset(even, tmp_path / name, "zarr", rate=rate, cameras=[])
    ours, theirs = (hashes(tmp_path / name / "replay_buffer.zarr") for name in ("plain", "same"))
    assert ours == theirs


def test_uneven_rows_can_be_resampled_by_their_times(uneven: rc.Dataset, tmp_path: Path):
    made = export_dataset(uneven, tmp_path / "out", "zarr", rate=20)
    group = zarr.open_group(str(tmp_path / "out" / "replay_buffer.zarr"), mode="r")
    first = uneven[0]
    time = first["time"] - first["time"][0]
    count = int(np.floor(time[-1] * 20 + 1e-6)) + 1
    rows = [np.flatnonzero(time <= k / 20 + 1e-6)[-1] for k in range(count)]
    qpos = first["robots/robot/arm/qpos"].astype("f4")
    np.testing.assert_array_equal(group["data/state"][:count, :7], qpos[rows])
    assert made.rate == 20


def test_relative_actions_of_an_environment_keep_their_rate(uneven: rc.Dataset, tmp_path: Path):
    with pytest.raises(rc.ArgumentError, match="is relative to last_step, so it belongs to the"):
        export_dataset(uneven, tmp_path / "out", "zarr", rate=20, actions="action/robot/tquat")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("rate", [0, -1, "fast", float("nan"), float("inf"), 1001, "1/0"])
def test_a_rate_is_a_number_of_rows_per_second(even: rc.Dataset, tmp_path: Path, rate: Any):
    with pytest.raises(rc.ArgumentError, match=r"expected rows per second, above 0 and at most"):
        export_dataset(even, tmp_path / "out", "zarr", rate=rate)


def test_lerobot_needs_a_whole_rate_and_logs_take_none(even: rc.Dataset, tmp_path: Path):
    with pytest.raises(rc.ArgumentError, match=r"LeRobot v3.0 needs a whole number, such as 12"):
        export_dataset(even, tmp_path / "out", rate=12.5)
    with pytest.raises(rc.ArgumentError, match="format 'mcap' takes no rate"):
        export_dataset(even, tmp_path / "out", "mcap", rate=10)
