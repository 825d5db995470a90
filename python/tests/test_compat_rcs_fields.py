"""Fields of RCS's configurations that mean what they mean there."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

import robocell as rc
import robocell.compat.rcs as rcs
from rcs_cells import SMALL, built, fr3, minimal
from robocell.compat.rcs.envs.base import ControlMode, RelativeTo
from robocell.compat.rcs.envs.configs import EmptyWorldFR3, EmptyWorldFR3Duo
from robocell.compat.rcs.envs.scenes import SimEnvCreator
from robocell.compat.rcs.sim import (
    CameraType,
    SimCameraConfig,
    SimConfig,
    SimGripperConfig,
)

__all__ = ["fr3"]  # a fixture


def test_ready_made_configurations_match_the_page():
    for creator in (EmptyWorldFR3(), EmptyWorldFR3Duo()):
        cfg = creator.config()
        assert cfg.sim_cfg == SimConfig(async_control=False, realtime=True, frequency=1)
        assert cfg.control_mode == ControlMode.CARTESIAN_TQuat
        assert (cfg.max_relative_movement, cfg.relative_to) == (None, RelativeTo.LAST_STEP)


def test_one_number_limits_cartesian_steps_in_metres_and_to_a_quarter_turn(fr3):
    for limit in (0.05, np.float64(0.05), np.float32(0.05), np.array(0.05), np.int64(1), 1):
        config = minimal(fr3, max_relative_movement=limit).to_env_config()
        assert config.max_relative_movement == pytest.approx((float(limit), np.pi / 2))
    joints = replace(minimal(fr3, max_relative_movement=0.05), control_mode=ControlMode.JOINTS)
    assert joints.to_env_config().max_relative_movement == pytest.approx((0.05,))


def test_a_free_camera_matches_mujoco(fr3):
    root = rcs.common.Pose(translation=[1, 2, 3], rpy=[0, 0, 0.7])
    eye = SimCameraConfig(identifier="", type=CameraType.free, **SMALL)
    cfg = minimal(fr3, camera_cfgs={"eye": eye}, root_frame_to_world=root)
    scene = built(cfg)
    there = mujoco.MjvScene(scene.model, maxgeom=1000)
    mujoco.mjv_updateScene(
        scene.model, scene.data, mujoco.MjvOption(), None, mujoco.MjvCamera(),
        mujoco.mjtCatBit.mjCAT_ALL, there,
    )  # fmt: skip
    eyes = [np.array(camera.pos) for camera in there.camera]
    pose = scene.camera_pose("eye_free")
    assert np.allclose(pose.translation, np.mean(eyes, axis=0), atol=1e-6)
    assert np.allclose(pose.matrix[:3, 2], -np.array(there.camera[0].forward), atol=1e-6)
    assert np.allclose(pose.matrix[:3, 1], there.camera[0].up, atol=1e-6)
    assert scene.model.camera("eye_free").fovy == scene.model.vis.global_.fovy
    assert cfg.to_env_config().cameras.streams[0].camera == "eye_free"


@pytest.mark.parametrize("kind", ["free", "default_free", "tracking"])
def test_cameras_of_every_type_take_images(fr3, kind: str):
    eye = SimCameraConfig(identifier="robotrobot_fr3_link7", type=CameraType[kind], **SMALL)
    env = SimEnvCreator()(minimal(fr3, camera_cfgs={"eye": eye}, headless=True))
    observation, _ = env.reset(seed=0)
    image = observation["frames"]["eye"]["rgb"]["data"]
    assert image.shape == (24, 32, 3)
    assert image.std() > 0, "it sees more than one colour"
    env.close()


def test_rejects_widths_out_of_the_grippers_range(fr3):
    for closed, opened, told in ((0.04, 0, "open and closed are swapped"), (5, 6, "correct it")):
        gripper = SimGripperConfig(min_joint_width=closed, max_joint_width=opened)
        with pytest.raises(rc.SpecError, match=f"min_joint_width, max_joint_width: .*{told}"):
            SimEnvCreator()(minimal(fr3, gripper_cfgs={"robot": gripper}, headless=True))


def test_widths_and_collision_geoms_of_grippers_become_robocells():
    gripper = SimGripperConfig(
        min_joint_width=1.0, max_joint_width=0.005, collision_geoms=["hand_c"],
        ignored_collision_geoms=["cube_geom"],
    ).to_robot()  # fmt: skip
    group = gripper.move_groups["gripper"]
    assert (group.joint_range.open, group.joint_range.closed) == (0.005, 1.0)
    assert [geom.name for geom in gripper.collision_geoms] == ["hand_c"]
    assert list(gripper.ignored_collision_geoms) == ["cube_geom"]
    assert SimGripperConfig().to_robot().move_groups["gripper"].joint_range is None


@pytest.mark.parametrize("root", ["menagerie:robotiq_2f85", "path"])
def test_a_gripper_can_be_given_by_model_path(fr3, root: str):
    folder = rc.menagerie.folder("robotiq_2f85") if root == "path" else root
    gripper = SimGripperConfig(
        gripper_type=f"{folder}/2f85.xml",
        joints=["right_driver_joint", "left_driver_joint"],
        actuator="fingers_actuator",
        min_actuator_width=255,
        max_actuator_width=0,
        collision_geoms_fingers=[],
    )
    assert gripper.to_robot().name == "2f85"
    scene = built(minimal(fr3, gripper_cfgs={"robot": gripper}))
    assert scene.robot("gripperrobot").gripper.opening == pytest.approx(1, abs=0.01)


def test_the_width_is_read_between_the_joint_widths(fr3):
    seen = []
    for widest in (0.04, 0.08):
        cfg = minimal(fr3, gripper_cfgs={"robot": SimGripperConfig(max_joint_width=widest)})
        cfg.wrapper_cfg.binary_gripper = False
        cfg.headless = True
        env = SimEnvCreator()(cfg)
        env.reset(seed=0)
        still = {"robot": {"tquat": [0, 0, 0, 0, 0, 0, 1], "gripper": [1]}}
        for _ in range(30):
            observation, *_ = env.step(still)
        seen.append(observation["robot"]["gripper"][0])
        env.close()
    assert seen == pytest.approx([1, 0.5], abs=0.02)
