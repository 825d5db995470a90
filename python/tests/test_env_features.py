"""Features of a user's own and sensors in observations, and the schema that spaces are views of."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import robocell as rc
from robocell.data import EnvRecorder, replay_actions
from robocell.envs import from_dataset
from robocell.gym import FlatGymEnv, GymEnv, VectorGymEnv, pick_cube_config
from robocell.lerobot import LeRobotEnv
from test_dataset_env import make

STAY = {"robot": {"tquat": [0, 0.01, -0.02, 0, 0, 0, 1], "gripper": 1}}


@rc.features.register_feature(
    "env_test_tool", shape=(2,), units="m", frame="world", names=["x", "z"]
)
def tool(scene: rc.Scene) -> np.ndarray:
    return scene.robot("robot").tcp_in_world.translation[[0, 2]]


@rc.features.register_feature(
    "env_test_matrix", shape=(2, 3), names=["a", "b", "c"], lower=[0] * 6, upper=[4] * 6
)
def matrix(scene: rc.Scene) -> np.ndarray:
    return np.arange(6).reshape(2, 3)


@rc.features.register_feature("env_test_number", units="m")
def number(scene: rc.Scene) -> float:
    return 0.5


@pytest.fixture
def config(tmp_path: Path) -> rc.EnvConfig:
    """A cube, and a plate that weighs what lies on it."""
    (tmp_path / "pad.xml").write_text(
        """<mujoco><worldbody><body name="plate"><geom size="0.05 0.05 0.01" type="box"/>
        <site name="top" size="0.06"/></body></worldbody>
        <sensor><touch name="weight" site="top"/></sensor></mujoco>"""
    )
    chosen = pick_cube_config(
        relative_to="last_step", features=["env_test_tool", "sensors/*", "robots/*/arm/qvel"]
    )
    chosen.root_frame_objects["pad"] = rc.envs.EnvObject(
        mjcf_path=str(tmp_path / "pad.xml"),
        offset=rc.Pose(translation=[0.3, 0.4, 0.01]),
        fixed=True,
    )
    return chosen


@pytest.fixture
def env(config: rc.EnvConfig) -> Iterator[rc.Env]:
    made = rc.Env(config)
    yield made
    made.close()


def test_custom_features_are_observed_like_built_in_ones(env: rc.Env):
    observation, _ = env.reset(seed=1)
    seen = observation["features"]
    assert list(seen) == ["env_test_tool", "sensors/pad_weight", "robots/robot/arm/qvel"]
    assert np.array_equal(seen["env_test_tool"], tool(env.scene))
    observation, *_ = env.step(STAY)
    assert np.array_equal(observation["features"]["env_test_tool"], tool(env.scene))
    features = {feature.name: feature for feature in env.observed}
    own = features["observation/features/env_test_tool"]
    assert (own.units, own.frame, own.names) == ("m", "world", ["x", "z"])
    assert features["observation/features/sensors/pad_weight"].units == "N"
    assert features["observation/robot/tquat"].frame == "shared base frame"
    assert [f.name for f in env.commanded] == ["action/robot/tquat", "action/robot/gripper"]
    assert [path for path, _, _ in env.observation_parts] == [
        tuple(f.name.split("/")[1:]) if "features" not in f.name else ("features", f.name[21:])
        for f in env.observed
    ]


def test_features_are_equal_in_gymnasium_and_in_vectors(config: rc.EnvConfig):
    single, flat = GymEnv(config), FlatGymEnv(config)
    vector = VectorGymEnv(config, 2, threads=2)
    observation, _ = single.reset(seed=1)
    assert single.observation_space.contains(observation)
    assert single.observation_space["features"]["env_test_tool"].shape == (2,)
    numbers, _ = flat.reset(seed=1)
    assert flat.observation_space.contains(numbers)
    assert len(numbers) == sum(size for _, _, size in single.core.observation_parts)
    both, _ = vector.reset(seed=1)
    assert vector.observation_space.contains(both)
    for name, value in observation["features"].items():
        assert np.array_equal(both["features"][name][0], value)
    assert vector.single_observation_space == single.observation_space
    assert [f.name for f in vector.core.observed] == [f.name for f in single.core.observed]
    single.close()
    flat.close()
    vector.close()


def test_in_lerobot_the_role_selects_the_key(config: rc.EnvConfig):
    plain, chosen = LeRobotEnv(pick_cube_config()), LeRobotEnv(config)
    config.features = [*config.features, "objects/cube/pose"]
    privileged = LeRobotEnv(config)
    sizes = []
    for env in (plain, chosen, privileged):
        observation, _ = env.reset(seed=1)
        assert env.observation_space.contains(observation)
        sizes.append([len(observation[key]) for key in ("agent_pos", "environment_state")])
        env.close()
    (agent, world), *others = sizes
    assert others == [[agent + 10, world], [agent + 10, world + 7]]


def test_without_features_observations_are_unchanged():
    env = GymEnv(pick_cube_config())
    observation, _ = env.reset(seed=1)
    assert sorted(observation) == ["objects", "robot"]
    assert sorted(observation["robot"]) == ["gripper", "joints", "tquat", "xyzrpy"]
    env.close()


def test_an_unknown_feature_error_suggests_the_nearest():
    with pytest.raises(rc.NotFoundError, match=r"no feature 'env_test_tol'.*'env_test_tool'"):
        rc.Env(pick_cube_config(features=["env_test_tol"]))


def test_the_environment_of_a_dataset_observes_recorded_features(env: rc.Env, tmp_path: Path):
    folder = tmp_path / "out"
    with EnvRecorder(env, folder):
        env.reset(seed=1)
        for _ in range(3):
            env.step(STAY)
    (episode,) = dataset = rc.Dataset(folder)
    assert np.array_equal(
        episode["features/env_test_tool"], episode["observation/features/env_test_tool"]
    )
    assert replay_actions(env, episode).ok
    assert rc.data.verify_replay(episode, 0).ok

    back = from_dataset(dataset, privileged=True)
    assert back.actions == ["action/robot/tquat", "action/robot/gripper"]
    row, info = back.reset(seed=1)
    assert info["instruction"]
    for i in range(3):
        for name in back.observations:
            assert np.array_equal(row[name], episode[name][i]), name
        row, _, terminated, _, info = back.step({n: episode[n][i] for n in back.actions})
    assert not terminated
    assert info["is_success"] is False
    with pytest.raises(rc.ArgumentError, match="action 'joints' is none of this environment"):
        back.core.act({"joints": [0]})
    vector = from_dataset(
        dataset, ["robots/robot/arm/qpos", "observation/features/env_test_tool"], flat=True
    )
    numbers, _ = vector.reset(seed=1)
    assert np.array_equal(
        numbers,
        [*episode["robots/robot/arm/qpos"][0], *episode["observation/features/env_test_tool"][0]],
    )
    vector.step(np.concatenate([episode[n][0] for n in vector.actions]))


def test_features_keep_their_shapes_and_ranges(config: rc.EnvConfig, tmp_path: Path):
    config.features = ["env_test_matrix", "env_test_number"]
    single, vector = GymEnv(config), VectorGymEnv(config, 2)
    whole = {"env_test_matrix": [[0, 1, 2], [3, 4, 4]], "env_test_number": 0.5}
    for name, space in single.observation_space["features"].spaces.items():
        assert space.shape == np.shape(whole[name])
    one, _ = single.reset(seed=1)
    both, _ = vector.reset(seed=1)
    assert one in single.observation_space
    assert both in vector.observation_space
    for name, expected in whole.items():
        assert np.array_equal(one["features"][name], expected)
        assert one["features"][name].shape == np.shape(expected)
        assert np.array_equal(both["features"][name], [expected] * 2)
    single.close()
    vector.close()
    env = rc.Env(config)
    with EnvRecorder(env, tmp_path / "env"):
        env.reset(seed=1)
        env.step(STAY)
    env.close()
    (of_env,) = rc.Dataset(tmp_path / "env")
    of_run = make(tmp_path / "run", 1, features=list(whole))[0]
    for name, expected in whole.items():
        raw = [[0, 1, 2], [3, 4, 5]] if name == "env_test_matrix" else expected
        for column, stored in (
            (of_env.column(f"features/{name}"), raw),
            (of_env.column(f"observation/features/{name}"), expected),
            (of_run.column(f"features/{name}"), raw),
        ):
            assert column.row_shape == np.shape(expected)
            assert np.array_equal(column[0], stored)
        env = from_dataset(rc.Dataset(tmp_path / "run"), cameras=False)
        row, _ = env.reset(seed=0)
        space = env.observation_space[f"features/{name}"]
        assert np.array_equal(row[f"features/{name}"], np.clip(raw, space.low, space.high))


def test_signals_of_a_task_are_features(tmp_path: Path):
    class Points(rc.tasks.Task):
        def judge(self, scene: rc.Scene) -> rc.tasks.TaskVerdict:
            return rc.tasks.TaskVerdict()

        def instruction(self) -> str:
            return "look"

        def signals(self) -> list[rc.features.Feature]:
            grid = rc.features.Feature(
                "grid",
                shape=[2, 2],
                units="m",
                frame="world",
                names=["x", "y"],
                lower=[0] * 4,
                upper=[3] * 4,
            )
            return [grid, rc.features.Feature("count", privileged=True)]

        def observe(self, scene: rc.Scene) -> dict[str, object]:
            return {"grid": [[1, 2], [3, 4]], "count": 7}

    rc.register_task("points_of_test")(Points)
    config = pick_cube_config(task={"kind": "points_of_test"}, relative_to="last_step")
    env = rc.Env(config)
    with EnvRecorder(env, tmp_path / "out"):
        observation, _ = env.reset(seed=1)
        env.step(STAY)
    assert np.array_equal(observation["task"]["grid"], [[1, 2], [3, 3]])
    assert observation["task"]["count"].shape == ()
    schema = {feature.name: feature for feature in env.observed}
    grid = schema["observation/task/grid"]
    assert (grid.units, grid.frame, grid.names, grid.shape) == ("m", "world", ["x", "y"], (2, 2))
    assert (grid.role, schema["observation/task/count"].role) == ("observation", "privileged")
    env.close()
    (episode,) = rc.Dataset(tmp_path / "out")
    assert np.array_equal(episode["observation/task/grid"][0], [[1, 2], [3, 3]])
    assert np.array_equal(episode["task/grid"][0], [[1, 2], [3, 4]])
    with pytest.raises(rc.ArgumentError, match="lower"):
        rc.features.Feature("odd", shape=[2], lower=[0])
