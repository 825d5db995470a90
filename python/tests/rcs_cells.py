"""Configurations of RCS's page that its tests share: an FR3 alone, two on a mount."""

from __future__ import annotations

import pytest

import robocell as rc
import robocell.compat.rcs as rcs
from robocell.compat.rcs import DEFAULT_TRANSFORMS
from robocell.compat.rcs.envs.base import ControlMode
from robocell.compat.rcs.envs.scenes import SimEnvCreator, SimEnvCreatorConfig
from robocell.compat.rcs.sim import SimCameraConfig, SimConfig, SimRobotConfig

EXACT = (1e-9, 1e-9)
SMALL = {"resolution_width": 32, "resolution_height": 24}


@pytest.fixture(scope="module")
def fr3() -> SimRobotConfig:
    """An arm whose files are there."""
    from menagerie import require_menagerie

    require_menagerie("franka_fr3", "franka_emika_panda")
    return SimRobotConfig()


def camera(name: str) -> SimCameraConfig:
    return SimCameraConfig(identifier=name, frame_rate=30, **SMALL)


def minimal(robot_cfg: SimRobotConfig, **more) -> SimEnvCreatorConfig:
    """One arm, nothing else."""
    return SimEnvCreatorConfig(
        robot_cfgs={"robot": robot_cfg},
        sim_cfg=SimConfig(async_control=True),
        control_mode=ControlMode.CARTESIAN_TQuat,
        **more,
    )


def duo(robot_cfg: SimRobotConfig, **more) -> SimEnvCreatorConfig:
    robot_cfg_left = robot_cfg_right = robot_cfg
    # --- Dual-arm scene
    robot_cfgs = {"left": robot_cfg_left, "right": robot_cfg_right}
    robot_to_shared_base_frame = {
        "left": DEFAULT_TRANSFORMS["FR3_DUOMOUNT_LEFT_ROBOT"],
        "right": DEFAULT_TRANSFORMS["FR3_DUOMOUNT_RIGHT_ROBOT"],
    }
    shared_base_frame_to_root_frame = DEFAULT_TRANSFORMS["FR3_DUOMOUNT_HEIGHT_OFFSET"]
    root_frame_to_world = rcs.common.Pose()
    # ---
    frames = {
        "robot_to_shared_base_frame": robot_to_shared_base_frame,
        "shared_base_frame_to_root_frame": shared_base_frame_to_root_frame,
        "root_frame_to_world": root_frame_to_world,
    }
    return SimEnvCreatorConfig(
        robot_cfgs=robot_cfgs,
        sim_cfg=SimConfig(async_control=True),
        control_mode=ControlMode.CARTESIAN_TQuat,
        **(frames | more),
    )


def built(cfg: SimEnvCreatorConfig) -> rc.Scene:
    return rc.Scene.build(SimEnvCreator().create_model(cfg))
