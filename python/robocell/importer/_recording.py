"""One recording of another dataset, on its way to an episode: columns, images, task, result."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any, Protocol

from numpy.typing import NDArray


@dataclass(frozen=True)
class Clip:
    """Consecutive frames of an MP4 file.

    Attributes:
        file: The file.
        first: Index of the first frame.
        fps: Frame rate of the file.
    """

    file: Path
    first: int
    fps: Fraction


@dataclass(frozen=True)
class Stills:
    """Images in a row: blocks of pixels (n, height, width, 3), or one PNG or JPEG file each."""

    blocks: Iterator[Any]


@dataclass(frozen=True)
class Column:
    """A column with a row for each step.

    Attributes:
        values: (rows, ...) numbers.
        names: Names of the components; empty for none.
    """

    values: NDArray[Any]
    names: tuple[str, ...] = ()


@dataclass(frozen=True)
class Recording:
    """A recording.

    Attributes:
        task: Its instruction; "" for none.
        rows: Its length.
        columns: Reads each column, by its name in the source.
        images: Images by their names in the source, one for each row.
        metadata: More about it, for the episode's metadata.
    """

    task: str
    rows: int
    columns: dict[str, Callable[[], Column]]
    images: dict[str, Clip | Stills] = field(default_factory=dict)
    metadata: dict[str, Any] = field(default_factory=dict)


class Origin(Protocol):
    """A dataset of another format.

    Attributes:
        title: How messages call its format.
        rate: Rows per second; None if it does not say.
        robots: Names of the robots; "" if it does not say.
        fingerprint: Differs when a file of the dataset was changed.
        gaps: Which numbers its recordings skip, "no 1 between episode_0 and episode_2"; "" for
            none.
    """

    title: str
    rate: Fraction | None
    robots: str
    fingerprint: str
    gaps: str

    def __len__(self) -> int:
        """The number of recordings."""

    def read(self, index: int) -> Recording:
        """Reads a recording; columns and images are read when they are needed."""

    def column_name(self, name: str) -> str | None:
        """Returns the column of an episode for a name of the format; None to leave it out."""
