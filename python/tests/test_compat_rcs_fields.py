"""Fields of RCS's configurations that mean what they mean there."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

import robocell.compat.rcs as rcs
from rcs_cells import SMALL, built, fr3, minimal
from robocell.compat.rcs.envs.base import ControlMode, RelativeTo
from robocell.compat.rcs.envs.configs import EmptyWorldFR3, EmptyWorldFR3Duo
from robocell.compat.rcs.sim import CameraType, SimCameraConfig, SimConfig

__all__ = ["fr3"]  # a fixture


def test_ready_made_configurations_are_the_pages():
    for creator in (EmptyWorldFR3(), EmptyWorldFR3Duo()):
        cfg = creator.config()
        assert cfg.sim_cfg == SimConfig(async_control=False, realtime=True, frequency=1)
        assert cfg.control_mode == ControlMode.CARTESIAN_TQuat
        assert (cfg.max_relative_movement, cfg.relative_to) == (None, RelativeTo.LAST_STEP)


def test_one_number_limits_cartesian_steps_in_metres_and_to_a_quarter_turn(fr3):
    for limit in (0.05, np.float64(0.05), 1):
        config = minimal(fr3, max_relative_movement=limit).to_env_config()
        assert config.max_relative_movement == pytest.approx((limit, np.pi / 2))
    joints = replace(minimal(fr3, max_relative_movement=0.05), control_mode=ControlMode.JOINTS)
    assert joints.to_env_config().max_relative_movement == pytest.approx((0.05,))


def test_a_free_camera_is_mujocos(fr3):
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
