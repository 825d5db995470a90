"""What sensors have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Sensor"]


class Sensor(ABC):
    """Reads numbers of an environment.

    Attributes:
        uuid: Name of the sensor in observations; runs record it as the feature of this name.
        unit: Unit of the numbers in recordings, such as "m, 1" where they differ.
    """

    unit = "1"

    def __init__(self, uuid: str) -> None:
        """Takes the name."""
        self.uuid = uuid

    @abstractmethod
    def get_observation(
        self, env: Any, task: Any = None, batch_index: int = 0
    ) -> NDArray[np.float64]:
        """Returns the numbers now, always in the same shape."""

    def reset(self) -> None:  # noqa: B027  may be left out
        """Forgets what the sensor keeps of an episode. Default: nothing."""
