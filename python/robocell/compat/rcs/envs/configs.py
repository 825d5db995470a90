"""Ready-made environments: one FR3 with its hand and two cameras, and two of them on a mount."""

from __future__ import annotations

from robocell.compat.rcs.envs.base import ControlMode
from robocell.compat.rcs.envs.cameras import PAGE_CAMERAS, camera_of_the_page
from robocell.compat.rcs.envs.scenes import SimEnvCreator, SimEnvCreatorConfig
from robocell.compat.rcs.registries import (
    DEFAULT_TRANSFORMS,
    GRIPPER_MOUNT_OFFSETS,
    GRIPPER_TCP_OFFSETS,
    OBJECT_PATHS,
    SCENE_PATHS,
)
from robocell.compat.rcs.sim import SimCameraConfig, SimConfig, SimGripperConfig, SimRobotConfig

__all__ = [
    "EmptyWorldFR3",
    "EmptyWorldFR3Duo",
]


# The page's: its simulation runs until the arm has arrived, and shows that in real time.
def _sim() -> SimConfig:
    return SimConfig(async_control=False, realtime=True, frequency=1)


def _camera(name: str) -> SimCameraConfig:
    return SimCameraConfig(name, 30, resolution_width=256, resolution_height=256)


def _fr3() -> SimRobotConfig:
    return SimRobotConfig(tcp_offset=GRIPPER_TCP_OFFSETS["FrankaHand"])


class EmptyWorldFR3(SimEnvCreator):
    """One FR3, a camera above it and one at its wrist."""

    def config(self) -> SimEnvCreatorConfig:
        """Returns its configuration, which you may change."""
        return SimEnvCreatorConfig(
            robot_cfgs={"robot": _fr3()},
            sim_cfg=_sim(),
            control_mode=ControlMode.CARTESIAN_TQuat,
            scene=SCENE_PATHS["empty_world"],
            gripper_cfgs={"robot": SimGripperConfig()},
            gripper_offsets={"robot": GRIPPER_MOUNT_OFFSETS["FrankaHand"]},
            camera_cfgs={name: _camera(name) for name in ("bird_eye", "wrist")},
            camera_adds={name: camera_of_the_page(name, "robot") for name in PAGE_CAMERAS},
            add_gravcomp=True,
        )


class EmptyWorldFR3Duo(SimEnvCreator):
    """Two FR3 on a mount, tilted outwards, with one frame for the actions of both."""

    def config(self) -> SimEnvCreatorConfig:
        """Returns its configuration, which you may change."""
        sides = ("left", "right")
        return SimEnvCreatorConfig(
            robot_cfgs={side: _fr3() for side in sides},
            sim_cfg=_sim(),
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
            add_gravcomp=True,
        )
