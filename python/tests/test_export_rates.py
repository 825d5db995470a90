"""Exports need evenly spaced rows, unless the format stores their times."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

import robocell as rc
from command_line import refused, robocell_command
from robocell.data import EnvRecorder
from robocell.export import FORMATS, export_dataset
from robocell.export._rates import rate_of

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
    assert "Record environments with `sim: {async_control: true}`" in text
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
