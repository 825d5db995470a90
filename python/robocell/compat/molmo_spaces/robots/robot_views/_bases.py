"""Bases of robots: move groups that carry all others."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

import robocell as rc
from robocell.compat.molmo_spaces._elements import name_of
from robocell.compat.molmo_spaces.robots.robot_views._move_groups import (
    MoveGroup,
    RobotBaseGroup,
    SimplyActuatedMoveGroup,
)
from robocell.compat.molmo_spaces.utils.mj_model_and_data_utils import body_pose, site_pose
from robocell.compat.molmo_spaces.utils.pose import (
    as_pose_mat,
    pos_quat_to_pose_mat,
    pose_mat_to_pos_quat,
    relative_pose,
)

Numbers = NDArray[np.float64]


class FreeJointRobotBaseGroup(RobotBaseGroup):
    """A base with a free joint; `floating` ones may leave the ground."""

    def __init__(
        self,
        mj_data: mujoco.MjData,
        base_joint_id: int,
        joint_ids: Sequence[int],
        actuator_ids: Sequence[int],
        floating: bool = False,
    ) -> None:
        """Takes the free joint, and further joints and actuators that belong to the base."""
        model = mj_data.model
        if model.jnt_type[base_joint_id] != mujoco.mjtJoint.mjJNT_FREE:
            raise rc.ArgumentError(
                f"{type(self).__name__}: joint '{name_of(model, 'joint', base_joint_id)}' is not a "
                "free joint; base_joint_id is that of the base's <freejoint>"
            )
        body = int(model.jnt_bodyid[base_joint_id])
        super().__init__(mj_data, [int(base_joint_id), *joint_ids], actuator_ids, body)
        self._base_joint_id = int(base_joint_id)
        self._floating = floating

    @property
    def floating(self) -> bool:
        """True if the base may leave the ground."""
        return self._floating

    @property
    def noop_ctrl(self) -> Numbers:
        """The present controls."""
        return self.ctrl

    @property
    def pose(self) -> Numbers:
        """Pose (4, 4) of the base in the world: the position of its free joint."""
        at = self._joint_posadr[:7]
        return pos_quat_to_pose_mat(self.mj_data.qpos[at[:3]], self.mj_data.qpos[at[3:]])

    @pose.setter
    def pose(self, pose: ArrayLike) -> None:
        self.mj_data.qpos[self._joint_posadr[:7]] = np.concatenate(pose_mat_to_pos_quat(pose))

    def get_jacobian(self) -> Numbers:
        """Returns the engine's Jacobian (6, nv) at the body of the free joint."""
        return _body_jacobian(self, int(self.mj_model.jnt_bodyid[self._base_joint_id]))


class HoloJointsRobotBaseGroup(RobotBaseGroup, SimplyActuatedMoveGroup):
    """A base on slides along x and y and a hinge about z, each with a position servo."""

    def __init__(
        self,
        mj_data: mujoco.MjData,
        world_site_id: int,
        holo_base_site_id: int,
        joint_ids: Sequence[int],
        actuator_ids: Sequence[int],
        root_body_id: int,
    ) -> None:
        """Takes sites of the world and of the base, and the joints x, y, yaw in this order."""
        super().__init__(mj_data, joint_ids, actuator_ids, root_body_id)
        slide, hinge = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
        types = [int(self.mj_model.jnt_type[joint]) for joint in self._joint_ids]
        if types != [slide, slide, hinge] or self.n_actuators != 3:
            raise rc.ArgumentError(
                f"{type(self).__name__}: expected a slide x, a slide y and a hinge yaw with an "
                f"actuator each, got {self.n_joints} joints and {self.n_actuators} actuators"
            )
        self._world_site_id = int(world_site_id)
        self._holo_base_site_id = int(holo_base_site_id)

    @property
    def pose(self) -> Numbers:
        """Pose (4, 4) of the base in the world, from its three joints.

        Where the joints hang on a mocap body, as in scenes of robocell, they start at its pose.
        """
        x, y, yaw = self.joint_pos
        turned = [np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)]
        return self._start() @ pos_quat_to_pose_mat([x, y, 0], turned)

    @pose.setter
    def pose(self, pose: ArrayLike) -> None:
        matrix = relative_pose(pose, self._start())
        self.joint_pos = [matrix[0, 3], matrix[1, 3], np.arctan2(matrix[1, 0], matrix[0, 0])]

    @property
    def ctrl(self) -> Numbers:
        """Targets of x, y and yaw. A yaw that is set takes the shorter way from the present one."""
        return self.mj_data.ctrl[self._actuator_ids]

    @ctrl.setter
    def ctrl(self, ctrl: ArrayLike) -> None:
        target = self._numbers("ctrl", ctrl, 3).copy()
        present = self.joint_pos[2]
        target[2] = present + np.remainder(target[2] - present + np.pi, 2 * np.pi) - np.pi
        self.mj_data.ctrl[self._actuator_ids] = target

    @property
    def noop_ctrl(self) -> Numbers:
        """Targets that hold the base where its site is."""
        pose = relative_pose(site_pose(self.mj_data, self._holo_base_site_id), self._start())
        return np.array([pose[0, 3], pose[1, 3], np.arctan2(pose[1, 0], pose[0, 0])])

    def get_jacobian(self) -> Numbers:
        """Returns the engine's Jacobian (6, nv) at the base's site."""
        jacobian = np.zeros((6, self.mj_model.nv))
        mujoco.mj_jacSite(
            self.mj_model, self.mj_data, jacobian[:3], jacobian[3:], self._holo_base_site_id
        )
        return jacobian

    def _start(self) -> Numbers:
        """Returns the pose (4, 4) at which the joints are zero."""
        parent = int(self.mj_model.body_parentid[self.mj_model.jnt_bodyid[self._joint_ids[0]]])
        carrier = _mocap_carrier(self.mj_model, parent)
        if carrier is None:
            return np.eye(4)
        mocap = int(self.mj_model.body_mocapid[carrier[0]])
        pos, quat = self.mj_data.mocap_pos[mocap], self.mj_data.mocap_quat[mocap]
        return pos_quat_to_pose_mat(pos, quat) @ carrier[1]


class _JointlessBaseGroup(RobotBaseGroup):
    """A base without joints and actuators."""

    @property
    def noop_ctrl(self) -> Numbers:
        """No numbers: there is nothing to control."""
        return np.array([])

    def get_jacobian(self) -> Numbers:
        """Returns zeros (6, nv): no joint moves the base."""
        return np.zeros((6, self.mj_model.nv))


class MocapRobotBaseGroup(_JointlessBaseGroup):
    """A base that is a mocap body, or hangs fixed on one: it stands still and can be put anywhere.

    In scenes of robocell a mocap body carries the robot's own base body.
    """

    def __init__(self, mj_data: mujoco.MjData, robot_base_body_id: int) -> None:
        """Takes the id of the body, not the mocap id."""
        super().__init__(mj_data, [], [], int(robot_base_body_id))
        carrier = _mocap_carrier(mj_data.model, int(robot_base_body_id))
        if carrier is None:
            name = name_of(mj_data.model, "body", robot_base_body_id)
            raise rc.ArgumentError(
                f"{type(self).__name__}: body '{name}' is not a mocap body and hangs on none. Add "
                'it with mocap=True (<body mocap="true">), or use ImmobileRobotBaseGroup'
            )
        self._carrier, self._in_carrier = carrier
        self._robot_base_mocap_id = int(mj_data.model.body_mocapid[self._carrier])

    @property
    def pose(self) -> Numbers:
        """Pose (4, 4) of the base in the world. It is set at once; call mj_forward afterwards."""
        data, mocap = self.mj_data, self._robot_base_mocap_id
        return pos_quat_to_pose_mat(data.mocap_pos[mocap], data.mocap_quat[mocap]) @ (
            self._in_carrier
        )

    @pose.setter
    def pose(self, pose: ArrayLike) -> None:
        carrier = as_pose_mat(pose) @ np.linalg.inv(self._in_carrier)
        pos, quat = pose_mat_to_pos_quat(carrier)
        self.mj_data.mocap_pos[self._robot_base_mocap_id] = pos
        self.mj_data.mocap_quat[self._robot_base_mocap_id] = quat


class ImmobileRobotBaseGroup(_JointlessBaseGroup):
    """A base that stays where the model puts it."""

    def __init__(self, mj_data: mujoco.MjData, robot_base_body_id: int) -> None:
        """Takes the id of the body."""
        super().__init__(mj_data, [], [], int(robot_base_body_id))

    @property
    def pose(self) -> Numbers:
        """Pose (4, 4) of the base in the world. Setting it raises ArgumentError."""
        return body_pose(self.mj_data, self.root_body_id)

    @pose.setter
    def pose(self, pose: ArrayLike) -> NoReturn:
        raise rc.ArgumentError(
            f"{type(self).__name__}.pose cannot be set: the base is fixed in the model. A "
            "MocapRobotBaseGroup can be put anywhere"
        )


def _body_jacobian(group: MoveGroup, body: int) -> Numbers:
    jacobian = np.zeros((6, group.mj_model.nv))
    mujoco.mj_jacBody(group.mj_model, group.mj_data, jacobian[:3], jacobian[3:], body)
    return jacobian


def _mocap_carrier(model: mujoco.MjModel, body: int) -> tuple[int, Numbers] | None:
    """Returns the mocap body that carries a body, and the pose (4, 4) of the body in it."""
    inside = np.eye(4)
    while model.body_mocapid[body] < 0:
        if body == 0 or model.body_jntnum[body]:
            return None
        inside = pos_quat_to_pose_mat(model.body_pos[body], model.body_quat[body]) @ inside
        body = int(model.body_parentid[body])
    return body, inside
