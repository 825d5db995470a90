"""Converts the ranges of an environment to Gymnasium's spaces."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium import spaces

from robocell._core import CameraConfig, EnvConfig

FAR = 1e6  # upper bound for pixels, metres and seconds


def space_of(lower: Any, upper: Any) -> spaces.Space[Any]:
    """Converts dictionaries of ranges to a space of the same structure."""
    if isinstance(lower, Mapping):
        return spaces.Dict({key: space_of(lower[key], upper[key]) for key in lower})
    return spaces.Box(lower, upper, dtype=np.float64)


def _image(shape: tuple[int, ...], low: int, high: int, dtype: type) -> spaces.Space[Any]:
    return spaces.Dict(
        {
            "data": spaces.Box(low, high, shape, dtype),
            "intrinsics": spaces.Box(-FAR, FAR, (3, 3), np.float64),
            "extrinsics": spaces.Box(-FAR, FAR, (4, 4), np.float64),
        }
    )


def _frame_space(config: EnvConfig, stream: CameraConfig) -> spaces.Space[Any]:
    """Returns the space of one stream; ``intrinsics`` are in pixels."""
    wide, high = config.cameras.resolution
    size = (stream.height or int(high), stream.width or int(wide))
    frame: dict[str, spaces.Space[Any]] = {"time": spaces.Box(0, FAR, (1,), np.float64)}
    if stream.rgb:
        frame["rgb"] = _image((*size, 3), 0, 255, np.uint8)
    if stream.depth or config.wrappers.include_depth:
        frame["depth"] = _image((*size, 1), 0, 65535, np.uint16)
    if stream.segmentation:
        frame["segmentation"] = _image((*size, 1), -1, 2**31 - 1, np.int32)
    return spaces.Dict(frame)


def frame_space(config: EnvConfig) -> spaces.Space[Any]:
    """Returns the space of all streams."""
    return spaces.Dict({s.name: _frame_space(config, s) for s in config.cameras.streams})
