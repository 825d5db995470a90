"""What both solvers share: the robot alone in a model, and robocell's chains of its groups."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

import robocell as rc
from robocell.compat.molmo_spaces._assembly import compile_alone
from robocell.compat.molmo_spaces._elements import name_of, require_among
from robocell.compat.molmo_spaces.robots.robot_views.abstract import (
    FreeJointRobotBaseGroup,
    ImmobileRobotBaseGroup,
    MJCFFrameMixin,
    MoveGroup,
    RobotView,
    _dimensions,
)
from robocell.compat.molmo_spaces.utils.pose import inverse_pose
from robocell.kinematics import Chain

Numbers = NDArray[np.float64]
QposDict = dict[str, Numbers]


class RobotAlone:
    """A robot in a model of its own. It is compiled when it is first used.

    Attributes:
        config: The robot's configuration.
    """

    def __init__(self, config: Any) -> None:
        """Keeps the configuration."""
        self.config = config
        self._chains: dict[str, GroupChain] = {}

    @cached_property
    def _compiled(self) -> tuple[mujoco.MjModel, mujoco.MjData, RobotView]:
        return compile_alone(self.config, self.config.robot_namespace)

    @property
    def model(self) -> mujoco.MjModel:
        """The model."""
        return self._compiled[0]

    @property
    def data(self) -> mujoco.MjData:
        """The data of this solver."""
        return self._compiled[1]

    @property
    def view(self) -> RobotView:
        """The view of `data`."""
        return self._compiled[2]

    def require_positions(self, q0: Mapping[str, ArrayLike]) -> None:
        """Raises ArgumentError unless there are positions of every group, in the right number."""
        ids = self.view.move_group_ids()
        if set(q0) != set(ids):
            missing, unknown = set(ids) - set(q0), set(q0) - set(ids)
            said = [f"missing: {', '.join(sorted(missing))}"] if missing else []
            said += [f"unknown: {', '.join(sorted(unknown))}"] if unknown else []
            raise rc.ArgumentError(
                f"joint positions of robot '{self.config.name}' need a key for each move group "
                f"({', '.join(ids)}; [] for a group without joints). {'; '.join(said)}"
            )
        for name in ids:
            group: MoveGroup = self.view.get_move_group(name)
            group._numbers("joint_pos", q0[name], group.pos_dim)

    def put(self, qpos: Mapping[str, ArrayLike], base_pose: ArrayLike) -> None:
        """Puts the robot at a base pose and joint positions."""
        base = self.view.base
        if not isinstance(base, ImmobileRobotBaseGroup):
            base.pose = base_pose
        for name, positions in qpos.items():
            group = self.view.get_move_group(name)
            if group is not base or group.is_mobile:
                group.joint_pos = positions
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)

    def chain(self, mg_id: str) -> GroupChain:
        """Returns the chain to the leaf frame of a group."""
        if mg_id not in self._chains:
            require_among([mg_id], self.view.move_group_ids(), f"robot '{self.config.name}'")
            self._chains[mg_id] = GroupChain(self, mg_id)
        return self._chains[mg_id]


class GroupChain:
    """The joints from the base, or from the world if the base drives, to a group's leaf frame.

    Attributes:
        chain: robocell's chain.
        from_world: True if the joints of the base are in the chain.
    """

    def __init__(self, alone: RobotAlone, mg_id: str) -> None:
        """Raises ArgumentError for a group whose leaf frame is no site or body of the model."""
        self.alone, self.mg_id = alone, mg_id
        group = alone.view.get_move_group(mg_id)
        if not isinstance(group, MJCFFrameMixin):
            raise rc.ArgumentError(
                f"inverse kinematics of move group '{mg_id}': {type(group).__name__} does not say "
                "which site or body it moves; make MJCFFrameMixin its first base class"
            )
        model, base = alone.model, alone.view.base
        self.from_world = base.n_joints > 0 and not isinstance(base, FreeJointRobotBaseGroup)
        start = "world" if self.from_world else name_of(model, "body", base.root_body_id)
        tip = name_of(model, group.leaf_frame_type, group.leaf_frame_id)
        self.chain = Chain.from_model(model, start, **{f"tip_{group.leaf_frame_type}": tip})
        # Where the values of each joint of the chain are: in which group, and at which index.
        places = {}
        for name in alone.view.move_group_ids():
            of_group: MoveGroup = alone.view.get_move_group(name)
            at = 0
            for joint in of_group._joint_ids:
                places[name_of(model, "joint", joint)] = (name, at)
                at += _dimensions(model, joint)[0]
        self.places = [places.get(name) for name in self.chain.joint_names]
        self.link_places = [places.get(name) for name in self.chain.link_joint_names]

    def locked_joints(self, unlocked: Sequence[str] | None) -> list[str]:
        """Returns the joints that do not move: those of other groups, and of none."""
        ids = self.alone.view.move_group_ids()
        if unlocked is not None:
            require_among(unlocked, ids, f"robot '{self.alone.config.name}': unlocked group")
        free = ids if unlocked is None else unlocked
        return [
            name
            for name, place in zip(self.chain.joint_names, self.places, strict=True)
            if place is None or place[0] not in free
        ]

    def start(self, q0: Mapping[str, ArrayLike]) -> Numbers:
        """Returns the joint values (n,) of positions of all groups."""
        q = np.empty(self.chain.n_joints)
        for i, (name, place) in enumerate(zip(self.chain.joint_names, self.places, strict=True)):
            if place is None:
                q[i] = self.alone.model.joint(name).qpos0[0]
            else:
                q[i] = np.asarray(q0[place[0]], dtype=np.float64)[place[1]]
        return q

    def positions(self, q: Numbers, q0: Mapping[str, ArrayLike]) -> QposDict:
        """Returns positions of all groups: those of the chain from q (n,), the others from q0."""
        result = {name: np.array(each, dtype=np.float64) for name, each in q0.items()}
        for value, place in zip(self.chain.expand(q), self.link_places, strict=True):
            if place is not None:
                result[place[0]][place[1]] = value
        return result

    def in_base(self, poses: Numbers, base_poses: Numbers, rel_to_base: bool) -> Numbers:
        """Returns targets (..., 4, 4) in the frame that the chain starts at."""
        if self.from_world:
            return base_poses @ poses if rel_to_base else poses
        return poses if rel_to_base else inverse_pose(base_poses) @ poses


def combined_tolerance(eps: float) -> float:
    """Returns the bound on both norms, m and rad, whose root of squares is `eps`."""
    return float(eps) / np.sqrt(2)
