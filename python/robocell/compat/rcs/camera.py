"""What the numbers of depth images are."""

from __future__ import annotations


class BaseCameraSet:
    """Depth images are uint16: metres times DEPTH_SCALE."""

    DEPTH_SCALE = 1000
