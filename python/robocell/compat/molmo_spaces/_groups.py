"""A user's move groups as groups of a robocell robot, for `robot.set_group`."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

import robocell as rc
from robocell.compat.molmo_spaces._elements import name_of
from robocell.compat.molmo_spaces.robots.robot_views.abstract import (
    MJCFFrameMixin,
    MoveGroup,
    SimplyActuatedMoveGroup,
)

Numbers = NDArray[np.float64]


class OwnMoveGroup(rc.robots.MoveGroup):
    """A user's group that is neither gripper nor base: asks it what robocell asks of a group.

    Attributes:
        own: The user's group.
    """

    def __init__(self, own: MoveGroup) -> None:
        """Takes the group, which is in a view."""
        super().__init__()
        self.own = own

    def get_name(self) -> str:
        return self.own.name

    def get_kind(self) -> str:
        is_arm = isinstance(self.own, SimplyActuatedMoveGroup) and isinstance(
            self.own, MJCFFrameMixin
        )
        return "arm" if is_arm else "generic"

    def get_joint_names(self) -> list[str]:
        return [name_of(self.own.mj_model, "joint", each) for each in self.own._joint_ids]

    def get_actuator_names(self) -> list[str]:
        return [name_of(self.own.mj_model, "actuator", each) for each in self.own._actuator_ids]

    def get_joint_pos(self) -> Numbers:
        return self.own.joint_pos

    def set_joint_pos(self, q: Numbers) -> None:
        self.own.joint_pos = q

    def get_joint_vel(self) -> Numbers:
        return self.own.joint_vel

    def set_joint_vel(self, v: Numbers) -> None:
        self.own.joint_vel = v

    def get_joint_torque(self) -> Numbers:
        return self.own.mj_data.qfrc_actuator[self.own._joint_veladr]

    def get_ctrl(self) -> Numbers:
        return self.own.ctrl

    def set_ctrl(self, ctrl: Numbers) -> None:
        self.own.ctrl = ctrl

    def get_noop_ctrl(self) -> Numbers:
        return self.own.noop_ctrl

    def ctrl_for_joint_pos(self, q: Numbers) -> Numbers:
        if len(q) != self.own.n_actuators:
            raise rc.ArgumentError(
                f"move group '{self.own.name}' has {len(q)} joint positions and "
                f"{self.own.n_actuators} actuators: command it through its controller"
            )
        return q

    def get_joint_pos_limits(self) -> Numbers:
        return self.own.joint_pos_limits

    def get_ctrl_limits(self) -> Numbers:
        return self.own.ctrl_limits

    def get_leaf_frame_to_world(self) -> rc.Pose:
        return rc.Pose(self.own.leaf_frame_to_world)

    def get_root_frame_to_world(self) -> rc.Pose:
        return rc.Pose(self.own.root_frame_to_world)

    def get_leaf_frame_to_robot(self) -> rc.Pose:
        return rc.Pose(self.own.leaf_frame_to_robot)

    def get_jacobian(self) -> Numbers:
        return self.own.get_jacobian()[:, self.own._joint_veladr]

    def integrate(self, q: ArrayLike, v: ArrayLike) -> Numbers:
        return self.own.integrate_joint_vel(q, v)
