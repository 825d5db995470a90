"""Reads the zarr replay buffers of Diffusion Policy and UMI."""

from __future__ import annotations

import math
import os
import warnings
import zipfile
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError, IoError
from robocell._extras import needed_by
from robocell.importer._arrays import is_numbers, is_pixels, numbers, pixels
from robocell.importer._foreign_files import ADVICE, fingerprint, reading
from robocell.importer._recording import Clip, Column, Recording, Stills

with needed_by("robocell.importer", "export"):
    import zarr
    from numcodecs.errors import UnknownCodecError

ENDS = "meta/episode_ends"
# Codecs of numbers. Others, such as pickle, could execute what a dataset says.
COMPRESSORS = {"blosc", "bz2", "gzip", "lz4", "lzma", "zlib", "zstd"}
ENCODINGS = {"astype", "bitround", "bytes", "delta", "fixedscaleoffset", "packbits", "quantize"}
CHECKSUMS = {"adler32", "crc32", "crc32c", "fletcher32", "jenkins_lookup3"}
CODECS = COMPRESSORS | ENCODINGS | CHECKSUMS | {"shuffle", "sharding_indexed", "transpose"}


class ReplayBuffer:
    """A replay buffer; see `recording.Origin`."""

    title = "zarr replay buffer"
    rate: Fraction | None = None
    robots = ""
    gaps = ""

    def __init__(self, place: Path, fill_missing_chunks: bool = False) -> None:
        self.place = place
        self._fill_missing_chunks = fill_missing_chunks
        self._whole: set[str] = set()  # arrays of which all chunks are there
        is_zip = place.suffix == ".zip"
        self.fingerprint = fingerprint(place.parent, [place]) if is_zip else fingerprint(place)
        with reading(f"the replay buffer '{place}' with data and {ENDS}"):
            store = zarr.storage.ZipStore(place, mode="r") if is_zip else str(place)
            # Consolidated metadata could name arrays that are elsewhere.
            root: Any = zarr.open_group(store, mode="r", use_consolidated=False)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # about folders without arrays: see below
                self._arrays: dict[str, Any] = dict(sorted(_arrays(root["data"], place)))
                groups = set(root["data"].group_keys())
            ends = root[ENDS]
        for folder in () if is_zip else sorted((place / "data").iterdir()):
            is_known = folder.name in self._arrays or folder.name in groups
            if folder.is_dir() and not folder.name.startswith(".") and not is_known:
                raise IoError(f"'{folder}' has no description of an array: {ADVICE}")
        self._ends = self._checked_ends(ends)
        for name, array in self._arrays.items() if len(self) else ():
            if array.ndim == 0 or array.shape[0] != self._ends[-1]:
                raise IoError(
                    f"'{place}': data/{name} has the shape {array.shape}, the last episode ends at "
                    f"row {self._ends[-1]}: {ADVICE}"
                )

    def __len__(self) -> int:
        return len(self._ends) - 1

    def read(self, index: int) -> Recording:
        """Reads an episode."""
        first, last = int(self._ends[index]), int(self._ends[index + 1])
        columns: dict[str, Callable[[], Column]] = {}
        images: dict[str, Clip | Stills] = {}
        for name, array in self._arrays.items():
            place = f"'{self.place}': data/{name}"
            if is_pixels(array):
                _require_known_codecs(array, place)
                images[name] = Stills(self._pixels(array, first, last, place))
            elif is_numbers(array):
                columns[name] = partial(self._column, array, first, last, place)
        if not columns:
            raise ArgumentError(f"'{self.place}': data has no arrays of numbers to import")
        return Recording("", last - first, columns, images, {"episode": index})

    def column_name(self, name: str) -> str | None:
        """Returns "observation/state" for state; the action keeps its name."""
        return name if name == "action" else f"observation/{name}"

    def _column(self, array: Any, first: int, last: int, place: str) -> Column:
        _require_known_codecs(array, place)
        self._require_chunks(array, place)
        return Column(numbers(array, first, last, place))

    def _pixels(self, array: Any, first: int, last: int, place: str) -> Iterator[NDArray[np.uint8]]:
        self._require_chunks(array, place)
        yield from pixels(array, first, last, place)

    def _require_chunks(self, array: Any, place: str) -> None:
        """Raises IoError unless all chunks of an array are stored; zarr reads others as filled."""
        if self._fill_missing_chunks or array.path in self._whole:
            return
        stored = self._files(array.path)
        sizes = getattr(array, "shards", None) or array.chunks
        counts = [math.ceil(size / each) for size, each in zip(array.shape, sizes, strict=True)]
        # A damaged shape may be huge, so no more are looked at than are stored, and one.
        for number in range(min(math.prod(counts), len(stored) + 1)):
            index: list[int] = []
            for count in reversed(counts):
                number, at = divmod(number, count)
                index.insert(0, at)
            key = array.metadata.encode_chunk_key(tuple(index))
            if key not in stored:
                raise IoError(
                    f"{place}: chunk {key} is missing, of {math.prod(counts)}: {ADVICE}. A writer "
                    f"may have left out chunks that are {array.fill_value} throughout; if so, "
                    "--fill-missing-chunks imports them"
                )
        self._whole.add(array.path)

    def _files(self, path: str) -> set[str]:
        """Returns the files below a path of the store, relative to it."""
        with reading(f"'{self.place}': {path}"):
            if self.place.suffix == ".zip":
                with zipfile.ZipFile(self.place) as content:
                    names = content.namelist()
                return {name[len(path) + 1 :] for name in names if name.startswith(f"{path}/")}
            root = self.place / path
            return {
                os.path.relpath(os.path.join(folder, name), root)
                for folder, _, names in os.walk(root)
                for name in names
            }

    def _checked_ends(self, array: Any) -> NDArray[np.int64]:
        """Returns the row at which the first episode begins, and those at which each ends."""
        place = f"'{self.place}': {ENDS}"
        if not isinstance(array, zarr.Array) or not is_numbers(array) or array.ndim != 1:
            raise IoError(f"{place} is no list of numbers, one for each episode: {ADVICE}")
        if array.shape[0] == 0:
            return np.zeros(1, np.int64)
        _require_known_codecs(array, place)
        self._require_chunks(array, place)
        ends = numbers(array, 0, array.shape[0], place)
        if ends.dtype.kind not in "iu":
            raise IoError(f"{place} has the type {ends.dtype}; expected whole numbers: {ADVICE}")
        if ends.max() > np.iinfo(np.int64).max:
            raise IoError(f"{place} has the number {ends.max()}; expected a row: {ADVICE}")
        bounds = np.concatenate([[0], ends.astype(np.int64)])
        for episode in np.flatnonzero(bounds[1:] <= bounds[:-1])[:1]:
            raise IoError(
                f"{place}: episode {episode} begins at row {bounds[episode]} and ends at row "
                f"{bounds[episode + 1]}; expected at least one row: {ADVICE}"
            )
        return bounds


def _arrays(group: Any, place: Path) -> list[tuple[str, Any]]:
    try:
        return list(group.arrays())
    except UnknownCodecError as error:
        raise ArgumentError(
            f"'{place}': data has an array whose codec is not imported: {error}. Known: "
            f"{', '.join(sorted(CODECS))}"
        ) from error


def _require_known_codecs(array: Any, place: str) -> None:
    """Raises ArgumentError for an array whose bytes need a codec that is not in `CODECS`."""
    for name in sorted(_codecs(array.metadata.to_dict())):
        if name.removeprefix("numcodecs.") not in CODECS:
            raise ArgumentError(
                f"{place} is stored with the codec '{name}', which is not imported. Known: "
                f"{', '.join(sorted(CODECS))}"
            )


def _codecs(entry: Any) -> set[str]:
    """Returns the codecs in the metadata of an array: entries "id" of zarr 2, "name" of zarr 3."""
    found: set[str] = set()
    if isinstance(entry, dict):
        for key in ("filters", "codecs", "index_codecs"):
            found |= {name for each in entry.get(key) or () for name in _names(each)}
        if entry.get("compressor") is not None:
            found |= _names(entry["compressor"])
    return found


def _names(codec: Any) -> set[str]:
    settings = codec if isinstance(codec, dict) else codec.get_config()
    own = str(settings.get("id") or settings.get("name") or "")
    return {own} | _codecs(settings.get("configuration"))
