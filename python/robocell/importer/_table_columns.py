"""Numbers of a column of a Parquet table, as the feature of a LeRobot dataset describes them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import IoError
from robocell._extras import needed_by
from robocell.importer._entries import Entries
from robocell.importer._foreign_files import ADVICE, reading

with needed_by("robocell.importer", "export"):
    import pyarrow as pa
    import pyarrow.compute as pc


def numbers_of(column: Any, feature: Entries, place: str) -> NDArray[Any]:
    """Returns (rows, ...) numbers of the feature's type.

    Args:
        column: The column, of numbers or of lists.
        feature: Its entries `dtype` and `shape`.
        place: Where it is, which begins messages.

    Raises:
        IoError: It has another shape, no numbers, or numbers that the type does not have.
    """
    rows = len(column)
    with reading(place):
        shape, values = _flat(column, place)
        found = values.to_numpy(zero_copy_only=False)
    wanted = _shape(feature)
    if shape != wanted and (shape, wanted) not in (((), (1,)), ((1,), ())):
        raise IoError(f"{place} has the shape {shape}; expected {wanted}: {ADVICE}")
    kind = _kind(feature)
    with np.errstate(all="ignore"):
        numbers = found.astype(kind)
    if kind.kind != "f" and not np.array_equal(numbers, found):
        raise IoError(f"{place} has numbers that are no {kind}: {ADVICE}")
    return numbers.reshape(rows, *shape)


def _flat(column: Any, place: str) -> tuple[tuple[int, ...], Any]:
    """Returns the shape of each row, and all numbers one after the other."""
    values = column.combine_chunks()
    shape: list[int] = []
    kinds = pa.types
    while (
        kinds.is_list(values.type)
        or kinds.is_large_list(values.type)
        or kinds.is_fixed_size_list(values.type)
    ):
        sizes = pc.unique(pc.list_value_length(values)).to_pylist()
        if len(sizes) > 1 or None in sizes:
            raise IoError(f"{place} has rows of different lengths: {ADVICE}")
        shape.append(sizes[0] if sizes else 0)
        values = values.flatten()
    is_number = (
        kinds.is_integer(values.type)
        or kinds.is_floating(values.type)
        or kinds.is_boolean(values.type)
    )
    if not is_number or values.null_count:
        what = "empty entries" if is_number else f"the type {values.type}"
        raise IoError(f"{place} has {what}; expected numbers: {ADVICE}")
    return tuple(shape), values


def _shape(feature: Entries) -> tuple[int, ...]:
    shape = feature.content.get("shape")
    if not isinstance(shape, list) or not all(type(size) is int and size > 0 for size in shape):
        raise feature.wrong("shape", "a list of whole numbers")
    return tuple(shape)


def _kind(feature: Entries) -> np.dtype[Any]:
    name = feature.text("dtype")
    try:
        kind = np.dtype(name)
    except TypeError:
        kind = np.dtype(object)
    if kind.kind not in "fiub":
        raise feature.wrong("dtype", "a type of numbers; a mapping file leaves others out")
    return kind
