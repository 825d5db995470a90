"""Images and depth of episodes as arrays, a few at a time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from robocell._core import IoError
from robocell.export._mp4 import Mp4
from robocell.export._source import Camera, Item, Source
from robocell.export._videos import images

DEPTH_BYTES = 16 << 20  # of depth in memory


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


def depth_name(feature: str) -> str:
    """Returns "wrist_depth" for the images "wrist_image"."""
    for ending in ("_image", "_rgb"):
        if feature.endswith(ending):
            return f"{feature.removesuffix(ending)}_depth"
    return f"{feature}_depth"


def depth_blocks(
    source: Source, item: Item, camera: Camera
) -> Iterator[tuple[int, NDArray[np.uint16]]]:
    """Yields the depth of a camera: the row of the first image, and (n, height, width, 1).

    Numbers are millimetres along the camera's axis, 0 for no hit, 65535 for that and more.

    Raises:
        IoError: The video of the depth is damaged, or ends before the rows do.
    """
    episode, rows = source.recorded(item), source.rows_of(item)
    rows = np.arange(item.rows) if rows is None else rows
    at_once = max(1, DEPTH_BYTES // (2 * camera.width * camera.height))
    for first in range(0, item.rows, at_once):
        chosen = rows[first : first + at_once]
        try:
            found = [episode.frame(camera.name, int(row), "depth") for row in chosen]
        except IndexError as error:
            raise IoError(
                f"episode '{episode.folder}': the depth of camera '{camera.name}' ends before the "
                f"rows do: {error}. `robocell verify --decode-videos DATASET` finds such videos"
            ) from error
        yield first, np.stack(found)[..., None]


def depth_notes(source: Source, dtype: str, unit: str) -> list[str]:
    """Returns the sentence of a card about depth; none without depth."""
    if not source.depths:
        return []
    names = ", ".join(f"`{depth_name(each.feature)}`" for each in source.depths)
    return [f"Depth is along the camera's axis, {dtype} in {unit}, 0 for no hit: {names}."]
