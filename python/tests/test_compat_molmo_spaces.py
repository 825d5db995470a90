"""The names of MolmoSpaces: each is there, is documented, and agrees with the engine."""

from __future__ import annotations

import importlib
import inspect
import statistics
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
import pytest

import robocell as rc
from molmospaces_toys import (
    MODEL,
    ArmGroup,
    FlyingView,
    MobileView,
    ToyConfig,
    ToyRobot,
    TwoArms,
    TwoArmsView,
)
from robocell.compat.molmo_spaces.configs.camera_configs import (
    CameraSystemConfig,
    MjcfCameraConfig,
)
from robocell.compat.molmo_spaces.configs.robot_configs import ActionNoiseConfig, BaseRobotConfig
from robocell.compat.molmo_spaces.configs.task_sampler_configs import PickTaskSamplerConfig
from robocell.compat.molmo_spaces.controllers.joint_pos import JointPosController
from robocell.compat.molmo_spaces.controllers.joint_rel_pos import JointRelPosController
from robocell.compat.molmo_spaces.data_generation.config_registry import (
    get_config_class,
    register_config,
)
from robocell.compat.molmo_spaces.env.data_views import create_mlspaces_body
from robocell.compat.molmo_spaces.env.env import CPUMujocoEnv
from robocell.compat.molmo_spaces.env.sensors import TCPPoseSensor
from robocell.compat.molmo_spaces.kinematics.mujoco_kinematics import MlSpacesKinematics
from robocell.compat.molmo_spaces.kinematics.parallel.warp_kinematics import SimpleWarpKinematics
from robocell.compat.molmo_spaces.molmo_spaces_constants import (
    register_user_asset_library,
    register_user_grasp_library,
)
from robocell.compat.molmo_spaces.robots.robot_views.abstract import (
    FreeJointRobotBaseGroup,
    ImmobileRobotBaseGroup,
    MocapRobotBaseGroup,
    MoveGroup,
    RobotView,
)
from robocell.compat.molmo_spaces.utils.mj_model_and_data_utils import body_pose, site_pose
from robocell.compat.molmo_spaces.utils.pose import pos_quat_to_pose_mat, pose_mat_to_7d

# Section "import surface used by the two tutorials" of the notes on the original.
SURFACE = {
    "robots.robot_views.abstract": "MocapRobotBaseGroup MJCFFrameMixin SimplyActuatedMoveGroup "
    "GripperGroup MoveGroup RobotView RobotViewFactory FreeJointRobotBaseGroup "
    "HoloJointsRobotBaseGroup ImmobileRobotBaseGroup RobotBaseGroup",
    "robots.abstract": "Robot",
    "configs.robot_configs": "BaseRobotConfig FrankaRobotConfig ActionNoiseConfig",
    "controllers.abstract": "Controller",
    "controllers.joint_pos": "JointPosController",
    "controllers.joint_rel_pos": "JointRelPosController",
    "kinematics.mujoco_kinematics": "MlSpacesKinematics",
    "kinematics.parallel.warp_kinematics": "SimpleWarpKinematics",
    "env.sensors": "TCPPoseSensor",
    "env.env": "CPUMujocoEnv",
    "env.data_views": "create_mlspaces_body",
    "configs": "PickTaskSamplerConfig",
    "configs.task_sampler_configs": "PickTaskSamplerConfig",
    "configs.abstract_exp_config": "MlSpacesExpConfig",
    "configs.base_pick_config": "PickBaseConfig",
    "configs.camera_configs": "AllCameraTypes CameraSystemConfig MjcfCameraConfig "
    "FrankaDroidCameraSystem RobotMountedCameraConfig FixedExocentricCameraConfig "
    "RandomizedExocentricCameraConfig",
    "data_generation.config_registry": "register_config",
    "tasks.pick_task_sampler": "PickTaskSampler",
    "molmo_spaces_constants": "register_user_asset_library register_user_grasp_library",
    "utils.mj_model_and_data_utils": "body_pose",
    "utils.pose": "pose_mat_to_7d",
}
ALIASES = {"RobotViewFactory", "AllCameraTypes"}  # types that carry no docstring of their own
PAGE = Path(__file__).resolve().parents[2] / "docs" / "compat_molmo_spaces.md"


@pytest.fixture
def data() -> mujoco.MjData:
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = mujoco.MjData(model)
    rng = np.random.default_rng(1)
    mujoco.mj_integratePos(model, data.qpos, rng.uniform(-1, 1, model.nv), 1)
    data.qvel[:] = rng.uniform(-1, 1, model.nv)
    mujoco.mj_forward(model, data)
    return data


@pytest.fixture
def view(data: mujoco.MjData) -> MobileView:
    return MobileView(data, "")


@pytest.mark.parametrize("module", SURFACE)
def test_every_name_is_there_and_documented(module: str):
    loaded = importlib.import_module(f"robocell.compat.molmo_spaces.{module}")
    page = PAGE.read_text()
    for name in SURFACE[module].split():
        value = getattr(loaded, name)
        assert name in page, f"docs/compat_molmo_spaces.md does not mention {name}"
        if name in ALIASES:
            continue
        assert value.__doc__, name
        if inspect.isclass(value):
            members = [
                each
                for key, each in vars(value).items()
                if not key.startswith("_") and (callable(each) or isinstance(each, property))
            ]
            assert all(inspect.getdoc(each) for each in members), name


class TestGroups:
    def test_values_are_those_of_the_data(self, view: MobileView, data: mujoco.MjData):
        arm = view.get_move_group("arm")
        assert arm.name == "arm"
        assert np.array_equal(arm.joint_pos, data.qpos[3:5])
        assert np.array_equal(arm.joint_vel, data.qvel[3:5])
        arm.joint_pos, arm.joint_vel, arm.ctrl = [0.1, 0.2], [0.3, 0.4], [0.5, 0.6]
        assert data.qpos[3:5].tolist() == [0.1, 0.2]
        assert data.qvel[3:5].tolist() == [0.3, 0.4]
        assert data.ctrl[3:5].tolist() == [0.5, 0.6]
        assert arm.joint_pos_limits.tolist() == [[-2, 2], [-np.inf, np.inf]]
        assert arm.ctrl_limits[0].tolist() == [-2, 2]
        assert np.array_equal(arm.noop_ctrl, arm.joint_pos)

    def test_jacobians_are_finite_differences(self, view: MobileView, data: mujoco.MjData):
        model, step = data.model, 1e-7
        arm = view.get_move_group("arm")
        jacobian = view.get_jacobian("arm", ["base", "arm"])
        before = arm.leaf_frame_to_world
        for column, address in enumerate([0, 1, 2, 3, 4]):
            moved = mujoco.MjData(model)
            moved.qpos[:] = data.qpos
            velocity = np.zeros(model.nv)
            velocity[address] = 1
            mujoco.mj_integratePos(model, moved.qpos, velocity, step)
            mujoco.mj_forward(model, moved)
            after = ArmGroup(moved, view.base, "").leaf_frame_to_world
            linear = (after[:3, 3] - before[:3, 3]) / step
            turned = (after[:3, :3] @ before[:3, :3].T - np.eye(3)) / step
            angular = [turned[2, 1], turned[0, 2], turned[1, 0]]
            assert np.allclose(jacobian[:, column], [*linear, *angular], atol=1e-5)

    def test_frames_are_relative_to_root_and_robot(self, view: MobileView):
        arm = view.get_move_group("arm")
        leaf, root, base = arm.leaf_frame_to_world, arm.root_frame_to_world, view.base.pose
        assert np.allclose(root @ arm.leaf_frame_to_root, leaf)
        assert np.allclose(base @ arm.leaf_frame_to_robot, leaf)
        assert np.allclose(base @ arm.root_frame_to_robot, root)

    def test_free_and_ball_joints_have_more_positions_than_velocities(self, data: mujoco.MjData):
        group = _passive(data)
        assert (group.n_joints, group.pos_dim, group.vel_dim) == (2, 11, 9)
        velocity = np.random.default_rng(0).uniform(-2, 2, 9)
        whole, speeds = data.qpos.copy(), np.zeros(data.model.nv)
        speeds[group._joint_veladr] = velocity
        mujoco.mj_integratePos(data.model, whole, speeds, 1)
        found = group.integrate_joint_vel(group.joint_pos, velocity)
        assert np.array_equal(found, whole[group._joint_posadr])
        # From where it is told to, which is not where the data are.
        still = group.integrate_joint_vel(found, np.zeros(9))
        assert np.allclose(still, found)

    def test_a_gripper_computes_what_holds_it_and_leaves_its_controls(self, view: MobileView):
        gripper = view.get_gripper("gripper")
        gripper.ctrl = [0.011]
        for opening, held in ((0.02, 0.02), (0.001, 0.0)):
            gripper.joint_pos = [opening, opening]
            assert gripper.noop_ctrl.tolist() == [held]
            assert gripper.is_open == (held > 0)
            assert gripper.ctrl.tolist() == [0.011]

    def test_a_group_has_a_name_in_a_view_alone(self, data: mujoco.MjData):
        group = _passive(data)
        with pytest.raises(rc.Error, match="has no name: a RobotView gives it one"):
            _ = group.name

        class Two(MobileView):
            def __init__(self) -> None:
                RobotView.__init__(self, data, {"a": group, "b": group})

        with pytest.raises(rc.ArgumentError, match="'b' is in a view already, as 'a'"):
            Two()

    def test_wrong_numbers_and_ids_are_named(self, view: MobileView, data: mujoco.MjData):
        arm = view.get_move_group("arm")
        with pytest.raises(rc.ArgumentError, match=r"arm.joint_pos: expected 2 numbers.*\(3,\)"):
            arm.joint_pos = [0, 0, 0]
        with pytest.raises(rc.ArgumentError, match="joint_ids: 99 is not an id"):
            _passive(data, [99])
        with pytest.raises(rc.NotFoundError, match=r"no 'arn'.*Did you mean 'arm'"):
            view.get_move_group("arn")
        with pytest.raises(rc.ArgumentError, match=r"'arm'.*is a ArmGroup, not a GripperGroup"):
            view.get_gripper("arm")


class TestBases:
    def test_a_holonomic_base_turns_the_short_way(self, view: MobileView, data: mujoco.MjData):
        pose = pos_quat_to_pose_mat([0.3, -0.2, 0], [np.cos(0.2), 0, 0, np.sin(0.2)])
        view.base.pose = pose
        mujoco.mj_forward(data.model, data)
        assert np.allclose(view.base.pose, pose)
        assert np.allclose(site_pose(data, data.model.site("base").id), pose)
        view.base.ctrl = np.array([0, 0, 0.4 + 2 * np.pi - 0.1])
        assert view.base.ctrl[2] == pytest.approx(0.3)
        assert np.allclose(view.base.noop_ctrl, [0.3, -0.2, 0.4])
        assert view.base.is_mobile

    def test_a_base_on_the_ground_has_no_columns_off_the_ground(self, data: mujoco.MjData):
        free = data.model.joint("free").id
        for floating, zero in ((False, True), (True, False)):

            class Drone(RobotView):
                name, base = "drone", property(lambda self: self._move_groups["base"])

            base = FreeJointRobotBaseGroup(data, free, [], [], floating=floating)
            jacobian = Drone(data, {"base": base}).get_jacobian("base", ["base"])
            assert (not jacobian[:, [2, 3, 4]].any()) == zero
            assert jacobian[:, [0, 1, 5]].any()
        target = pos_quat_to_pose_mat([1, 2, 3], [0.5, 0.5, 0.5, 0.5])
        base.pose = target
        mujoco.mj_forward(data.model, data)
        assert np.allclose(body_pose(data, base.root_body_id), target)

    def test_a_mocap_base_and_what_it_carries_can_be_put_anywhere(self, data: mujoco.MjData):
        pose = pos_quat_to_pose_mat([1, 2, 3], [0.5, 0.5, 0.5, 0.5])
        for name in ("mocap", "carried"):
            base = MocapRobotBaseGroup(data, data.model.body(name).id)
            base.pose = pose
            assert np.allclose(base.pose, pose)
            mujoco.mj_forward(data.model, data)
            assert np.allclose(body_pose(data, base.root_body_id), pose)
            assert base.noop_ctrl.size == 0
            assert not base.is_mobile
        with pytest.raises(rc.ArgumentError, match="body 'link1' is not a mocap body"):
            MocapRobotBaseGroup(data, data.model.body("link1").id)

    def test_an_immobile_base_stays(self, data: mujoco.MjData):
        base = ImmobileRobotBaseGroup(data, data.model.body("carried").id)
        assert np.allclose(base.pose, body_pose(data, data.model.body("carried").id))
        with pytest.raises(rc.ArgumentError, match=r"cannot be set.*MocapRobotBaseGroup"):
            base.pose = np.eye(4)


class TestViews:
    def test_dictionaries_have_all_groups_or_those_named(self, view: MobileView):
        assert view.move_group_ids() == ["base", "arm", "gripper"]
        assert list(view.get_qpos_dict(["arm"])) == ["arm"]
        for read in (view.get_qvel_dict, view.get_ctrl_dict, view.get_noop_ctrl_dict):
            assert list(read()) == ["base", "arm", "gripper"]
        view.set_qpos_dict({"arm": [0.5, 0.25]})
        assert view.get_qpos_dict()["arm"].tolist() == [0.5, 0.25]
        assert view.n_grippers == 1
        assert view.get_gripper_movegroup_ids() == ["gripper"]


class TestControllers:
    def test_targets_stay_within_the_limits(self, view: MobileView):
        controller = JointPosController(view.get_move_group("arm"))
        assert controller.stationary
        held = view.get_move_group("arm").joint_pos
        assert np.array_equal(controller.compute_ctrl_inputs(), held)
        controller.set_target([5, 0.5])
        assert controller.target.tolist() == [2, 0.5]
        assert not controller.stationary
        controller.set_to_stationary()
        assert np.array_equal(controller.target, held)
        with pytest.raises(rc.ArgumentError, match="'arm': expected 2 finite numbers"):
            controller.set_target([np.nan, 0])

    def test_changes_begin_where_the_group_is_and_small_ones_do_not_drift(self, view: MobileView):
        arm = view.get_move_group("arm")
        controller = JointRelPosController(arm)
        arm.joint_pos = [0.1, 0.2]
        controller.set_target([0.1, -0.1])
        assert np.allclose(controller.target, [0.2, 0.1])
        controller.set_target([0, 0])
        arm.joint_pos = [0.15, 0.2]  # it sags
        controller.set_target([0, 0])
        assert np.allclose(controller.target, [0.1, 0.2])


class TestRobots:
    def test_commands_reach_the_engine_and_missing_groups_hold(self):
        robot = _robot(ActionNoiseConfig(enabled=False))
        robot.update_control({"arm": [0.3, 0.2]})
        robot.compute_control()
        assert robot.mj_data.ctrl[:2].tolist() == [0.3, 0.2]
        robot.update_control({"gripper": [0.01], "arm": None})
        robot.compute_control()
        assert np.allclose(robot.mj_data.ctrl[:2], robot.mj_data.qpos[:2])
        with pytest.raises(rc.NotFoundError, match="no controller for 'arn'"):
            robot.update_control({"arn": [0]})

    def test_noise_is_bounded_at_the_tcp_and_kept_apart(self):
        noise = ActionNoiseConfig(
            action_scale_factor=10, max_tcp_position_noise=0.01, rotation_noise_scale=0
        )
        robot = _robot(noise)
        robot.rng = np.random.default_rng(0)
        jacobian = robot.robot_view.get_jacobian("arm", ["arm"])
        start = robot.robot_view.get_move_group("arm").joint_pos
        seen = []
        for _ in range(50):
            robot.update_control({"arm": start + 0.1})
            commanded = robot.controllers["arm"].target
            assert np.allclose(robot.last_unnoised_cmd_joint_pos()["arm"], start + 0.1)
            seen.append(np.abs(jacobian @ (commanded - start - 0.1))[:3].max())
        assert 1e-4 < max(seen) < 0.01 * np.sqrt(3)
        assert robot.apply_action_noise({"arm": start})["arm"] == pytest.approx(start)

    @pytest.mark.parametrize("spread", [0.3, 1, 4])
    def test_noise_is_a_truncated_normal(self, spread: float):
        robot = _robot()
        robot.rng = np.random.default_rng(0)
        drawn = np.sort(robot._truncated(spread, 1.0, 4000))
        normal = statistics.NormalDist(0, spread)
        low, high = normal.cdf(-1), normal.cdf(1)
        expected = [(normal.cdf(value) - low) / (high - low) for value in drawn]
        # The 1e-6 quantile of Kolmogorov and Smirnov's distance is 2.69 / sqrt(n).
        assert np.abs(expected - np.arange(4000) / 4000).max() < 2.69 / np.sqrt(4000)

    def test_overrides_are_for_the_robots_own_actuators(self):
        spec = mujoco.MjSpec.from_string(
            "<mujoco><worldbody><body><joint name='lid'/><geom size='.1'/></body></worldbody>"
            "<actuator><position name='lid' joint='lid' kp='7'/></actuator></mujoco>"
        )
        config = ToyConfig(K_stiffness=[50, 60], force_limit=[3], gravcomp=True)
        ToyRobot.add_robot_to_scene(config, spec, "robot_0/", [0.1, 0.2], [1, 0, 0, 0])
        ToyRobot.apply_control_overrides(spec, config)
        model = spec.compile()
        gains = {model.actuator(i).name: model.actuator_gainprm[i, 0] for i in range(model.nu)}
        assert gains["lid"] == 7
        assert [gains["robot_0/a1"], gains["robot_0/a2"]] == [50, 60]
        assert model.actuator("robot_0/a1").forcerange.tolist() == [-3, 3]
        assert model.body_gravcomp[model.body("robot_0/link0").id] == 1
        config.K_damping = [1] * 9
        with pytest.raises(rc.ArgumentError, match="K_damping: 9 values for 3 actuators"):
            ToyRobot.apply_control_overrides(spec, config)

    def test_poses_are_matrices_or_numbers(self):
        robot = _robot()
        for pose in ([1, 2, 0.5], pose_mat_to_7d(pos_quat_to_pose_mat([1, 2, 0], [1, 0, 0, 0]))):
            robot.set_world_pose(pose)
            assert robot.robot_view.base.pose[:2, 3].tolist() == [1, 2]
        with pytest.raises(rc.ArgumentError, match=r"got an array of shape \(5,\)"):
            robot.set_world_pose(np.zeros(5))

    def test_without_meshes_masses_stay(self):
        config = ToyConfig()
        masses = []
        for strip in (False, True):
            spec = mujoco.MjSpec()
            ToyRobot.add_robot_to_scene(config, spec, "r/", [0, 0, 0], [1, 0, 0, 0], False, strip)
            model = spec.compile()
            masses.append(model.body_mass.tolist())
        assert np.allclose(*masses)


class TestKinematics:
    def test_solutions_are_right_in_the_engine_and_within_limits(self):
        config = ToyConfig()
        one, many = MlSpacesKinematics(config), SimpleWarpKinematics(config)
        base = pos_quat_to_pose_mat([1, 2, 3], [0.5, 0.5, 0.5, 0.5])
        q0 = {"base": [], "arm": [0.2, 0.3], "gripper": [0.01, 0.01]}
        goals = [q0 | {"arm": [a, b]} for a, b in ((0.5, 0.6), (-1, 1), (1.5, -0.4))]
        targets = np.array([one.fk(goal, base)["arm"] for goal in goals])
        batch = many.ik("arm", targets, None, q0, base)
        for target, found in zip(targets, batch, strict=True):
            assert one.ik("arm", target, None, q0, base)["arm"] == pytest.approx(found["arm"])
            assert np.allclose(one.fk(found, base)["arm"], target, atol=1e-4)
            assert found["gripper"].tolist() == [0.01, 0.01]
            assert abs(found["arm"][0]) <= 2
        in_base = np.linalg.inv(base) @ targets
        again = many.ik("arm", in_base, ["arm"], q0, base, rel_to_base=True)
        assert np.allclose([q["arm"] for q in again], [q["arm"] for q in batch])
        assert np.allclose(many.fk(batch, base)[1]["arm"], targets[1], atol=1e-4)

    def test_what_cannot_be_reached_is_none_and_alone(self):
        many = SimpleWarpKinematics(ToyConfig())
        q0 = {"base": [], "arm": [0.2, 0.3], "gripper": [0, 0]}
        near = many.fk(q0, np.eye(4))["arm"]
        far = near.copy()
        far[0, 3] += 10
        found = many.ik("arm", np.array([near, far]), None, q0, np.eye(4))
        assert found[0] is not None
        assert found[1] is None
        assert many.ik("arm", far, None, q0, np.eye(4)) is None
        assert many.ik("arm", near, ["gripper"], q0, np.eye(4))["arm"].tolist() == [0.2, 0.3]
        with pytest.raises(rc.ArgumentError, match="batches of different sizes: 3 positions, 2 "):
            many.ik("arm", np.array([near, far]), None, [q0] * 3, np.eye(4))

    def test_positions_of_every_group_are_required(self):
        one = MlSpacesKinematics(ToyConfig())
        with pytest.raises(rc.ArgumentError, match=r"\[\] for a group.*missing: base, gripper"):
            one.fk({"arm": [0, 0]}, np.eye(4))

    @pytest.mark.parametrize("frame", ["world", "base", "leaf"])
    def test_joint_velocities_make_the_twist(self, frame: str):
        one = MlSpacesKinematics(ToyConfig())
        base = pos_quat_to_pose_mat([1, 2, 3], [0.5, 0.5, 0.5, 0.5])
        q0 = {"base": [], "arm": [0.2, 0.3], "gripper": [0, 0]}
        leaf = one.fk(q0, base)["arm"]
        axes = {"world": np.eye(4), "base": base, "leaf": leaf}[frame][:3, :3]
        speeds = np.array([0.4, -0.3])
        view = one._robot.view
        made = view.get_jacobian("arm", ["arm"]) @ speeds
        twist = np.concatenate([axes.T @ made[:3], axes.T @ made[3:]])
        found = one.twist_to_joint_vel("arm", twist, ["arm"], q0, base, frame)
        assert np.allclose(found["arm"], speeds, atol=1e-6)

    def test_a_driving_base_helps_unless_it_is_locked(self):
        config = ToyConfig(
            robot_xml_path=Path("mobile.xml"),
            robot_view_factory=MobileView,
            robot_cls=_Mobile,
            init_qpos={},
        )
        one = MlSpacesKinematics(config)
        q0 = {"base": [0, 0, 0], "arm": [0.2, 0.3], "gripper": [0, 0]}
        target = one.fk(q0 | {"base": [3, 1, 0.5]}, np.eye(4))["arm"]
        found = one.ik("arm", target, None, q0, np.eye(4))
        assert np.allclose(one.fk(found, np.eye(4))["arm"], target, atol=1e-4)
        assert one.ik("arm", target, ["arm"], q0, np.eye(4)) is None

    def test_a_free_base_goes_where_its_gripper_should_be(self):
        config = ToyConfig(
            robot_xml_path=Path("flying.xml"),
            robot_view_factory=FlyingView,
            robot_cls=_Flying,
            init_qpos={},
        )
        one, many = MlSpacesKinematics(config), SimpleWarpKinematics(config)
        q0 = {"base": [0, 0, 1, 1, 0, 0, 0], "gripper": [0.01, 0.01]}
        target = pos_quat_to_pose_mat([1, 2, 3], [0.5, 0.5, 0.5, 0.5])
        found = one.ik("gripper", target, None, q0, np.eye(4))
        assert np.allclose(one.fk(found, np.eye(4))["gripper"], target)
        again = many.ik("gripper", np.array([target] * 2), None, q0, np.eye(4))
        assert np.allclose(again[1]["base"], found["base"])
        assert one.ik("gripper", target, ["gripper"], q0, np.eye(4)) is None

    def test_two_arms_of_one_robot_are_solved_apart(self):
        config = ToyConfig(robot_view_factory=TwoArmsView, robot_cls=TwoArms, init_qpos={})
        many = SimpleWarpKinematics(config)
        q0 = {"base": [], "left_gripper": [0, 0], "right_gripper": [0, 0]}
        q0 |= {"left_arm": [0.2, 0.3], "right_arm": [0.1, -0.2]}
        poses = many.fk(q0 | {"left_arm": [0.6, -0.1], "right_arm": [1, 1]}, np.eye(4))
        start = many.fk(q0, np.eye(4))
        assert not np.allclose(start["left_arm"], poses["left_arm"], atol=0.1)
        for arm, other in (("left_arm", "right_arm"), ("right_arm", "left_arm")):
            found = many.ik(arm, poses[arm], None, q0, np.eye(4))
            assert np.allclose(many.fk(found, np.eye(4))[arm], poses[arm], atol=1e-3)
            assert found[other].tolist() == q0[other]


class TestBodiesAndSensors:
    def test_poses_of_bodies_are_read_and_written(self, data: mujoco.MjData):
        pose = pos_quat_to_pose_mat([1, 2, 3], [0.5, 0.5, 0.5, 0.5])
        for name in ("drone", "mocap"):
            body = create_mlspaces_body(data, name)
            body.pose = pose
            assert np.allclose(body.pose, pose)
            mujoco.mj_forward(data.model, data)
            assert np.allclose(body_pose(data, body.body_id), pose)
            assert np.allclose(body.position, [1, 2, 3])
        with pytest.raises(rc.ArgumentError, match="body 'link1' cannot be moved"):
            create_mlspaces_body(data, "link1").pose = pose
        with pytest.raises(rc.NotFoundError, match=r"no body 'dron'.*Did you mean 'drone'"):
            create_mlspaces_body(data, "dron")

    def test_the_tcp_sensor_reads_the_gripper_in_the_base(self):
        env = CPUMujocoEnv(SimpleNamespace(robot_config=ToyConfig()), _compiled())
        read = TCPPoseSensor(uuid="tcp_pose").get_observation(env)
        gripper = env.current_robot.robot_view.get_gripper("gripper")
        pose = np.linalg.inv(env.current_robot.robot_view.base.pose) @ gripper.leaf_frame_to_world
        assert read.dtype == np.float32
        assert np.allclose(read, pose_mat_to_7d(pose), atol=1e-6)
        env.step(5)
        assert env.current_data.time == pytest.approx(5 * env.mj_model.opt.timestep)


class TestConfigs:
    def test_a_misspelt_field_is_named(self):
        with pytest.raises(rc.ArgumentError, match=r"no field 'samples_per_hose'.*per_house'"):
            PickTaskSamplerConfig(samples_per_hose=2)
        with pytest.raises(rc.NotFoundError, match=r"no folder '/nowhere'.*Put the model"):
            BaseRobotConfig(robot_dir=Path("/nowhere")).get_robot_xml_path()
        with pytest.raises(rc.ArgumentError, match="robot_cls is not set"):
            MlSpacesKinematics(BaseRobotConfig()).fk({}, np.eye(4))

    def test_cameras_have_names_of_their_own(self):
        camera = MjcfCameraConfig(name="a", mjcf_name="eye")
        system = CameraSystemConfig(cameras=[camera])
        assert system.get_camera_by_name("a") is system.cameras[0]
        with pytest.raises(rc.ArgumentError, match="two cameras are called 'a'"):
            system.add_camera(camera)
        with pytest.raises(rc.NotFoundError, match=r"no 'b'. There are: a"):
            system.get_camera_by_name("b")

    def test_names_of_experiments_are_unique(self):
        from robocell.compat.molmo_spaces.configs.base_pick_config import PickBaseConfig

        register_config("OneOfATest")(type("One", (PickBaseConfig,), {}))
        with pytest.raises(rc.ArgumentError, match=r"'OneOfATest' is .*One already"):
            register_config("OneOfATest")(type("Other", (PickBaseConfig,), {}))
        with pytest.raises(rc.NotFoundError, match=r"no 'OneOfATes'.*Did you mean 'OneOfATest'"):
            get_config_class("OneOfATes")
        with pytest.raises(rc.ArgumentError, match="is not a subclass of MlSpacesExpConfig"):
            register_config("x")(object)

    def test_libraries_are_folders(self, tmp_path: Path):
        with pytest.raises(rc.NotFoundError, match=r"no asset library 'mine'.*comes first"):
            register_user_grasp_library("grasps", tmp_path, "mine")
        register_user_asset_library("mine", tmp_path)
        register_user_grasp_library("grasps_of_test", tmp_path, "mine")
        assert "grasps_of_test" in rc.tasks.grasp_libraries()
        rc.tasks.unregister_grasp_library("grasps_of_test")
        with pytest.raises(rc.NotFoundError, match="there is no folder"):
            register_user_asset_library("other", tmp_path / "nothing")


def _passive(data: mujoco.MjData, joints: list[int] | None = None) -> MoveGroup:
    class Passive(MoveGroup):
        noop_ctrl = property(lambda self: self.ctrl)
        leaf_frame_to_world = root_frame_to_world = property(lambda self: np.eye(4))

        def get_jacobian(self) -> Any:
            return np.zeros((6, self.mj_model.nv))

    model = data.model
    return Passive(data, joints or [model.joint("free").id, model.joint("ball").id], [], 0)


class _Flying(ToyRobot):
    """The gripper alone."""

    @staticmethod
    def robot_model_root_name() -> str:
        return "hand"

    add_robot_to_scene = classmethod(
        lambda cls, *given, **named: super(ToyRobot, cls).add_robot_to_scene(*given, **named)
    )


class _Mobile(ToyRobot):
    """The toy on wheels."""

    @staticmethod
    def robot_model_root_name() -> str:
        return "wheels"

    add_robot_to_scene = classmethod(
        lambda cls, *given, **named: super(ToyRobot, cls).add_robot_to_scene(*given, **named)
    )


def _compiled() -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    ToyRobot.add_robot_to_scene(ToyConfig(), spec, "robot_0/", [0, 0, 0], [1, 0, 0, 0])
    return spec.compile()


def _robot(noise: ActionNoiseConfig | None = None) -> ToyRobot:
    config = ToyConfig(action_noise_config=noise or ActionNoiseConfig())
    data = mujoco.MjData(_compiled())
    mujoco.mj_forward(data.model, data)
    robot = ToyRobot(data, SimpleNamespace(robot_config=config))
    robot.reset()
    mujoco.mj_forward(data.model, data)
    return robot
