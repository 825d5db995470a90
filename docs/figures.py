"""What the scripts that draw pictures for docs/ share. Draws nothing by itself."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

DOCS = Path(__file__).parent
COLOURS = 256
GAP_PX = 4
Frame = NDArray[np.uint8]  # (height, width, 3)


def save(image: Image.Image | Frame, name: str, width: int | None = None) -> None:
    """Writes docs/NAME with few colours, scaled down to a width."""
    if not isinstance(image, Image.Image):
        image = Image.fromarray(np.ascontiguousarray(image))
    image = image.convert("RGB")
    if width and width < image.width:
        height = round(image.height * width / image.width)
        image = image.resize((width, height), Image.Resampling.LANCZOS)
    few = image.quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE, kmeans=1)  # rare ones stay
    few.save(DOCS / name, optimize=True)
    print(DOCS / name)


def sheet(rows: Sequence[Sequence[Frame]]) -> Image.Image:
    """Frames of one size in rows, with white gaps between them."""
    height, width, _ = rows[0][0].shape
    columns = max(len(row) for row in rows)
    size = (columns * (width + GAP_PX) - GAP_PX, len(rows) * (height + GAP_PX) - GAP_PX)
    image = Image.new("RGB", size, "white")
    for i, row in enumerate(rows):
        for j, frame in enumerate(row):
            at = (j * (width + GAP_PX), i * (height + GAP_PX))
            image.paste(Image.fromarray(np.ascontiguousarray(frame)), at)
    return image


def spread(frames: Frame, count: int) -> list[Frame]:
    """So many frames of a video, evenly spread, first and last among them."""
    return [frames[i] for i in np.linspace(0, len(frames) - 1, count).round().astype(int)]
