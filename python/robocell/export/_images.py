"""Images of episodes as arrays, a few at a time, for formats that do not hold videos."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from robocell._core import IoError
from robocell.export._mp4 import Mp4
from robocell.export._source import Camera, Item, Source
from robocell.export._videos import images


def blocks(source: Source, item: Item, camera: Camera) -> Iterator[tuple[int, NDArray[np.uint8]]]:
    """Yields the images of a camera in an episode: the row of the first, and (n, height, width, 3).

    Raises:
        IoError: The video is damaged, or has not one frame for each row.
    """
    video = source.video(item, camera)
    facts = Mp4.read(video)
    if facts.frames != item.rows:
        raise IoError(
            f"'{video}' has {facts.frames} frames for {item.rows} rows: it is damaged. `robocell "
            "verify --decode-videos DATASET` finds such videos"
        )
    row = 0
    for block in images(video, facts, source.resized(camera)):
        yield row, block
        row += len(block)
