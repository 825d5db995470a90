"""Robots that drive: datasets of `navigate`, and environments and policies that act as recorded."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robocell as rc
from robocell.envs import from_dataset
from robocell.evaluate import evaluate

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> rc.Dataset:
    """A drive of the differential drive to the table."""
    run = rc.RunConfig.load(ROOT / "examples" / "mobile" / "cart.yaml")
    run.scenes = rc.scenes.SceneSourceSpec(source="tabletop")
    run.task = {"kind": "navigate", "to": "table", "within": 0.6, "facing": 0.4}
    run.cameras.streams.clear()
    run.output, run.episodes = str(tmp_path_factory.mktemp("drives") / "out"), 1
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    for item in rc.generate.make_plan(run):
        result = runner.run(item)
        assert result.success, result.failures
    return rc.Dataset(run.output)


def test_the_place_of_a_base_on_wheels_is_observed_and_commanded(dataset: rc.Dataset):
    episode = dataset[0]
    features = {feature.name: feature for feature in episode.features}
    for name in ("robots/cart/base/qpos", "robots/cart/action/base"):
        assert features[name].names == ["x", "y", "yaw"], name
        assert features[name].units == "m, m, rad", name
    places = np.asarray(episode["robots/cart/base/qpos"])
    targets = np.asarray(episode["robots/cart/action/base"])
    assert np.hypot(*(places[-1] - places[0])[:2]) > 0.5
    assert np.abs((places - targets)[:, :2]).max() < 0.3
    assert np.hypot(*(places[-1] - targets[-1])[:2]) < 0.03
    assert episode.metadata["instruction"] == "go to the table"
    assert np.asarray(episode["subtask"])[[0, -1]].tolist() == [0, 1]


def test_an_environment_of_a_drive_acts_as_recorded(dataset: rc.Dataset):
    env = from_dataset(dataset)
    env.reset(seed=0)
    info: dict[str, object] = {}
    for target in np.asarray(dataset[0]["robots/cart/action/base"]):
        _, _, terminated, _, info = env.step({"robots/cart/action/base": target})
        if terminated:
            break
    assert info["is_success"]


def test_a_policy_that_drives_is_evaluated(dataset: rc.Dataset, tmp_path: Path):
    result = evaluate(dataset.folder, "replay", output=tmp_path / "out", cameras=False)
    assert (result.successes, result.rollouts) == (1, 1)
