"""A task that adds objects without poses starts as well in an environment as in a run."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import ClassVar

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


class AtTheOrigin(rc.tasks.Task):
    """A cube whose place is said, and which is the origin."""

    def prepare(self, spec, rng):
        cube = rc.SceneObject(name="cube", shape=rc.Shape.BOX, size=[0.02] * 3, mass=0.1)
        assert cube.pos is None
        cube.rgba, cube.friction, cube.pos = [1, 0, 0, 1], [1, 0.02, 0.001], [0, 0, 0]
        spec.objects.append(cube)

    def judge(self, scene):
        return rc.tasks.TaskVerdict(success=False)

    def instruction(self):
        return "look at the cube"


def test_a_pose_that_was_given_is_a_pose_also_at_the_origin(config: rc.EnvConfig):
    rc.register_task("at_the_origin_of_test")(AtTheOrigin)
    base = rc.Pose(translation=[-0.5, 0, 0])
    env = rc.Env(
        rc.EnvConfig(
            robots=config.robots,
            task={"kind": "at_the_origin_of_test"},
            add_floor=False,
            shared_base_frame_to_root_frame=base,
            world_frame_objects={
                "stand": {
                    "shape": "box",
                    "size": [0.05] * 3,
                    "mass": 1,
                    "fixed": True,
                    "offset": rc.Pose(translation=[0, 0, -0.07]),
                }
            },
        )
    )
    env.reset(seed=1)
    assert np.array_equal(env.scene.body_pose("cube").translation, [0, 0, 0])
    env.close()


class InRooms(AtTheOrigin):
    """A cube for each support that is known."""

    seen: ClassVar[list[str]] = []

    def prepare(self, spec, rng):
        self.seen[:] = [support.body for support in self.annotations.supports]
        super().prepare(spec, rng)


def test_a_task_prepares_by_the_annotations_of_its_scene():
    rc.register_task("in_rooms_of_test")(InRooms)
    rc7 = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    config = rc.EnvConfig(robots={"rc7": rc7}, scene="tabletop", task={"kind": "in_rooms_of_test"})
    config.shared_base_frame_to_root_frame = rc.Pose(translation=[-0.5, 0, 0.2])
    rc.Env(config).close()
    assert InRooms.seen[0] == "table"
    with pytest.raises(rc.Error, match=r"asked for in prepare\(\) first"):
        _ = InRooms().annotations
