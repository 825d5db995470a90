"""Control modes and controllers from Python: what holds, what moves, what gives way."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import robocell as rc
from test_kdl_chain import PyKDL, needs_pykdl

MODES = ["position", "velocity", "torque"]


def gen3(prefix: str = "", y: float = 0) -> rc.RobotSpec:
    """The Gen3 with the 2F-85, without a configuration."""
    arm = rc.RobotSpec(path=rc.menagerie.model_path("kinova_gen3"), prefix=prefix, pos=[0, y, 0])
    arm.attachments.append(
        rc.robots.AttachmentSpec(
            mjcf_path=rc.menagerie.model_path("robotiq_2f85"),
            attach_to=rc.robots.AttachTarget(rc.robots.AttachKind.Site, "pinch_site"),
            prefix="g_",
        )
    )
    return arm


def build(*robots: rc.RobotSpec) -> rc.Scene:
    spec = rc.SceneSpec(name="cell", timestep=0.002, add_floor=True, add_skybox=False)
    spec.robots = list(robots)
    return rc.Scene.build(spec)


def arm_of(scene: rc.Scene, prefix: str = "") -> rc.Robot:
    tool = rc.robots.ToolFrameSpec(tool_body="g_base", tcp_site="g_pinch")
    return rc.Robot.from_scene(scene, "base_link", "bracelet_link", prefix=prefix, tool=tool)


def two_joints(folder: Path, joint: str, actuator: str) -> rc.Robot:
    """An arm that turns about the vertical and a level axis, in velocity mode."""
    (folder / "arm.xml").write_text(f"""<mujoco><compiler angle="radian"/>
      <default><joint armature="0.05" {joint}/><geom contype="0" conaffinity="0" size="0.03"/>
      </default><worldbody><body name="base"><geom mass="1"/>
        <body name="upper"><joint name="j1" axis="0 0 1"/>
          <geom type="capsule" mass="2" fromto="0 0 0 0.3 0 0"/>
          <body name="fore" pos="0.3 0 0"><joint name="j2" axis="0 1 0"/>
            <geom type="capsule" mass="1" fromto="0 0 0 0.3 0 0"/><site name="tcp"/>
      </body></body></body></worldbody>
      <actuator><{actuator} name="a1" joint="j1"/><{actuator} name="a2" joint="j2"/></actuator>
    </mujoco>""")
    config = rc.RobotConfig(name="arm", model=str(folder / "arm.xml"))
    config.move_groups["arm"] = rc.robots.MoveGroupConfig(
        kind="arm", joints=["j1", "j2"], actuators=["a1", "a2"], leaf=rc.scene.ElementRef("tcp")
    )
    config.control["arm"] = "joint_velocity"
    modes = ["velocity", "torque" if actuator.startswith("motor") else "position"]
    return build(rc.RobotSpec(name="arm", config=config, control_modes=modes)).robot("arm")


def rc7(gravcomp: bool = True, **fields: object) -> rc.Robot:
    """The built-in robot."""
    config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
    config.gravcomp = gravcomp
    return build(rc.RobotSpec(name="a", config=config, **fields)).robot("a")


def tcp(robot: rc.Robot) -> np.ndarray:
    return robot.tcp_in_world.translation


def drift(
    steps: int, *robots: rc.Robot, command: Callable[[rc.Robot], None] | None = None
) -> float:
    """The farthest that a TCP gets from where it was, while robots of one scene are updated."""
    start, farthest = [tcp(robot) for robot in robots], 0.0
    for _ in range(steps):
        for robot in robots:
            robot.update()
            if command:
                command(robot)
        assert robots[0].step()
        for robot, before in zip(robots, start, strict=True):
            farthest = max(farthest, float(np.linalg.norm(tcp(robot) - before)))
    return farthest


def command_gravity_torques(robot: rc.Robot) -> None:
    robot.jnt_trq_cmd = robot.gravity_torques()


def run(robot: rc.Robot, steps: int) -> None:
    for _ in range(steps):
        robot.update()
        assert robot.step()


class TestModes:
    def test_gravity_torques_hold_the_arm_with_its_gripper(self, menagerie):
        robot = arm_of(build(gen3()))
        robot.ctrl_mode = rc.control.CtrlMode.TORQUE
        assert drift(500, robot, command=command_gravity_torques) < 1e-3

    def test_gravity_torques_hold_two_arms(self, menagerie):
        scene = build(gen3("l_", 0.6), gen3("r_", -0.6))
        robots = [arm_of(scene, "l_"), arm_of(scene, "r_")]
        robots[0].ctrl_mode = "torque"
        assert robots[1].ctrl_mode == rc.control.CtrlMode.POSITION
        robots[1].ctrl_mode = "torque"
        assert drift(500, *robots, command=command_gravity_torques) < 1e-3

    def test_torque_mode_disables_the_servos(self):
        robot = rc7()
        bare = rc.RobotConfig.load(rc.models.robot_file("rc7"))
        for i in range(1, 8):
            bare.edits.append(rc.robots.Edit(delete={"actuator": f"servo{i}"}))
        bare.move_groups["arm"].actuators = []
        bare.control.clear()
        without = build(rc.RobotSpec(name="a", config=bare)).robot("a")
        robot.ctrl_mode = "torque"
        robot.jnt_trq_cmd = np.zeros(7)
        for one in (robot, without):
            one.arm.joint_vel = [0.5, -0.4, 0.3, 0.6, -0.7, 0.8, 2]
            run(one, 300)
        np.testing.assert_allclose(robot.arm.joint_pos, without.arm.joint_pos, atol=1e-9)

    def test_switching_moves_nothing(self):
        robot = rc7(gravcomp=False, control_modes=MODES)
        run(robot, 1000)
        for mode in ("torque", "position", "velocity", "torque"):
            robot.ctrl_mode = mode
            assert drift(100, robot) < 1e-3, mode
        robot.scene.reset()
        assert robot.ctrl_mode == rc.control.CtrlMode.TORQUE
        assert drift(100, robot) < 1e-3

    def test_velocity_mode_tracks_the_commanded_velocity(self):
        robot = rc7(gravcomp=False, control_modes=MODES)
        robot.ctrl_mode = rc.control.CtrlMode.VELOCITY
        before = robot.arm.joint_pos
        robot.jnt_vel_cmd[0] = 0.3
        run(robot, 500)
        assert robot.arm.joint_pos[0] - before[0] == pytest.approx(0.3, abs=0.02)
        assert robot.arm.joint_vel[0] == pytest.approx(0.3, abs=3e-3)

    @pytest.mark.parametrize(
        ("joint", "actuator"),
        [
            ('damping="60"', 'position kp="2000"'),
            ('damping="0.4" frictionloss="2"', 'motor ctrlrange="-90 90"'),
            ('stiffness="20" springref="0.4"', 'motor gear="-30" ctrlrange="-3 3"'),
        ],
    )
    def test_velocity_is_reached_against_resistance(self, tmp_path, joint, actuator):
        robot = two_joints(tmp_path, joint, actuator)
        for velocity in ([0.1, 0.1], [-0.1, 0.0], [0.0, 0.2]):
            robot.jnt_vel_cmd = velocity
            run(robot, 800)
            np.testing.assert_allclose(robot.jnt_vel_msr, velocity, atol=1e-3)

    def test_velocity_servos_push_no_harder_than_the_motor(self, tmp_path):
        robot = two_joints(tmp_path, 'damping="0.4"', 'motor gear="2" ctrlrange="-3 6"')
        robot.jnt_vel_cmd = [50, -50]
        run(robot, 10)
        np.testing.assert_allclose(robot.jnt_trq_msr, [12, -6], rtol=2e-3)
        assert abs(robot.jnt_trq_msr) @ [1, 2] <= 24

    def test_modes_are_actuator_groups_of_the_model(self):
        robot = rc7(control_modes=["torque"])
        model = robot.scene.model
        servo, motor = model.actuator("servo1").group[0], model.actuator("joint1_torque").group[0]
        assert servo != motor
        assert model.opt.disableactuator == 1 << motor
        robot.ctrl_mode = "torque"
        assert model.opt.disableactuator == 1 << servo
        with pytest.raises(rc.ArgumentError, match=r"to velocity: .* add velocity to the control"):
            robot.ctrl_mode = "velocity"
        with pytest.raises(rc.ArgumentError, match=r"ctrl_mode must be one of position, velocity"):
            robot.ctrl_mode = "torq"

    def test_each_control_mode_of_the_arm_has_a_port(self):
        robot = rc7()
        with pytest.raises(rc.ArgumentError, match=r"no jnt_vel_cmd: .* add velocity to the contr"):
            robot.jnt_vel_cmd = np.zeros(7)
        position = robot.jnt_pos_cmd
        robot.jnt_trq_cmd = [0, 5, 0, 0, 0, 0, 0]
        assert robot.ctrl_mode == rc.control.CtrlMode.POSITION
        robot.ctrl_mode = "torque"
        assert robot.jnt_trq_cmd.tolist() == [0, 5, 0, 0, 0, 0, 0]
        assert position.tolist() == robot.jnt_pos_cmd.tolist()
        robot.ctrl_mode = "position"
        position[0] += 0.2  # the array that was kept is the port still
        target = position[0]
        run(robot, 500)
        assert robot.arm.joint_pos[0] == pytest.approx(target, abs=0.02)

    def test_ports_reject_invalid_commands(self):
        robot = rc7()
        robot.set_controller("arm", "cartesian_pose")
        with pytest.raises(RuntimeError, match=r"no jnt_pos_cmd while .*set ctrl_mode to position"):
            robot.jnt_pos_cmd = np.zeros(7)
        robot.ctrl_mode = "torque"
        with pytest.raises(ValueError, match="expected 7 joint values, got 3"):
            robot.jnt_trq_cmd = np.zeros(3)
        robot.jnt_trq_cmd[2] = np.nan
        with pytest.raises(rc.ArgumentError, match="the target of 'joint3' is nan"):
            robot.update()

    def test_actions_carry_torques_and_velocities(self):
        robot = rc7(control_modes=MODES)
        robot.ctrl_mode = "torque"
        robot.apply({"arm": rc.control.GroupCommand.torques(range(7))})
        assert robot.jnt_trq_cmd.tolist() == list(range(7))
        with pytest.raises(rc.ArgumentError, match="takes joint torques, not joint positions"):
            robot.apply({"arm": rc.control.GroupCommand.joints(np.zeros(7))})
        robot.ctrl_mode = "velocity"
        robot.apply({"arm": rc.control.GroupCommand.velocities([0.1] * 7)})
        assert robot.jnt_vel_cmd.tolist() == [0.1] * 7

    def test_teleports_update_frames_at_once_or_on_demand(self):
        robot = rc7()
        for q, forward in ((np.linspace(0, 0.6, 7), True), (np.linspace(0.6, 0, 7), False)):
            robot.set_joint_pos(q, call_forward=forward)
            assert robot.tcp_in_world.is_close(robot.base_in_world * robot.fk_frame(q), 1e-7, 1e-9)

    def test_stepping_a_robot_steps_its_scene(self):
        robot = rc7()
        assert robot.step_n(10)
        assert robot.scene.time() == pytest.approx(0.02)


class TestSharedArms:
    """Several robots made of one arm."""

    @pytest.mark.parametrize("configured", [True, False])
    def test_another_robot_handle_of_an_arm_changes_nothing(self, configured):
        scene = rc7().scene
        first = rc.Robot.from_scene(scene, "base_link", "link7")
        first.ctrl_mode = "torque"
        first.jnt_trq_cmd = [0, 5, 0, 0, 0, 0, 0]
        tool = rc.robots.ToolFrameSpec(tcp_site="tcp")
        second = (
            scene.robot("a")
            if configured
            else rc.Robot.from_scene(scene, "base_link", "link7", tool=tool)
        )
        for robot in (first, second, first):
            assert robot.ctrl_mode == rc.control.CtrlMode.TORQUE
            run(robot, 2)
            robot.update()
            np.testing.assert_allclose(robot.jnt_trq_msr, [0, 5, 0, 0, 0, 0, 0], atol=1e-9)
        scene.add_object(
            rc.SceneObject(
                name="cube", shape="box", size=[0.02] * 3, rgba=[1, 0, 0, 1], mass=0.1,
                friction=[0.8, 0.02, 0.001], pos=[0.9, 0.9, 0.02],
            )
        )  # fmt: skip
        for robot in (second, first):
            run(robot, 1)
            robot.update()
            np.testing.assert_allclose(robot.jnt_trq_msr, [0, 5, 0, 0, 0, 0, 0], atol=1e-9)
        scene.remove_object("cube")
        scene.reset()
        second.ctrl_mode = "position"
        assert first.ctrl_mode == rc.control.CtrlMode.POSITION
        first.ctrl_mode = "torque"
        assert second.ctrl_mode == rc.control.CtrlMode.TORQUE

    def test_the_mode_outlives_its_robots(self):
        scene = build(rc.RobotSpec(path=rc.models.robot_file("rc7").replace(".yaml", ".xml")))
        rc.Robot.from_scene(scene, "base_link", "link7").ctrl_mode = "torque"
        robot = rc.Robot.from_scene(scene, "base_link", "link7")
        assert robot.ctrl_mode == rc.control.CtrlMode.TORQUE
        assert robot.jnt_trq_cmd.tolist() == robot.gravity_torques().tolist()

    def test_a_part_of_an_arm_is_measured_but_not_driven(self):
        arm = rc7()
        part = rc.Robot.from_scene(arm.scene, "base_link", "link4")
        why = r"servo1 \.\.\. servo4 are driven by robot 'a' / group 'arm' already, an arm of other"
        with pytest.raises(rc.NotFoundError, match=why):
            part.jnt_pos_cmd = np.zeros(4)
        with pytest.raises(rc.ArgumentError, match=why):
            part.ctrl_mode = "position"
        assert part.is_driven("arm") is False
        target = arm.jnt_pos_cmd[0] + 0.3
        arm.jnt_pos_cmd[0] = target
        for _ in range(500):
            part.update()  # would hold its joints where they were
            run(arm, 1)
        part.update()
        assert part.jnt_pos_msr[0] == pytest.approx(target, abs=0.02)
        in_world = part.base_in_world * part.fk_frame()
        assert in_world.is_close(arm.scene.body_pose("link4"), 1e-9, 1e-9)

    def test_a_paused_robot_does_not_step_the_scene(self):
        robot = rc7()
        assert robot.paused is False
        robot.paused = True
        assert robot.scene.robot("a").paused
        assert robot.step()
        assert robot.step_n(10)
        assert robot.scene.time() == 0
        robot.update()
        robot.scene.step()
        assert robot.scene.time() > 0
        robot.paused = False
        robot.step_n(2)
        assert robot.scene.time() == pytest.approx(3 * robot.scene.timestep())


def push(robot: rc.Robot, joint: int, torque: float) -> None:
    dof = robot.scene.model.joint(robot.joint_names[joint]).dofadr[0]
    robot.scene.data.qfrc_applied[dof] = torque


class TestImpedance:
    def test_a_joint_yields_like_a_spring(self):
        robot = rc7(gravcomp=False)
        impedance = robot.set_controller("arm", "joint_impedance")
        assert isinstance(impedance, rc.control.JointImpedanceController)
        impedance.stiffness = 300
        assert impedance.stiffness.tolist() == [300.0] * 7
        start = robot.arm.joint_pos
        run(robot, 200)
        np.testing.assert_allclose(robot.arm.joint_pos, start, atol=2e-3)
        push(robot, 3, 6.0)
        run(robot, 1500)
        assert robot.arm.joint_pos[3] - start[3] == pytest.approx(0.02, abs=1e-3)
        with pytest.raises(rc.ArgumentError, match="stiffness has 2 values; give 1 or 7"):
            impedance.stiffness = [1, 2]

    def test_the_tcp_yields_along_the_axes_of_the_base(self):
        robot = rc7(gravcomp=False, euler=[0, 40, 0])
        soft = robot.set_controller("arm", "cartesian_impedance")
        soft.stiffness = [500, 700, 900, 60, 60, 60]
        start = robot.fk_frame()
        assert soft.pose == start
        soft.feedforward = [5, -7, 9, 0, 0, 0]
        run(robot, 1500)
        moved = robot.fk_frame().translation - start.translation
        np.testing.assert_allclose(moved, [0.01, -0.01, 0.01], atol=1e-3)

    def test_the_posture_does_not_move_the_tcp(self):
        robot = rc7(gravcomp=False)
        soft = robot.set_controller("arm", "cartesian_impedance")
        start, before = robot.fk_frame(), robot.arm.joint_pos
        soft.posture = before + np.array([0.3, 0, 0, 0, 0, 0, 0])
        run(robot, 1000)
        assert robot.fk_frame().is_close(start, 5e-3, 2e-3)
        assert abs(robot.arm.joint_pos[0] - before[0]) > 0.02

    @needs_pykdl
    def test_accepts_frames_and_wrenches_of_kdl(self):
        soft = rc7().set_controller("arm", "cartesian_impedance")
        goal = rc.Pose(translation=[0.4, 0.1, 0.3])
        soft.pose = goal.to_kdl()
        assert soft.pose.is_close(goal, 1e-7, 1e-12)
        soft.feedforward = PyKDL.Wrench(PyKDL.Vector(1, 2, 3), PyKDL.Vector(4, 5, 6))
        assert soft.feedforward.tolist() == [1, 2, 3, 4, 5, 6]


class TestCartesianPose:
    def test_moves_on_a_straight_line_within_its_speed_limit(self):
        robot = rc7()
        cartesian = robot.set_controller("arm", "cartesian_pose")
        cartesian.max_linear_speed = 0.1
        start = robot.fk_frame()
        goal = rc.Pose(
            translation=start.translation + np.array([-0.05, 0.08, -0.06]), rotation=start.rotation
        )
        cartesian.pose = goal
        way = goal.translation - start.translation
        way /= np.linalg.norm(way)
        path = [start.translation]
        for _ in range(700):
            run(robot, 1)
            path.append(robot.fk_frame().translation)
        moved = np.array(path) - start.translation
        assert np.linalg.norm(moved - np.outer(moved @ way, way), axis=1).max() < 2e-3
        assert np.linalg.norm(np.diff(path, axis=0), axis=1).max() / 0.002 < 0.13
        assert robot.fk_frame().is_close(goal, 5e-3, 1e-3)

    def test_a_controller_can_outlive_its_robot(self):
        cartesian = rc7().set_controller("arm", "cartesian_pose")
        assert cartesian.kind == "cartesian_pose"
        assert cartesian.target.shape == (7,)
        cartesian.reset()

    def test_an_unknown_controller_error_lists_the_controllers(self):
        with pytest.raises(rc.NotFoundError, match=r"no controller 'cartesian_impedence'.*mean"):
            rc7().set_controller("arm", "cartesian_impedence")

    def test_the_configuration_selects_the_controller(self):
        config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
        config.control["arm"] = "joint_impedance"
        robot = build(rc.RobotSpec(name="a", config=config)).robot("a")
        assert robot.controller().kind == "joint_impedance"
        assert robot.controller("gripper").kind == "joint_position"
