"""What controllers have in common: a target of a move group in, controls of its actuators out."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike, NDArray

import robocell as rc
from robocell.compat.molmo_spaces.robots.robot_views.abstract import MoveGroup

__all__ = ["AbstractPositionController", "Controller"]

Numbers = NDArray[np.float64]


class Controller(ABC):
    """Computes the controls of one move group. It never steps the simulation.

    Attributes:
        robot_move_group: The group.
    """

    def __init__(self, robot_move_group: MoveGroup) -> None:
        """Begins stationary: the group is held where it is."""
        self.robot_move_group = robot_move_group

    @property
    @abstractmethod
    def target(self) -> Numbers:
        """The present target."""

    @property
    @abstractmethod
    def stationary(self) -> bool:
        """True while the controller holds the group where it was told to."""

    @abstractmethod
    def set_target(self, target: ArrayLike) -> None:
        """Sets the target."""

    @abstractmethod
    def set_to_stationary(self) -> None:
        """Holds the group where it is now."""

    @abstractmethod
    def compute_ctrl_inputs(self) -> Numbers:
        """Returns the controls (n_actuators,)."""

    @abstractmethod
    def reset(self) -> None:
        """Forgets the target, and holds the group where it is now."""


class AbstractPositionController(Controller):
    """A controller whose target is a value for each actuator, within the limits of the controls."""

    def __init__(self, robot_move_group: MoveGroup) -> None:
        """Begins stationary: the group is held where it is."""
        super().__init__(robot_move_group)
        self._target: Numbers | None = None
        self._stationary = True

    @property
    def target(self) -> Numbers:
        """The controls (n_actuators,) that the controller gives."""
        if self._target is None:
            self.set_to_stationary()
        assert self._target is not None
        return self._target

    @property
    def target_pos(self) -> Numbers:
        """The same as `target`."""
        return self.target

    @property
    def stationary(self) -> bool:
        """True while no target is set."""
        return self._stationary

    def set_to_stationary(self) -> None:
        """Takes the group's `noop_ctrl` of this moment."""
        self._target = np.array(self.robot_move_group.noop_ctrl, dtype=np.float64)
        self._stationary = True

    def compute_ctrl_inputs(self) -> Numbers:
        """Returns the target as controls (n_actuators,)."""
        return self.target.copy()

    def reset(self) -> None:
        """Holds the group where it is when controls are next computed."""
        self._target = None
        self._stationary = True

    def _take(self, target: ArrayLike) -> None:
        limits = self.robot_move_group.ctrl_limits
        self._target = np.clip(np.asarray(target, dtype=np.float64), limits[:, 0], limits[:, 1])
        self._stationary = False

    def _require(self, target: ArrayLike) -> Numbers:
        """Returns it as numbers (n_actuators,). Raises ArgumentError for others."""
        numbers = np.asarray(target, dtype=np.float64)
        group = self.robot_move_group
        if numbers.shape != (group.n_actuators,) or not np.all(np.isfinite(numbers)):
            raise rc.ArgumentError(
                f"{type(self).__name__} of '{group._name or type(group).__name__}': expected "
                f"{group.n_actuators} finite numbers, got {numbers.tolist()}"
            )
        return numbers
