"""Images of the size that a policy was trained on."""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray


def resize_with_pad(image: NDArray[np.uint8], height: int, width: int) -> NDArray[np.uint8]:
    """Returns an image (h, w, 3) as (height, width, 3): its sides keep their ratio, black bars pad.

    It is scaled as Pillow scales with its bilinear filter, which is what openpi's clients do, to
    one level of 255.
    """
    own_height, own_width = image.shape[:2]
    if (own_height, own_width) == (height, width):
        return np.ascontiguousarray(image)
    ratio = max(own_width / width, own_height / height)
    inner_height = max(1, int(own_height / ratio))
    inner_width = max(1, int(own_width / ratio))
    rows = _weights(own_height, inner_height)
    columns = _weights(own_width, inner_width)
    numbers = image.astype(np.float32)
    # Both passes round, as Pillow's do; the width comes first.
    across = np.rint(np.einsum("wx,hxc->hwc", columns, numbers, optimize=True))
    scaled = np.rint(np.tensordot(rows, across, axes=1))
    padded = np.zeros((height, width, image.shape[2]), np.uint8)
    top, left = (height - inner_height) // 2, (width - inner_width) // 2
    padded[top : top + inner_height, left : left + inner_width] = np.clip(scaled, 0, 255)
    return padded


@functools.lru_cache(maxsize=32)
def _weights(size: int, wanted: int) -> NDArray[np.float32]:
    """Returns the weights (wanted, size) of a triangle filter, as wide as the scale asks for."""
    scale = size / wanted
    support = max(scale, 1.0)
    centers = (np.arange(wanted) + 0.5) * scale
    distances = np.abs(np.arange(size) + 0.5 - centers[:, None]) / support
    weights = np.clip(1.0 - distances, 0.0, None)
    normalised: NDArray[np.float32] = (weights / weights.sum(axis=1, keepdims=True)).astype(
        np.float32
    )
    return normalised
