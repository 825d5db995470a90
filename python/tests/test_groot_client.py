"""The client of GR00T's servers: it speaks their protocol, and no server can hold it up."""

from __future__ import annotations

import io
import socket
import struct
import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import msgpack
import numpy as np
import pytest

import robocell as rc
from groot_peer import groot_server, modalities, packed
from raw_server import raw_server
from robocell.policy_server import GrootClient, LostServerError, PolicyServerError, RemotePolicy
from robocell.policy_server import _groot_client as client_module
from robocell.policy_server._client import KEY, MOST_BYTES
from robocell.policy_server._groot_preset import groot_preset

CONFIG = modalities(["wrist"], ["arm", "gripper"], ["arm", "gripper"])
OBSERVATION = {
    "video": {"wrist": np.arange(12, dtype=np.uint8).reshape(2, 2, 3)},
    "state": {"arm": np.arange(7, dtype=np.float32), "gripper": np.ones(1, np.float32)},
    "language": {"annotation.human.task_description": "pick up the cube"},
}
ARM = np.arange(112, dtype=np.float32).reshape(1, 16, 7)
GRIPPER = np.ones((1, 16, 1), np.float32)
CHUNK = [{"gripper": GRIPPER, "arm": ARM}, {}]
SHORT_S = 0.3


def test_a_server_of_groot_sees_the_observation_and_its_parts_are_joined():
    seen: list[Any] = []

    def act(observation: dict[str, Any]) -> Any:
        seen.append(observation)
        return CHUNK

    requests: list[Any] = []
    with groot_server(act, CONFIG, requests=requests) as url, GrootClient(url) as client:
        assert client.modalities["action"] == ("arm", "gripper")
        client.reset({"prompt": "pick up the cube"})
        reply = client.infer(OBSERVATION)
        np.testing.assert_array_equal(reply.actions, np.concatenate([ARM, GRIPPER], axis=2)[0])
    assert [each["endpoint"] for each in requests] == ["get_modality_config", "reset", "get_action"]
    assert seen[0]["video"]["wrist"].shape == (1, 1, 2, 2, 3)
    assert seen[0]["video"]["wrist"].dtype == np.uint8
    assert seen[0]["state"]["arm"].shape == (1, 1, 7)
    assert seen[0]["state"]["arm"].dtype == np.float32
    assert seen[0]["language"] == {"annotation.human.task_description": [["pick up the cube"]]}


def test_the_token_is_sent_and_its_absence_explained(monkeypatch: pytest.MonkeyPatch):
    with groot_server(lambda observation: CHUNK, CONFIG, token="secret") as url:
        with pytest.raises(PolicyServerError, match=KEY):
            GrootClient(url).connect()
        monkeypatch.setenv(KEY, "secret\n")
        with GrootClient(url) as client:
            assert client.infer(OBSERVATION).actions.shape == (16, 8)


def npy(header: bytes, data: bytes = b"") -> bytes:
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + data


def objects() -> bytes:
    file = io.BytesIO()
    np.save(file, np.array([{}], object), allow_pickle=True)
    return file.getvalue()


def part(data: bytes) -> bytes:
    return packed([{"arm": {"__ndarray_class__": True, "as_npy": data}, "gripper": GRIPPER}, {}])


@pytest.mark.parametrize(
    ("reply", "said"),
    [
        ({"error": "no checkpoint"}, "the server has an error: no checkpoint"),
        ([{"arm": ARM}, {}], r"action 'gripper' has the shape \(1, k, n\); got nothing"),
        ([{"arm": ARM[0], "gripper": GRIPPER}, {}], "action 'arm' has the shape"),
        ([{"arm": ARM[:, :3], "gripper": GRIPPER}, {}], r"different lengths: \[3, 16\]"),
        ([{"arm": np.nan * ARM, "gripper": GRIPPER}, {}], "not finite"),
        (part(objects()), "dtype '|O'"),
        (
            part(npy(b"{'descr': '<f8', 'fortran_order': False, 'shape': (1, 268435456, 8), }\n")),
            "needs",
        ),
        (part(npy(b"{'descr': '<f8', 'fortran_order': False, 'shape': (1 << 60,), }\n")), "numpy"),
        (part(npy(b"(" * 900)), "numpy"),
        (part(b"\x93NUMPY"), "numpy"),
        (b"\xc1garbage", "not a msgpack message"),
        (msgpack.packb([1, 2]), "the reply has no actions but list"),
        (b"\xdd\x7f\xff\xff\xff", "not a msgpack message"),
    ],
)
def test_a_wrong_reply_is_an_error_with_its_reason(reply: Any, said: str):
    with groot_server(lambda observation: reply, CONFIG) as url, GrootClient(url) as client:
        with pytest.raises(PolicyServerError, match=said) as caught:
            client.infer(OBSERVATION)
        assert len(str(caught.value)) < 700


@pytest.mark.parametrize(
    ("config", "said"),
    [
        ([], "no map"),
        ({}, "it lists no keys of 'video'"),
        (modalities(["wrist"], ["arm"], [], 1), "it lists no keys of 'action'"),
        (modalities(["wrist"], ["arm"], ["arm"], 3), "its video has 3 times"),
    ],
)
def test_modalities_that_cannot_be_served_are_named(config: Any, said: str):
    with (
        groot_server(lambda observation: CHUNK, config) as url,
        pytest.raises(PolicyServerError, match=said),
    ):
        GrootClient(url).connect()


@pytest.mark.parametrize(
    "url", ["zmq://", "zmq://:5", "zmq://a:99999", "zmq://u:p@a:5", "zmq://a/b"]
)
def test_what_is_no_url_is_explained(url: str):
    with pytest.raises(rc.ArgumentError, match="URL"):
        GrootClient(url)


# ---- servers that misbehave ----------------------------------------------------------------------

GREETING = b"\xff" + b"\0" * 8 + b"\x7f\x03\x00" + b"NULL".ljust(20, b"\0") + b"\0" * 32
READY = b"\x05READY\x0bSocket-Type\x00\x00\x00\x03REP"
Talk = Callable[[socket.socket, int], None]


def silent(connection: socket.socket, _: int) -> None:
    time.sleep(30)


def closes(connection: socket.socket, _: int) -> None:
    connection.close()


def says(data: bytes) -> Talk:
    def talk(connection: socket.socket, _: int) -> None:
        connection.sendall(data)
        time.sleep(30)

    return talk


def drips(connection: socket.socket, _: int) -> None:
    for byte in GREETING * 20:
        connection.sendall(bytes([byte]))
        time.sleep(0.02)


@pytest.mark.parametrize(
    "talk",
    [
        silent,
        closes,
        drips,
        says(b"HTTP/1.1 400 Bad Request\r\n\r\n" + b"x" * 100),
        says(GREETING.replace(b"NULL", b"PLAIN"[:4])),
        says(GREETING + b"\x00\x05hello"),
        says(GREETING + b"\x06" + struct.pack(">Q", 1 << 40)),
        says(GREETING + b"\x04\x19\x05READY\x0bSocket-Type\x00\x00\x00\x03PUB"),
    ],
)
def test_what_is_no_groot_server_is_named_in_time(talk: Talk, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(client_module, "CONNECT_S", SHORT_S)
    with raw_server(talk) as url:
        url = url.replace("ws:", "zmq:")
        began = time.monotonic()
        with pytest.raises(LostServerError, match=f"no GR00T server at {url}: ."):
            GrootClient(url).connect()
        assert time.monotonic() - began < 10


def message(body: bytes) -> bytes:
    return b"\x01\x00\x02" + struct.pack(">Q", len(body)) + body


def receive_until(connection: socket.socket, word: bytes) -> None:
    """Reads all up to a word, in however many pieces it comes."""
    received = b""
    while word not in received:
        piece = connection.recv(65536)
        assert piece, f"the client closed before {word!r}"
        received += piece


def answers(*data: bytes, pause_s: float = 0.0, again: bool = False) -> Talk:
    """Greets, lists the modalities, and then sends this in place of a reply."""

    def talk(connection: socket.socket, _: int) -> None:
        connection.sendall(GREETING + bytes([4, len(READY)]) + READY)
        connection.recv(65536)
        connection.sendall(message(packed(CONFIG)))
        time.sleep(0.05)
        connection.recv(65536)
        while True:
            for each in data:
                connection.sendall(each)
                time.sleep(pause_s)
            if not again:
                break
        time.sleep(30)

    return talk


@pytest.mark.parametrize(
    ("talk", "said"),
    [
        (answers(b"\x01\x00\x02" + struct.pack(">Q", 2 << 30)), "a message is too large"),
        (answers(b"\x01\x00\x02" + struct.pack(">Q", MOST_BYTES + 1)), "a message is too large"),
        (answers(b"\x01\x00\x02" + struct.pack(">Q", 1000)), "no answer within 0.3 s"),
        (answers(*[b"\x01\x00\x00\xff", *[b"x"] * 255], pause_s=0.02), "no answer within 0.3 s"),
        (answers(b"\x01\x00" * 100, again=True), "not an empty frame"),
        (answers(b"\x04\x01x" * 100, again=True), "not an empty frame"),
        (answers(b"\x01\x00\x03" + struct.pack(">Q", 1 << 20), b"\0" * (1 << 20), again=True), "."),
        (answers(b"\xff\xff"), "does not speak ZeroMQ"),
        (answers(b"\x00\x05hello"), "not an empty frame"),
    ],
)
def test_a_server_that_misbehaves_ends_its_call_in_time(talk: Talk, said: str):
    with raw_server(talk) as url:
        client = GrootClient(url.replace("ws:", "zmq:"), SHORT_S)
        client.connect()
        began = time.monotonic()
        with pytest.raises(PolicyServerError, match=said):
            client.infer(OBSERVATION)
        assert time.monotonic() - began < 10
        client.close()


def test_a_dropped_connection_is_tried_once_more():
    numbers = []

    def drops(connection: socket.socket, number: int) -> None:
        numbers.append(number)
        connection.sendall(GREETING + bytes([4, len(READY)]) + READY)
        if number == 0:
            receive_until(connection, b"get_modality_config")
            connection.sendall(message(packed(CONFIG)))
            receive_until(connection, b"get_action")  # and then closes without an answer
        else:
            receive_until(connection, b"get_action")
            connection.sendall(message(packed(CHUNK)))
        connection.close()

    with raw_server(drops) as url, GrootClient(url.replace("ws:", "zmq:"), 5) as client:
        assert client.infer(OBSERVATION).actions.shape == (16, 8)
        with pytest.raises(LostServerError, match=r"closed the connection|broke"):
            client._call("ping", retries=False)
    assert numbers == [0, 1]


# ---- a cell --------------------------------------------------------------------------------------


def features() -> list[Any]:
    named = {
        "robots/rc7/hand/qpos": ("observation", (2,)),
        "robots/rc7/arm/qpos": ("observation", (7,)),
        "robots/rc7/opening": ("observation", ()),
        "robots/rc7/action/arm": ("action", (7,)),
        "robots/rc7/action/hand": ("action", (1,)),
    }
    return [
        SimpleNamespace(name=name, role=role, shape=shape, names=[])
        for name, (role, shape) in named.items()
    ]


def test_the_parts_of_an_export_are_columns_of_the_cell():
    preset = groot_preset(
        {
            "video": ["wrist"],
            "state": ["arm", "gripper"],
            "action": ["arm", "hand"],
            "language": ["annotation.human.task_description"],
        },
        features(),
        "zmq://a",
    )
    bound = preset.bind(features(), ["exo", "wrist"])
    [[arm], [gripper]] = bound.observation.values()
    assert (arm.column, gripper.column) == ("robots/rc7/arm/qpos", "robots/rc7/opening")
    assert [each.column for each in bound.actions] == [
        "robots/rc7/action/arm",
        "robots/rc7/action/hand",
    ]
    assert bound.cameras == {"video>wrist": "wrist"}


def test_a_policy_of_groot_is_asked_by_the_names_of_an_export():
    seen: list[Any] = []

    def act(observation: dict[str, Any]) -> Any:
        seen.append(observation)
        return [{"arm": ARM, "hand": GRIPPER}, {}]

    config = modalities(["wrist"], ["arm", "gripper"], ["arm", "hand"])
    image = np.zeros((4, 6, 3), np.uint8)
    cameras = SimpleNamespace(draw=True, streams=[SimpleNamespace(name="wrist")])
    context: Any = SimpleNamespace(
        instruction="lift", seed=5, features=features(), run=SimpleNamespace(cameras=cameras)
    )
    with groot_server(act, config) as url:
        remote = RemotePolicy(url)
        remote.reset(context)
        joints, opening = np.arange(7.0), np.array(0.25)
        row = {"robots/rc7/arm/qpos": joints, "robots/rc7/opening": opening, "wrist": image}
        action = remote.act(row)
        remote.client.close()
    assert np.array_equal(action["robots/rc7/action/arm"], ARM[0])
    assert np.array_equal(action["robots/rc7/action/hand"], GRIPPER[0])
    assert np.array_equal(seen[0]["state"]["arm"][0, 0], joints)
    assert np.array_equal(seen[0]["state"]["gripper"][0, 0], [0.25])
    assert seen[0]["video"]["wrist"].shape == (1, 1, 4, 6, 3)
    assert seen[0]["language"] == {"annotation.human.task_description": [["lift"]]}


def test_a_part_that_no_column_has_is_named():
    with pytest.raises(rc.NotFoundError, match=r"no column for its state 'arn'.* 'arm'.*--preset"):
        groot_preset(
            {"video": ["wrist"], "state": ["arn"], "action": ["arm"], "language": ["l"]},
            features(),
            "zmq://a",
        )
