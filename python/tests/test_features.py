"""Features of a user's own: recorded, seen by policies, refused when they are not right."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import robocell as rc
from command_line import robocell_command
from robocell.envs import from_dataset
from test_dataset_env import make

ROOT = Path(__file__).parents[2]


def test_custom_features_are_recorded_and_observed(tmp_path: Path):
    @rc.features.register_feature("tcp_height_of_test", units="m", frame="world")
    def height(scene: rc.Scene) -> float:
        return scene.robot("rc7").tcp_in_world.translation[2]

    made = make(tmp_path / "out", 1, features=["tcp_height_of_test"])
    name = "features/tcp_height_of_test"
    column = made[0].column(name)
    assert (column.units, column.frame) == ("m", "world")
    assert np.allclose(made[0][name], np.asarray(made[0]["robots/rc7/tcp_pose"])[:, 2])
    row, _ = from_dataset(made, cameras=False).reset(seed=0)
    assert row[name] == made[0][name][0]
    result = robocell_command("evaluate", made.folder, "--policy", "expert", "-n", 1)
    assert result.returncode == 2
    assert "features: no registered feature 'tcp_height_of_test'. A feature of" in result.stderr
    assert "a dataset imports none by itself: name it with --import" in result.stderr


def test_rejects_invalid_features(tmp_path: Path):
    with pytest.raises(rc.SpecError, match="no registered feature 'nothing_of_test'"):
        make(tmp_path / "out", 1, features=["nothing_of_test"])

    @rc.features.register_feature("wide_of_test", shape=[2])
    def wide(scene: rc.Scene) -> list[float]:
        return [1, 2, 3]

    with pytest.raises(rc.ArgumentError, match="feature 'wide_of_test'"):
        make(tmp_path / "wide", 1, features=["wide_of_test"])
    with pytest.raises(TypeError, match="expected a function"):
        rc.features.register_feature("a_of_test")(3)
    with pytest.raises(rc.ArgumentError, match="lower"):
        rc.features.register_feature("b_of_test", lower=[0])(lambda scene: 0.0)


def test_features_can_be_pickled():
    made = rc.features.Feature(
        "tip",
        shape=[2],
        units="m",
        frame="world",
        names=["x", "y"],
        privileged=True,
        lower=[-np.inf, -1 / 3],
        upper=[0.1, np.inf],
        description="Where the tip is.",
    )
    env = rc.Env(rc.EnvConfig.load(rc.models.cell_file("rc7")))
    built_in = [*env.observed, *env.commanded]
    env.close()
    fields = ("name", "role", "dtype", "shape", "units", "frame", "names", "values")
    protocols = range(pickle.HIGHEST_PROTOCOL + 1)
    for feature, protocol in [(made, p) for p in protocols] + [(each, 4) for each in built_in]:
        again = pickle.loads(pickle.dumps(feature, protocol))
        for field in (*fields, "description", "lower", "upper", "source"):
            assert getattr(again, field) == getattr(feature, field), (feature, field)


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_values_can_be_pickled_by_every_protocol(protocol: int):
    verdict = rc.tasks.TaskVerdict(0.5, True, 0.25, 3)
    pose = rc.Pose(translation=[1, 2, 3])
    config = rc.EnvConfig.load(rc.models.cell_file("rc7"))
    for value in (verdict, pose, config):
        again = pickle.loads(pickle.dumps(value, protocol))
        assert (type(again), repr(again)) == (type(value), repr(value))
