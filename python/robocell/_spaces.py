"""Ranges of an environment as Gymnasium's spaces."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium import spaces


def space_of(lower: Any, upper: Any) -> spaces.Space[Any]:
    """Dictionaries of ranges as a space of the same shape."""
    if isinstance(lower, Mapping):
        return spaces.Dict({key: space_of(lower[key], upper[key]) for key in lower})
    return spaces.Box(lower, upper, dtype=np.float64)
