"""What solvers of many poses have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import ArrayLike

__all__ = ["ParallelKinematics"]


class ParallelKinematics(ABC):
    """Kinematics of a batch. Arguments without a batch hold for all its elements.

    Poses are (B, 4, 4) or (4, 4), positions a list of dictionaries or one. A call without any
    batch returns a single result.
    """

    @abstractmethod
    def warmup_ik(self, batch_size: int) -> None:
        """Prepares for batches of this size."""

    @abstractmethod
    def fk(
        self,
        qpos_dicts: Mapping[str, ArrayLike] | Sequence[Mapping[str, ArrayLike]],
        base_poses: ArrayLike,
        rel_to_base: bool = False,
    ) -> Any:
        """Returns the poses of the leaf frames."""

    @abstractmethod
    def ik(
        self,
        move_group_id: str,
        poses: ArrayLike,
        unlocked_move_group_ids: Sequence[str] | None,
        q0_dicts: Mapping[str, ArrayLike] | Sequence[Mapping[str, ArrayLike]],
        base_poses: ArrayLike,
        rel_to_base: bool = False,
    ) -> Any:
        """Returns positions that put a leaf frame at the poses; None where there are none."""
