"""The clearance of the ready filter; the engine's distances between geoms are the oracle."""

from __future__ import annotations

import copy

import mujoco
import numpy as np
import pytest

import robocell as rc

CLEARANCES = (0, 0.01, 0.03, 0.1, 0.2)
OBSTACLES = {
    "ball": (rc.Shape.SPHERE, [0.15, 0, 0]),
    "can": (rc.Shape.CYLINDER, [0.1, 0.15, 0]),
    "box": (rc.Shape.BOX, [0.15, 0.15, 0.1]),
}


def beside(obstacle: str) -> rc.Robot:
    """The built-in robot on a floor, an obstacle in its reach."""
    shape, size = OBSTACLES[obstacle]
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    spec.robots.append(rc.RobotSpec(name="a", config=config))
    spec.objects.append(
        rc.SceneObject(
            name=obstacle,
            shape=shape,
            size=size,
            rgba=[1, 1, 1, 1],
            mass=1,
            friction=[1, 0.005, 0.0001],
            pos=[0.45, 0, 0.4],
            fixed=True,
        )
    )
    return rc.Scene.build(spec).robot("a")


class Engine:
    """What the engine says of configurations, in a copy of the scene's state."""

    def __init__(self, robot: rc.Robot):
        m = self.model = robot.scene.model
        self.data = copy.copy(robot.scene.data)
        self.qpos = [m.joint(f"joint{i + 1}").qposadr[0] for i in range(7)]
        root = m.body_rootid[m.body("link1").id]
        self.own = {g for g in range(m.ngeom) if m.body_rootid[m.geom_bodyid[g]] == root}
        colliding = np.flatnonzero(m.geom_contype | m.geom_conaffinity)
        # Bodies that no joint moves stay in place, whatever the configuration.
        moved = m.body_dofnum[m.body_weldid[m.geom_bodyid]] > 0
        arm = [g for g in colliding if g in self.own and moved[g]]
        around = [g for g in colliding if g not in self.own]
        self.pairs = [(a, b) for a in arm for b in around]

    def judge(self, q: np.ndarray) -> tuple[bool, float]:
        """Whether the robot touches itself; its least distance to what is not the robot, m."""
        self.data.qpos[self.qpos] = q
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_collision(self.model, self.data)
        contact = self.data.contact
        between = [self.own.issuperset(pair) for pair in contact.geom.tolist()]
        least = 1.0
        for a, b in self.pairs:
            least = min(least, mujoco.mj_geomDistance(self.model, self.data, a, b, least, None))
        return bool((contact.dist[between] < 0).any()), least


@pytest.mark.parametrize("obstacle", OBSTACLES)
def test_clearance_is_the_minimum_distance_between_robot_and_surroundings(obstacle: str):
    robot = beside(obstacle)
    engine = Engine(robot)
    low, high = np.array(robot.joint_limits).T
    q = np.random.default_rng(0).uniform(low, high, (1500, 7))
    touches_itself, distance = np.array([engine.judge(x) for x in q]).T
    kept = []
    for clearance in CLEARANCES:
        keep = rc.kinematics.CollisionFilter(robot, clearance=clearance)(q)
        expected = (touches_itself == 0) & (distance >= clearance)
        wrong = np.flatnonzero(keep != expected)
        assert not wrong.size, (clearance, wrong, keep[wrong], distance[wrong])
        kept.append(keep.sum())
    assert np.all(np.diff(kept) < 0), "else some clearance has nothing to refuse"
