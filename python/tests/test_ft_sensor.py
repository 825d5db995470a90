"""Force-torque sensors from Python: the guide's wrist, and what is said when names are wrong."""

from __future__ import annotations

import numpy as np
import pytest

import robocell as rc
from test_kdl_chain import PyKDL, needs_pykdl

GRAVITY = 9.81


def wrist() -> tuple[rc.RobotSpec, rc.robots.ToolFrameSpec]:
    """The Gen3, a sensor on its site, the 2F-85 on the sensor's."""
    from menagerie import require_menagerie

    require_menagerie("kinova_gen3", "robotiq_2f85")
    sensor = rc.robots.AttachmentSpec(mjcf_path="ft_sensor")
    sensor.attach_to = rc.robots.AttachTarget(rc.robots.AttachKind.Site, "pinch_site")
    gripper = rc.robots.AttachmentSpec(mjcf_path="menagerie:robotiq_2f85", prefix="g_")
    gripper.attach_to = rc.robots.AttachTarget(rc.robots.AttachKind.Site, "wrist_ft_site")
    arm = rc.RobotSpec(path="menagerie:kinova_gen3", attachments=[sensor, gripper])
    tool = rc.robots.ToolFrameSpec(tool_body="ft_sensor", tcp_site="g_pinch")
    ft = rc.robots.ForceTorqueSensorSpec()
    ft.name = "wrist_ft"
    ft.frame_site = "wrist_ft_site"
    tool.ft_sensors = [ft]
    return arm, tool


@pytest.fixture
def robot() -> rc.Robot:
    arm, tool = wrist()
    arm.pos = [0, 0, 1]
    spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=True, robots=[arm])
    return rc.Robot.from_scene(rc.Scene.build(spec), "base_link", "bracelet_link", tool=tool)


def subtree_mass(scene: rc.Scene, body: str) -> float:
    return float(scene.model.body_subtreemass[scene.model.body(body).id])


@needs_pykdl
@pytest.mark.parametrize("q", [[0.0] * 7, [0, 0.5, 3, -2, 1, 1, 1.5], [1, -1, 0, 1.5, 0, 0.7, 0]])
def test_the_gripper_hangs_from_the_sensor(robot: rc.Robot, q: list[float]):
    robot.set_joint_pos(q)
    robot.ctrl_mode = rc.control.CtrlMode.TORQUE
    for _ in range(300):
        robot.update()
        robot.jnt_trq_cmd = robot.gravity_torques()
        robot.step()
    robot.update()
    wrench = robot.ft_sensor("wrist_ft")
    assert isinstance(wrench, PyKDL.Wrench)
    numbers = [*wrench.force, *wrench.torque]
    assert numbers == robot.ft_sensor_wrench("wrist_ft").tolist()
    load = robot.ft_sensor_frame("wrist_ft").rotation @ np.array(numbers[:3])
    weight = GRAVITY * subtree_mass(robot.scene, "g_base_mount")
    assert np.linalg.norm(load - [0, 0, -weight]) < 0.01 * weight


def test_tare_and_compensation():
    arm, tool = wrist()
    tool.ft_sensors.append(
        rc.robots.ForceTorqueSensorSpec(
            name="pushed", force_sensor="wrist_ft_force", torque_sensor="wrist_ft_torque",
            compensate_tool=True,
        )
    )  # fmt: skip
    spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=True, robots=[arm])
    robot = rc.Robot.from_scene(rc.Scene.build(spec), "base_link", "bracelet_link", tool=tool)
    assert robot.ft_sensor_names == ["wrist_ft", "pushed"]
    for _ in range(1500):
        robot.update()
        robot.step()
    robot.update()
    assert np.linalg.norm(robot.ft_sensor_wrench("wrist_ft")[:3]) > 5
    assert np.linalg.norm(robot.ft_sensor_wrench("pushed")[:3]) < 0.1
    robot.tare_ft_sensor("wrist_ft")
    robot.update()
    assert not robot.ft_sensor_wrench("wrist_ft").any()


def test_after_a_reset_it_reads_the_new_state_and_can_be_tared(robot: rc.Robot):
    for _ in range(50):
        robot.update()
        robot.step()
    robot.scene.reset()
    after = robot.ft_sensor_wrench("wrist_ft").copy()
    assert after.all(), "before the forward pass of a reset all are zero"
    robot.scene.forward()
    robot.update()
    np.testing.assert_allclose(robot.ft_sensor_wrench("wrist_ft"), after, atol=1e-6)
    robot.scene.reset()
    robot.tare_ft_sensor("wrist_ft")
    robot.update()
    np.testing.assert_allclose(robot.ft_sensor_wrench("wrist_ft"), np.zeros(6), atol=1e-9)


def test_rejects_unknown_sensor_names(robot: rc.Robot):
    with pytest.raises(rc.NotFoundError, match=r"no ft sensor 'wrist'.*Did you mean 'wrist_ft'\?"):
        robot.ft_sensor_wrench("wrist")
    tool = rc.robots.ToolFrameSpec(ft_sensors=[rc.robots.ForceTorqueSensorSpec(name="wrist")])
    with pytest.raises(
        rc.NotFoundError, match=r"no force sensor 'wrist_force'\. Its force sensors"
    ):
        rc.Robot.from_scene(robot.scene, "base_link", "bracelet_link", tool=tool)
    with pytest.raises(rc.SpecError, match=r"ft_sensors\[0\]\.name"):
        rc.Robot.from_scene(
            robot.scene, "base_link", "bracelet_link",
            tool=rc.robots.ToolFrameSpec(ft_sensors=[rc.robots.ForceTorqueSensorSpec()]),
        )  # fmt: skip
