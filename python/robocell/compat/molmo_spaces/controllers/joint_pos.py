"""The controller of joint positions."""

from __future__ import annotations

from numpy.typing import ArrayLike

from robocell.compat.molmo_spaces.controllers.abstract import AbstractPositionController

__all__ = ["JointPosController"]


class JointPosController(AbstractPositionController):
    """Passes its target on to position servos, within the limits of their controls."""

    def set_target(self, target: ArrayLike) -> None:
        """Sets the controls (n_actuators,): joint positions of an arm, raw values of a gripper."""
        self._take(self._require(target))
