"""The controller of changes of joint positions."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robocell.compat.molmo_spaces.controllers.abstract import AbstractPositionController

__all__ = ["JointRelPosController"]

SMALLEST = 1e-6  # norm of a change, rad or m


class JointRelPosController(AbstractPositionController):
    """Moves by a change from where the group is when the target is set."""

    def set_target(self, target: ArrayLike) -> None:
        """Sets the change (n_actuators,). One below 1e-6 holds the group, without drift."""
        change = self._require(target)
        if np.linalg.norm(change) >= SMALLEST:
            self._take(self.robot_move_group.noop_ctrl + change)
        elif not self.stationary:
            self.set_to_stationary()
