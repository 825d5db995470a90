"""Names of scenes, objects, grippers, cameras and transforms.

Models are robocell's own, by their built-in names, and the Menagerie's; no file is read here.
"""

from __future__ import annotations

import difflib
from math import pi
from typing import TypeVar

from robocell.compat.rcs.common import Pose

# The page's names, which `robocell.compat.rcs` has too.
__all__ = [
    "CAMERA_PATHS",
    "DEFAULT_TRANSFORMS",
    "GRIPPER_MOUNT_OFFSETS",
    "GRIPPER_PATHS",
    "GRIPPER_TCP_OFFSETS",
    "HOME_POSITIONS",
    "OBJECT_PATHS",
    "SCENE_PATHS",
]

Value = TypeVar("Value")


class UnknownNameError(KeyError):
    """A name that a registry does not have; the text lists those that it has."""

    def __str__(self) -> str:
        """Returns the text without the quotes that KeyError adds."""
        return str(self.args[0])


class Registry(dict[str, Value]):
    """A dictionary of names. Raises KeyError with the nearest name for an unknown one."""

    def __init__(self, name: str, entries: dict[str, Value]) -> None:
        super().__init__(entries)
        self.name = name

    def __missing__(self, key: object) -> Value:
        """Raises KeyError with the names of the registry."""
        near = difflib.get_close_matches(str(key), list(self), 1)
        hint = f" Did you mean '{near[0]}'?" if near else ""
        raise UnknownNameError(f"{self.name}: no '{key}'. It has: {', '.join(self)}.{hint}")


SCENE_PATHS = Registry("SCENE_PATHS", {"empty_world": "empty_world", "tabletop": "tabletop"})

OBJECT_PATHS = Registry(
    "OBJECT_PATHS",
    {
        "green_cube": "green_cube",
        "fr3_duo_mount": "fr3_duo_mount",
        "robotiq_d405_mount": "robotiq_d405_mount",
    },
)

GRIPPER_PATHS = Registry(
    "GRIPPER_PATHS",
    {
        "FrankaHand": "menagerie:franka_emika_panda/hand.xml",
        "Robotiq2F85": "menagerie:robotiq_2f85/2f85.xml",
        "ParallelHand": "parallel_hand",
    },
)

CAMERA_PATHS = Registry("CAMERA_PATHS", {"d405": "d405"})

# Gripper type -> its pose in the attachment site of an FR3: that is turned by 45 degrees.
GRIPPER_MOUNT_OFFSETS = Registry(
    "GRIPPER_MOUNT_OFFSETS",
    {
        "FrankaHand": Pose(rpy=[0, 0, -pi / 4]),
        "Robotiq2F85": Pose(rpy=[0, 0, pi / 4]),
        "ParallelHand": Pose(rpy=[0, 0, -pi / 4]),
    },
)

# Gripper type -> the TCP in the attachment site of an FR3.
GRIPPER_TCP_OFFSETS = Registry(
    "GRIPPER_TCP_OFFSETS",
    {
        "FrankaHand": Pose(translation=[0, 0, 0.1034], rpy=[0, 0, -pi / 4]),
        "Robotiq2F85": Pose(translation=[0, 0, 0.1489], rpy=[0, 0, pi / 4]),
        "ParallelHand": Pose(translation=[0, 0, 0.14], rpy=[0, 0, -pi / 4]),
    },
)

DEFAULT_TRANSFORMS = Registry(
    "DEFAULT_TRANSFORMS",
    {
        "FR3_DUOMOUNT_BASE": Pose(),
        "FR3_DUOMOUNT_HEIGHT_OFFSET": Pose(translation=[0, 0, 0.342]),
        "FR3_DUOMOUNT_LEFT_ROBOT": Pose(
            translation=[0, 0.05018, 0], quaternion=[-0.436978, 0.0225312, -0.243326, 0.865641]
        ),
        "FR3_DUOMOUNT_RIGHT_ROBOT": Pose(
            translation=[0, -0.05018, 0], quaternion=[0.436978, 0.0225312, 0.243326, 0.865641]
        ),
        "FR3_ROBOTIQ_WRIST_D405_MOUNT": Pose(quaternion=[0, 0, 0.7071068, 0.7071068]),
    },
)

HOME_POSITIONS = Registry(
    "HOME_POSITIONS", {"FR3": [0, -pi / 4, 0, -3 * pi / 4, 0, pi / 2, pi / 4]}
)
