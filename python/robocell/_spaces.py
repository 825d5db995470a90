"""Converts the schema of an environment to Gymnasium's spaces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium import spaces

from robocell._core import CameraConfig, EnvConfig, Feature

FAR = 1e6  # upper bound for pixels, metres and seconds


Part = tuple[tuple[str, ...], int, int]  # keys, first number, how many


def space_of(
    features: Sequence[Feature], parts: Sequence[Part], frames: spaces.Space[Any] | None = None
) -> spaces.Dict:
    """Returns a space of dictionaries that has each feature at its path."""
    tree: dict[str, Any] = {}
    for feature, (path, _, _) in zip(features, parts, strict=True):
        at = tree
        for key in path[:-1]:
            at = at.setdefault(key, {})
        low, high = (
            np.array(ends, dtype=np.float64).reshape(feature.shape)
            for ends in (feature.lower, feature.upper)
        )
        at[path[-1]] = spaces.Box(low, high, dtype=np.float64)
    if frames is not None:
        tree["frames"] = frames
    return _dict_of(tree)


def _dict_of(tree: Mapping[str, Any]) -> spaces.Dict:
    return spaces.Dict({k: _dict_of(v) if isinstance(v, dict) else v for k, v in tree.items()})


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


def frame_space(config: EnvConfig) -> spaces.Space[Any] | None:
    """Returns the space of all streams, None without any."""
    if not (config.cameras.draw and config.cameras.streams):
        return None
    return spaces.Dict({s.name: _frame_space(config, s) for s in config.cameras.streams})
