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
    return rc.EnvConfig(robots={"rc7": rc7}, task={"kind": "red_on_blue"})


def places(env: rc.Env) -> np.ndarray:
    return np.array([env.scene.body_pose(name).translation for name in CUBES])


def test_the_cubes_of_the_example_start_separated_at_rest_and_in_reach(config: rc.EnvConfig):
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


def test_a_given_pose_at_the_origin_is_kept(config: rc.EnvConfig):
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


def test_a_task_prepares_from_scene_annotations():
    rc.register_task("in_rooms_of_test")(InRooms)
    rc7 = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    config = rc.EnvConfig(robots={"rc7": rc7}, scene="tabletop", task={"kind": "in_rooms_of_test"})
    config.shared_base_frame_to_root_frame = rc.Pose(translation=[-0.5, 0, 0.2])
    rc.Env(config).close()
    assert InRooms.seen[0] == "table"
    with pytest.raises(rc.Error, match=r"in prepare\(\) first"):
        _ = InRooms().annotations


BUTTON = """<mujoco model="button"><worldbody><body name="case">
<geom type="box" size="0.03 0.03 0.01" mass="0.2"/>
<body name="cap" pos="0 0 0.015"><joint name="travel" type="slide" axis="0 0 1" range="-0.01 0"
 stiffness="200" damping="1"/><geom type="cylinder" size="0.01 0.005" mass="0.01"/></body>
</body></worldbody></mujoco>"""


class Button(rc.tasks.Task):
    """A button whose model slides and does not move freely; `fixed` and `pos` as given."""

    model: ClassVar[str]
    fixed: ClassVar[bool | None] = None
    pos: ClassVar[list[float] | None] = None
    named: ClassVar[list[str]] = ["button"]

    def prepare(self, spec, rng):
        button = rc.SceneObject(name="button", mjcf_path=self.model)
        button.fixed, button.pos = self.fixed, self.pos
        spec.objects.append(button)

    def objects(self):
        return self.named

    def instruction(self):
        return "press"

    def judge(self, scene):
        return rc.tasks.TaskVerdict(success=False)


@pytest.mark.parametrize("world", ["environment", "run"])
@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({}, r"'button' has no `pos`, and no place can be drawn for it.*`fixed: false`.*prepare\)"),
        ({"fixed": True}, r"added object 'button' .* as fixed and without `pos`.*in prepare\)"),
        ({"pos": [0.4, 0, 0.01], "named": ["knob"]}, r"no object 'knob'.*button.*in objects\)"),
        ({"pos": [0.4, 0, 0.01]}, ""),
    ],
)
def test_an_object_without_a_place_is_an_error_of_its_hook(
    tmp_path: Path, world: str, fields: dict[str, object], text: str
):
    model = tmp_path / "button.xml"
    model.write_text(BUTTON)
    kind = f"button_of_test_{world}_{len(fields)}_{'fixed' in fields}"
    made = type("Made", (Button,), {**fields, "model": str(model)})
    rc.register_task(kind)(made)
    rc7 = rc.RobotConfig.load(rc.models.robot_file("rc7"))

    def begin() -> None:
        if world == "environment":
            rc.Env(rc.EnvConfig(robots={"rc7": rc7}, task={"kind": kind})).close()
            return
        run = rc.RunConfig(run="button", task={"kind": kind}, output=str(tmp_path / "out"))
        run.robot, run.max_attempts = rc7, 50
        rc.envs.RunEnv(run).reset(0)

    if not text:
        begin()
        return
    with pytest.raises(rc.ArgumentError, match=text):
        begin()


def test_a_model_of_prepare_that_is_missing_names_the_line(tmp_path: Path):
    @rc.tasks.register_task("of_a_missing_cup")
    class OfAMissingCup(rc.tasks.Task):
        def prepare(self, spec, rng):
            spec.objects.append(rc.scene.SceneObject(name="cup", mjcf_path="nowhere.xml"))

        def judge(self, scene):
            return rc.tasks.TaskVerdict()

        def instruction(self):
            return "drink"

    rc7 = rc.models.robot_file("rc7")
    line = r"test_prepared_objects.py:\d+, in prepare: object 'cup': model file "
    with pytest.raises(rc.NotFoundError, match=line + "'nowhere.xml' not found"):
        rc.Env(rc.EnvConfig(robots={"robot": rc7}, task={"kind": "of_a_missing_cup"}))
