"""Finds which format a dataset has, and opens it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from robocell._core import ArgumentError, IoError, NotFoundError
from robocell._suggestions import did_you_mean

if TYPE_CHECKING:
    from robocell.importer._recording import Origin

FORMATS = ("lerobot", "robomimic", "aloha", "zarr")


def find(source: Path, format: str | None) -> tuple[Path, str]:
    """Returns the folder or file to read, and its format.

    Raises:
        NotFoundError: There is no such format.
        IoError: There is no such file or folder, or it cannot be read.
        ArgumentError: It has none of the formats.
    """
    if format is not None and format not in FORMATS:
        raise NotFoundError(
            f"no format '{format}'.{did_you_mean(format, FORMATS)} Formats: {', '.join(FORMATS)}"
        )
    if not source.exists():
        raise IoError(f"there is no file or folder '{source}'")
    for kind in FORMATS if format is None else (format,):
        place = _place(source, kind)
        if place is not None:
            return place, kind
    if (source / "dataset.json").is_file():
        raise ArgumentError(f"'{source}' is a dataset of robocell already; nothing is to import")
    what = f"a dataset of the format '{format}'" if format else "a dataset that can be imported"
    raise ArgumentError(
        f"'{source}' is not {what}: LeRobot datasets have meta/info.json, robomimic's are an HDF5 "
        "file with data/demo_0, ALOHA's a folder with episode_0.hdf5, replay buffers a zarr group "
        "with meta/episode_ends"
    )


def open_origin(place: Path, kind: str, fill_missing_chunks: bool = False) -> Origin:
    """Opens a dataset; the packages that it needs are imported now."""
    if kind == "lerobot":
        from robocell.importer._lerobot import LeRobot

        return LeRobot(place)
    if kind == "zarr":
        from robocell.importer._zarr_files import ReplayBuffer

        return ReplayBuffer(place, fill_missing_chunks)
    from robocell.importer._hdf5_files import Aloha, Robomimic

    return Robomimic(place) if kind == "robomimic" else Aloha(place)


def _place(source: Path, kind: str) -> Path | None:
    """Returns where the dataset of a format is: the source, its folder, or inside; else None."""
    if kind == "lerobot":
        return source if (source / "meta/info.json").is_file() else None
    if kind == "zarr":
        buffers = [source, *sorted(source.glob("*.zarr"))] if source.is_dir() else [source]
        return next(filter(_is_replay_buffer, buffers), None)
    files = [source] if source.is_file() else sorted(source.glob("*.hdf5"))
    files = [file for file in files if file.suffix in (".hdf5", ".h5")]
    episodes = [file for file in files if file.stem.startswith("episode_")]
    return _robomimic(files, episodes) if kind == "robomimic" else _aloha(episodes)


def _robomimic(files: Iterable[Path], episodes: Iterable[Path]) -> Path | None:
    others = [file for file in files if file not in episodes]
    if not others:
        return None
    from robocell.importer._hdf5_files import is_robomimic

    return next(filter(is_robomimic, others), None)


def _aloha(episodes: list[Path]) -> Path | None:
    if not episodes:
        return None
    from robocell.importer._hdf5_files import is_aloha

    return episodes[0].parent if is_aloha(episodes[0]) else None


def _is_replay_buffer(place: Path) -> bool:
    return place.name.endswith(".zarr.zip") or (place / "meta/episode_ends").is_dir()
