"""A task that adds objects without poses starts as well in an environment as in a run."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

import robocell as rc

EXAMPLES = Path(__file__).parents[2] / "examples"
CUBES = ("red", "blue")


@pytest.fixture(scope="module")
def config() -> rc.EnvConfig:
    """The environment of the shipped example, as a user writes it."""
    sys.path.append(str(EXAMPLES))
    try:
        importlib.import_module("stack_cubes")
    finally:
        sys.path.remove(str(EXAMPLES))
    rc7 = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    return rc.EnvConfig(robots={"rc7": rc7}, task={"kind": "stack"})


def places(env: rc.Env) -> np.ndarray:
    return np.array([env.scene.body_pose(name).translation for name in CUBES])


def test_the_cubes_of_the_example_start_apart_at_rest_and_in_reach(config: rc.EnvConfig):
    env = rc.Env(config)
    seen = []
    for seed in range(8):
        env.reset(seed=seed)
        start = places(env)
        seen.append(start)
        assert np.linalg.norm((start[0] - start[1])[:2]) > 0.04
        assert start[:, 2] == pytest.approx(0.02, abs=0.002)
        assert 0.3 <= np.linalg.norm(start[0, :2]) <= 0.4
        assert (np.linalg.norm(start, axis=1) < env.scene.robot("rc7").reach).all()
        assert "blue" not in {c.body2 for c in env.scene.contacts("red")}
        env.scene.step_n(200)
        assert np.abs(places(env) - start).max() < 0.003
    assert np.ptp([start[0, 1] for start in seen]) > 0.1
    env.reset(seed=3)
    assert np.array_equal(places(env), seen[3])
    env.close()


def test_copies_of_a_vector_start_like_a_single_one(config: rc.EnvConfig):
    from robocell.gym import VectorGymEnv

    env = rc.Env(config)
    observation, _ = env.reset(seed=11)
    vector = VectorGymEnv(config, 2)
    both, _ = vector.reset(seed=[5, 11])
    for name in CUBES:
        own = observation["objects"][name]["tquat"]
        assert np.array_equal(both["objects"][name]["tquat"][1], own)
    vector.close()
    env.close()
