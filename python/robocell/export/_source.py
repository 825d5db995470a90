"""The episodes of an export, and what they have in common: features, rate, cameras.

Everything that would stop an export is found here, before it writes.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import accumulate
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError, Dataset, Episode, NotFoundError
from robocell._durable import flush_path
from robocell._placeholders import AS_RECORDED, Gripper
from robocell._suggestions import did_you_mean, shortened
from robocell.export._features import Resolved
from robocell.export._mapping import Mapping
from robocell.export._rates import mean_rate, rate_of
from robocell.export._resampled import ResampledEpisode, rows_at
from robocell.export._videos import resample


@dataclass(frozen=True)
class Item:
    """One episode of an export.

    Attributes:
        id: Its id in the dataset.
        rows: Its length.
        task: Its instruction.
        robots: Its robots, separated by commas.
        success: Whether the task was done.
        end_reason: Why it ended.
        video_bytes: Size of its largest video.
        digest: Hash of its episode.json, which holds the hashes of all its files.
    """

    id: str
    rows: int
    task: str
    robots: str
    success: bool
    end_reason: str
    video_bytes: int
    digest: str


@dataclass(frozen=True)
class Camera:
    """A camera of an export.

    Attributes:
        feature: Its name in the training dataset.
        name: Its name in the episodes.
        width: In pixels.
        height: In pixels.
    """

    feature: str
    name: str
    width: int
    height: int


@dataclass(frozen=True)
class Source:
    """What is exported.

    Attributes:
        dataset: The dataset that has the episodes.
        items: The episodes, in order.
        resolved: Their features.
        cameras: Their cameras.
        rate: Rows per second; where they are not even, their mean.
        left_out: What the episodes have and the export does not contain, in words.
        image_size: Width and height of exported images; None for those of the cameras.
        gripper: The numbers of open and closed grippers.
        is_even: Whether the rows of all episodes are known to have this rate.
        resampled: Whether `rate` was asked for; rows are then those of `ResampledEpisode`.
        scratch: Folder for videos at this rate.
        depths: The cameras whose depth is exported too.
    """

    dataset: Dataset
    items: tuple[Item, ...]
    resolved: Resolved
    cameras: tuple[Camera, ...]
    rate: Fraction
    left_out: tuple[str, ...]
    image_size: tuple[int, int] | None = None
    gripper: Gripper = AS_RECORDED
    is_even: bool = True
    resampled: bool = False
    scratch: Path | None = None
    depths: tuple[Camera, ...] = ()

    @property
    def fps(self) -> int:
        """The whole number of frames per second that is nearest to the rate."""
        return max(1, round(self.rate))

    @cached_property
    def rows(self) -> int:
        """The rows of all episodes."""
        return sum(item.rows for item in self.items)

    @property
    def robot_type(self) -> str | None:
        """The robots of all episodes; None without any."""
        return ", ".join(dict.fromkeys(item.robots for item in self.items if item.robots)) or None

    @cached_property
    def tasks(self) -> list[str]:
        """The instructions, in the order in which they first appear."""
        return list(dict.fromkeys(item.task for item in self.items))

    @cached_property
    def task_indices(self) -> dict[str, int]:
        """The number of each instruction."""
        return {task: index for index, task in enumerate(self.tasks)}

    @cached_property
    def first_rows(self) -> list[int]:
        """The number of rows before each episode."""
        return list(accumulate((item.rows for item in self.items), initial=0))

    def recorded(self, item: Item) -> Episode:
        """Opens an episode as it was recorded."""
        return self.dataset[item.id]

    def rows_of(self, item: Item) -> NDArray[np.int64] | None:
        """Returns the recorded row of each row; None if they are those of the recording."""
        if not self.resampled:
            return None
        names = [camera.name for camera in self.cameras]
        return rows_at(self.recorded(item), self.rate, names)

    def episode(self, item: Item) -> Episode:
        """Opens an episode, with rows at the rate of the export."""
        episode, rows = self.recorded(item), self.rows_of(item)
        # It has the members of an episode that exports use.
        if rows is None:
            return episode
        return cast(Episode, ResampledEpisode(episode, rows, self.rate))

    def resized(self, camera: Camera) -> tuple[int, int] | None:
        """Returns the width and height that images are brought to, or None if they have it."""
        own = (camera.width, camera.height)
        return None if self.image_size in (None, own) else self.image_size

    def shape_of(self, camera: Camera) -> tuple[int, int]:
        """Returns the height and width of exported images."""
        width, height = self.image_size or (camera.width, camera.height)
        return height, width

    def video(self, item: Item, camera: Camera) -> Path:
        """Returns the file with the colour images of a camera in an episode."""
        episode, rows = self.recorded(item), self.rows_of(item)
        described: Any = episode.json
        recorded = episode.folder / described["cameras"][camera.name]["file"]
        if rows is None:
            return recorded
        assert self.scratch is not None
        made = self.scratch / item.id / f"{camera.name}.mp4"
        if not made.exists():
            made.parent.mkdir(parents=True, exist_ok=True)
            partial = made.with_suffix(".partial.mp4")
            resample(recorded, rows.tolist(), self.rate, partial)
            flush_path(partial)  # a file of this name is complete, also after a power cut
            os.replace(partial, made)
        return made

    def encoded_for(self, reason: str) -> str:
        """Returns why videos are not those of the episodes: a reason of the format, or the rate."""
        return reason or (f"at {float(self.rate):g} frames per second" if self.resampled else "")


def choose(
    dataset: Dataset, episodes: Sequence[str] | None = None, successes_only: bool = False
) -> list[str]:
    """Returns the ids of the episodes to export.

    Args:
        dataset: The dataset.
        episodes: Ids, places ("7"), or ranges of places ("0:100"); None for all.
        successes_only: Leave out the episodes that failed.

    Raises:
        ArgumentError: There are none.
        NotFoundError: The dataset has no such episode.
    """
    if not len(dataset):
        raise ArgumentError(
            f"dataset '{dataset.folder}' has no episodes. `robocell generate` with its run file "
            "makes them, `robocell report` sums up its attempts"
        )
    ids = dataset.ids
    chosen = ids if episodes is None else _named(dataset, episodes)
    if successes_only:
        chosen = [name for name in chosen if dataset[name].success]
    if not chosen:
        why = "none of the episodes succeeded" if successes_only else "the selection is empty"
        raise ArgumentError(
            f"no episodes of dataset '{dataset.folder}' to export: {why}. It has {len(ids)}: "
            f"{shortened(ids)}"
        )
    return chosen


def _named(dataset: Dataset, wanted: Sequence[str]) -> list[str]:
    ids = dataset.ids
    chosen: dict[str, None] = {}
    for name in wanted:
        first, colon, last = name.partition(":")
        if name in dataset:
            found = [name]
        elif colon and all(not each or each.lstrip("-").isdigit() for each in (first, last)):
            found = ids[int(first) if first else None : int(last) if last else None]
        elif name.isdigit() and int(name) < len(ids):
            found = [ids[int(name)]]
        else:
            raise NotFoundError(
                f"dataset '{dataset.folder}' has no episode '{name}'.{did_you_mean(name, ids)} It "
                f"has {len(ids)}: {shortened(ids)}. Ranges of places are 0:{len(ids)}"
            )
        chosen.update(dict.fromkeys(found))
    return list(chosen)


def gather(
    dataset: Dataset,
    ids: Sequence[str],
    mapping: Mapping,
    *,
    stores_times: bool = False,
    rate: Fraction | None = None,
    depth: bool = False,
    holds_depth: bool = False,
) -> Source:
    """Reads what the episodes are, and checks that they fit in one training dataset.

    Args:
        dataset: The dataset.
        ids: The episodes.
        mapping: The table of features.
        stores_times: Whether the format stores the time of each row, so rates may differ.
        rate: Rows per second that all episodes are brought to; None for those of the episodes.
        depth: Whether depth is exported too.
        holds_depth: Whether the format can hold depth.

    Raises:
        ArgumentError: Two episodes differ in features, rate or cameras, or rows have no rate.
        NotFoundError: An episode lacks a column or a camera.
    """
    first = dataset[ids[0]]
    resolved = mapping.resolve(first)
    cameras = _cameras(first, resolved)
    items = []
    rates: list[Fraction | None] = []
    is_resampled = False
    used = {camera.name for camera in cameras}
    having_depth = [name for name in first.depth_cameras if name in used]
    if depth:
        _require_depth(first, having_depth, mapping)
    for name in ids:
        episode = dataset[name]
        own = mapping.resolve(episode)
        resolved.require_same(own, episode, first)
        resolved = resolved.with_values_of(own)
        rows = None
        if rate is not None:
            rates.append(rate)
            rows = rows_at(episode, rate, (*own.images.values(), *episode.cameras))
            is_resampled = is_resampled or rows is not None
        else:
            rates.append(_rate(episode, own, stores_times))
        if not stores_times:
            _require_same(episode, first, "rate", rates[-1], rates[0])
        _require_same(episode, first, "sizes of images", _cameras(episode, own), cameras)
        if depth:
            with_depth = [each for each in episode.depth_cameras if each in used]
            _require_same(episode, first, "cameras with depth", with_depth, having_depth)
        items.append(_item(episode, own, cameras, len(episode) if rows is None else len(rows)))
    common = rates[0] if len(set(rates)) == 1 else None
    without_depth = [n for n in first.depth_cameras if not (depth and n in having_depth)]
    left_out = [f"depth of {name}" for name in without_depth]
    if holds_depth and not depth and having_depth:
        left_out[-1] += " (--depth exports it)"
    left_out += [f"segmentation of {name}" for name in first.segmentation_cameras]
    left_out += [f"camera {name}" for name in first.cameras if name not in used]
    return Source(
        dataset,
        tuple(items),
        resolved,
        cameras,
        common if common is not None else mean_rate(dataset[name] for name in ids),
        tuple(left_out),
        mapping.image_size,
        mapping.gripper,
        common is not None,
        is_resampled,
        depths=tuple(each for each in cameras if depth and each.name in having_depth),
    )


def _require_depth(first: Episode, having_depth: Sequence[str], mapping: Mapping) -> None:
    """Raises ArgumentError unless the exported cameras of an episode have depth in their size."""
    if not having_depth:
        there = ", ".join(first.depth_cameras)
        raise ArgumentError(
            f"episode '{first.folder}': none of the exported cameras has depth"
            + (f"; these have: {there}" if there else ". Record it with `depth: true` in a stream")
        )
    if mapping.image_size is not None:
        raise ArgumentError(
            f"{mapping.place}: `image_size` resizes images, and depth keeps the size of its "
            "camera: leave one of them out"
        )


def _rate(episode: Episode, resolved: Resolved, stores_times: bool) -> Fraction | None:
    """Returns the rate of an episode, or None without one if the format needs none."""
    try:
        return rate_of(episode, (*resolved.images.values(), *episode.cameras))
    except ArgumentError:
        if not stores_times:
            raise
        return None


def _require_same(episode: Episode, first: Episode, what: str, own: object, other: object) -> None:
    if own != other:
        raise ArgumentError(
            f"episode '{episode.folder}' cannot be in one dataset with '{first.folder}': its "
            f"{what}: {own} instead of {other}. Export them apart: --episodes"
        )


def _item(episode: Episode, resolved: Resolved, cameras: Sequence[Camera], rows: int) -> Item:
    described: Any = episode.json
    if not len(episode):
        raise ArgumentError(f"episode '{episode.folder}' has no rows. Leave it out: --episodes")
    videos = [described["cameras"][camera.name] for camera in cameras]
    for camera, video in zip(cameras, videos, strict=True):
        if video["frames"] != len(episode):
            raise ArgumentError(
                f"episode '{episode.folder}': camera '{camera.name}' has {video['frames']} frames "
                f"for {len(episode)} rows. Leave it out: --cameras"
            )
    sizes = [described["files"][video["file"]]["bytes"] for video in videos]
    return Item(
        id=episode.id,
        rows=rows,
        task=resolved.task,
        robots=", ".join(resolved.robots),
        success=episode.success,
        end_reason=episode.end_reason,
        video_bytes=max(sizes, default=0),
        digest=str(described.get("run", {}).get("json_sha256", "")),
    )


def _cameras(episode: Episode, resolved: Resolved) -> tuple[Camera, ...]:
    described: Any = episode.json
    return tuple(
        Camera(
            feature, name, described["cameras"][name]["width"], described["cameras"][name]["height"]
        )
        for feature, name in resolved.images.items()
    )
