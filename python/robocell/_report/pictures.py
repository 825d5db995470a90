"""Pictures of episodes as data of a page: contact sheets and short loops."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import Dataset, Episode, Error
from robocell._report.facts import EpisodeFacts

Image = NDArray[np.uint8]
SHOWN = 6  # images of a contact sheet
LOOP = 24  # images of a loop
MOST_CAMERAS = 2
SHEET_WIDTH, LOOP_WIDTH = 168, 256  # px of an image
LOOP_MS = 3600  # what a loop lasts
# Decoding in order takes 2 ms an image and a jump 40 ms: beyond this distance jumps are cheaper.
JUMP = 20


@dataclass(frozen=True)
class Card:
    """The pictures of one episode.

    Attributes:
        episode: It.
        loop: Data URI of an animated WebP of its first camera.
        sheets: Camera -> data URI of a JPEG with images of the whole episode.
        width, height: Of the loop, px.
    """

    episode: EpisodeFacts
    loop: str
    sheets: dict[str, str]
    width: int
    height: int


def chosen(episodes: Sequence[EpisodeFacts], number: int) -> list[EpisodeFacts]:
    """Returns successes with cameras, of as many kinds of objects and tasks as possible."""
    by_kind: dict[tuple[str, str], list[EpisodeFacts]] = {}
    for episode in episodes:
        if episode.success and episode.cameras and episode.rows:
            by_kind.setdefault((episode.task, episode.object_kind), []).append(episode)
    picked: list[EpisodeFacts] = []
    for turn in range(number):
        for listed in by_kind.values():
            if turn < len(listed) and len(picked) < number:
                picked.append(listed[turn])
    return sorted(picked, key=lambda episode: episode.id)


def failed(episodes: Sequence[EpisodeFacts], number: int) -> dict[str, EpisodeFacts]:
    """Returns reason -> a failed episode with cameras; the most frequent reasons first."""
    by_reason: dict[str, list[EpisodeFacts]] = {}
    for episode in episodes:
        if not episode.success and episode.cameras and episode.rows:
            by_reason.setdefault(episode.end_reason, []).append(episode)
    frequent = sorted(by_reason.items(), key=lambda entry: -len(entry[1]))[:number]
    return {reason: listed[len(listed) // 2] for reason, listed in frequent}


def card(dataset: Dataset, facts: EpisodeFacts) -> Card | None:
    """Returns the pictures of an episode; None if its videos cannot be read."""
    episode = dataset[facts.id]
    # A camera beside the robot shows the whole scene, the one of its hand only a part.
    cameras = sorted(episode.cameras, key=lambda name: ("wrist" in name or "hand" in name, name))
    try:
        decoded = {
            name: _frames(episode, name, i == 0)
            for i, name in enumerate(cameras)
            if i < MOST_CAMERAS
        }
    except Error:
        return None
    if not decoded:
        return None
    loop = [_resized(image, LOOP_WIDTH) for image in decoded[cameras[0]][1]]
    return Card(
        facts,
        _webp(loop),
        {name: _sheet(images) for name, (images, _) in decoded.items()},
        loop[0].width,
        loop[0].height,
    )


def _frames(episode: Episode, camera: str, loop: bool) -> tuple[list[Image], list[Image]]:
    """Returns the images of a sheet, and of a loop if wanted, without keeping all of the video."""
    described: Any = episode.json
    number = described["cameras"][camera]["frames"]
    sheet = np.linspace(0, number - 1, SHOWN).round().astype(int)
    shown = np.linspace(0, number - 1, min(LOOP, number)).round().astype(int) if loop else sheet
    wanted = sorted({*map(int, sheet), *map(int, shown)})
    gap = (number - 1) / max(1, len(wanted) - 1)
    rows = range(wanted[-1] + 1) if gap < JUMP else wanted
    needed = set(wanted)
    images = {}
    for row in rows:
        image = episode.frame(camera, row)
        if row in needed:
            images[row] = image
    return [images[int(i)] for i in sheet], [images[int(i)] for i in shown] if loop else []


def _resized(image: Image, width: int) -> Any:
    from PIL import Image as Pictures

    height = max(1, round(image.shape[0] * width / image.shape[1]))
    return Pictures.fromarray(image).resize((width, height), Pictures.Resampling.LANCZOS)


def _sheet(images: Sequence[Image]) -> str:
    from PIL import Image as Pictures

    small = [_resized(image, SHEET_WIDTH) for image in images]
    whole = Pictures.new("RGB", (len(small) * (SHEET_WIDTH + 2) - 2, small[0].height), "white")
    for place, image in enumerate(small):
        whole.paste(image, (place * (SHEET_WIDTH + 2), 0))
    data = io.BytesIO()
    whole.save(data, "JPEG", quality=82)
    return _uri("image/jpeg", data)


def _webp(images: Sequence[Any]) -> str:
    data = io.BytesIO()
    images[0].save(
        data,
        "WEBP",
        save_all=True,
        append_images=images[1:],
        duration=max(20, LOOP_MS // len(images)),
        loop=0,
        quality=62,
        method=2,
    )
    return _uri("image/webp", data)


def _uri(kind: str, data: io.BytesIO) -> str:
    return f"data:{kind};base64,{base64.b64encode(data.getvalue()).decode()}"
