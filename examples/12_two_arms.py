"""Example 12: two arms carry a board together, and what stands on it stays there.

There is one path, the board's; each hand keeps its place on it. Both arms are soft (Cartesian
impedance), so that they do not fight over millimetres. The same in C++: 12_two_arms.cc.

Run: python examples/12_two_arms.py [folder for picture]
"""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

import robocell as rc

# Each hand points down, comes from 12 cm above, and holds the board here.
GRASPS = {
    "left": rc.Pose(translation=[-0.17, 0, 0], quaternion=[1, 0, 0, 0]),
    "right": rc.Pose(translation=[0.17, 0, 0], quaternion=[0, 1, 0, 0]),
}
BEFORE = rc.Pose(translation=[0, 0, -0.12])


def build() -> rc.Scene:
    """Two of the built-in robot on one table, face to face, and a board with a cube between."""
    spec = rc.SceneSpec(name="two_arms", timestep=0.002, add_floor=True, add_skybox=True)
    spec.objects.append(rc.SceneObject(name="table", mjcf_path="table", pos=[0, 0, 0.7]))
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    config.base = rc.robots.BaseConfig()  # it needs no pedestal
    for name, x, yaw in ("left", -0.5, 0), ("right", 0.5, 180):
        robot = rc.RobotSpec(name=name, prefix=f"{name}_", config=config)
        robot.pos, robot.euler = [x, 0, 0.7], [0, 0, yaw]
        spec.robots.append(robot)
    board = rc.SceneObject(name="board", shape=rc.Shape.BOX, size=[0.24, 0.03, 0.01])
    board.pos, board.rgba, board.mass = [0, -0.1, 0.71], [0.45, 0.3, 0.2, 1], 0.3
    board.condim, board.friction = rc.scene.Condim.TORSIONAL, [1, 0.02, 0.001]
    cube = rc.SceneObject(name="cube", shape=rc.Shape.BOX, size=[0.02, 0.02, 0.02])
    cube.pos, cube.rgba, cube.mass = [0, -0.1, 0.74], [0.85, 0.25, 0.18, 1], 0.1
    cube.friction = [1, 0.02, 0.001]
    spec.objects.append(board)
    spec.objects.append(cube)
    scene = rc.Scene.build(spec)
    scene.reset()
    return scene


class Arm:
    """One of the two, on springs; poses are its TCP's in the world."""

    def __init__(self, robot: rc.Robot, grasp: rc.Pose) -> None:
        self.robot, self.grasp = robot, grasp
        self.spring = robot.set_controller("arm", "cartesian_impedance")
        self.spring.stiffness = [1500, 1500, 1500, 60, 60, 60]  # N/m, then Nm/rad
        self.pose = robot.tcp_in_world  # where the springs draw it to

    def draw_to(self, pose: rc.Pose) -> None:
        """Puts the springs' other end there."""
        self.pose = pose
        self.spring.pose = self.robot.base_in_world.inverse() * pose


def follow(arms: list[Arm], path: Callable[[Arm, float], rc.Pose], seconds: float) -> None:
    """Each arm along its path from 0 to 1, all at the same time, from rest to rest."""
    scene = arms[0].robot.scene
    ticks = round(seconds / scene.timestep())
    for i in range(1, ticks + 1):
        for arm in arms:
            arm.draw_to(path(arm, rc.control.minimum_jerk(i, ticks).position))
            arm.robot.update()
        scene.step()


def carry(arms: list[Arm], start: rc.Pose, goal: rc.Pose, seconds: float) -> None:
    """The board from start to goal: each hand keeps its place on it."""
    follow(arms, lambda arm, s: start.interpolate(goal, s) * arm.grasp, seconds)


def grip(arms: list[Arm], opening: float) -> None:
    """Opens (1) or closes (0) all hands."""
    for arm in arms:
        arm.robot.gripper.opening = opening
    follow(arms, lambda arm, _: arm.pose, 0.5)


def draw(scene: rc.Scene, file: Path) -> None:
    """A picture of the scene as it is."""
    renderer = rc.render.Renderer(scene, shadows=True, multisamples=4)
    view = rc.render.OrbitCamera(lookat=(0, 0, 0.85), distance=1.6, azimuth=110, elevation=-25)
    rc.render.write_png(file, renderer.render(view, 640, 480)["rgb"])


def main(folder: Path) -> None:
    """They carry the board to the other side of the table, and turn it on the way."""
    scene = build()
    arms = [Arm(scene.robot(name), grasp) for name, grasp in GRASPS.items()]
    home = {arm: arm.pose for arm in arms}
    start = scene.body_pose("board")
    stood = start.inverse() * scene.body_pose("cube")
    goal = rc.Pose(translation=[0, 0.2, 0]) * start * rc.Pose(rpy=[0, 0, math.radians(20)])
    up = rc.Pose(translation=[0, 0, 0.2])

    follow(arms, lambda arm, s: home[arm].interpolate(start * arm.grasp * BEFORE, s), 1.2)
    follow(arms, lambda arm, s: start * arm.grasp * BEFORE.interpolate(rc.Pose(), s), 0.6)
    grip(arms, 0)
    carry(arms, start, up * start, 0.8)
    carry(arms, up * start, up * goal, 1.5)
    draw(scene, folder / "picture.png")
    carry(arms, up * goal, goal, 0.8)
    grip(arms, 1)

    board = scene.body_pose("board")
    moved, stands = start.inverse() * board, board.inverse() * scene.body_pose("cube")
    way = 1000 * float(np.linalg.norm(moved.translation))
    slip = 1000 * float(np.linalg.norm(stands.translation - stood.translation))
    print(f"the board came {way:.0f} mm and was turned by {math.degrees(moved.rpy[2]):.0f} degrees")
    print(f"the cube on it slid {slip:.0f} mm")
    assert board.is_close(goal, 0.02, 0.005)
    assert slip < 2


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        out.mkdir(parents=True, exist_ok=True)
        main(out)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
