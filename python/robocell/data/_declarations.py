"""Columns and cameras of an episode that is written row by row: their declarations."""

from __future__ import annotations

import math
import numbers
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from robocell._arguments import show
from robocell._core import ArgumentError, NotFoundError, _EpisodeSchema
from robocell._quantities import require_units
from robocell._suggestions import did_you_mean, shortened

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

STEPS = "steps"
TYPES = ("float64", "float32", "int64", "int32", "uint8", "bool")
LARGEST_DENOMINATOR = 1001  # of a rate that is given as a float: 30000/1001
MOST_AXES = 16
MOST_NUMBERS = 2**18  # of a row
LARGEST = 2**31 - 1  # of a size and of both numbers of a rate


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

    Examples:
        >>> rc.data.ColumnSpec(shape=3, units="N", frame="world", names=["x", "y", "z"]).dtype
        'float64'
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

    Examples:
        >>> rc.data.CameraStream(width=640, height=480, depth=True).fps
        30
    """

    width: int
    height: int
    fps: float | Fraction = 30
    intrinsics: ArrayLike | None = None
    depth: bool = False
    table: str = STEPS


@dataclass(frozen=True)
class DeclaredColumn:
    """A column of a table.

    Attributes:
        index: Its index there.
        dtype: Type of its numbers.
        shape: Shape of one row.
        values: Number of values that have a name; 0 without names.
    """

    index: int
    dtype: str
    shape: tuple[int, ...]
    values: int


@dataclass(frozen=True)
class DeclaredCamera:
    """A camera of a table.

    Attributes:
        index: Its index in the episode.
        table: Its table.
        width: In pixels.
        height: In pixels.
        depth: Whether it has depth.
    """

    index: int
    table: str
    width: int
    height: int
    depth: bool


class Declarations:
    """The tables, columns and cameras of an episode.

    Args:
        place: What messages begin with: "episode 'a'".
        tables: Names of further tables.
        columns: The columns by name.
        cameras: The cameras by name.

    Raises:
        ArgumentError: One cannot be declared.
        NotFoundError: A camera names an unknown table.
    """

    def __init__(
        self,
        place: str,
        tables: Iterable[str],
        columns: Mapping[str, ColumnSpec],
        cameras: Mapping[str, CameraStream],
    ) -> None:
        self._place = place
        self.schema = _EpisodeSchema()
        self._tables = {STEPS: 0}
        for name in texts(tables, f"{place}: tables"):
            self._tables[name] = self.schema.add_table(name)
        self._columns: dict[str, dict[str, DeclaredColumn]] = {name: {} for name in self._tables}
        for name, column in _named(columns, ColumnSpec, f"{place}: columns").items():
            self._declare(name, column)
        self._cameras: dict[str, DeclaredCamera] = {}
        for name, camera in _named(cameras, CameraStream, f"{place}: cameras").items():
            if f"cameras/{name}" in self._columns[STEPS]:
                raise ArgumentError(
                    f"{place}: column 'cameras/{name}' has the name of the group of camera '{name}'"
                )
            self._cameras[name] = self._declare_camera(name, camera)
        for name, own in self._columns.items():
            has_camera = any(camera.table == name for camera in self._cameras.values())
            if name != STEPS and not own and not has_camera:
                prefixes = [each.partition("/")[0] for each in self._columns[STEPS]]
                raise ArgumentError(
                    f"{place}: table '{name}' has no column; its columns are called '{name}/...'."
                    f"{did_you_mean(name, prefixes)}"
                )

    def table(self, name: str) -> int:
        """Returns the index of a table."""
        return self._tables[self._known("table", name, self._tables)]

    def columns(self, table: str) -> Mapping[str, DeclaredColumn]:
        """Returns the columns of a table by their full names."""
        return self._columns[self._known("table", table, self._tables)]

    def camera(self, name: str) -> DeclaredCamera:
        """Returns a camera."""
        return self._cameras[self._known("camera", name, self._cameras)]

    def require_columns(self, table: str, values: Any) -> None:
        """Raises an error unless values are a mapping with exactly the columns of a table."""
        columns = self.columns(table)
        if not isinstance(values, Mapping):
            raise ArgumentError(f"{self._place}: a row takes {{column: value}}, got {show(values)}")
        for name in values:
            self._known(f"column of table '{table}'", name, columns)
        if missing := [name for name in columns if name not in values]:
            raise ArgumentError(
                f"{self._place}: a row of table '{table}' has no value for {shortened(missing)}; "
                "each row has one for each column; a float without one is NaN"
            )

    def _known(self, what: str, name: Any, known: Iterable[str]) -> str:
        names = list(known)
        if not isinstance(name, str):
            raise ArgumentError(f"{self._place}: the name of a {what} is a text, got {show(name)}")
        if name in names:
            return name
        raise NotFoundError(
            f"{self._place}: no {what} '{name}'.{did_you_mean(name, names)} Declared: "
            f"{shortened(names) or 'none'}"
        )

    def _declare(self, name: str, column: ColumnSpec) -> None:
        place = f"{self._place}: column '{name}'"
        table, short = STEPS, name
        first, slash, rest = name.partition("/")
        if slash and first == STEPS:
            raise ArgumentError(
                f"{place}: columns of the table '{STEPS}' have no prefix; call it '{rest}'"
            )
        if slash and first in self._tables:
            table, short = first, rest
        dtype, shape = _type(place, column.dtype), _shape(place, column.shape)
        values = texts(column.values, f"{place}: values")
        require_units(place, _text(column.units, f"{place}: units"))
        index = self.schema.add_column(
            self._tables[table],
            short,
            dtype,
            shape,
            column.units,
            _text(column.frame, f"{place}: frame"),
            texts(column.names, f"{place}: names"),
            values,
            _text(column.description, f"{place}: description"),
        )
        self._columns[table][name] = DeclaredColumn(index, dtype, shape, len(values))

    def _declare_camera(self, name: str, camera: CameraStream) -> DeclaredCamera:
        place = f"{self._place}: camera '{name}'"
        width = whole(camera.width, f"{place}: width")
        height = whole(camera.height, f"{place}: height")
        depth = boolean(camera.depth, f"{place}: depth")
        rate = _rate(place, camera.fps)
        index = self.schema.add_camera(
            self.table(camera.table),
            name,
            width,
            height,
            (rate.numerator, rate.denominator),
            _intrinsics(place, camera.intrinsics),
            depth,
        )
        return DeclaredCamera(index, camera.table, width, height, depth)


def boolean(value: Any, what: str) -> bool:
    """Returns True or False, also of NumPy's; raises ArgumentError for anything else."""
    import numpy as np

    if isinstance(value, bool | np.bool_):
        return bool(value)
    raise ArgumentError(f"{what} is True or False, got {show(value)}")


def whole(value: Any, what: str) -> int:
    """Returns a whole number; raises ArgumentError for anything else."""
    if isinstance(value, numbers.Integral) and not isinstance(value, bool):
        if abs(int(value)) <= LARGEST:
            return int(value)
        raise ArgumentError(f"{what} is at most {LARGEST}, got {int(value)}")
    raise ArgumentError(f"{what} is a whole number, got {show(value)}")


def texts(value: Any, what: str) -> list[str]:
    """Returns a list of texts; raises ArgumentError for anything else, such as a single text."""
    found = [] if isinstance(value, str) or not isinstance(value, Iterable) else list(value)
    is_list = not isinstance(value, str) and isinstance(value, Iterable)
    if is_list and all(isinstance(each, str) for each in found):
        return found
    raise ArgumentError(f"{what} is a list of texts, got {show(value)}")


def _text(value: Any, what: str) -> str:
    if isinstance(value, str):
        return value
    raise ArgumentError(f"{what} is a text, got {show(value)}")


def _named(given: Any, kind: type, what: str) -> dict[str, Any]:
    """Returns a mapping of names to declarations of a kind; raises ArgumentError otherwise."""
    if not isinstance(given, Mapping):
        raise ArgumentError(f"{what} are {{name: {kind.__name__}(...)}}, got {show(given)}")
    for name, value in given.items():
        if not isinstance(name, str):
            raise ArgumentError(f"{what}: a name is a text, got {show(name)}")
        if not isinstance(value, kind):
            raise ArgumentError(f"{what}: '{name}' is a {kind.__name__}, got {show(value)}")
    return dict(given)


def _type(place: str, given: Any) -> str:
    """Returns the name of a column's type, which may be one of NumPy's."""
    import numpy as np

    name = str(given)
    if given is not None and not isinstance(given, str):
        with suppress(TypeError):
            name = np.dtype(given).name
    if name not in TYPES:
        raise ArgumentError(f"{place}: '{name}' is not a type of columns: {', '.join(TYPES)}")
    return name


def _shape(place: str, given: Any) -> tuple[int, ...]:
    if isinstance(given, str) or not isinstance(given, Iterable):
        given = (given,)
    shape = tuple(whole(each, f"{place}: each number of the shape") for each in given)
    if len(shape) > MOST_AXES or math.prod(shape) > MOST_NUMBERS:
        raise ArgumentError(
            f"{place}: shape {shape} is too large: a row has at most {MOST_AXES} axes and "
            f"{MOST_NUMBERS} numbers. Images belong into cameras"
        )
    return shape


def _rate(place: str, fps: Any) -> Fraction:
    """Returns the rate of a camera; that of a float is the nearest of short fractions."""
    rate: Fraction | None = None
    if isinstance(fps, numbers.Rational) and not isinstance(fps, bool):
        rate = Fraction(int(fps.numerator), int(fps.denominator))
    elif isinstance(fps, numbers.Real) and not isinstance(fps, bool) and math.isfinite(fps):
        rate = Fraction(float(fps)).limit_denominator(LARGEST_DENOMINATOR)
    if rate is None or rate <= 0 or max(rate.numerator, rate.denominator) > LARGEST:
        raise ArgumentError(
            f"{place}: fps is a number above 0, such as 30 or Fraction(30000, 1001), got "
            f"{show(fps)}"
        )
    return rate


def _intrinsics(place: str, given: Any) -> list[float] | None:
    import numpy as np

    if given is None:
        return None
    try:
        matrix = np.asarray(given, np.float64)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"{place}: intrinsics are no array of numbers: {error}") from error
    if matrix.shape != (3, 3):
        raise ArgumentError(f"{place}: intrinsics are a 3x3 matrix, got the shape {matrix.shape}")
    if not np.isfinite(matrix).all():
        raise ArgumentError(f"{place}: intrinsics must be finite, got {matrix.tolist()}")
    return [float(each) for each in matrix.ravel()]
