"""Episodes row by row, from a real robot or any other source."""

from __future__ import annotations

import functools
import os
import re
import threading
import warnings as python_warnings
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from robocell._arguments import show
from robocell._core import ArgumentError, IoError, _EpisodeWriter, remove_leftovers
from robocell._durable import make_folders
from robocell.data._declarations import (
    STEPS,
    CameraStream,
    ColumnSpec,
    Declarations,
    DeclaredColumn,
    boolean,
    texts,
)
from robocell.data._metadata import metadata_text

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

MANIFEST = "dataset.json"


class EpisodeWriter:
    """Writes one episode, row by row: what a real robot did, or another simulator.

    Nothing is visible before `commit`, which verifies the files and flushes them to the disk.
    Without it the end of the block removes what was written, with a warning. `abort` and an
    exception that leaves the block remove it too. A killed process leaves a hidden folder, which no
    reader sees: the next writer of the same id removes it, and `robocell verify --repair` sets it
    aside.

    Args:
        dataset: Folder of the dataset; created if missing.
        id: The episode's id, its folder's name.
        columns: The declared columns by name. Every row gives each column of its table a value.
        cameras: The declared cameras by name. Every row has one frame of each.
        tables: Further tables with rows of their own; "control" has the columns `control/...`.
        metadata: Your own JSON-compatible metadata. Exports read "instruction", the task in words.
        versions: Versions of your own software, by name.

    Raises:
        ArgumentError: A declaration cannot be one, `metadata` is not JSON-compatible, or the folder
            is the dataset of a run, whose episodes are those of its plan.
        IoError: The episode exists already, or the disk fails.

    A wrong value is an ArgumentError that names the column; nothing was written, and the next call
    may correct it. An IoError ends the episode. A camera whose images come with the rows needs one
    for every row. Threads may share a writer: one call follows the
    other, and a row stays together with its images.

    Segmentation, stored models, ranges of columns and settings of the encoder are declared in C++
    only (`EpisodeSchema`, `EpisodeOptions`).

    Examples:
        >>> columns = {
        ...     "time": rc.data.ColumnSpec(units="s"),
        ...     "robots/ur5e/arm/qpos": rc.data.ColumnSpec(shape=6, units="rad"),
        ... }
        >>> with rc.data.EpisodeWriter("out/real", "pick-000", columns) as episode:
        ...     for i in range(3):
        ...         episode.add_row({"time": i / 30, "robots/ur5e/arm/qpos": [0.1 * i] * 6})
        ...     folder = episode.commit(success=True)
        >>> rc.Dataset("out/real")["pick-000"]["robots/ur5e/arm/qpos"].shape
        (3, 6)
    """

    def __init__(
        self,
        dataset: str | os.PathLike[str],
        id: str,
        columns: Mapping[str, ColumnSpec],
        cameras: Mapping[str, CameraStream] | None = None,
        *,
        tables: Iterable[str] = (),
        metadata: Mapping[str, Any] | None = None,
        versions: Mapping[str, str] | None = None,
    ) -> None:
        if not isinstance(id, str):
            raise ArgumentError(f"the id of an episode is a text, got {show(id)}")
        self._id = id
        self._place = f"episode '{id}'"
        self._declared = Declarations(
            self._place, tables, columns, {} if cameras is None else cameras
        )
        json_texts = metadata_text(metadata), metadata_text(versions, "versions")
        folder = Path(dataset)
        if (folder / MANIFEST).is_file():
            raise ArgumentError(
                f"'{folder}' is the dataset of a run, whose episodes are those of its plan; write "
                "into another folder"
            )
        try:
            make_folders(folder)
        except OSError as error:
            raise IoError(f"cannot create '{folder}': {error.strerror}") from error
        _remove_leftovers_of(folder, id)
        self._writer = _EpisodeWriter(folder, id, self._declared.schema, *json_texts)
        self._lock = threading.Lock()  # a row and its images are one step
        self._videos: set[str] = set()  # cameras with a finished video
        self._with_rows: set[str] = set()  # cameras whose images come with their rows
        self._is_over = False

    def add_row(
        self,
        values: Mapping[str, Any],
        frames: Mapping[str, ArrayLike] | None = None,
        *,
        table: str = STEPS,
    ) -> None:
        """Adds one row: a value for each column of the table.

        Args:
            values: The values by the names of their columns. Whole numbers fit into columns of
                floats, but not the reverse. NaN means that there is no value.
            frames: Images of cameras, as `add_frame` takes them.
            table: The table.

        Raises:
            NotFoundError: There is no such column, camera or table.
            ArgumentError: A column has no value, or one of another shape or type; or an image is
                not the next one of its camera. Neither the row nor an image was added.
            IoError: The disk fails; the episode is gone.
        """
        arrays = self._arrays(values, table, None)
        images = self._images({} if frames is None else frames, table)
        index = self._declared.table(table)
        with self._lock:
            self._require_next_images(images, table)
            self._with_rows.update(images)
            try:
                self._writer.put_rows(index, arrays, 1)
                for name, image in images.items():
                    self._writer.write_frame(self._declared.camera(name).index, image)
            except BaseException:  # such as Ctrl-C between the row and its image
                rows = self._writer.rows(index)
                if any(self._frames(name) != rows for name in images):
                    self._writer.abort()
                raise

    def add_rows(self, values: Mapping[str, ArrayLike], *, table: str = STEPS) -> None:
        """Adds rows at once: an array (rows, ...) for each column of the table.

        Raises as `add_row`.
        """
        self._declared.require_columns(table, values)
        given = {name: self._array(name, value) for name, value in values.items()}
        rows = {name: len(array) for name, array in given.items() if array.ndim}
        count = max(rows.values(), default=0)
        if len(set(rows.values())) > 1:
            short = min(rows, key=lambda name: rows[name])
            long = max(rows, key=lambda name: rows[name])
            raise ArgumentError(
                f"{self._place}: column '{short}' has {rows[short]} rows, column '{long}' has "
                f"{rows[long]}; each row needs a value of each"
            )
        arrays = self._arrays(given, table, count)
        with self._lock:
            self._writer.put_rows(self._declared.table(table), arrays, count)

    def add_frame(self, camera: str, image: ArrayLike) -> None:
        """Adds the image of the next row that has none: uint8 (height, width, 3), RGB."""
        index, pixels = self._declared.camera(camera).index, self._image(camera, image)
        with self._lock:
            self._writer.write_frame(index, pixels)

    def add_depth(self, camera: str, image: ArrayLike) -> None:
        """Adds the depth of the next row that has none: uint16 (height, width), millimetres."""
        declared = self._declared.camera(camera)
        pixels = self._pixels(camera, image, "uint16", (declared.height, declared.width))
        with self._lock:
            self._writer.write_depth(declared.index, pixels)

    def add_video(self, camera: str, file: str | os.PathLike[str]) -> None:
        """Adds all images of a camera as a finished MP4 file, which is copied.

        Every frame is decoded once. Sound in the file stays unused.

        Raises:
            ArgumentError: The file is no video of the camera's size and rate, it has several
                videos or a damaged frame, or the camera has images.
        """
        self._require_decodable(camera, file)
        self.add_checked_video(camera, file)

    def add_checked_video(self, camera: str, file: str | os.PathLike[str]) -> None:
        """Adds a video as `add_video` does, without decoding it: you did so."""
        index = self._declared.camera(camera).index
        with self._lock:
            self._writer.add_video(index, _path(file, self._place))
            self._videos.add(camera)

    def add_file(self, name: str, content: bytes | str) -> None:
        """Adds another file to the episode, such as "notes.txt"."""
        if not isinstance(name, str) or not isinstance(content, str | bytes | bytearray):
            raise ArgumentError(
                f"{self._place}: a file is a name and its content, a text or bytes, got "
                f"{show(name)} and {show(content)}"
            )
        with self._lock:
            self._writer.add_file(
                name, content.encode() if isinstance(content, str) else bytes(content)
            )

    def commit(
        self,
        success: bool,
        *,
        terminated: bool | None = None,
        truncated: bool = False,
        end_reason: str = "",
        warnings: Iterable[str] = (),
        results: Mapping[str, Any] | None = None,
        run: Mapping[str, Any] | None = None,
    ) -> Path:
        """Makes the episode visible, complete and flushed to the disk. Returns its folder.

        Args:
            success: Whether the task succeeded.
            terminated: Whether the task ended the episode; default: if it succeeded.
            truncated: Whether something else did: time, a person.
            end_reason: The reason in a word; "success" or "stopped" unless given.
            warnings: Warnings for the reader.
            results: Numbers for reports.
            run: Values that differ between equal runs: the operator, the machine.

        Raises:
            ArgumentError: There is no row, or a camera does not have one image for each row. The
                episode can still be corrected.
            IoError: The disk fails; the episode is gone.
        """
        succeeded = boolean(success, f"{self._place}: success")
        ended = (
            succeeded if terminated is None else boolean(terminated, f"{self._place}: terminated")
        )
        if not isinstance(end_reason, str):
            raise ArgumentError(f"{self._place}: end_reason is a text, got {show(end_reason)}")
        arguments = (
            succeeded,
            ended,
            boolean(truncated, f"{self._place}: truncated"),
            end_reason or ("success" if succeeded else "stopped"),
            texts(warnings, f"{self._place}: warnings"),
            metadata_text(results, "results"),
            metadata_text(run, "run"),
        )
        with self._lock:
            folder = self._writer.commit(*arguments)
            self._is_over = True
        return folder

    def abort(self) -> None:
        """Removes what was written; does nothing after `commit`."""
        self._is_over = True
        self._writer.abort()

    @property
    def id(self) -> str:
        """The episode's id."""
        return self._id

    @property
    def is_open(self) -> bool:
        """True until `commit`, `abort` or an IoError."""
        return self._writer.is_open

    def __enter__(self) -> Self:
        return self

    def __del__(self) -> None:
        """Warns of an episode that nobody ended; its files are removed."""
        if not getattr(self, "_is_over", True) and self.is_open:
            python_warnings.warn(self._gone(), RuntimeWarning, stacklevel=2)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is None and not self._is_over and self.is_open:
            python_warnings.warn(self._gone(), RuntimeWarning, stacklevel=2)
        self.abort()

    def __repr__(self) -> str:
        return f"<EpisodeWriter {self._id}: {'open' if self.is_open else 'closed'}>"

    def _gone(self) -> str:
        return (
            f"{self._place} was not committed and is gone. Call commit(success=...) before the end "
            "of the block to keep it, or abort() to drop it"
        )

    def _arrays(
        self, values: Mapping[str, Any], table: str, count: int | None
    ) -> list[tuple[int, NDArray[Any]]]:
        """Returns the column's index and the values of each column, as they are stored."""
        self._declared.require_columns(table, values)
        return [
            (column.index, self._stored(name, column, values[name], count))
            for name, column in self._declared.columns(table).items()
        ]

    def _stored(
        self, name: str, column: DeclaredColumn, value: Any, count: int | None
    ) -> NDArray[Any]:
        import numpy as np

        place = f"{self._place}: column '{name}'"
        given = self._array(name, value)
        shape = column.shape if count is None else (count, *column.shape)
        if given.shape != shape:
            raise ArgumentError(f"{place} takes the shape {shape}, got {given.shape}")
        with np.errstate(over="ignore"):  # _fits finds it
            stored = np.ascontiguousarray(given, column.dtype) if _is_number(given) else given
        if count != 0 and not _fits(given, stored, np.dtype(column.dtype)):
            raise ArgumentError(
                f"{place} was declared as {column.dtype}, which cannot store {_shown(given)}"
            )
        if column.values and stored.size and stored.max() >= column.values:
            raise ArgumentError(
                f"{place} has names for {column.values} values, 0 to {column.values - 1}, got "
                f"{stored.max()}"
            )
        return np.ascontiguousarray(stored, column.dtype)

    def _array(self, name: str, value: Any) -> NDArray[Any]:
        return _array(f"{self._place}: column '{name}'", value)

    def _images(self, frames: Any, table: str) -> dict[str, NDArray[Any]]:
        """Returns images by camera; the cameras are those of a table."""
        if not isinstance(frames, Mapping):
            raise ArgumentError(f"{self._place}: frames are {{camera: image}}, got {show(frames)}")
        for name in frames:
            own = self._declared.camera(name).table
            if own != table:
                raise ArgumentError(
                    f"{self._place}: camera '{name}' has one image for each row of table "
                    f"'{own}', not of '{table}'"
                )
        return {name: self._image(name, image) for name, image in frames.items()}

    def _require_next_images(self, images: Iterable[str], table: str) -> None:
        """Raises ArgumentError if an image would be that of another row, now or later."""
        rows = self._writer.rows(self._declared.table(table))
        for name in images:
            if name in self._videos:
                raise ArgumentError(
                    f"{self._place}: camera '{name}' has a video already, so its rows come without "
                    "images"
                )
        for name in {*images, *self._with_rows}:
            frames = self._frames(name)
            if self._declared.camera(name).table != table or not self.is_open:
                continue
            if frames < rows or (frames > rows and name in images):
                lacks = f"row {frames} of '{table}' has no image of camera '{name}'"
                has = f"row {rows} of '{table}' has an image of camera '{name}' already"
                raise ArgumentError(
                    f"{self._place}: "
                    + (f"{lacks}; add it with add_frame first" if frames < rows else has)
                )

    def _frames(self, camera: str) -> int:
        return self._writer.frames(self._declared.camera(camera).index)

    def _image(self, camera: str, image: ArrayLike) -> NDArray[Any]:
        declared = self._declared.camera(camera)
        return self._pixels(camera, image, "uint8", (declared.height, declared.width, 3))

    def _pixels(
        self, camera: str, image: ArrayLike, dtype: str, shape: tuple[int, ...]
    ) -> NDArray[Any]:
        import numpy as np

        given = _array(f"{self._place}: camera '{camera}'", image)
        if given.dtype != dtype or given.shape != shape:
            raise ArgumentError(
                f"{self._place}: images of camera '{camera}' are {dtype} of shape {shape}, got "
                f"{given.dtype} of shape {given.shape}"
            )
        return np.ascontiguousarray(given)

    def _require_decodable(self, camera: str, file: str | os.PathLike[str]) -> None:
        """Raises ArgumentError for a file with several videos or with a damaged frame."""
        from robocell.export._mp4 import Mp4
        from robocell.export._videos import require_decodable

        self._declared.camera(camera)
        path = _path(file, self._place)
        try:
            if not path.is_file():
                raise IoError(f"there is no file '{path}'")
            facts = Mp4.read(path)
            if facts.tracks != 1:
                raise IoError(f"'{path}' has {facts.tracks} videos, a camera has one")
            require_decodable(path, facts)
        except IoError as error:
            raise ArgumentError(f"{self._place}: camera '{camera}': {error}") from error


def _path(file: str | os.PathLike[str], place: str) -> Path:
    if isinstance(file, str | os.PathLike):
        return Path(file)
    raise ArgumentError(f"{place}: a video is a path, got {show(file)}")


def _remove_leftovers_of(folder: Path, id: str) -> None:
    """Removes what killed writers of an episode left; folders that are being written stay."""
    for process in _unfinished(folder.absolute()).pop(id, ()):
        remove_leftovers(folder, id, process)


@functools.lru_cache(maxsize=16)
def _unfinished(folder: Path) -> dict[str, set[int]]:
    """Returns the unfinished episodes of a folder with the processes that began them.

    A folder of many episodes is listed once by each process.
    """
    found: dict[str, set[int]] = {}
    with suppress(OSError):  # the writer says why the folder cannot be used
        for name in os.listdir(folder):
            if match := re.fullmatch(r"\.(.+)\.(\d+)\.\d+\.partial", name):
                found.setdefault(match[1], set()).add(int(match[2]))
    return found


def _array(place: str, value: Any) -> NDArray[Any]:
    """Returns a value as an array; raises ArgumentError if it is none, or has masked numbers."""
    import numpy as np

    if np.ma.is_masked(value):
        raise ArgumentError(f"{place}: the value has masked numbers; write NaN where there is none")
    try:
        return np.asarray(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise ArgumentError(f"{place}: the value is no array: {error}") from error


def _is_number(given: NDArray[Any]) -> bool:
    return given.dtype.kind in "fiub"


def _fits(given: NDArray[Any], stored: NDArray[Any], dtype: Any) -> bool:
    """Returns True if numbers are stored as another type without a change of meaning."""
    import numpy as np

    if dtype.kind == "b" or given.dtype.kind == "b":
        return dtype.kind == given.dtype.kind
    if dtype.kind == "f":
        return given.dtype.kind in "fiu" and bool((np.isfinite(stored) | ~np.isfinite(given)).all())
    if given.dtype.kind not in "iu":
        return False
    limits = np.iinfo(dtype)
    return not given.size or bool(given.min() >= limits.min and given.max() <= limits.max)


def _shown(given: NDArray[Any]) -> str:
    """Returns "float64 0.5", or the type alone for an array."""
    return f"{given.dtype} {given[()]}" if given.ndim == 0 else f"an array of {given.dtype}"
