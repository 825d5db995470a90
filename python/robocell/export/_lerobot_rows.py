"""What all versions of LeRobot datasets have in common: rows, their types, their statistics."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._extras import needed_by
from robocell.export._mp4 import Mp4
from robocell.export._source import Item, Source
from robocell.export._statistics import Images, Statistics, Vectors
from robocell.export._videos import key_images

with needed_by("robocell.export", "export"):
    import pyarrow as pa

# Columns of every LeRobot dataset, which no mapping has.
OWN = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}
TYPES = {"float32": pa.float32(), "int64": pa.int64(), "bool": pa.bool_()}


def features_of(source: Source, codecs: dict[str, str]) -> dict[str, Any]:
    """Returns the features as meta/info.json describes them."""
    features: dict[str, Any] = {
        camera.feature: {
            "dtype": "video",
            "shape": [*source.shape_of(camera), 3],
            "names": ["height", "width", "channels"],
            "info": {
                "video.height": source.shape_of(camera)[0],
                "video.width": source.shape_of(camera)[1],
                "video.codec": codecs[camera.feature],
                "video.pix_fmt": "yuv420p",
                "video.is_depth_map": False,
                "video.fps": source.fps,
                "video.channels": 3,
                "has_audio": False,
                "is_depth_map": False,
            },
        }
        for camera in source.cameras
    }
    for feature in source.resolved.features:
        features[feature.name] = {
            "dtype": feature.dtype,
            "shape": [feature.size],
            "names": list(feature.names),
        }
    for name, dtype in OWN.items():
        features[name] = {"dtype": dtype, "shape": [1], "names": None}
    return features


def columns_of(
    source: Source, item: Item, index: int, first: int, task: int
) -> dict[str, NDArray[Any]]:
    """Returns the numbers of an episode, (rows, size) each."""
    episode = source.episode(item)
    frames = np.arange(item.rows)
    columns = {feature.name: feature.read(episode) for feature in source.resolved.features}
    own: dict[str, NDArray[Any]] = {
        "timestamp": (frames / source.fps).astype(np.float32),
        "frame_index": frames,
        "episode_index": np.full(item.rows, index),
        "index": frames + first,
        "task_index": np.full(item.rows, task),
    }
    return columns | {name: value[:, None] for name, value in own.items()}


def _fields(source: Source) -> Iterator[tuple[str, Any]]:
    """Yields the columns of the data files."""
    for name, dtype, size in itertools.chain(
        ((each.name, each.dtype, each.size) for each in source.resolved.features),
        ((name, dtype, 1) for name, dtype in OWN.items()),
    ):
        of_one = TYPES[dtype]
        yield name, pa.field(name, of_one if size == 1 else pa.list_(of_one, size))


def schema(source: Source) -> Any:
    """Returns the Arrow schema of the data files."""
    return pa.schema([field for _, field in _fields(source)])


def table_of(source: Source, columns: dict[str, NDArray[Any]]) -> Any:
    """Returns an Arrow table of what `columns_of` returned."""
    arrays = [_array(columns[name], field.type) for name, field in _fields(source)]
    return pa.table(arrays, schema=schema(source))


def _array(values: NDArray[Any], kind: Any) -> Any:
    flat = np.ascontiguousarray(values).ravel()
    if pa.types.is_fixed_size_list(kind):
        return pa.FixedSizeListArray.from_arrays(pa.array(flat, kind.value_type), kind.list_size)
    return pa.array(flat, kind)


def statistics_of(values: NDArray[Any]) -> Statistics:
    """Returns the statistics of (rows, size) numbers."""
    vectors = Vectors(values.shape[1])
    vectors.add(values)
    return vectors.result()


def image_statistics(
    video: Path, facts: Mp4, lengths: Sequence[int]
) -> tuple[list[Statistics], Images]:
    """Returns the statistics of the key frames of each episode, and of all."""
    each, whole = [Images() for _ in lengths], Images()
    ends = np.cumsum(lengths)
    for index, image in key_images(video, facts):
        of_episode = each[int(np.searchsorted(ends, index, side="right"))]
        of_episode.add(image)
    for images in each:
        whole.merge(images.images, images.histogram)
    return [images.result() for images in each], whole


def numbers_of(column: Any) -> NDArray[Any]:
    """Returns a column of an Arrow table as (rows, size) numbers."""
    whole = column.combine_chunks()
    if pa.types.is_fixed_size_list(whole.type):
        size = whole.type.list_size
        return np.asarray(whole.flatten().to_numpy(zero_copy_only=False)).reshape(-1, size)
    return np.asarray(whole.to_numpy(zero_copy_only=False)).reshape(-1, 1)
