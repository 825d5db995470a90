"""Ready-made environments: one FR3 with its hand and two cameras, and two of them on a mount."""

from __future__ import annotations

from math import pi

from robocell.compat.rcs.common import Pose
from robocell.compat.rcs.envs.base import ControlMode
from robocell.compat.rcs.envs.scenes import CameraAdderConfig, SimEnvCreator, SimEnvCreatorConfig
from robocell.compat.rcs.registries import (
    DEFAULT_TRANSFORMS,
    GRIPPER_MOUNT_OFFSETS,
    GRIPPER_TCP_OFFSETS,
    OBJECT_PATHS,
    SCENE_PATHS,
)
from robocell.compat.rcs.sim import SimCameraConfig, SimConfig, SimGripperConfig, SimRobotConfig

WRIST = Pose(translation=[0.06, 0, 0.05], rpy=[pi, -0.35, pi / 2])


def _camera(name: str) -> SimCameraConfig:
    return SimCameraConfig(name, 30, resolution_width=256, resolution_height=256)


def _fr3() -> SimRobotConfig:
    return SimRobotConfig(tcp_offset=GRIPPER_TCP_OFFSETS["FrankaHand"])


class EmptyWorldFR3(SimEnvCreator):
    """One FR3, a camera above it and one at its wrist."""

    def config(self) -> SimEnvCreatorConfig:
        """Its configuration, to be changed as wished."""
        return SimEnvCreatorConfig(
            robot_cfgs={"robot": _fr3()},
            sim_cfg=SimConfig(async_control=True, frequency=30),
            control_mode=ControlMode.CARTESIAN_TQuat,
            scene=SCENE_PATHS["empty_world"],
            gripper_cfgs={"robot": SimGripperConfig()},
            gripper_offsets={"robot": GRIPPER_MOUNT_OFFSETS["FrankaHand"]},
            camera_cfgs={name: _camera(name) for name in ("bird_eye", "wrist")},
            camera_adds={
                "bird_eye": CameraAdderConfig(
                    fovy=60.0,
                    offset=Pose(
                        translation=[0.271, 0.0, 2.080],
                        quaternion=[0.0060, -0.0060, -0.7067, 0.7074],
                    ),
                ),
                "wrist": CameraAdderConfig(fovy=60.0, offset=WRIST, robot_name="robot"),
            },
            max_relative_movement=(0.2, pi / 4),
            add_gravcomp=True,
        )


class EmptyWorldFR3Duo(SimEnvCreator):
    """Two FR3 on a mount, tilted outwards, with one frame for the actions of both."""

    def config(self) -> SimEnvCreatorConfig:
        """Its configuration, to be changed as wished."""
        sides = ("left", "right")
        return SimEnvCreatorConfig(
            robot_cfgs={side: _fr3() for side in sides},
            sim_cfg=SimConfig(async_control=True, frequency=30),
            control_mode=ControlMode.CARTESIAN_TQuat,
            scene=SCENE_PATHS["empty_world"],
            gripper_cfgs={side: SimGripperConfig() for side in sides},
            gripper_offsets=dict.fromkeys(sides, GRIPPER_MOUNT_OFFSETS["FrankaHand"]),
            robot_to_shared_base_frame={
                "left": DEFAULT_TRANSFORMS["FR3_DUOMOUNT_LEFT_ROBOT"],
                "right": DEFAULT_TRANSFORMS["FR3_DUOMOUNT_RIGHT_ROBOT"],
            },
            shared_base_frame_to_root_frame=DEFAULT_TRANSFORMS["FR3_DUOMOUNT_HEIGHT_OFFSET"],
            root_frame_objects={
                "duo_mount": (
                    OBJECT_PATHS["fr3_duo_mount"],
                    DEFAULT_TRANSFORMS["FR3_DUOMOUNT_BASE"],
                )
            },
            max_relative_movement=(0.2, pi / 4),
            add_gravcomp=True,
        )
