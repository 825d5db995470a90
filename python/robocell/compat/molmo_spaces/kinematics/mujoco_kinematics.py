"""Forward and inverse kinematics of a robot, one pose at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import robocell as rc
from robocell.compat.molmo_spaces.kinematics._solver import RobotAlone
from robocell.compat.molmo_spaces.utils.pose import as_pose_mat, inverse_pose

__all__ = ["MlSpacesKinematics"]

Numbers = NDArray[np.float64]


class MlSpacesKinematics:
    """Kinematics of a robot in a model of its own, which is compiled at the first call.

    Positions of all groups are dictionaries {group: joint positions}, with an empty list for a
    group without joints.
    """

    def __init__(self, robot_config: Any) -> None:
        """Takes the robot's configuration."""
        self._robot = RobotAlone(robot_config)

    def fk(
        self, qpos_dict: Mapping[str, ArrayLike], base_pose: ArrayLike, rel_to_base: bool = False
    ) -> dict[str, Numbers]:
        """Returns the poses (4, 4) of the leaf frames of all groups, in the world or the base."""
        self._robot.require_positions(qpos_dict)
        self._robot.put(qpos_dict, as_pose_mat(base_pose, "base_pose"))
        view = self._robot.view
        to_frame = inverse_pose(view.base.pose) if rel_to_base else np.eye(4)
        return {
            name: to_frame @ view.get_move_group(name).leaf_frame_to_world
            for name in view.move_group_ids()
        }

    def ik(
        self,
        move_group_id: str,
        pose: ArrayLike,
        unlocked_move_group_ids: Sequence[str] | None,
        q0: Mapping[str, ArrayLike],
        base_pose: ArrayLike,
        rel_to_base: bool = False,
        eps: float = 1e-4,
        max_iter: int = 1000,
        damping: float = 1e-12,
        dt: float = 1.0,
    ) -> dict[str, Numbers] | None:
        """Finds positions of all groups that put a group's leaf frame at a pose (4, 4).

        Args:
            move_group_id: The group whose leaf frame moves.
            pose: The target, in the world or, with `rel_to_base`, in the base.
            unlocked_move_group_ids: Groups whose joints may move. None: all.
            q0: Positions of all groups, at which the search begins.
            base_pose: Pose (4, 4) of the base in the world.
            rel_to_base: The target is in the frame of the base.
            eps: Largest norm of the error, m and rad together.
            max_iter: Without effect: robocell's solver sets its own limits, and starts again.
            damping: Without effect.
            dt: Without effect.

        Returns positions within the limits, or None without a solution.
        """
        del max_iter, damping, dt
        (found,) = self._robot.solve(
            move_group_id,
            as_pose_mat(pose)[np.newaxis],
            unlocked_move_group_ids,
            [q0],
            as_pose_mat(base_pose, "base_pose")[np.newaxis],
            rel_to_base,
            eps,
        )
        return found

    def twist_to_joint_vel(
        self,
        move_group_id: str,
        twist: ArrayLike,
        unlocked_move_group_ids: Sequence[str] | None,
        q0: Mapping[str, ArrayLike],
        base_pose: ArrayLike,
        twist_frame: str = "world",
        damping: float = 1e-12,
    ) -> dict[str, Numbers]:
        """Returns joint velocities of the unlocked groups that move a leaf frame with a twist (6,).

        The twist is linear, then angular, in the axes of the "world", the "base" or the "leaf".
        It is the least-squares solution with this damping.
        """
        self._robot.require_positions(q0)
        self._robot.put(q0, as_pose_mat(base_pose, "base_pose"))
        view = self._robot.view
        group = view.get_move_group(move_group_id)
        axes = {
            "world": np.eye(4),
            "base": view.base.pose,
            "leaf": group.leaf_frame_to_world,
        }
        if twist_frame not in axes:
            raise rc.ArgumentError(
                f"twist_frame: expected 'world', 'base' or 'leaf', got {twist_frame!r}"
            )
        turn = axes[twist_frame][:3, :3]
        wanted = np.asarray(twist, dtype=np.float64)
        in_world = np.concatenate([turn @ wanted[:3], turn @ wanted[3:]])
        names = (
            view.move_group_ids() if unlocked_move_group_ids is None else (unlocked_move_group_ids)
        )
        jacobian = view.get_jacobian(move_group_id, names)
        square = jacobian @ jacobian.T + damping * np.eye(6)
        speeds = jacobian.T @ np.linalg.lstsq(square, in_world, rcond=None)[0]
        counts = np.cumsum([view.get_move_group(name).vel_dim for name in names])[:-1]
        return dict(zip(names, np.split(speeds, counts), strict=True))
