"""A user's move groups as groups of a robocell robot, for `robot.set_group`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

import robocell as rc
from robocell.compat.molmo_spaces._elements import name_of
from robocell.compat.molmo_spaces.robots.robot_views.abstract import (
    GripperGroup,
    MJCFFrameMixin,
    MoveGroup,
    RobotBaseGroup,
    SimplyActuatedMoveGroup,
)

Numbers = NDArray[np.float64]


class _OwnGroup:
    """Passes what robocell asks of a group on to a user's group."""

    own: MoveGroup

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


class OwnMoveGroup(_OwnGroup, rc.robots.MoveGroup):
    """A user's group that is neither gripper nor base.

    Attributes:
        own: The user's group.
    """

    def __init__(self, own: MoveGroup) -> None:
        """Takes the group, which is in a view."""
        super().__init__()
        self.own = own


class OwnGripper(_OwnGroup, rc.robots.GripperGroup):
    """A user's gripper. Its opening is read from its finger distances.

    Attributes:
        own: The user's gripper.
    """

    own: GripperGroup

    def __init__(self, own: GripperGroup) -> None:
        """Takes the gripper, which is in a view. Its own methods give the controls of both ends."""
        super().__init__()
        self.own = own
        before = own.ctrl.copy()
        ends = []
        for is_open in (False, True):
            own.set_gripper_ctrl_open(is_open)
            ends.append(own.ctrl.copy())
        own.ctrl = before
        self._closed, self._opened = ends

    def get_kind(self) -> str:
        """A gripper."""
        return "gripper"

    def get_inter_finger_dist(self) -> float:
        """The user's distance, m."""
        return float(self.own.inter_finger_dist)

    def get_inter_finger_dist_range(self) -> tuple[float, float]:
        """The user's range, m."""
        closed, opened = self.own.inter_finger_dist_range
        return float(closed), float(opened)

    def get_is_open(self) -> bool:
        """Whether the user's gripper is open."""
        return bool(self.own.is_open)

    def get_opening(self) -> float:
        """Where the distance is in its range, 0 to 1."""
        closed, opened = self.get_inter_finger_dist_range()
        return float(np.clip((self.get_inter_finger_dist() - closed) / (opened - closed), 0, 1))

    def set_opening(self, opening: float) -> None:
        """Commands the actuators between the controls of both ends."""
        self.own.ctrl = self._closed + opening * (self._opened - self._closed)

    def ctrl_for_opening(self, opening: float) -> float:
        """Returns the control of the first actuator."""
        return float(self._closed[0] + opening * (self._opened[0] - self._closed[0]))

    def get_is_grasping(self, body: str) -> bool:
        """Returns True if the fingers' bodies touch a body, or anything, from two sides."""
        touched = [_touches(self.own, tree, body) for tree in self._fingers()]
        return len(touched) >= 2 and sum(touched) >= 2

    def _fingers(self) -> Sequence[set[int]]:
        """Returns the bodies that each child of the gripper's root carries."""
        model, root = self.own.mj_model, self.own.root_body_id
        trees: dict[int, set[int]] = {}
        for body in range(root + 1, model.nbody):
            top = body
            while top > root and model.body_parentid[top] != root:
                top = int(model.body_parentid[top])
            if top > root:
                trees.setdefault(top, set()).add(body)
        return list(trees.values())


class OwnBase(_OwnGroup, rc.robots.BaseGroup):
    """A user's base.

    Attributes:
        own: The user's base.
    """

    own: RobotBaseGroup

    def __init__(self, own: RobotBaseGroup) -> None:
        """Takes the base, which is in a view."""
        super().__init__()
        self.own = own

    def get_kind(self) -> str:
        """A base."""
        return "base"

    def get_pose(self) -> rc.Pose:
        """The user's pose in the world."""
        return rc.Pose(self.own.pose)

    def set_pose(self, pose: rc.Pose) -> None:
        """Moves the user's base."""
        self.own.pose = pose.matrix

    def get_is_mobile(self) -> bool:
        """Whether the user's base is mobile."""
        return bool(self.own.is_mobile)


def as_group(own: MoveGroup) -> rc.robots.MoveGroup:
    """Returns a user's group as one that `robot.set_group` takes."""
    if isinstance(own, GripperGroup):
        return OwnGripper(own)
    if isinstance(own, RobotBaseGroup):
        return OwnBase(own)
    return OwnMoveGroup(own)


def _touches(group: MoveGroup, bodies: set[int], other: str) -> bool:
    model, data = group.mj_model, group.mj_data
    root = model.body_rootid[group.root_body_id]
    for contact in data.contact[: data.ncon]:
        pair = [int(model.geom_bodyid[geom]) for geom in contact.geom]
        for one, another in (pair, pair[::-1]):
            is_other = (
                name_of(model, "body", another) == other
                if other
                else model.body_rootid[another] != root
            )
            if one in bodies and is_other:
                return True
    return False
