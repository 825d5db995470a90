"""Episodes row by row, from a real robot or any other source."""

from __future__ import annotations

import os
import warnings as python_warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from robocell._core import ArgumentError, IoError, NotFoundError, _EpisodeSchema, _EpisodeWriter
from robocell._suggestions import did_you_mean, shortened
from robocell.data._metadata import metadata_text

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

STEPS = "steps"
LARGEST_DENOMINATOR = 1001  # of a rate that is given as a float: 30000/1001


@dataclass(frozen=True)
class ColumnSpec:
    """The declaration of a column.

    Attributes:
        dtype: "float64", "float32", "int64", "int32", "uint8" or "bool".
        shape: Shape of one row: () for a number, 7 or (7,) for a vector.
        units: "rad", "m", "1", or "m, 1" for a position with a quaternion.
        frame: Frame that the values are expressed in: "world".
        names: Names of the components along the last axis.
        values: Names of the integers 0, 1, ...
        description: A sentence, if the name is not enough.
    """

    dtype: str = "float64"
    shape: int | Sequence[int] = ()
    units: str = ""
    frame: str = ""
    names: Sequence[str] = ()
    values: Sequence[str] = ()
    description: str = ""


@dataclass(frozen=True)
class CameraStream:
    """The declaration of a camera: a colour video, with depth beside it if wanted.

    Attributes:
        width: In pixels, even.
        height: In pixels, even.
        fps: Rows per second of its table; the rate at which the video is played.
        intrinsics: 3x3, pixels, OpenCV axes.
        depth: Adds a lossless video of depth in millimetres.
        table: Its table: one frame for each row.
    """

    width: int
    height: int
    fps: float | Fraction = 30
    intrinsics: ArrayLike | None = None
    depth: bool = False
    table: str = STEPS


@dataclass(frozen=True)
class _Column:
    """A column of a table: its index there, and what a row of it is."""

    index: int
    dtype: str
    shape: tuple[int, ...]


class EpisodeWriter:
    """Writes one episode, row by row: what a real robot did, or another simulator.

    Nothing is visible before `commit`, which verifies the files and flushes them to the disk.
    Without it the end of the block removes what was written, with a warning; so do `abort`, an
    exception that leaves the block, and a crash.

    Args:
        dataset: Folder of the dataset; created if missing.
        id: The episode's id, its folder's name.
        columns: The declared columns by name. Every row gives each column of its table a value.
        cameras: The declared cameras by name. Every row has one frame of each.
        tables: Further tables with rows of their own; "control" has the columns `control/...`.
        metadata: Your own JSON-compatible metadata. Exports read "instruction", the task in words.
        versions: Versions of your own software, by name.

    Raises:
        ArgumentError: A declaration cannot be one, or `metadata` is not JSON-compatible.
        IoError: The episode exists already, or the disk fails.

    A wrong value is an ArgumentError that names the column; nothing was written, and the next call
    may correct it. An IoError ends the episode.

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
        self._id = id
        self._place = f"episode '{id}'"
        schema = _EpisodeSchema()
        self._tables = {STEPS: 0} | {name: schema.add_table(name) for name in tables}
        self._columns: dict[str, dict[str, _Column]] = {name: {} for name in self._tables}
        for name, column in columns.items():
            self._declare(schema, name, column)
        self._cameras: dict[str, tuple[int, CameraStream]] = {}
        for name, camera in (cameras or {}).items():
            self._cameras[name] = (self._declare_camera(schema, name, camera), camera)
        texts = metadata_text(metadata), metadata_text(versions, "versions")
        folder = Path(dataset)
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise IoError(f"cannot create '{folder}': {error.strerror}") from error
        self._writer = _EpisodeWriter(folder, id, schema, *texts)
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
            ArgumentError: A column has no value, or one of another shape or type.
            IoError: The disk fails; the episode is gone.
        """
        arrays = self._arrays(values, table, None)
        images = [self._image(camera, frame) for camera, frame in (frames or {}).items()]
        self._writer.put_rows(self._tables[table], arrays, 1)
        for index, image in images:
            self._writer.write_frame(index, image)

    def add_rows(self, values: Mapping[str, ArrayLike], *, table: str = STEPS) -> None:
        """Adds rows at once: an array (rows, ...) for each column of the table.

        Raises as `add_row`.
        """
        import numpy as np

        given = {name: np.asarray(value) for name, value in values.items()}
        count = max((len(array) for array in given.values() if array.ndim), default=0)
        arrays = self._arrays(given, table, count)
        self._writer.put_rows(self._tables[table], arrays, count)

    def add_frame(self, camera: str, image: ArrayLike) -> None:
        """Adds the image of the next row that has none: uint8 (height, width, 3), RGB."""
        self._writer.write_frame(*self._image(camera, image))

    def add_depth(self, camera: str, image: ArrayLike) -> None:
        """Adds the depth of the next row that has none: uint16 (height, width), millimetres."""
        index, stream = self._camera(camera)
        shape = (stream.height, stream.width)
        self._writer.write_depth(index, self._pixels(camera, image, "uint16", shape))

    def add_video(self, camera: str, file: str | os.PathLike[str]) -> None:
        """Adds all images of a camera as a finished MP4 file, which is copied.

        Raises:
            ArgumentError: The file is no video of the camera's size and rate, or there are images.
        """
        self._writer.add_video(self._camera(camera)[0], Path(file))

    def add_file(self, name: str, content: bytes | str) -> None:
        """Adds another file to the episode, such as "notes.txt"."""
        self._writer.add_file(name, content.encode() if isinstance(content, str) else content)

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
        folder = self._writer.commit(
            success,
            success if terminated is None else terminated,
            truncated,
            end_reason or ("success" if success else "stopped"),
            list(warnings),
            metadata_text(results, "results"),
            metadata_text(run, "run"),
        )
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

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is None and not self._is_over and self.is_open:
            python_warnings.warn(
                f"{self._place} was not committed and is gone. Call commit(success=...) before the "
                "end of the block to keep it, or abort() to drop it",
                RuntimeWarning,
                stacklevel=2,
            )
        self.abort()

    def __repr__(self) -> str:
        return f"<EpisodeWriter {self._id}: {'open' if self.is_open else 'closed'}>"

    def _declare(self, schema: _EpisodeSchema, name: str, column: ColumnSpec) -> None:
        table, short = STEPS, name
        first, slash, rest = name.partition("/")
        if slash and first in self._tables:
            table, short = first, rest
        shape = (column.shape,) if isinstance(column.shape, int) else tuple(column.shape)
        for what in ("names", "values"):
            if isinstance(getattr(column, what), str):
                raise ArgumentError(f"{self._place}: column '{name}': {what} is a list of texts")
        index = schema.add_column(
            self._tables[table],
            short,
            column.dtype,
            shape,
            column.units,
            column.frame,
            list(column.names),
            list(column.values),
            column.description,
        )
        self._columns[table][name] = _Column(index, column.dtype, shape)

    def _declare_camera(self, schema: _EpisodeSchema, name: str, camera: CameraStream) -> int:
        import numpy as np

        intrinsics = None
        if camera.intrinsics is not None:
            matrix = np.asarray(camera.intrinsics, np.float64)
            if matrix.shape != (3, 3):
                raise ArgumentError(
                    f"{self._place}: camera '{name}': intrinsics are a 3x3 matrix, got the shape "
                    f"{matrix.shape}"
                )
            intrinsics = matrix.ravel().tolist()
        rate = Fraction(camera.fps)
        if isinstance(camera.fps, float):
            rate = rate.limit_denominator(LARGEST_DENOMINATOR)
        return schema.add_camera(
            self._table(camera.table),
            name,
            camera.width,
            camera.height,
            (rate.numerator, rate.denominator),
            intrinsics,
            camera.depth,
        )

    def _table(self, name: str) -> int:
        if name not in self._tables:
            raise _no_such(self._place, "table", name, self._tables)
        return self._tables[name]

    def _camera(self, name: str) -> tuple[int, CameraStream]:
        if name not in self._cameras:
            raise _no_such(self._place, "camera", name, self._cameras)
        return self._cameras[name]

    def _arrays(
        self, values: Mapping[str, Any], table: str, count: int | None
    ) -> list[tuple[int, NDArray[Any]]]:
        """Returns the column's index and the values of each column, as they are stored."""
        self._table(table)
        columns = self._columns[table]
        for name in values:
            if name not in columns:
                raise _no_such(self._place, f"column of table '{table}'", name, columns)
        if missing := [name for name in columns if name not in values]:
            raise ArgumentError(
                f"{self._place}: a row of table '{table}' has no value for {shortened(missing)}; "
                "each row has one for each column, NaN where there is none"
            )
        return [
            (column.index, self._stored(name, column, values[name], count))
            for name, column in columns.items()
        ]

    def _stored(self, name: str, column: _Column, value: Any, count: int | None) -> NDArray[Any]:
        import numpy as np

        place = f"{self._place}: column '{name}'"
        try:
            given = np.asarray(value)
        except ValueError as error:
            raise ArgumentError(f"{place}: the value is no array: {error}") from error
        shape = column.shape if count is None else (count, *column.shape)
        if given.shape != shape:
            raise ArgumentError(f"{place} takes the shape {shape}, got {given.shape}")
        if count != 0 and not _fits(given, np.dtype(column.dtype)):
            raise ArgumentError(
                f"{place} was declared as {column.dtype}, which cannot store {_shown(given)}"
            )
        return np.ascontiguousarray(given, column.dtype)

    def _image(self, camera: str, image: ArrayLike) -> tuple[int, NDArray[Any]]:
        index, stream = self._camera(camera)
        return index, self._pixels(camera, image, "uint8", (stream.height, stream.width, 3))

    def _pixels(
        self, camera: str, image: ArrayLike, dtype: str, shape: tuple[int, ...]
    ) -> NDArray[Any]:
        import numpy as np

        given = np.asarray(image)
        if given.dtype != dtype or given.shape != shape:
            raise ArgumentError(
                f"{self._place}: images of camera '{camera}' are {dtype} of shape {shape}, got "
                f"{given.dtype} of shape {given.shape}"
            )
        return np.ascontiguousarray(given)


def _fits(given: NDArray[Any], dtype: Any) -> bool:
    """Returns True if numbers of a kind can be stored as another without a change of meaning."""
    import numpy as np

    if dtype.kind == "b" or given.dtype.kind == "b":
        return dtype.kind == given.dtype.kind
    if dtype.kind == "f":
        return given.dtype.kind in "fiu"
    if given.dtype.kind not in "iu":
        return False
    limits = np.iinfo(dtype)
    return not given.size or bool(given.min() >= limits.min and given.max() <= limits.max)


def _shown(given: NDArray[Any]) -> str:
    """Returns "float64 0.5", or the type alone for an array."""
    return f"{given.dtype} {given[()]}" if given.ndim == 0 else f"an array of {given.dtype}"


def _no_such(place: str, what: str, name: str, known: Iterable[str]) -> NotFoundError:
    names = list(known)
    return NotFoundError(
        f"{place}: no {what} '{name}'.{did_you_mean(name, names)} Declared: "
        f"{shortened(names) or 'none'}"
    )
