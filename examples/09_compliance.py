"""Example 9: three ways for an arm to be soft, and what it does when something pushes.

Gravity compensation: it weighs nothing, and is led by the hand. Cartesian impedance: its tool hangs
on springs, and presses with a force that is known. Admittance: a force-torque sensor at the wrist
tells it where to go. The same in C++: 09_compliance.cc.

Run: python examples/09_compliance.py [folder for picture]
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

import robocell as rc


def build() -> rc.Scene:
    """The built-in robot with a sensor between its flange and its hand, on a table."""
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    config.gravcomp = False  # else the engine carries the arm
    config.base = rc.robots.BaseConfig()  # it needs no pedestal
    config.edits.append(rc.robots.Edit(add_site="wrist", body="hand", pos=[0, 0, 0]))
    config.edits.append(rc.robots.Edit(add_sensor="wrist_ft_force", site="wrist", type="force"))
    config.edits.append(rc.robots.Edit(add_sensor="wrist_ft_torque", site="wrist", type="torque"))
    config.ft_sensors.append(rc.robots.ForceTorqueSensorSpec(name="wrist_ft", compensate_tool=True))
    spec = rc.SceneSpec(name="compliance", timestep=0.002, add_floor=True, add_skybox=True)
    robot = rc.RobotSpec(name="rc7", config=config, pos=[-0.35, 0, 0])
    robot.attach_to = rc.robots.AttachTarget(rc.robots.AttachKind.Site, "table_table_top")
    spec.robots.append(robot)
    spec.objects.append(rc.SceneObject(name="table", mjcf_path="table", pos=[0, 0, 0.7]))
    return rc.Scene.build(spec)


def push(robot: rc.Robot, force: np.ndarray | list[float]) -> None:
    """Pushes on the hand until told otherwise, N in the world."""
    robot.scene.set_body_wrench("hand", force, [0, 0, 0])


def measured_force(robot: rc.Robot) -> np.ndarray:
    """The measured force, N in the world frame."""
    return robot.ft_sensor_frame("wrist_ft").rotation @ robot.ft_sensor_wrench("wrist_ft")[:3]


def run(robot: rc.Robot, seconds: float, each: Callable[[], None] = lambda: None) -> np.ndarray:
    """Lets time go by, calling `each` between the robot's look and its step: how far it came, m."""
    start = robot.tcp_in_world.translation
    for _ in range(round(seconds / robot.scene.timestep())):
        robot.update()
        each()
        robot.step()
    return robot.tcp_in_world.translation - start


def lead_by_hand(robot: rc.Robot) -> None:
    """Motors that only carry the arm: it goes where it is led, and stays where it is left."""
    robot.ctrl_mode = "torque"
    way, last = np.array([0.05, 0.2, 0.1]), robot.scene.body_pose("hand").translation
    goal = last + way

    def carry() -> None:
        robot.jnt_trq_cmd = robot.gravity_torques()

    def lead() -> None:  # somebody's arm: a spring and a damper
        nonlocal last
        carry()
        here = robot.scene.body_pose("hand").translation
        push(robot, 200 * (goal - here) - 100 * (here - last) / robot.scene.timestep())
        last = here

    alone = run(robot, 1, carry)
    led = run(robot, 4, lead)
    push(robot, [0, 0, 0])
    run(robot, 2, carry)
    left = run(robot, 1, carry)
    moved = [1000 * float(np.linalg.norm(way)) for way in (alone, led, left)]
    print("weightless: alone {:.1f} mm, led {:.0f} mm, left there {:.1f} mm".format(*moved))
    assert moved[0] < 1
    assert moved[1] > 200
    assert moved[2] < 1


def press(robot: rc.Robot) -> None:
    """Springs at the tool: held off by the table, they push as far as they are stretched."""
    table = robot.scene.site_pose("table_table_top")
    robot.gripper.opening = 0

    def over_table(height: float) -> rc.Pose:
        """The TCP there, pointing down, in the robot base frame."""
        place = rc.Pose(translation=[0, 0, height], quaternion=[1, 0, 0, 0])
        return robot.base_in_world.inverse() * table * place

    robot.set_controller("arm", "cartesian_pose").pose = over_table(0.03)
    run(robot, 2)
    spring = robot.set_controller("arm", "cartesian_impedance")
    spring.stiffness = [800, 800, 500, 40, 40, 40]  # N/m, then Nm/rad
    for height in (-0.01, -0.03):
        spring.pose = over_table(height)
        run(robot, 1)
        stretched = robot.tcp_in_world.translation[2] - table.translation[2] - height
        force = measured_force(robot)[2]
        print(f"springs: stretched {1000 * stretched:.1f} mm they push with {force:.1f} N")
        assert abs(force - 500 * stretched) < 0.02 * force


def give_way(robot: rc.Robot) -> None:
    """Admittance control: the tool follows the measured force like a mass in oil."""
    cartesian = robot.set_controller("arm", "cartesian_pose")
    mass, oil, dt = 4.0, 100.0, robot.scene.timestep()  # kg, Ns/m, s
    goal, velocity = robot.tcp_in_world, np.zeros(3)

    def follow() -> None:
        nonlocal goal, velocity
        velocity = velocity + dt / mass * (measured_force(robot) - oil * velocity)
        goal = rc.Pose(translation=dt * velocity) * goal
        cartesian.pose = robot.base_in_world.inverse() * goal

    push(robot, [0, 10, 0])
    run(robot, 0.5, follow)
    speed = run(robot, 1, follow)[1]
    push(robot, [0, 0, 0])
    run(robot, 0.5, follow)
    rest = abs(run(robot, 1, follow)[1])
    print(
        f"admittance: 10 N move it with {1000 * speed:.0f} mm/s, none with {1000 * rest:.0f} mm/s"
    )
    assert abs(speed - 10 / oil) < 0.02 * speed
    assert rest < 1e-3


def main(folder: Path) -> None:
    """All three, one after the other, with a picture of each."""
    scene = build()
    robot, renderer = scene.robot("rc7"), rc.render.Renderer(scene, shadows=True, multisamples=4)
    view = rc.render.OrbitCamera(
        lookat=(-0.15, 0.05, 0.95), distance=1.35, azimuth=150, elevation=-20
    )
    pictures = []
    for part in lead_by_hand, press, give_way:
        scene.reset()
        before = renderer.render(view, 320, 300)["rgb"].astype(int)
        part(robot)
        after = renderer.render(view, 320, 300)["rgb"].astype(int)
        pictures.append(((before + 3 * after) // 4).astype(np.uint8))  # one shines through
    rc.render.write_png(folder / "picture.png", np.hstack(pictures))


if __name__ == "__main__":
    out = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="robocell_"))
    try:
        out.mkdir(parents=True, exist_ok=True)
        main(out)
    except OSError as error:  # also robocell's: the folder cannot be written
        sys.exit(f"error: {error}")
