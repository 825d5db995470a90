"""Move groups: joints and actuators of a robot, with root and leaf frames."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Literal

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

import robocell as rc
from robocell.compat.molmo_spaces.utils.mj_model_and_data_utils import body_pose, site_pose
from robocell.compat.molmo_spaces.utils.pose import relative_pose

Numbers = NDArray[np.float64]
# Numbers of a joint's position and velocity, by its type.
_DIMENSIONS = {int(mujoco.mjtJoint.mjJNT_FREE): (7, 6), int(mujoco.mjtJoint.mjJNT_BALL): (4, 3)}


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
            nq, nv = dimensions_of(self.mj_model, joint)
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
            nq, _ = dimensions_of(self.mj_model, joint)
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


def dimensions_of(model: mujoco.MjModel, joint: int) -> tuple[int, int]:
    """Returns how many positions and velocities a joint has."""
    return _DIMENSIONS.get(int(model.jnt_type[joint]), (1, 1))


def _ids(values: Sequence[int], count: int, what: str) -> list[int]:
    ids = [int(value) for value in values]
    for value in ids:
        if not 0 <= value < count:
            raise rc.ArgumentError(f"{what}: {value} is not an id; the model has 0 to {count - 1}")
    return ids
