"""The steps of a dataset as training items: observations, and the actions that follow.

    steps = Steps(dataset, {"robots/rc7/arm/qpos": 0, "robots/rc7/action/arm": range(16)})
    steps[0]["robots/rc7/arm/qpos"]  # (7,), of the first row of the first episode
    steps[0]["robots/rc7/action/arm"]  # (16, 7), of this row and the next 15
    steps[0]["robots/rc7/action/arm_is_pad"]  # (16,) bool: rows beyond the episode

Arrays are numpy arrays; ``torch_dataset`` returns the same items as tensors.
"""

from __future__ import annotations

import bisect
import functools
import operator
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError, Dataset, Episode, NotFoundError
from robocell._extras import needed_by
from robocell._suggestions import counted, did_you_mean, fitting, is_pattern

if TYPE_CHECKING:
    from robocell.data._torch import TorchSteps

Array = NDArray[Any]
Item = dict[str, Any]
Offsets = int | Sequence[int]
Keys = Mapping[str, Offsets] | Iterable[str]

PAD = "_is_pad"
# Keys of every item, beside the requested ones.
EPISODE, ROW = "episode", "row"


@dataclass(frozen=True)
class Key:
    """A column or image stream of every item.

    Attributes:
        name: Name in the episodes.
        offsets: The rows, relative to the item's own row.
        is_single: Whether there is one row, without a time axis.
        kind: "column", "constant", or for an image stream "rgb", "depth", "segmentation".
        camera: Camera of an image stream.
    """

    name: str
    offsets: tuple[int, ...]
    is_single: bool
    kind: str
    camera: str = ""

    @property
    def is_image(self) -> bool:
        """True if the key is read from a video."""
        return self.kind not in ("column", "constant")


class Steps:
    """The steps of all episodes of a dataset, as a sequence of items.

    Item ``i`` is one row of one episode: a dictionary with an array for each key, and the integers
    ``episode`` (its index in the dataset) and ``row``. Items of an episode follow each other. Only
    the rows and images of the item are read from the disk.

    A key with one offset is the value of that row. A key with several offsets has an axis for them
    in front, and beside it ``<key>_is_pad``: True where the episode has no such row. The nearest
    row, the first or the last, replaces it.

    Steps can be pickled, and used in forked and spawned processes.

    Args:
        dataset: A dataset, one of its slices, or a folder.
        keys: The columns of the table ``steps``, constants and image streams, with the rows of each
            as offsets from the item's own row: 0, ``[-1, 0]`` for the row before as well,
            ``range(16)`` for a chunk of actions. A list of names means offset 0. "*" stands for any
            part of the name of a column of ``steps``, as in ``rows``.
        open_episodes: Number of episodes that stay open between items.

    Raises:
        NotFoundError: The first episode has no such column or stream; the message has the nearest.
        ArgumentError: There are no episodes, or the offsets are invalid.

    Examples:
        >>> keys = {"robots/rc7/arm/qpos": 0, "robots/rc7/action/arm": range(16)}
        >>> steps = rc.data.Steps(dataset, keys)
        >>> steps[0]["robots/rc7/action/arm"].shape
        (16, 7)
    """

    def __init__(
        self,
        dataset: Dataset | str | os.PathLike[str],
        keys: Keys,
        open_episodes: int = 64,
    ) -> None:
        self.dataset = dataset if isinstance(dataset, Dataset) else Dataset(os.fspath(dataset))
        if len(self.dataset) == 0:
            raise ArgumentError(f"dataset '{self.dataset.folder}' has no episodes")
        given = keys if isinstance(keys, Mapping) else dict.fromkeys(_names(keys), 0)
        wanted = _named(self.dataset[0], given)
        self.keys = [_key(self.dataset[0], name, offsets) for name, offsets in wanted.items()]
        _require_own_names(self.keys)
        self._open_episodes = open_episodes
        self._ends = np.cumsum([len(episode) for episode in self.dataset]).tolist()
        self._prepare()

    def _prepare(self) -> None:
        self._open = functools.lru_cache(self._open_episodes)(self.dataset.__getitem__)
        self._frame_indices = functools.lru_cache(self._open_episodes)(self._frames_of_rows)

    def __getstate__(self) -> dict[str, Any]:
        own = self.__dict__.copy()
        del own["_open"], own["_frame_indices"]
        return own

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._prepare()

    @property
    def starts(self) -> list[int]:
        """The index of the first item of each episode."""
        return [0, *self._ends[:-1]]

    def __len__(self) -> int:
        return int(self._ends[-1])

    def locate(self, index: int) -> tuple[int, int]:
        """Returns the place of an item's episode in the dataset, and its row."""
        place = operator.index(index)
        if place < -len(self) or place >= len(self):
            raise IndexError(
                f"no step {index}: dataset '{self.dataset.folder}' has "
                f"{counted(len(self), 'step')} in {counted(len(self.dataset), 'episode')}"
            )
        place %= len(self)
        episode = bisect.bisect_right(self._ends, place)
        return episode, place - (self._ends[episode - 1] if episode else 0)

    def __getitem__(self, index: int) -> Item:
        episode, row = self.locate(index)
        opened = self._open(episode)
        item: Item = {}
        for key in self.keys:
            _add(item, key, self._read(opened, episode, key, row))
        item[EPISODE], item[ROW] = episode, row
        return item

    def _read(self, episode: Episode, place: int, key: Key, row: int) -> tuple[Array, Array]:
        """Returns the values at the key's rows, and which of the rows are beyond the episode."""
        if key.kind == "constant":
            return episode[key.name][None], np.zeros(1, bool)
        rows = row + np.array(key.offsets)
        there = np.clip(rows, 0, len(episode) - 1)
        missing = there != rows
        if not key.is_image:
            _require_table(episode, key.name)
            return episode.column(key.name)[there], missing
        frames = self._frame_indices(place, key.camera)[there]
        images = [episode.frame(key.name, int(frame)) for frame in np.maximum(frames, 0)]
        return np.stack(images), missing | (frames < 0)

    def _frames_of_rows(self, place: int, camera: str) -> Array:
        return self._open(place).frames_of_rows(camera)

    def __getitems__(self, indices: Sequence[int]) -> list[Item]:
        """Returns several items, read in the order of the disk, so that decoders go forward."""
        order = sorted(range(len(indices)), key=lambda i: self.locate(indices[i]))
        items: list[Item] = [{}] * len(indices)
        for i in order:
            items[i] = self[indices[i]]
        return items

    def __repr__(self) -> str:
        names = ", ".join(key.name for key in self.keys)
        return f"<Steps of {self.dataset.folder}: {len(self)} of {names}>"


def torch_dataset(
    dataset: Dataset | str | os.PathLike[str],
    keys: Keys,
    dtype: str = "float32",
    transform: Callable[[Item], Any] | None = None,
    open_episodes: int = 64,
) -> TorchSteps:
    """Returns the steps of a dataset as a ``torch.utils.data.Dataset``, for a ``DataLoader``.

    Items are those of ``Steps`` as tensors. Real numbers have the type ``dtype``. Colour images are
    uint8 (3, H, W), depth is float32 (1, H, W) in metres with 0 where nothing was hit, segmentation
    is int32 (1, H, W). ``DataLoader(steps, batch_size=64, shuffle=True, num_workers=2)`` works with
    forked and with spawned workers.

    Args:
        dataset: As in ``Steps``.
        keys: As in ``Steps``.
        dtype: The type of real numbers: "float32", "float64" or "float16".
        transform: Function of each item, a dictionary of tensors; it runs in the workers.
        open_episodes: As in ``Steps``.

    Raises:
        ModuleNotFoundError: torch is missing; the message has the command that installs it.
    """
    without = "Without it: robocell.data.Steps gives the same items as numpy arrays"
    with needed_by("robocell.data.torch_dataset", "torch", without):
        from robocell.data._torch import TorchSteps
    return TorchSteps(Steps(dataset, keys, open_episodes), dtype, transform)


def _names(keys: Iterable[str]) -> list[str]:
    if isinstance(keys, str):
        raise ArgumentError(f"keys are a list of names or a dictionary, got the text '{keys}'")
    return list(keys)


def _named(episode: Episode, wanted: Mapping[str, Offsets]) -> dict[str, Offsets]:
    """Returns the keys, with patterns replaced by the matching columns of the first episode."""
    if not any(is_pattern(name) for name in wanted):
        return dict(wanted)
    known = [name for name in episode.columns if episode.column(name).table == "steps"]
    named: dict[str, Offsets] = {}
    for name, offsets in wanted.items():
        named |= dict.fromkeys(fitting(f"episode '{episode.folder}'", [name], known), offsets)
    return named


def _key(episode: Episode, name: str, offsets: Offsets) -> Key:
    is_single = not isinstance(offsets, Sequence | np.ndarray)
    several: Any = [offsets] if is_single else offsets
    try:
        rows = tuple(operator.index(row) for row in several)
    except TypeError:
        rows = ()
    if not rows:
        raise ArgumentError(
            f"key '{name}': its rows are {offsets!r}; they are an integer such as 0, or a list of "
            "integers such as [-1, 0] or range(16)"
        )
    _require_known(episode, name)
    if name in episode.streams:
        return Key(name, rows, is_single, *_kind_and_camera(episode, name))
    if episode.column(name).table == "":
        if rows != (0,) or not is_single:
            raise ArgumentError(f"key '{name}' is a constant, without rows: its offset is 0")
        return Key(name, rows, True, "constant")
    _require_table(episode, name)
    return Key(name, rows, is_single, "column")


def _require_known(episode: Episode, name: str) -> None:
    known = [*episode.columns, *episode.streams]
    if name in known:
        return
    raise NotFoundError(
        f"episode '{episode.folder}': no column or image stream '{name}'."
        f"{did_you_mean(name, known)} Its `columns` and `streams` list them; the streams: "
        f"{', '.join(episode.streams) or 'none'}"
    )


def _kind_and_camera(episode: Episode, stream: str) -> tuple[str, str]:
    if stream in episode.cameras:
        return "rgb", stream
    camera, _, kind = stream.rpartition(".")
    return kind, camera


def _require_table(episode: Episode, name: str) -> None:
    table = episode.column(name).table
    if table != "steps":
        raise ArgumentError(
            f"episode '{episode.folder}': column '{name}' is of table '{table}', whose rows are "
            "not those of the steps"
        )


def _require_own_names(keys: list[Key]) -> None:
    if not keys:
        raise ArgumentError("there are no keys: name the columns and image streams of an item")
    own = [EPISODE, ROW]
    for key in keys:
        own += [key.name] if key.is_single else [key.name, key.name + PAD]
    twice = sorted({name for name in own if own.count(name) > 1})
    if twice:
        raise ArgumentError(f"an item would have '{twice[0]}' twice")


def _add(item: Item, key: Key, read: tuple[Array, Array]) -> None:
    values, missing = read
    item[key.name] = values[0] if key.is_single else values
    if not key.is_single:
        item[key.name + PAD] = missing
