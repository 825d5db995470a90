"""Whatever is asked or written between update() and step() under impedance, the step that goes on
from the first half ends at the bits of a whole ``mj_step``."""

from __future__ import annotations

import copy
from collections.abc import Callable

import mujoco
import numpy as np
import pytest

import robocell as rc

STEPS = 150


def cube(name: str, **fields: object) -> rc.SceneObject:
    return rc.SceneObject(
        name=name,
        shape=rc.Shape.BOX,
        size=[0.03, 0.03, 0.03],
        rgba=[1, 0, 0, 1],
        mass=0.2,
        friction=[1, 0.005, 0.0001],
        **fields,
    )


def cell() -> rc.Scene:
    """Two built-in robots and two cubes on a floor, another cube in the pool."""
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    for i, name in enumerate(("soft", "other")):
        prefix = f"{name}_"
        spec.robots.append(
            rc.RobotSpec(name=name, config=config, prefix=prefix, pos=[0, 1.2 * i, 0])
        )
    spec.objects = [
        cube("thrown", pos=[0.5, 0, 0.1]),
        cube("pushed", pos=[0.5, 0.1, 0.1]),
        cube("pooled", pos=[0.5, 0.2, 0.1], parked=True),
    ]
    return rc.Scene.build(spec)


class Acts:
    """What programs do between the two."""

    def __init__(self, scene: rc.Scene, rng: np.random.Generator):
        self.scene, self.rng = scene, rng
        self.soft, self.other = scene.robot("soft"), scene.robot("other")

    def all(self) -> list[Callable[[], object]]:
        return [
            self.scene.contacts,
            self.soft.update,
            self.look,
            self.teleport,
            self.try_positions,
            self.try_positions_in_the_data,
            self.swap_pooled,
            self.switch,
            lambda: self.scene.set_body_pose("thrown", [0.5, 0, 0.2], [0, 0, 0, 1]),
            lambda: self.scene.set_body_wrench("pushed", self.rng.normal(size=3), [0, 0, 0]),
            lambda: self.scene.set_state(self.scene.state()),
            lambda: mujoco.mj_forward(self.scene.model, self.scene.data),
            self.write_speeds,
            self.write_gravity,
        ]

    def look(self) -> None:
        self.soft.fk_frame()
        self.soft.arm.jacobian()
        self.soft.gravity_torques()
        rc.CollisionFilter(self.soft, clearance=0.01)(np.array([self.soft.arm.joint_pos]))

    def teleport(self) -> None:
        near = np.array(self.other.arm.joint_pos) + self.rng.normal(scale=0.05, size=7)
        self.other.set_joint_pos(near, call_forward=False)

    def try_positions(self) -> None:
        """Asks where servos would rest elsewhere, and puts everything back."""
        here = np.array(self.other.arm.joint_pos)
        self.other.set_joint_pos(here + 0.1, call_forward=False)
        assert np.isfinite(self.other.arm.noop_ctrl).all()
        self.other.set_joint_pos(here, call_forward=False)
        assert self.other.tcp_in_world

    def try_positions_in_the_data(self) -> None:
        positions = self.scene.data.qpos
        here = positions.copy()
        positions[:] = here + 0.1
        assert np.isfinite(self.other.arm.noop_ctrl).all()
        positions[:] = here

    def swap_pooled(self) -> None:
        parked = "pooled" in self.scene.parked_objects
        (self.scene.add_object if parked else self.scene.remove_object)("pooled")

    def switch(self) -> None:
        self.other.ctrl_mode = self.rng.choice(["position", "torque"])

    def write_speeds(self) -> None:
        self.scene.data.qvel[:] *= 0.99

    def write_gravity(self) -> None:
        self.scene.model.opt.gravity[2] = self.rng.normal(-9.81, 0.1)


def state(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    kind = mujoco.mjtState.mjSTATE_INTEGRATION
    numbers = np.empty(mujoco.mj_stateSize(model, kind))
    mujoco.mj_getState(model, data, numbers, kind)
    return numbers


@pytest.mark.parametrize("kind", ["joint_impedance", "cartesian_impedance"])
def test_the_step_is_the_engines_own(kind: str):
    scene = cell()
    rng = np.random.default_rng(1)
    acts = Acts(scene, rng)
    acts.soft.set_controller("arm", kind)
    known = acts.all()
    for _ in range(STEPS):
        acts.soft.update()
        acts.other.update()
        done = [known[i] for i in rng.integers(len(known), size=rng.integers(4))]
        for act in done:
            act()
        whole = copy.copy(scene.data)
        mujoco.mj_step(scene.model, whole)
        assert scene.step().ok
        np.testing.assert_array_equal(
            state(scene.model, scene.data), state(scene.model, whole), err_msg=str(done)
        )
