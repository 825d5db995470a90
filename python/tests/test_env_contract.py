"""What holds for every ready-made cell (examples/envs) in every scene with every control mode.

Two unlike cells are a part of `make test`; `make check` has them all.
"""

from __future__ import annotations

import copy
import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robocell as rc
from menagerie import require_menagerie
from robocell.gym import GymEnv

CELLS = sorted((Path(__file__).parents[2] / "examples" / "envs").glob("*.yaml"))
# On the floor, and on a table: what is another in the configuration.
SCENES: dict[str, dict[str, Any]] = {
    "empty_world": {},
    "tabletop": {
        "scene": "tabletop",
        "root_frame_to_world": rc.Pose(translation=[-0.05, 0, 0.45], rpy=[0, 0, 0.3]),
    },
}
MODES = {"joints": (0.1,), "cartesian_trpy": (0.1, 0.3), "cartesian_tquat": (0.1, 0.3)}
STEPS = 50
SENSED = ("qpos", "qvel", "ctrl", "xpos", "xquat", "site_xpos", "sensordata")

Leaves = dict[str, np.ndarray]


# A robot of robocell's own; one of the Menagerie, with unlimited joints and coupled fingers.
QUICK = {"rc7", "gen3_2f85"}


def each(cells: list[Path]) -> list[Any]:
    """Parameters: the cells, of which all but the quick ones are proofs."""
    marks = {True: (), False: pytest.mark.proof}
    return [pytest.param(file, id=file.stem, marks=marks[file.stem in QUICK]) for file in cells]


@pytest.fixture(scope="module", params=each(CELLS))
def cell(request: pytest.FixtureRequest) -> rc.EnvConfig:
    if request.param.stem != "rc7":
        require_menagerie()
    return rc.EnvConfig.load(request.param)


def made(cell: rc.EnvConfig, scene: str, mode: str, relative_to: str = "last_step") -> GymEnv:
    config = copy.copy(cell)
    for field, value in SCENES[scene].items():
        setattr(config, field, value)
    config.control_mode = mode
    config.relative_to = relative_to
    config.max_relative_movement = MODES[mode]
    config.sim.frequency = 125  # four steps of the engine
    return GymEnv(config)


def leaves(value: Any, path: str = "") -> Leaves:
    if not isinstance(value, dict):
        return {path: np.asarray(value)}
    return {p: v for key in value for p, v in leaves(value[key], f"{path}/{key}").items()}


def episode(env: GymEnv) -> list[Leaves]:
    """Fifty random steps, each as the spaces say."""
    env.action_space.seed(1)
    observation, _ = env.reset(seed=3)
    seen = [leaves(observation)]
    for _ in range(STEPS):
        action = env.action_space.sample()
        observation, reward, terminated, truncated, info = env.step(action)
        assert env.observation_space.contains(observation), info
        assert (reward, terminated, truncated) == (0, False, False), info
        seen.append(leaves(observation))
    return seen


def check_contract(env: GymEnv) -> None:
    first, second = episode(env), episode(env)
    for path in first[0]:
        once, again = (np.array([each[path] for each in seen]) for seen in (first, second))
        assert np.array_equal(once, again), f"{path}: equal seeds, another episode"
        assert np.ptp(once, axis=0).min() > 0, f"{path}: a part of it stands still"
        for each, next_one in itertools.pairwise(first):
            assert not np.shares_memory(each[path], next_one[path]), f"{path}: is no copy"
        for name in SENSED:
            engine = getattr(env.core.scene.data, name)
            assert not np.shares_memory(first[-1][path], engine), f"{path}: is the engine's {name}"


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("mode", MODES)
def test_every_cell_fulfils_the_contract(cell: rc.EnvConfig, scene: str, mode: str):
    env = made(cell, scene, mode)
    check_contract(env)
    env.close()


@pytest.mark.parametrize("mode", MODES)
def test_every_cell_fulfils_the_contract_with_a_configured_origin(cell: rc.EnvConfig, mode: str):
    env = made(cell, "empty_world", mode, "configured_origin")
    check_contract(env)
    env.close()


def test_home_is_collision_free(cell: rc.EnvConfig):
    for scene in SCENES:
        env = made(cell, scene, "joints")
        env.reset(seed=3)
        model, data = env.core.scene.model, env.core.scene.data
        touching = [
            [model.body(model.geom_bodyid[geom]).name for geom in data.contact.geom[i]]
            for i in range(data.ncon)
        ]
        assert not touching, scene
        env.close()


def test_the_cells_match_the_page():
    page = (Path(__file__).parents[2] / "docs" / "environments.md").read_text()
    assert rc.models.cells() == [file.stem for file in CELLS]
    assert len(CELLS) == 6
    assert {file.stem for file in CELLS} > QUICK
    for file in CELLS:
        assert f"`{file.stem}`" in page, file
