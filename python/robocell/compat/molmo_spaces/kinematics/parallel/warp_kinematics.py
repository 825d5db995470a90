"""Inverse kinematics of many poses: robocell's batched solver, on the processor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import robocell as rc
from robocell.compat.molmo_spaces.kinematics._solver import RobotAlone
from robocell.compat.molmo_spaces.kinematics.parallel.parallel_kinematics import (
    ParallelKinematics,
)
from robocell.compat.molmo_spaces.utils.pose import inverse_pose

__all__ = ["SimpleWarpKinematics"]

Numbers = NDArray[np.float64]
Positions = Mapping[str, ArrayLike] | Sequence[Mapping[str, ArrayLike]]


class SimpleWarpKinematics(ParallelKinematics):
    """Kinematics of a batch, in double precision. Solutions are always within the limits.

    An element gets the same answer in any batch, and an unreachable one does not slow the others.
    """

    def __init__(self, robot_config: Any, device: str = "cpu") -> None:
        """Takes the robot's configuration. `device` has no effect: the solver is on the CPU."""
        del device
        self._robot = RobotAlone(robot_config)

    def warmup_ik(self, batch_size: int) -> None:
        """Compiles the robot's model; there is nothing to prepare for a batch size."""
        del batch_size
        _ = self._robot.model

    def fk(
        self, qpos_dicts: Positions, base_poses: ArrayLike, rel_to_base: bool = False
    ) -> dict[str, Numbers] | list[dict[str, Numbers]]:
        """Returns the poses (4, 4) of the leaf frames of all groups, for each element."""
        all_q, (bases,), is_single = _batch(qpos_dicts, base_poses=base_poses)
        view = self._robot.view
        results = []
        for q, base in zip(all_q, bases, strict=True):
            self._robot.require_positions(q)
            self._robot.put(q, base)
            to_frame = inverse_pose(view.base.pose) if rel_to_base else np.eye(4)
            results.append(
                {
                    name: to_frame @ view.get_move_group(name).leaf_frame_to_world
                    for name in view.move_group_ids()
                }
            )
        return results[0] if is_single else results

    def ik(
        self,
        move_group_id: str,
        poses: ArrayLike,
        unlocked_move_group_ids: Sequence[str] | None,
        q0_dicts: Positions,
        base_poses: ArrayLike,
        rel_to_base: bool = False,
        converge_eps: float = 1e-3,
        success_eps: float = 5e-4,
        max_iter: int = 50,
        damping: float = 1e-12,
        dt: float = 1.0,
    ) -> dict[str, Numbers] | list[dict[str, Numbers] | None] | None:
        """Finds positions of all groups that put a group's leaf frame at poses (B, 4, 4).

        The arguments are those of `MlSpacesKinematics.ik`, each for one element or for all;
        `success_eps` is the largest norm of the error, m and rad together. `converge_eps`,
        `max_iter`, `damping` and `dt` have no effect.

        Returns a list with positions, or None without a solution, for each element.
        """
        del converge_eps, max_iter, damping, dt
        all_q, (targets, bases), is_single = _batch(q0_dicts, poses=poses, base_poses=base_poses)
        results = self._robot.solve(
            move_group_id, targets, unlocked_move_group_ids, all_q, bases, rel_to_base, success_eps
        )
        return results[0] if is_single else results


def _batch(
    positions: Positions, **poses: ArrayLike
) -> tuple[list[Mapping[str, ArrayLike]], list[Numbers], bool]:
    """Returns positions and poses of each element, and whether no argument had a batch."""
    sizes: dict[str, int] = {}
    if not isinstance(positions, Mapping):
        sizes["positions"] = len(positions)
    arrays = {}
    for name, given in poses.items():
        array = np.asarray(given, dtype=np.float64)
        if array.ndim not in (2, 3) or array.shape[-2:] != (4, 4):
            raise rc.ArgumentError(
                f"{name}: expected matrices of shape (4, 4) or (B, 4, 4), got {array.shape}"
            )
        if array.ndim == 3:
            sizes[name] = len(array)
        arrays[name] = array
    if len(set(sizes.values())) > 1:
        said = ", ".join(f"{size} {name}" for name, size in sizes.items())
        raise rc.ArgumentError(f"batches of different sizes: {said}")
    size = next(iter(sizes.values()), 1)
    every = [positions] * size if isinstance(positions, Mapping) else list(positions)
    return (
        every,
        [np.broadcast_to(array, (size, 4, 4)) for array in arrays.values()],
        not sizes,
    )
