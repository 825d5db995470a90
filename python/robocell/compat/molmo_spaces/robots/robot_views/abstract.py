"""Move groups and the view of a robot: names for parts of a `mujoco.MjData`.

A group lists joints and actuators of a model by id. It reads and writes their values in place, so
several views of one MjData always agree. Poses are 4x4 matrices in the world unless the name says
otherwise; after writing positions, call `mujoco.mj_forward` before reading poses.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, TypeAlias

import mujoco
import numpy as np
from numpy.typing import NDArray

import robocell as rc
from robocell.compat.molmo_spaces._elements import look_up
from robocell.compat.molmo_spaces.robots.robot_views._bases import (
    FreeJointRobotBaseGroup,
    HoloJointsRobotBaseGroup,
    ImmobileRobotBaseGroup,
    MocapRobotBaseGroup,
)
from robocell.compat.molmo_spaces.robots.robot_views._move_groups import (
    GripperGroup,
    MJCFFrameMixin,
    MoveGroup,
    RobotBaseGroup,
    SimplyActuatedMoveGroup,
)

__all__ = [
    "FreeJointRobotBaseGroup",
    "GripperGroup",
    "HoloJointsRobotBaseGroup",
    "ImmobileRobotBaseGroup",
    "MJCFFrameMixin",
    "MocapRobotBaseGroup",
    "MoveGroup",
    "RobotBaseGroup",
    "RobotView",
    "RobotViewFactory",
    "SimplyActuatedMoveGroup",
]

Numbers = NDArray[np.float64]
# Velocities of a free joint that leave the ground: z, and rotations about x and y.
_OFF_THE_GROUND = [2, 3, 4]


class RobotView(ABC):
    """A robot in a model: its move groups by id. Subclasses define `name` and `base`.

    Attributes:
        mj_model: The model.
        mj_data: The data that the groups read and write.
    """

    def __init__(self, mj_data: mujoco.MjData, move_groups: dict[str, Any]) -> None:
        """Gives each group its id as its name. A group belongs to one view."""
        self.mj_model: mujoco.MjModel = mj_data.model
        self.mj_data = mj_data
        self._move_groups: dict[str, Any] = move_groups
        for name, group in move_groups.items():
            if group._name is not None:
                raise rc.ArgumentError(
                    f"move group '{name}' is in a view already, as '{group._name}'; make a group "
                    "for each id"
                )
            group._name = name

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of the kind of robot."""

    @property
    @abstractmethod
    def base(self) -> RobotBaseGroup:
        """The group of the base."""

    @cached_property
    def root_body_id(self) -> int:
        """Id of the root of the robot's tree of bodies, as `body_rootid` of contacts has it."""
        return int(self.mj_model.body_rootid[self.base.root_body_id])

    @property
    def n_grippers(self) -> int:
        """Number of grippers."""
        return len(self.get_gripper_movegroup_ids())

    def move_group_ids(self) -> list[str]:
        """Returns the ids of all groups."""
        return list(self._move_groups)

    def get_move_group(self, mg_id: str) -> Any:
        """Returns a group by its id. Raises NotFoundError that lists the ids."""
        return look_up(self._move_groups, mg_id, f"robot view '{self.name}': move group")

    def get_gripper(self, gripper_group_id: str) -> Any:
        """Returns a gripper by its id. Raises ArgumentError for another kind of group."""
        group = self.get_move_group(gripper_group_id)
        if not isinstance(group, GripperGroup):
            raise rc.ArgumentError(
                f"move group '{gripper_group_id}' of robot view '{self.name}' is a "
                f"{type(group).__name__}, not a GripperGroup. Its grippers: "
                f"{', '.join(self.get_gripper_movegroup_ids()) or 'none'}"
            )
        return group

    def get_gripper_movegroup_ids(self) -> list[str]:
        """Returns the ids of all grippers."""
        return [
            name for name, group in self._move_groups.items() if isinstance(group, GripperGroup)
        ]

    def get_qpos_dict(self, move_group_ids: Sequence[str] | None = None) -> dict[str, Numbers]:
        """Returns the joint positions of these groups, or of all."""
        return {name: self.get_move_group(name).joint_pos for name in self._ids(move_group_ids)}

    def set_qpos_dict(self, qpos_dict: dict[str, Any]) -> None:
        """Sets the joint positions of the groups in it."""
        for name, positions in qpos_dict.items():
            self.get_move_group(name).joint_pos = positions

    def get_qvel_dict(self, move_group_ids: Sequence[str] | None = None) -> dict[str, Numbers]:
        """Returns the joint velocities of these groups, or of all."""
        return {name: self.get_move_group(name).joint_vel for name in self._ids(move_group_ids)}

    def get_ctrl_dict(self, move_group_ids: Sequence[str] | None = None) -> dict[str, Numbers]:
        """Returns the controls of these groups, or of all."""
        return {name: self.get_move_group(name).ctrl for name in self._ids(move_group_ids)}

    def get_noop_ctrl_dict(self, move_group_ids: Sequence[str] | None = None) -> dict[str, Numbers]:
        """Returns the controls that hold these groups, or all, where they are."""
        return {name: self.get_move_group(name).noop_ctrl for name in self._ids(move_group_ids)}

    def get_jacobian(self, move_group_id: str, input_move_group_ids: Sequence[str]) -> Numbers:
        """Returns the Jacobian (6, n) of a group's leaf frame for the joints of other groups.

        Columns are in the order of `input_move_group_ids`. A base with a free joint that is not
        floating has no columns for leaving the ground: they are zero.
        """
        whole = self.get_move_group(move_group_id).get_jacobian()
        parts = [np.zeros((6, 0))]
        for name in input_move_group_ids:
            group = self.get_move_group(name)
            columns = whole[:, group._joint_veladr]
            if isinstance(group, FreeJointRobotBaseGroup) and not group.floating:
                columns[:, _OFF_THE_GROUND] = 0
            parts.append(columns)
        return np.concatenate(parts, axis=1)

    def _ids(self, chosen: Sequence[str] | None) -> Sequence[str]:
        return self.move_group_ids() if chosen is None else chosen


RobotViewFactory: TypeAlias = Callable[[mujoco.MjData, str], RobotView]
"""Makes the view of a robot from the data and the namespace of its names; a class is one."""
