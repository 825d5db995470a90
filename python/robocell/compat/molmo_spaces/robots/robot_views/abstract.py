"""Move groups and the view of a robot: names for parts of a `mujoco.MjData`.

A group lists joints and actuators of a model by id. It reads and writes their values in place, so
several views of one MjData always agree. Poses are 4x4 matrices in the world unless the name says
otherwise; after writing positions, call `mujoco.mj_forward` before reading poses.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, Literal, NoReturn, TypeAlias

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

import robocell as rc
from robocell.compat.molmo_spaces._elements import look_up, name_of
from robocell.compat.molmo_spaces.utils.mj_model_and_data_utils import body_pose, site_pose
from robocell.compat.molmo_spaces.utils.pose import (
    as_pose_mat,
    pos_quat_to_pose_mat,
    pose_mat_to_pos_quat,
    relative_pose,
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
# Numbers of a joint's position and velocity, by its type.
_DIMENSIONS = {int(mujoco.mjtJoint.mjJNT_FREE): (7, 6), int(mujoco.mjtJoint.mjJNT_BALL): (4, 3)}
# Velocities of a free joint that leave the ground: z, and rotations about x and y.
_OFF_THE_GROUND = [2, 3, 4]


class MoveGroup(ABC):
    """Joints and actuators that move a leaf frame relative to a root frame.

    Subclasses define `noop_ctrl`, `leaf_frame_to_world`, `root_frame_to_world` and `get_jacobian`.

    Attributes:
        mj_model: The model.
        mj_data: The data that the group reads and writes.
    """

    def __init__(
        self,
        mj_data: mujoco.MjData,
        joint_ids: Sequence[int],
        actuator_ids: Sequence[int],
        root_body_id: int,
        robot_base_group: RobotBaseGroup | None = None,
    ) -> None:
        """Takes ids of the model; a group without `robot_base_group` is itself the base."""
        self.mj_model: mujoco.MjModel = mj_data.model
        self.mj_data = mj_data
        self._joint_ids = _ids(joint_ids, self.mj_model.njnt, f"{type(self).__name__}: joint_ids")
        self._actuator_ids = _ids(
            actuator_ids, self.mj_model.nu, f"{type(self).__name__}: actuator_ids"
        )
        self._root_body_id = int(root_body_id)
        self._robot_base_group = robot_base_group
        self._name: str | None = None
        self._joint_posadr: list[int] = []
        self._joint_veladr: list[int] = []
        for joint in self._joint_ids:
            nq, nv = _dimensions(self.mj_model, joint)
            q, v = int(self.mj_model.jnt_qposadr[joint]), int(self.mj_model.jnt_dofadr[joint])
            self._joint_posadr += range(q, q + nq)
            self._joint_veladr += range(v, v + nv)

    @property
    def name(self) -> str:
        """The id of the group in its robot view. Raises Error before it is in one."""
        if self._name is None:
            raise rc.Error(f"this {type(self).__name__} has no name: a RobotView gives it one")
        return self._name

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return len(self._joint_ids)

    @property
    def pos_dim(self) -> int:
        """Number of joint positions: seven of a free joint, four of a ball joint."""
        return len(self._joint_posadr)

    @property
    def vel_dim(self) -> int:
        """Number of joint velocities: six of a free joint, three of a ball joint."""
        return len(self._joint_veladr)

    @property
    def n_actuators(self) -> int:
        """Number of actuators."""
        return len(self._actuator_ids)

    @property
    def joint_pos(self) -> Numbers:
        """Joint positions (pos_dim,), rad or m; a copy. Setting them writes into the data."""
        return self.mj_data.qpos[self._joint_posadr]

    @joint_pos.setter
    def joint_pos(self, joint_pos: ArrayLike) -> None:
        self.mj_data.qpos[self._joint_posadr] = self._numbers("joint_pos", joint_pos, self.pos_dim)

    @property
    def joint_vel(self) -> Numbers:
        """Joint velocities (vel_dim,), rad/s or m/s; a copy. Setting them writes into the data."""
        return self.mj_data.qvel[self._joint_veladr]

    @joint_vel.setter
    def joint_vel(self, joint_vel: ArrayLike) -> None:
        self.mj_data.qvel[self._joint_veladr] = self._numbers("joint_vel", joint_vel, self.vel_dim)

    @property
    def ctrl(self) -> Numbers:
        """Controls (n_actuators,); a copy. Setting them writes into the data."""
        return self.mj_data.ctrl[self._actuator_ids]

    @ctrl.setter
    def ctrl(self, ctrl: ArrayLike) -> None:
        self.mj_data.ctrl[self._actuator_ids] = self._numbers("ctrl", ctrl, self.n_actuators)

    @property
    def joint_pos_limits(self) -> Numbers:
        """Limits (pos_dim, 2); infinite without limits, and of free and ball joints."""
        limits = np.full((self.pos_dim, 2), [-np.inf, np.inf])
        at = 0
        for joint in self._joint_ids:
            nq, _ = _dimensions(self.mj_model, joint)
            if nq == 1 and self.mj_model.jnt_limited[joint]:
                limits[at] = self.mj_model.jnt_range[joint]
            at += nq
        return limits

    @property
    def ctrl_limits(self) -> Numbers:
        """Limits of the controls (n_actuators, 2); infinite without limits."""
        limits = self.mj_model.actuator_ctrlrange[self._actuator_ids].reshape(-1, 2).copy()
        limits[self.mj_model.actuator_ctrllimited[self._actuator_ids] == 0] = [-np.inf, np.inf]
        return limits

    @property
    @abstractmethod
    def noop_ctrl(self) -> Numbers:
        """Controls (n_actuators,) that hold the group where it is."""

    def integrate_joint_vel(self, joint_pos: ArrayLike, joint_vel: ArrayLike) -> Numbers:
        """Returns the positions (pos_dim,) after a unit of time at these velocities (vel_dim,).

        It is the engine's own integration: positions of a free joint move in the axes of the world
        and its rotation in those of the body. Nothing in the data changes.
        """
        qpos, qvel = self.mj_model.qpos0.copy(), np.zeros(self.mj_model.nv)
        qpos[self._joint_posadr] = self._numbers("joint_pos", joint_pos, self.pos_dim)
        qvel[self._joint_veladr] = self._numbers("joint_vel", joint_vel, self.vel_dim)
        mujoco.mj_integratePos(self.mj_model, qpos, qvel, 1)
        return qpos[self._joint_posadr]

    @property
    def root_body_id(self) -> int:
        """Id of the group's root body."""
        return self._root_body_id

    @property
    @abstractmethod
    def leaf_frame_to_world(self) -> Numbers:
        """Pose (4, 4) of the frame that the group moves."""

    @property
    @abstractmethod
    def root_frame_to_world(self) -> Numbers:
        """Pose (4, 4) of the frame that the group starts at."""

    @property
    def leaf_frame_to_root(self) -> Numbers:
        """Pose (4, 4) of the leaf frame in the root frame."""
        return relative_pose(self.leaf_frame_to_world, self.root_frame_to_world)

    @property
    def root_frame_to_robot(self) -> Numbers:
        """Pose (4, 4) of the root frame in the frame of the robot's base."""
        if self._robot_base_group is None:
            return np.eye(4)
        return relative_pose(self.root_frame_to_world, self._robot_base_group.pose)

    @property
    def leaf_frame_to_robot(self) -> Numbers:
        """Pose (4, 4) of the leaf frame in the frame of the robot's base."""
        if self._robot_base_group is None:
            return self.leaf_frame_to_root
        return relative_pose(self.leaf_frame_to_world, self._robot_base_group.pose)

    @abstractmethod
    def get_jacobian(self) -> Numbers:
        """Returns the Jacobian (6, nv) of the leaf frame in world axes, linear rows first."""

    def _numbers(self, what: str, values: ArrayLike, count: int) -> Numbers:
        numbers = np.asarray(values, dtype=np.float64)
        if numbers.shape != (count,):
            raise rc.ArgumentError(
                f"{self._name or type(self).__name__}.{what}: expected {count} numbers, got an "
                f"array of shape {numbers.shape}"
            )
        return numbers


class MJCFFrameMixin(ABC):
    """The leaf frame is a site or a body of the model. It stands before the group among the bases.

    Subclasses define `leaf_frame_id` and `leaf_frame_type`.
    """

    mj_model: mujoco.MjModel
    mj_data: mujoco.MjData

    @property
    @abstractmethod
    def leaf_frame_id(self) -> int:
        """Id of the site or body."""

    @property
    @abstractmethod
    def leaf_frame_type(self) -> Literal["site", "body"]:
        """What the id names: "site" or "body"."""

    @property
    def leaf_frame_to_world(self) -> Numbers:
        """Pose (4, 4) of the site or body in the world."""
        pose = site_pose if self._kind() == "site" else body_pose
        return pose(self.mj_data, self.leaf_frame_id)

    def get_jacobian(self) -> Numbers:
        """Returns the engine's Jacobian (6, nv) at the site or body, linear rows first."""
        jacobian = np.zeros((6, self.mj_model.nv))
        of_frame = mujoco.mj_jacSite if self._kind() == "site" else mujoco.mj_jacBody
        of_frame(self.mj_model, self.mj_data, jacobian[:3], jacobian[3:], self.leaf_frame_id)
        return jacobian

    def _kind(self) -> str:
        kind = self.leaf_frame_type
        if kind not in ("site", "body"):
            raise rc.ArgumentError(
                f"{type(self).__name__}.leaf_frame_type: expected 'site' or 'body', got {kind!r}"
            )
        return kind


class SimplyActuatedMoveGroup(MoveGroup):
    """One position servo for each hinge or slide, in the same order."""

    @property
    def joint_ids(self) -> list[int]:
        """Ids of the joints."""
        return self._joint_ids

    @property
    def actuator_ids(self) -> list[int]:
        """Ids of the actuators."""
        return self._actuator_ids

    @property
    def joint_posadr(self) -> list[int]:
        """Indices of the joints in qpos."""
        return self._joint_posadr

    @property
    def joint_veladr(self) -> list[int]:
        """Indices of the joints in qvel."""
        return self._joint_veladr

    @property
    def noop_ctrl(self) -> Numbers:
        """The present joint positions, which the servos then hold."""
        return self.joint_pos.copy()


class GripperGroup(MoveGroup):
    """A gripper that is open or closed.

    Subclasses define `set_gripper_ctrl_open`, `inter_finger_dist` and `inter_finger_dist_range`.
    """

    @abstractmethod
    def set_gripper_ctrl_open(self, open: bool) -> None:
        """Sets the controls that open the gripper, or close it."""

    @property
    @abstractmethod
    def inter_finger_dist_range(self) -> tuple[float, float]:
        """Smallest and largest distance of the fingers, m."""

    @property
    @abstractmethod
    def inter_finger_dist(self) -> float:
        """Present distance of the fingers, m."""

    @property
    def is_open(self) -> bool:
        """True if the fingers are farther apart than in the middle of their range."""
        return bool(self.inter_finger_dist > np.mean(self.inter_finger_dist_range))

    @property
    def noop_ctrl(self) -> Numbers:
        """Controls that open an open gripper and close any other; the data stays as it is."""
        before = self.ctrl.copy()
        self.set_gripper_ctrl_open(self.is_open)
        held = self.ctrl.copy()
        self.ctrl = before
        return held


class RobotBaseGroup(MoveGroup):
    """The base of a robot, whose pose is that of the robot. Subclasses define `pose`."""

    def __init__(
        self,
        mj_data: mujoco.MjData,
        joint_ids: Sequence[int],
        actuator_ids: Sequence[int],
        root_body_id: int,
    ) -> None:
        """Takes ids of the model."""
        super().__init__(mj_data, joint_ids, actuator_ids, root_body_id)

    @property
    def is_mobile(self) -> bool:
        """True if the base has actuators."""
        return self.n_actuators > 0

    @property
    @abstractmethod
    def pose(self) -> Numbers:
        """Pose (4, 4) of the base in the world."""

    @pose.setter
    @abstractmethod
    def pose(self, pose: ArrayLike) -> None: ...

    @property
    def leaf_frame_to_world(self) -> Numbers:
        """The pose of the base."""
        return self.pose

    @property
    def root_frame_to_world(self) -> Numbers:
        """The pose of the base."""
        return self.pose


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


def _dimensions(model: mujoco.MjModel, joint: int) -> tuple[int, int]:
    """Returns how many positions and velocities a joint has."""
    return _DIMENSIONS.get(int(model.jnt_type[joint]), (1, 1))


def _ids(values: Sequence[int], count: int, what: str) -> list[int]:
    ids = [int(value) for value in values]
    for value in ids:
        if not 0 <= value < count:
            raise rc.ArgumentError(f"{what}: {value} is not an id; the model has 0 to {count - 1}")
    return ids


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
