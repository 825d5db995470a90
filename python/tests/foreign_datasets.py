"""Small datasets of each format that can be imported, and ways to damage them."""

from __future__ import annotations

import io
import itertools
import json
import os
import shutil
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import zarr
from PIL import Image

from robocell.export._videos import encode

ROWS = (4, 3)  # of the episodes
SIZE = 16  # pixels
DATA_V2 = "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet"
DATA_V3 = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
VIDEO_V3 = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"
VALUES = (None, -1, 0, 1e308, float("nan"), 10**30, "x", "\udc80", [], {}, True, "../../secret")

Damage = Callable[[Path], None]


def pixels(rows: int) -> np.ndarray[Any, Any]:
    """Images that differ."""
    images = np.zeros((rows, SIZE, SIZE, 3), np.uint8)
    images[:] = 40 * np.arange(rows, dtype=np.uint8)[:, None, None, None]
    return images


def files(rows: int, format: str) -> list[bytes]:
    """The same as files."""
    found = []
    for image in pixels(rows):
        stream = io.BytesIO()
        Image.fromarray(image).save(stream, format)
        found.append(stream.getvalue())
    return found


def table(episodes: tuple[int, ...], first: int = 0) -> pa.Table:
    """The rows of episodes, as LeRobot stores them."""
    columns: dict[str, list[Any]] = {
        "observation.state": [],
        "action": [],
        "next.success": [],
        "episode_index": [],
        "observation.images.still": [],
    }
    for episode, rows in enumerate(episodes, first):
        columns["observation.state"] += [[float(row), 0.5] for row in range(rows)]
        columns["action"] += [float(row) for row in range(rows)]
        columns["next.success"] += [row == rows - 1 for row in range(rows)]
        columns["episode_index"] += [episode] * rows
        columns["observation.images.still"] += [
            {"bytes": file, "path": f"still-{row}.png"}
            for row, file in enumerate(files(rows, "PNG"))
        ]
    return pa.table(columns)


def info(version: str, **entries: Any) -> dict[str, Any]:
    """The description of a LeRobot dataset."""
    features = {
        "observation.state": {"dtype": "float32", "shape": [2], "names": ["a", "b"]},
        "action": {"dtype": "float32", "shape": [1], "names": None},
        "next.success": {"dtype": "bool", "shape": [1], "names": None},
        "episode_index": {"dtype": "int64", "shape": [1], "names": None},
        "observation.images.still": {"dtype": "image", "shape": [SIZE, SIZE, 3], "names": None},
    }
    shared = {"codebase_version": version, "fps": 10, "robot_type": "rc7", "features": features}
    return {**shared, "total_episodes": len(ROWS), "chunks_size": 1000, **entries}


def write(path: Path, content: Any) -> None:
    """Writes JSON; surrogates stay escapes."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content))


def lerobot_v2(root: Path) -> Path:
    """A file for each episode, images in the tables."""
    write(root / "meta/info.json", info("v2.1", data_path=DATA_V2))
    lines = [{"episode_index": i, "tasks": ["sort"], "length": rows} for i, rows in enumerate(ROWS)]
    (root / "meta/episodes.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    (root / "data/chunk-000").mkdir(parents=True)
    for episode, rows in enumerate(ROWS):
        file = root / f"data/chunk-000/episode_{episode:06d}.parquet"
        pq.write_table(table((rows,), episode), file)
    return root


def lerobot_v3(root: Path) -> Path:
    """One file with all episodes, and one video."""
    content = info("v3.0", data_path=DATA_V3, video_path=VIDEO_V3)
    del content["features"]["observation.images.still"]
    video = {"dtype": "video", "shape": [SIZE, SIZE, 3], "names": None}
    content["features"]["observation.images.top"] = video
    write(root / "meta/info.json", content)
    episodes: dict[str, list[Any]] = {
        "episode_index": [0, 1],
        "tasks": [["sort"], ["stack"]],
        "length": list(ROWS),
        "data/chunk_index": [0, 0],
        "data/file_index": [0, 0],
        "videos/observation.images.top/chunk_index": [0, 0],
        "videos/observation.images.top/file_index": [0, 0],
        "videos/observation.images.top/from_timestamp": [0.0, ROWS[0] / 10],
    }
    for place, each in (("meta/episodes", pa.table(episodes)), ("data", table(ROWS))):
        (root / place / "chunk-000").mkdir(parents=True)
        pq.write_table(each, root / place / "chunk-000/file-000.parquet")
    video_file = root / "videos/observation.images.top/chunk-000/file-000.mp4"
    video_file.parent.mkdir(parents=True)
    source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{SIZE}x{SIZE}"]
    encode([pixels(sum(ROWS)).tobytes()], source, Fraction(10), video_file, "images")
    return root


def robomimic(root: Path) -> Path:
    """A folder with one file."""
    root.mkdir()
    with h5py.File(root / "demo.hdf5", "w") as file:
        data = file.create_group("data")
        settings = {"env_name": "Lift", "env_kwargs": {"control_freq": 20, "robots": ["Panda"]}}
        data.attrs["env_args"] = json.dumps(settings)
        for episode, rows in enumerate(ROWS):
            demo = data.create_group(f"demo_{episode}")
            demo.attrs["num_samples"] = rows
            demo["actions"] = np.zeros((rows, 3), np.float32)
            demo["rewards"] = np.zeros(rows)
            demo["dones"] = np.arange(rows) == rows - 1
            demo["obs/object"] = np.ones((rows, 2))
            demo["obs/top_image"] = pixels(rows)
    return root


def aloha(root: Path) -> Path:
    """A folder with a file for each episode, images as JPEG files."""
    root.mkdir()
    for episode, rows in enumerate(ROWS):
        with h5py.File(root / f"episode_{episode}.hdf5", "w") as file:
            file.attrs["rate"] = 50.0
            file["action"] = np.zeros((rows, 3))
            file["observations/qpos"] = np.zeros((rows, 3))
            jpegs = files(rows, "JPEG")
            padded = np.zeros((rows, max(map(len, jpegs))), np.uint8)
            for row, jpeg in enumerate(jpegs):
                padded[row, : len(jpeg)] = np.frombuffer(jpeg, np.uint8)
            file["observations/images/top"] = padded
    return root


def replay_buffer(root: Path) -> Path:
    """A zarr group in a folder."""
    group = zarr.open_group(str(root / "a.zarr"), mode="w", zarr_format=2)
    arrays: dict[str, Any] = {
        "data/state": np.zeros((sum(ROWS), 2), np.float32),
        "data/action": np.zeros((sum(ROWS), 3), np.float32),
        "data/img": pixels(sum(ROWS)),
        "meta/episode_ends": np.cumsum(ROWS),
    }
    for name, values in arrays.items():
        group.create_array(name, data=values, config={"write_empty_chunks": True})
    return root


DATASETS: dict[str, Callable[[Path], Path]] = {
    each.__name__: each for each in (lerobot_v2, lerobot_v3, robomimic, aloha, replay_buffer)
}


def damages(root: Path) -> dict[str, Damage]:
    """Ways to damage a dataset, by their names; each changes a copy of it."""
    found: dict[str, Damage] = {}
    for file in sorted(root.rglob("*")):
        name = str(file.relative_to(root))
        if file.is_file():
            kinds = itertools.chain(_of_bytes(), _of_content(file))
            found |= {f"{name} {what}": _at(name, damage) for what, damage in kinds}
    return found


def _at(name: str, damage: Damage) -> Damage:
    return lambda root: damage(root / name)


def _of_bytes() -> Iterator[tuple[str, Damage]]:
    yield "dropped", Path.unlink
    yield "a folder", lambda file: (file.unlink(), file.mkdir())[0]
    yield "a pipe", lambda file: (file.unlink(), os.mkfifo(file))[0]
    yield "a link to the outside", _link
    for at in (0, 1, 40, 50, 90, 99):
        yield (
            f"cut at {at} %",
            lambda file, at=at: os.truncate(file, file.stat().st_size * at // 100),
        )
    for seed in range(8):
        yield f"other bytes {seed}", lambda file, seed=seed: _scramble(file, seed)


def _link(file: Path) -> None:
    outside = Path(shutil.copy(file, file.parents[len(file.parents) - 2] / "outside"))
    outside = Path(shutil.move(outside, _outside(file)))
    file.unlink()
    file.symlink_to(outside)


def _outside(file: Path) -> Path:
    folder = next(each for each in file.parents if each.name == "there")
    return folder.with_name("outside")


def _scramble(file: Path, seed: int) -> None:
    random = np.random.default_rng(seed)
    content = bytearray(file.read_bytes())
    for at in random.integers(0, len(content), 1 + seed):
        content[at] = random.integers(256)
    file.write_bytes(content)


def _of_content(file: Path) -> Iterator[tuple[str, Damage]]:
    if file.suffix in (".json", ".jsonl") or file.name in (".zarray", ".zgroup"):
        yield from _of_json(file)
    elif file.suffix == ".parquet":
        yield from _of_table(file)
    elif file.suffix == ".hdf5":
        yield from _of_hdf5(file)


def _of_json(file: Path) -> Iterator[tuple[str, Damage]]:
    documents = [json.loads(line) for line in _documents(file)]
    yield "not UTF-8", lambda file: file.write_bytes(b'{"a": "\xff\xfe"}') and None
    yield "nested", lambda file: file.write_text("[" * 100_000) and None
    for number, document in enumerate(documents):
        for path in _leaves(document):
            yield f"{number} without {path}", lambda file, n=number, p=path: _set(file, n, p)
            for value in VALUES:
                yield (
                    f"{number} {path} = {value!a}",
                    lambda file, n=number, p=path, v=value: _set(file, n, p, v),
                )


def _documents(file: Path) -> list[str]:
    text = file.read_text()
    return text.splitlines() if file.suffix == ".jsonl" else [text]


def _leaves(entry: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    children = entry.items() if isinstance(entry, dict) else enumerate(entry)
    for key, child in children:
        yield (*path, key)
        if isinstance(child, dict | list):
            yield from _leaves(child, (*path, key))


def _set(file: Path, number: int, path: tuple[Any, ...], *value: Any) -> None:
    documents = [json.loads(line) for line in _documents(file)]
    *parents, last = path
    entry = documents[number]
    for key in parents:
        entry = entry[key]
    if value:
        entry[last] = value[0]
    else:
        del entry[last]
    file.write_text("".join(json.dumps(each) + "\n" for each in documents))


def _of_table(file: Path) -> Iterator[tuple[str, Damage]]:
    names = pq.read_schema(file).names
    ragged = [[1.0], [1.0, 2.0]]
    for name in names:
        yield f"without {name}", lambda file, n=name: _change(file, lambda t: t.drop_columns([n]))
        for what, value in (
            ("texts", "x"),
            ("empty", None),
            ("NaN", float("nan")),
            ("huge", 1e308),
            ("negative", -1),
            ("lists", [1.0, 2.0, 3.0]),
            ("a path outside", {"bytes": None, "path": "../../secret"}),
        ):
            yield (
                f"{name} {what}",
                lambda file, n=name, v=value: _change(file, lambda t: replaced(t, n, [v] * len(t))),
            )
        yield (
            f"{name} ragged",
            lambda file, n=name: _change(
                file, lambda t: replaced(t, n, (ragged * len(t))[: len(t)])
            ),
        )
    for one, other in itertools.combinations(names, 2):
        yield (
            f"{one} and {other} exchanged",
            lambda file, a=one, b=other: _change(
                file,
                lambda t: t.rename_columns(
                    [{a: b, b: a}.get(name, name) for name in t.column_names]
                ),
            ),
        )
    yield "without rows", lambda file: _change(file, lambda t: t.slice(0, 0))
    yield "without a row", lambda file: _change(file, lambda t: t.slice(1))
    yield "twice", lambda file: _change(file, lambda t: pa.concat_tables([t, t]))


def _change(file: Path, change: Callable[[pa.Table], pa.Table]) -> None:
    pq.write_table(change(pq.read_table(file, partitioning=None)), file)


def replaced(table: pa.Table, name: str, values: list[Any]) -> pa.Table:
    """The table with other values in a column."""
    return table.set_column(table.column_names.index(name), name, pa.array(values))


def _of_hdf5(file: Path) -> Iterator[tuple[str, Damage]]:
    with h5py.File(file) as content:
        names: list[str] = []
        content.visit(names.append)
        datasets = [name for name in names if isinstance(content[name], h5py.Dataset)]
        attributes = [(name, key) for name in ("/", *names) for key in content[name].attrs]
    for name in names:
        yield f"without {name}", lambda file, n=name: _replace(file, n, None)
        yield (
            f"{name} elsewhere",
            lambda file, n=name: _replace(file, n, h5py.ExternalLink(str(_outside(file)), n)),
        )
        yield f"{name} a loop", lambda file, n=name: _replace(file, n, h5py.SoftLink(f"/{n}"))
        values = {
            "text": "x",
            "a number": 3.0,
            "empty": h5py.Empty("f4"),
            "no rows": np.zeros((0, 3), np.float32),
            "no columns": np.zeros((4, 0), np.float32),
            "one row": np.zeros((1, 3), np.float32),
            "NaN": np.full(4, np.nan),
            "complex": np.zeros(4, complex),
            "large": np.full((4, 3), np.iinfo(np.uint64).max),
            "texts": np.array([b"x"] * 4),
        }
        for what, value in values.items():
            yield f"{name} {what}", lambda file, n=name, v=value: _replace(file, n, v)
    for name in datasets:
        yield f"{name} huge", lambda file, n=name: _replace(file, n, (1 << 40, 3))
        yield f"{name} wide", lambda file, n=name: _replace(file, n, (4, 1 << 40))
        yield f"{name} of another file", _of_another_file(name)
    for name, key in attributes:
        for value in (
            -1,
            0,
            float("nan"),
            1e308,
            "x",
            b"\xff",
            [1, 2],
            "{}",
            "[]",
            '{"env_kwargs": 3}',
        ):
            yield (
                f"{name} {key} = {value}",
                lambda file, n=name, k=key, v=value: _attribute(file, n, k, v),
            )


def _replace(file: Path, name: str, value: Any) -> None:
    with h5py.File(file, "a") as content:
        del content[name]
        if isinstance(value, tuple):
            content.create_dataset(
                name, value, np.float32, chunks=tuple(min(each, 64) for each in value)
            )
        elif value is not None:
            content[name] = value


def _of_another_file(name: str) -> Damage:
    def damage(file: Path) -> None:
        with h5py.File(file, "a") as content:
            shape = content[name].shape
            del content[name]
            layout = h5py.VirtualLayout(shape, np.float32)
            layout[:] = h5py.VirtualSource(str(_outside(file)), "x", shape)
            content.create_virtual_dataset(name, layout)

    return damage


def _attribute(file: Path, name: str, key: str, value: Any) -> None:
    with h5py.File(file, "a") as content:
        content[name].attrs[key] = value
