"""Example 1: build a scene with a robot and a cube, pick the cube up, and take a picture.

The same in C++: 01_build_and_control.cc. Run: python examples/01_build_and_control.py [folder]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

import robocell as rc


def move_to(robot: rc.Robot, tcp: rc.Pose, seconds: float) -> None:
    """Drives the arm to a pose of the TCP (in the robot base frame) along a smooth joint path."""
    ik = robot.kinematics.ik(tcp, prefer="seed")
    if not ik.success:
        raise RuntimeError(f"the pose is out of reach: {ik}")
    start = robot.jnt_pos_cmd.copy()
    ticks = round(seconds / robot.scene.timestep())
    for i in range(1, ticks + 1):
        robot.jnt_pos_cmd[:] = start + rc.control.minimum_jerk(i, ticks).position * (ik.q - start)
        robot.update()
        robot.step()


def grip(robot: rc.Robot, opening: float, seconds: float) -> None:
    """Opens (1) or closes (0) the gripper and waits."""
    robot.apply({"gripper": rc.control.GroupCommand.opening(opening)})
    for _ in range(round(seconds / robot.scene.timestep())):
        robot.update()
        robot.step()


def main(folder: Path) -> None:
    """Picks up the cube, and draws that into `folder`."""
    spec = rc.SceneSpec(name="lift", timestep=0.002, add_floor=True, add_skybox=True)
    spec.robots.append(
        rc.RobotSpec(name="arm", config=rc.RobotConfig.load(rc.models.robot_file("rc7")))
    )
    spec.objects.append(
        rc.SceneObject(
            name="cube", shape=rc.Shape.BOX, size=[0.02, 0.02, 0.02], pos=[0.45, 0, 0.02],
            rgba=[1, 0.5, 0, 1], mass=0.1, friction=[0.8, 0.02, 0.001],
            condim=rc.scene.Condim.TORSIONAL,
        )
    )  # fmt: skip
    scene = rc.Scene.build(spec)
    scene.reset()
    robot = rc.Robot.of(scene, "arm")

    # A pose above the cube, tool pointing down, expressed in the robot base frame.
    cube = robot.base_in_world.inverse() * scene.body_pose("cube")
    grasp = rc.Pose(translation=cube.translation, quaternion=[1, 0, 0, 0])
    above = rc.Pose(translation=cube.translation + np.array([0, 0, 0.12]), quaternion=[1, 0, 0, 0])

    grip(robot, 1, 0.3)
    move_to(robot, above, 2)
    move_to(robot, grasp, 1)
    grip(robot, 0, 0.6)
    move_to(robot, above, 1)

    height = float(scene.body_pose("cube").translation[2])
    print(f"the cube is {height:.3f} m above the floor")
    assert robot.gripper.is_grasping("cube")
    assert height > 0.1
    renderer = rc.render.Renderer(scene, shadows=True, multisamples=4)
    view = rc.render.OrbitCamera(lookat=(0.25, 0, 0.3), distance=1.7, azimuth=130, elevation=-20)
    rc.render.write_png(folder / "picture.png", renderer.render(view, 640, 480)["rgb"])


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        out.mkdir(parents=True, exist_ok=True)
        main(out)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
