"""Numbers for a page: one header in JSON, and arrays that it refers to, in one block of bytes.

    packed = Packed()
    header = {"vertices": packed.add(vertices)}   # {"at": 0, "shape": [8, 3], "type": "f4"}
    data = packed.block(header)

The page reads the length of the header from the first four bytes, then the header, then the arrays
at multiples of eight bytes after it.
"""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

TYPES: dict[str, np.dtype[Any]] = {
    "f4": np.dtype("<f4"),
    "u4": np.dtype("<u4"),
    "u1": np.dtype("u1"),
    "i4": np.dtype("<i4"),
}


class Packed:
    """Collects arrays."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._size = 0

    def add(self, values: ArrayLike, kind: str = "f4") -> dict[str, Any]:
        """Adds an array, and returns what the header says about it."""
        array = np.ascontiguousarray(values, dtype=TYPES[kind])
        data = array.tobytes()
        place = {"at": self._size, "shape": list(array.shape), "type": kind}
        padded = data + b"\0" * (-len(data) % 8)
        self._parts.append(padded)
        self._size += len(padded)
        return place

    def block(self, header: dict[str, Any]) -> bytes:
        """Returns header and arrays."""
        text = json.dumps(header, allow_nan=False, separators=(",", ":")).encode()
        text += b" " * (-(len(text) + 4) % 8)
        return b"".join([struct.pack("<I", len(text)), text, *self._parts])


def unpacked(data: bytes) -> tuple[dict[str, Any], Any]:
    """Returns the header, and a function that returns the array of one of its entries."""
    [size] = struct.unpack_from("<I", data)
    header = json.loads(data[4 : 4 + size])

    def array(place: dict[str, Any]) -> Any:
        kind, shape = TYPES[place["type"]], place["shape"]
        count = int(np.prod(shape))
        return np.frombuffer(data, kind, count, 4 + size + place["at"]).reshape(shape)

    return header, array
