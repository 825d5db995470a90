"""Messages of policy servers: what arrives is numbers, texts and arrays, and small."""

from __future__ import annotations

import contextlib
import struct
import tracemalloc
from typing import Any

import msgpack
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import openpi_peer
from robocell.policy_server._wire import LONGEST_LIST, WireError, pack, unpack

PLAIN = ("?", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", "f2", "f4", "f8")


@pytest.mark.parametrize("dtype", PLAIN)
@pytest.mark.parametrize("shape", [(), (0,), (3,), (2, 3), (0, 8), (1, 2, 3, 1)])
def test_arrays_travel_both_ways_to_and_from_openpi(dtype: str, shape: tuple[int, ...]):
    array = np.arange(int(np.prod(shape))).reshape(shape).astype(dtype)
    sent = {"a": array, "nested": [{"x": array}], "s": array.dtype.type(1), "n": None, "t": "ä"}
    for write, read in (
        (pack, unpack),
        (pack, openpi_peer.unpacked),
        (openpi_peer.packed, unpack),
    ):
        got = read(write(sent))
        assert got["a"].dtype == array.dtype
        assert got["s"] == 1
        assert (got["n"], got["t"]) == (None, "ä")
        np.testing.assert_array_equal(got["a"], array)
        np.testing.assert_array_equal(got["nested"][0]["x"], array)


def test_keys_of_arrays_may_be_texts():
    message = {"__ndarray__": True, "data": b"\0" * 4, "dtype": "<f4", "shape": [1]}
    assert unpack(msgpack.packb(message)) == np.zeros(1)


def test_big_endian_arrays_are_read():
    assert unpack(pack(np.array([1.5], ">f8")))[0] == 1.5


@pytest.mark.parametrize(
    "value",
    [
        np.array([object()]),
        np.array(["text"]),
        np.array([1j]),
        np.zeros(1, [("a", float)]),
        np.array(["2020-01-01"], "datetime64[D]"),
        np.longdouble([1]),
        object(),
        {"a": {1, 2}},
        2**70,
    ],
)
def test_sends_nothing_but_numbers_texts_and_arrays(value: Any):
    with pytest.raises(WireError, match=r"^the message cannot be sent: "):
        pack(value)


def array(**changed: Any) -> bytes:
    fields = {"data": b"\0" * 8, "dtype": "<f4", "shape": [2]} | changed
    return msgpack.packb({b"__ndarray__": True, **{k.encode(): v for k, v in fields.items()}})


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (array(dtype="|O"), "an array has the dtype '|O'"),
        (array(dtype="O"), "an array has the dtype 'O'"),
        (array(dtype="<c8"), "an array has the dtype '<c8'"),
        (array(dtype="|V8"), "an array has the dtype '|V8'"),
        (array(dtype="<U2"), "an array has the dtype '<U2'"),
        (array(dtype="f4,f4"), "an array has the dtype 'f4,f4'"),
        (array(dtype="(999999999,)f8"), "an array has the dtype '(999999999,)f8'"),
        (array(dtype="<f16"), "an array has the dtype '<f16'"),
        (array(dtype=[["a", "<f4"]]), "an array has the dtype "),
        (array(dtype=None), "an array has the dtype 'None'"),
        (array(shape=[3]), "needs 12 bytes, and has 8"),
        (array(shape=[-2]), "an array of 8 bytes has the shape [-2]"),
        (array(shape=[2**40, 2**40]), "an array of 8 bytes has the shape"),
        (array(shape=[0, *[2**27] * 4], data=b""), "not a msgpack message: array is too big"),
        (array(shape=[2.0]), "an array of 8 bytes has the shape"),
        (array(shape=[True, 2]), "an array of 8 bytes has the shape"),
        (array(shape=[1] * 40), "an array of 8 bytes has the shape"),
        (array(shape=2), "an array of 8 bytes has the shape"),
        (array(data="text"), "an array has no data"),
        (msgpack.packb({b"__ndarray__": True}), "an array has the dtype 'None'"),
        (
            msgpack.packb({b"__npgeneric__": True, b"dtype": "<f4", b"data": [1]}),
            "a scalar of dtype <f4 is a list",
        ),
        (
            msgpack.packb({b"__npgeneric__": True, b"dtype": "|u1", b"data": 999}),
            "a scalar does not fit the dtype |u1",
        ),
        (msgpack.packb(msgpack.ExtType(42, b"x")), "an extension type, 42"),
        (msgpack.packb({1: 2}), "is not allowed for map key"),
        (b"", "are not a msgpack message"),
        (b"\xc1", "are not a msgpack message"),
        (pack([1]) + b"\0", "are not a msgpack message"),
        (b"\xa1\xff", "are not a msgpack message"),
        (b"\x91" * 5000, "are not a msgpack message"),
    ],
)
def test_rejects_what_is_no_message_of_the_protocol(message: bytes, said: str):
    with pytest.raises(WireError) as caught:
        unpack(message)
    assert said in str(caught.value)


TWO_GB = struct.pack(">I", 2**31 - 1)


@pytest.mark.parametrize("kind", [b"\xdd", b"\xdf", b"\xdb", b"\xc6", b"\xc9"])
def test_a_header_of_two_gigabytes_reserves_nothing(kind: bytes):
    """Lists, maps, texts, bytes and extensions, alone and inside each other."""
    for message in (kind + TWO_GB, (b"\xdd" + TWO_GB) * 500, b"\x92" + kind + TWO_GB):
        tracemalloc.start()
        with pytest.raises(WireError):
            unpack(message)
        assert tracemalloc.get_traced_memory()[1] < 1 << 20
        tracemalloc.stop()


def test_many_small_objects_do_not_fill_the_memory():
    empty = b"\xdd" + struct.pack(">I", LONGEST_LIST) + b"\x90" * LONGEST_LIST
    message = b"\xdd" + struct.pack(">I", 100) + empty * 100
    tracemalloc.start()
    with pytest.raises(WireError, match="more than 100000 elements"):
        unpack(message)
    assert tracemalloc.get_traced_memory()[1] < 40 << 20
    tracemalloc.stop()


@given(st.binary(max_size=200))
@example(b"\x81\xa1a")
def test_any_bytes_are_a_message_or_a_wire_error(data: bytes):
    with contextlib.suppress(WireError):
        unpack(data)


def test_damaged_messages_are_a_message_or_a_wire_error():
    whole = pack({"actions": np.arange(16, dtype=np.float32).reshape(2, 8), "server_timing": {}})
    rng = np.random.default_rng(0)
    for at in range(len(whole)):
        for byte in (*rng.integers(256, size=3), 0, 255):
            damaged = bytearray(whole)
            damaged[at] = byte
            with contextlib.suppress(WireError):
                unpack(bytes(damaged))
        with pytest.raises(WireError):
            unpack(whole[:at])
