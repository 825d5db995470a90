"""Messages of the openpi protocol: msgpack with NumPy arrays, and nothing else.

An array is the map {"__ndarray__": true, "data": bytes, "dtype": "<f4", "shape": [10, 8]}, a NumPy
scalar {"__npgeneric__": true, "data": 0.5, "dtype": "<f4"}; the keys are bytes. Numbers and
booleans are the only types of elements. What arrives is checked before memory is allocated for it:
nothing is unpickled, and a short message cannot become a large object.

Not for: sockets (channel.py).
"""

from __future__ import annotations

import functools
import io
import math
import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import Error
from robocell._extras import needed_by

with needed_by("robocell.policy_server", "policy"):
    import msgpack

MOST_ITEMS = 100_000  # elements of all lists and maps of a message
LONGEST_LIST = 16_384
LONGEST_TEXT = 65_536  # bytes
MOST_DIMENSIONS = 8
LONGEST_SIDE = 1 << 28  # of an array
DTYPE = re.compile(r"[<>|=]?(b1|[iu][1248]|f[248])")
ARRAY, SCALAR = b"__ndarray__", b"__npgeneric__"
ARRAY_TEXT, SCALAR_TEXT = ARRAY.decode(), SCALAR.decode()
NPY = "__ndarray_class__"  # of GR00T's servers
NPY_LONGEST = 1024  # bytes of a header
NPY_HEADER = re.compile(
    rb"\x93NUMPY[\x01-\x03]\x00(?:..){1,2}\{'descr': '(?P<descr>[^']*)', 'fortran_order': "
    rb"(?P<order>True|False), 'shape': \((?P<shape>(?:\d{1,19}, ?)*(?:\d{1,19})?)\), *\} *\n",
    re.DOTALL,
)


class WireError(Error):
    """A message does not follow the protocol."""


def pack(message: object, *, npy: bool = False) -> bytes:
    """Returns a message as bytes.

    Args:
        message: Numbers, texts, bytes, lists, maps and arrays.
        npy: Write arrays as GR00T's servers read them: files of numpy in bytes.

    Raises:
        WireError: It holds something else than numbers, texts, bytes, lists, maps and arrays.
    """
    try:
        packed: bytes = msgpack.packb(message, default=_packed_npy if npy else _packed)
    except (TypeError, ValueError, OverflowError) as error:
        raise WireError(f"the message cannot be sent: {error}") from error
    return packed


def unpack(data: bytes) -> Any:
    """Returns the message in bytes; its arrays are read-only views of them.

    Raises:
        WireError: The bytes are not a message, or hold an array of objects, or something too large.
    """
    items = 0

    def count(number: int) -> None:
        nonlocal items
        items += number + 1
        if items > MOST_ITEMS:
            raise WireError(f"the message has more than {MOST_ITEMS} elements in lists and maps")

    def as_list(values: list[Any]) -> list[Any]:
        count(len(values))
        return values

    def as_map(values: dict[Any, Any]) -> Any:
        count(len(values))
        if ARRAY in values:
            return _array(values.get(b"data"), values.get(b"dtype"), values.get(b"shape"))
        if SCALAR in values:
            return _scalar(values.get(b"data"), values.get(b"dtype"))
        if ARRAY_TEXT in values:
            return _array(values.get("data"), values.get("dtype"), values.get("shape"))
        if SCALAR_TEXT in values:
            return _scalar(values.get("data"), values.get("dtype"))
        if NPY in values:
            return _npy(values.get("as_npy"))
        return values

    def no_extension(code: int, _data: bytes) -> None:
        raise WireError(f"the message has an extension type, {code}, which the protocol lacks")

    try:
        return msgpack.unpackb(
            data,
            raw=False,
            strict_map_key=True,
            list_hook=as_list,
            object_hook=as_map,
            ext_hook=no_extension,
            max_str_len=LONGEST_TEXT,
            max_bin_len=len(data),
            max_array_len=LONGEST_LIST,
            max_map_len=LONGEST_LIST,
            max_ext_len=64,
        )
    except WireError:
        raise
    except (ValueError, TypeError, OverflowError, RecursionError, MemoryError) as error:
        # msgpack's own errors are ValueErrors; a StackError has no text.
        reason = str(error) or type(error).__name__
        raise WireError(f"{len(data)} bytes are not a msgpack message: {reason[:200]}") from error
    except msgpack.exceptions.UnpackException as error:
        reason = str(error) or type(error).__name__
        raise WireError(f"{len(data)} bytes are not a msgpack message: {reason[:200]}") from error


def name_of(key: object) -> str:
    """Returns the key of a map as a text: some peers send keys as bytes."""
    return key.decode("utf-8", "replace") if isinstance(key, bytes) else str(key)


def as_json(value: Any, levels: int = 20) -> Any:
    """Returns a part of a message as JSON has it: other keys and values become texts."""
    if levels == 0:
        return "..."
    if isinstance(value, dict):
        return {name_of(key): as_json(each, levels - 1) for key, each in value.items()}
    if isinstance(value, list):
        return [as_json(each, levels - 1) for each in value]
    if value is None or isinstance(value, bool | int | str):
        return value
    return value if isinstance(value, float) and math.isfinite(value) else str(value)


def _packed(value: object) -> object:
    if isinstance(value, np.ndarray):
        _require_plain(value.dtype)
        return {
            ARRAY: True,
            b"data": value.tobytes(),
            b"dtype": value.dtype.str,
            b"shape": value.shape,
        }
    if isinstance(value, np.generic):
        _require_plain(value.dtype)
        return {SCALAR: True, b"data": value.item(), b"dtype": value.dtype.str}
    raise TypeError(f"{type(value).__name__} is no number, text, list, map or array")


def _packed_npy(value: object) -> object:
    if isinstance(value, np.ndarray):
        _require_plain(value.dtype)
        file = io.BytesIO()
        np.save(file, value, allow_pickle=False)
        return {NPY: True, "as_npy": file.getvalue()}
    if isinstance(value, np.generic):
        _require_plain(value.dtype)
        return value.item()
    raise TypeError(f"{type(value).__name__} is no number, text, list, map or array")


@functools.lru_cache(64)
def _require_plain(dtype: np.dtype[Any]) -> None:
    if not DTYPE.fullmatch(dtype.str):
        raise TypeError(f"arrays of {dtype} are not part of the protocol")


def _dtype(name: object) -> np.dtype[Any]:
    dtype = _known_dtype(name) if isinstance(name, str | bytes) else None
    if dtype is None:
        raise WireError(
            f"an array has the dtype {_text(name)[:40]!r}; allowed are booleans, integers and "
            "floats of up to 8 bytes, such as '<f4'"
        )
    return dtype


@functools.lru_cache(64)
def _known_dtype(name: str | bytes) -> np.dtype[Any] | None:
    text = _text(name)
    return np.dtype(text) if DTYPE.fullmatch(text) else None


def _text(name: object) -> str:
    return name.decode("ascii", "replace") if isinstance(name, bytes) else str(name)


def _array(data: object, dtype_name: object, shape: object) -> NDArray[Any]:
    dtype = _dtype(dtype_name)
    if not isinstance(data, bytes):
        raise WireError("an array has no data")
    if (
        not isinstance(shape, list)
        or len(shape) > MOST_DIMENSIONS
        or not all(type(size) is int and 0 <= size <= LONGEST_SIDE for size in shape)
    ):
        raise WireError(f"an array of {len(data)} bytes has the shape {str(shape)[:80]}")
    if math.prod(shape) * dtype.itemsize != len(data):
        raise WireError(
            f"an array of shape {shape} and dtype {dtype.str} needs "
            f"{math.prod(shape) * dtype.itemsize} bytes, and has {len(data)}"
        )
    return np.frombuffer(data, dtype).reshape(shape) if data else np.zeros(shape, dtype)


def _npy(data: object) -> NDArray[Any]:
    """Returns the array in a file of numpy, without numpy's own reader, which reserves first."""
    if not isinstance(data, bytes):
        raise WireError("an array has no data")
    header = NPY_HEADER.match(data[:NPY_LONGEST])
    if header is None:
        raise WireError(f"an array is no file of numpy: {data[:40]!r}")
    shape = [int(size) for size in header["shape"].split(b",") if size.strip()]
    whole = _array(data[header.end() :], header["descr"], shape)
    return whole.reshape(shape[::-1]).T if header["order"] == b"True" else whole


def _scalar(value: object, dtype_name: object) -> Any:
    dtype = _dtype(dtype_name)
    if not isinstance(value, bool | int | float):
        raise WireError(f"a scalar of dtype {dtype.str} is a {type(value).__name__}")
    try:
        return dtype.type(value)
    except (ValueError, OverflowError) as error:
        raise WireError(f"a scalar does not fit the dtype {dtype.str}: {error}") from error
