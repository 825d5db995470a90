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
from robocell.compat.molmo_spaces.robots.robot_views._move_groups import dimensions_of
from robocell.compat.molmo_spaces.robots.robot_views.abstract import (
    FreeJointRobotBaseGroup,
    ImmobileRobotBaseGroup,
    MJCFFrameMixin,
    MoveGroup,
    RobotView,
)
from robocell.compat.molmo_spaces.utils.pose import (
    inverse_pose,
    pos_quat_to_pose_mat,
    pose_mat_to_7d,
)
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
        """Puts the robot at a base pose and joint positions, which are those of the base too."""
        base = self.view.base
        if not isinstance(base, ImmobileRobotBaseGroup):
            base.pose = base_pose
        for name, positions in qpos.items():
            group = self.view.get_move_group(name)
            group.joint_pos = positions
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)

    def chain(self, mg_id: str) -> GroupChain:
        """Returns the chain to the leaf frame of a group."""
        if mg_id not in self._chains:
            require_among([mg_id], self.view.move_group_ids(), f"robot '{self.config.name}'")
            self._chains[mg_id] = GroupChain(self, mg_id)
        return self._chains[mg_id]

    def base_poses(self, all_q: Sequence[Mapping[str, ArrayLike]], given: Numbers) -> Numbers:
        """Returns the poses (B, 4, 4) of the base: given, or the positions of its free joint."""
        base = self.view.base
        if not isinstance(base, FreeJointRobotBaseGroup):
            return given
        numbers = [np.asarray(q[base.name], dtype=np.float64) for q in all_q]
        return np.array([pos_quat_to_pose_mat(each[:3], each[3:7]) for each in numbers])

    def solve(
        self,
        mg_id: str,
        targets: Numbers,
        unlocked: Sequence[str] | None,
        all_q: Sequence[Mapping[str, ArrayLike]],
        base_poses: Numbers,
        rel_to_base: bool,
        eps: float,
    ) -> list[QposDict | None]:
        """Solves for each target (B, 4, 4) from its own positions and base pose (B, 4, 4)."""
        for q in {id(each): each for each in all_q}.values():
            self.require_positions(q)
        chain, bases = self.chain(mg_id), self.base_poses(all_q, base_poses)
        locked = chain.locked_joints(unlocked)
        if not chain.has_joints:
            return chain.bases_for(targets, unlocked, all_q, bases, rel_to_base)
        # Largest norms, m and rad, whose root of squares is `eps`.
        options = {"tolerance": eps / np.sqrt(2), "locked_joints": locked}
        seeds = np.array([chain.start(q) for q in all_q])
        in_base = chain.in_base(targets, bases, rel_to_base)
        if len(targets) == 1:
            one = chain.chain.ik(in_base[0], seed=seeds[0], **options)
            return [chain.positions(one.q, all_q[0]) if one.success else None]
        found = chain.chain.ik_batch(in_base, seeds=seeds, **options)
        return [
            chain.positions(q, q0) if success else None
            for q, q0, success in zip(found.q, all_q, found.success, strict=True)
        ]


class GroupChain:
    """The joints from the base, or from the world if the base drives, to a group's leaf frame.

    Attributes:
        chain: robocell's chain.
        from_world: True if the joints of the base are in the chain.
        has_joints: True if there are joints; else the leaf frame is fixed in the base.
    """

    def __init__(self, alone: RobotAlone, mg_id: str) -> None:
        """Raises ArgumentError for a group whose leaf frame is no site or body of the model."""
        self.alone, self.mg_id = alone, mg_id
        group: Any = alone.view.get_move_group(mg_id)
        if not isinstance(group, MJCFFrameMixin):
            raise rc.ArgumentError(
                f"inverse kinematics of move group '{mg_id}': {type(group).__name__} does not say "
                "which site or body it moves; make MJCFFrameMixin its first base class"
            )
        model, base = alone.model, alone.view.base
        self.from_world = base.n_joints > 0 and not isinstance(base, FreeJointRobotBaseGroup)
        start = "world" if self.from_world else name_of(model, "body", base.root_body_id)
        tip = name_of(model, group.leaf_frame_type, group.leaf_frame_id)
        self.has_joints = self.from_world or self._moves_in_base(group)
        if not self.has_joints:
            self.leaf_in_base: Numbers = alone.view.get_move_group(mg_id).leaf_frame_to_robot
            return
        self.chain = Chain.from_model(model, start, **{f"tip_{group.leaf_frame_type}": tip})
        # Where the values of each joint of the chain are: in which group, and at which index.
        places = {}
        for name in alone.view.move_group_ids():
            of_group: MoveGroup = alone.view.get_move_group(name)
            at = 0
            for joint in of_group._joint_ids:
                places[name_of(model, "joint", joint)] = (name, at)
                at += dimensions_of(model, joint)[0]
        self.places = [places.get(name) for name in self.chain.joint_names]
        self.link_places = [places.get(name) for name in self.chain.link_joint_names]

    def _moves_in_base(self, group: Any) -> bool:
        """Returns True if there is a joint between the base and the leaf frame."""
        model, base = self.alone.model, self.alone.view.base.root_body_id
        body = int(group.leaf_frame_id)
        if group.leaf_frame_type == "site":
            body = int(model.site_bodyid[body])
        while body not in (0, base):
            if model.body_jntnum[body]:
                return True
            body = int(model.body_parentid[body])
        return False

    def bases_for(
        self,
        targets: Numbers,
        unlocked: Sequence[str] | None,
        all_q: Sequence[Mapping[str, ArrayLike]],
        bases: Numbers,
        rel_to_base: bool,
    ) -> list[QposDict | None]:
        """Returns positions with the poses of a free base that put the leaf frame at targets."""
        base = self.alone.view.base
        if not isinstance(base, FreeJointRobotBaseGroup):
            raise rc.ArgumentError(
                f"inverse kinematics of move group '{self.mg_id}': no joint moves its leaf frame. "
                f"Put the base there: base.pose = target @ inv(leaf_frame_to_robot)"
            )
        if unlocked is not None and base.name not in unlocked:
            return [None] * len(targets)
        found: list[QposDict | None] = []
        for target, q, pose in zip(targets, all_q, bases, strict=True):
            in_world = pose @ target if rel_to_base else target
            result = {name: np.array(each, dtype=np.float64) for name, each in q.items()}
            result[base.name][:7] = pose_mat_to_7d(in_world @ inverse_pose(self.leaf_in_base))
            found.append(result)
        return found

    def locked_joints(self, unlocked: Sequence[str] | None) -> list[str]:
        """Returns the joints that do not move: those of other groups, and of none."""
        ids = self.alone.view.move_group_ids()
        if unlocked is not None:
            require_among(unlocked, ids, f"robot '{self.alone.config.name}': unlocked group")
        if not self.has_joints:
            return []
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
