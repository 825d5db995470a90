"""Scenes whose reset hooks refer to what keeps the scene go when Python's collector runs."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Callable
from typing import Any

import pytest

import robocell as rc


class Token:
    """Something that a hook holds, and by which the test sees whether the hook is there."""


def build() -> rc.Scene:
    spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots = [rc.RobotSpec(name="r", config=config)]
    return rc.Scene.build(spec)


def robot_of(scene: rc.Scene) -> rc.Robot:
    return scene.robot("r")


def from_bodies(scene: rc.Scene) -> rc.Robot:
    return rc.Robot.from_scene(scene, "base_link", "link7")


HANDLES: dict[str, Callable[[rc.Scene], Any]] = {
    "scene": lambda scene: scene,
    "robot": robot_of,
    "robot from bodies": from_bodies,
    "two robots": lambda scene: (robot_of(scene), from_bodies(scene)),
    "scene and robot": lambda scene: (scene, robot_of(scene)),
    "arm": lambda scene: robot_of(scene).arm,
    "gripper": lambda scene: robot_of(scene).gripper,
    "controller": lambda scene: robot_of(scene).controller("arm"),
    "impedance": lambda scene: robot_of(scene).set_controller("arm", "joint_impedance"),
    "kinematics": lambda scene: robot_of(scene).kinematics,
    "filter": lambda scene: rc.kinematics.CollisionFilter(robot_of(scene)),
    "relation": lambda scene: rc.scenes.SpatialRelation(scene, "hand", "next_to", "link7"),
    "stepper": lambda scene: rc.control.Stepper(scene, [robot_of(scene)]),
    "all": lambda scene: [make(scene) for name, make in HANDLES.items() if name != "all"],
    "model": lambda scene: scene.model,
    "data": lambda scene: scene.data,
}


def alive_after_collection(make: Callable[[rc.Scene], Any]) -> weakref.ref:
    def live() -> weakref.ref:
        scene, token = build(), Token()
        kept = make(scene)
        scene.on_reset(lambda _: (token, kept))
        scene.reset()
        return weakref.ref(token)

    token = live()
    for _ in range(2):
        gc.collect()
    return token


@pytest.mark.parametrize("name", HANDLES)
def test_a_hook_that_holds_a_handle_is_collected(name: str):
    assert alive_after_collection(HANDLES[name])() is None


def test_a_hook_that_keeps_its_context_is_collected():
    def live() -> weakref.ref:
        scene, token, kept = build(), Token(), []
        scene.on_reset(lambda reset: (token, kept.extend([reset, reset.scene])))
        scene.reset()
        return weakref.ref(token)

    token = live()
    gc.collect()
    assert token() is None


@pytest.mark.parametrize("name", [name for name in HANDLES if name not in ("model", "data")])
def test_a_handle_that_is_held_keeps_the_hooks(name: str):
    """Whoever has any handle may reset the scene, and the hook is to be there."""
    scene, token = build(), Token()
    kept = HANDLES[name](scene)
    scene.on_reset(lambda _, token=token: None)
    gone = weakref.ref(token)
    del scene, token
    for _ in range(3):
        gc.collect()
    assert gone() is not None
    del kept
    gc.collect()
    assert gone() is None


def test_a_cpp_handle_keeps_the_hooks():
    """A command port keeps its robot without Python's knowing."""
    scene, token = build(), Token()
    port = robot_of(scene).jnt_pos_cmd
    scene.on_reset(lambda _, token=token: None)
    gone = weakref.ref(token)
    del scene, token
    gc.collect()
    assert gone() is not None
    del port
    gc.collect()
    assert gone() is None


def test_a_group_that_refers_to_its_robot_is_collected():
    class Wrist(rc.robots.MoveGroup):
        def get_name(self) -> str:
            return "wrist"

        def get_joint_pos(self) -> list[float]:
            return [0.0]

        def get_joint_vel(self) -> list[float]:
            return [0.0]

        def get_ctrl(self) -> list[float]:
            return []

        def get_joint_names(self) -> list[str]:
            return ["w"]

        def get_actuator_names(self) -> list[str]:
            return []

    def live() -> weakref.ref:
        scene = build()
        robot, token = robot_of(scene), Token()
        wrist = Wrist()
        wrist.refers = (robot, robot.arm, scene, token)
        robot.set_group(wrist)
        return weakref.ref(token)

    token = live()
    gc.collect()
    gc.collect()
    assert token() is None


def test_many_scenes_with_hooks_can_be_created_and_freed():
    tokens = []
    for _ in range(10):
        tokens.append(alive_after_collection(robot_of))
    assert [token() for token in tokens] == [None] * 10
