"""Example 7: a force-torque sensor at the wrist: weigh what the gripper holds.

The same in C++: 07_weigh.cc. Run: python examples/07_weigh.py [folder]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

import robocell as rc

MASSES = {"red": 0.05, "yellow": 0.12, "blue": 0.3}  # kg
COLOURS = {
    "red": [0.85, 0.25, 0.18, 1],
    "yellow": [0.95, 0.7, 0.2, 1],
    "blue": [0.16, 0.42, 0.75, 1],
}
PLACES = {"red": -0.12, "yellow": 0.0, "blue": 0.12}  # y, metres


def scale() -> rc.RobotConfig:
    """The built-in robot with a sensor between its flange and its hand."""
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    config.edits.append(rc.robots.Edit(add_site="wrist", body="hand", pos=[0, 0, 0]))
    config.edits.append(rc.robots.Edit(add_sensor="wrist_ft_force", site="wrist", type="force"))
    config.edits.append(rc.robots.Edit(add_sensor="wrist_ft_torque", site="wrist", type="torque"))
    # Without the hand's own weight, only the weight of what it holds remains.
    config.ft_sensors.append(rc.robots.ForceTorqueSensorSpec(name="wrist_ft", compensate_tool=True))
    return config


def cell() -> rc.Scene:
    """The robot and three cubes of one size."""
    spec = rc.SceneSpec(name="weigh", timestep=0.002, add_floor=True, add_skybox=True)
    spec.robots.append(rc.RobotSpec(name="arm", config=scale()))
    for name, mass in MASSES.items():
        spec.objects.append(
            rc.SceneObject(
                name=name, shape=rc.Shape.BOX, size=[0.02, 0.02, 0.02],
                pos=[0.45, PLACES[name], 0.02], rgba=COLOURS[name], mass=mass,
                friction=[1.0, 0.02, 0.001], condim=rc.scene.Condim.TORSIONAL,
            )
        )  # fmt: skip
    scene = rc.Scene.build(spec)
    scene.reset()
    return scene


def wait(robot: rc.Robot, seconds: float) -> None:
    """Lets time go by."""
    for _ in range(round(seconds / robot.scene.timestep())):
        robot.update()
        robot.step()


def move_to(robot: rc.Robot, position: np.ndarray, seconds: float) -> None:
    """Drives the TCP, pointing down, to a place in the world along a smooth joint path."""
    tcp = robot.base_in_world.inverse() * rc.Pose(translation=position, quaternion=[1, 0, 0, 0])
    ik = robot.kinematics.ik(tcp, prefer="seed")
    if not ik.success:
        raise RuntimeError(f"the place is out of reach: {ik}")
    start = robot.jnt_pos_cmd.copy()
    ticks = round(seconds / robot.scene.timestep())
    for i in range(1, ticks + 1):
        t = i / ticks
        robot.jnt_pos_cmd[:] = start + t**3 * (10 - 15 * t + 6 * t * t) * (ik.q - start)
        robot.update()
        robot.step()


def weigh(robot: rc.Robot) -> float:
    """What hangs from the sensor, kg: the mean over half a second at rest."""
    wait(robot, 0.5)
    weights = []
    for _ in range(250):
        robot.update()
        down = robot.ft_sensor_frame("wrist_ft").inverse().rotation @ [0, 0, -1]
        weights.append(float(robot.ft_sensor_wrench("wrist_ft")[:3] @ down))
        robot.step()
    return sum(weights) / len(weights) / 9.81


def main(folder: Path) -> None:
    """Weighs the cubes, and draws the last one in the hand into `folder`."""
    scene = cell()
    robot = scene.robot("arm")
    for name, mass in MASSES.items():
        cube = scene.body_pose(name).translation.copy()
        above = cube + np.array([0, 0, 0.12])
        robot.apply({"gripper": rc.control.GroupCommand.opening(1)})
        move_to(robot, above, 1.5)
        move_to(robot, cube, 0.8)
        robot.apply({"gripper": rc.control.GroupCommand.opening(0)})
        wait(robot, 0.5)
        move_to(robot, above, 0.8)
        measured = weigh(robot)
        print(f"the {name} cube weighs {1000 * measured:.0f} g")
        assert abs(measured - mass) < 0.01 * mass
        if name != "blue":
            move_to(robot, cube, 0.8)
    renderer = rc.render.Renderer(scene, shadows=True, multisamples=4)
    view = rc.render.OrbitCamera(lookat=(0.3, 0, 0.25), distance=1.5, azimuth=150, elevation=-20)
    rc.render.write_png(folder / "picture.png", renderer.render(view, 640, 480)["rgb"])


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        out.mkdir(parents=True, exist_ok=True)
        main(out)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
