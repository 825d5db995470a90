"""The scale of depth images."""

from __future__ import annotations

__all__ = [
    "BaseCameraSet",
]


class BaseCameraSet:
    """Depth images are uint16: metres times DEPTH_SCALE."""

    DEPTH_SCALE = 1000
