"""The client of policy servers: it speaks openpi's protocol, and no server can hold it up."""

from __future__ import annotations

import json
import socket
import struct
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from websockets.server import ServerProtocol

import openpi_peer
import robocell as rc
from openpi_peer import openpi_server
from raw_server import raw_server
from robocell.evaluate import _greeting
from robocell.policy_server import LostServerError, PolicyClient, PolicyServerError
from robocell.policy_server import _client as client_module
from robocell.policy_server._client import KEY, MOST_BYTES
from robocell.policy_server._server import PolicyServer

CHUNK = np.arange(80, dtype=np.float32).reshape(10, 8)
OBSERVATION = {
    "observation/image": np.arange(224 * 224 * 3, dtype=np.uint8).reshape(224, 224, 3),
    "observation/state": np.arange(8, dtype=np.float32),
    "prompt": "pick up the cube",
}
SHORT_S = 0.3


def test_a_server_of_openpi_sees_the_observation_and_its_actions_arrive():
    seen: list[dict[str, Any]] = []

    def infer(observation: dict[str, Any]) -> Any:
        seen.append(observation)
        return {"actions": CHUNK, "server_timing": {"infer_ms": 1.5}}

    with (
        openpi_server(infer, {"name": "pi0", "version": 3}) as url,
        PolicyClient(url) as client,
    ):
        assert client.metadata == {"name": "pi0", "version": 3}
        client.reset({"seed": 3})
        for _ in range(3):
            reply = client.infer(OBSERVATION)
            np.testing.assert_array_equal(reply.actions, CHUNK)
            assert reply.server_ms == 1.5
            assert 0 < reply.call_ms < 5000
    assert len(seen) == 3
    assert seen[0].keys() == OBSERVATION.keys(), "nothing that openpi does not know"
    np.testing.assert_array_equal(seen[0]["observation/image"], OBSERVATION["observation/image"])


def test_each_rollout_has_its_own_connection_to_a_server_of_openpi():
    """Some servers keep a policy's state for each connection."""
    requests: list[Any] = []
    with openpi_server(lambda _: CHUNK, requests=requests) as url, PolicyClient(url) as client:
        for _ in range(3):
            client.reset()
            client.infer(OBSERVATION)
    assert len(requests) == 4


def test_a_server_of_roboarena_is_reset_and_its_bare_array_read():
    resets: list[Any] = []
    seen: list[Any] = []

    def infer(observation: dict[str, Any]) -> Any:
        seen.append(observation)
        return CHUNK

    config = vars(openpi_peer.RoboArenaConfig())
    with openpi_server(infer, config, resets.append) as url, PolicyClient(url) as client:
        client.reset({"prompt": "stack"})
        np.testing.assert_array_equal(client.infer(OBSERVATION).actions, CHUNK)
    assert resets == [{"prompt": "stack"}]
    assert len(seen) == 1


@pytest.mark.parametrize(
    "reply", [CHUNK, {"action": CHUNK}, {"actions": CHUNK.tolist()}, {"actions": CHUNK[0]}]
)
def test_actions_may_come_in_several_shapes(reply: Any):
    with openpi_server(lambda _: reply) as url, PolicyClient(url) as client:
        actions = client.infer(OBSERVATION).actions
    assert actions.shape in ((10, 8), (8,))
    np.testing.assert_array_equal(np.atleast_2d(actions)[0], CHUNK[0])


def test_the_api_key_is_sent_and_never_part_of_a_url(monkeypatch: pytest.MonkeyPatch):
    requests: list[Any] = []
    monkeypatch.setenv(KEY, "from the environment")
    with openpi_server(lambda _: CHUNK, requests=requests) as url:
        for key in ("secret", None):
            client = PolicyClient(url, api_key=key)
            assert "secret" not in repr(client)
            client.connect()
            client.close()
    headers = [request.headers["Authorization"] for request in requests]
    assert headers == ["Api-Key secret", "Api-Key from the environment"]
    with pytest.raises(rc.ArgumentError, match=f"environment variable {KEY}"):
        PolicyClient("ws://user:secret@127.0.0.1:8000")
    with pytest.raises(rc.ArgumentError, match="such as ws://127"):
        PolicyClient("ws://[::1:8000")


NAN = CHUNK.copy()
NAN[3, 2] = np.nan


@pytest.mark.parametrize(
    ("reply", "said"),
    [
        ("Traceback (most recent call last):\n  x\nKeyError: 'state'", "error: KeyError: 'state'"),
        ("x" * 60_000, r"x \.\.\.$"),
        ({"actions": NAN}, r"not finite: entry \[3, 2\] is nan"),
        ({"actions": np.zeros((2, 3, 4))}, r"\(n,\) or \(k, n\); got \(2, 3, 4\)"),
        ({"actions": np.zeros((0, 8))}, r"got \(0, 8\)"),
        ({"actions": np.zeros((5000, 8))}, "5000 actions; at most 4096"),
        ({"actions": "fast"}, "no array but str"),
        ({"actions": [1, [2, 3]]}, "something else than numbers"),
        ({"actions": [{}, {}]}, "something else than numbers"),
        ({"action_columns": [], "x": 1}, "no 'actions'. It has: action_columns, x"),
        ({"actions": CHUNK, "action_columns": [["arm", 0]]}, "a list of \\[name, size\\]"),
        (None, "no array but NoneType"),
        (b"\xc1", "1 bytes are not a msgpack message"),
        (b"\xdd\x7f\xff\xff\xff", "not a msgpack message"),
        (
            openpi_peer.packed(
                {b"__ndarray__": True, b"data": b"\0" * 8, b"dtype": "|O", b"shape": [1]}
            ),
            r"dtype '\|O'",
        ),
    ],
)
def test_a_wrong_reply_is_an_error_with_its_reason(reply: Any, said: str):
    with openpi_server(lambda _: reply) as url, PolicyClient(url) as client:
        with pytest.raises(PolicyServerError, match=said) as caught:
            client.infer(OBSERVATION)
        assert url in str(caught.value)
        assert len(str(caught.value)) < 700


# ---- servers that misbehave ----------------------------------------------------------------------


def greeted(connection: socket.socket, metadata: bytes = b"\x80") -> ServerProtocol:
    """Does the handshake, and sends the metadata."""
    protocol = ServerProtocol(max_size=None)
    while not (events := protocol.events_received()):
        protocol.receive_data(connection.recv(65536))
    protocol.send_response(protocol.accept(events[0]))
    protocol.send_binary(metadata)
    connection.sendall(b"".join(protocol.data_to_send()))
    return protocol


def silent(connection: socket.socket, _: int) -> None:
    time.sleep(30)


def closes(connection: socket.socket, _: int) -> None:
    connection.close()


def garbage(connection: socket.socket, _: int) -> None:
    connection.sendall(b"\0\xff" * 1000)


def endless_headers(connection: socket.socket, _: int) -> None:
    connection.sendall(b"HTTP/1.1 101 Switching Protocols\r\n")
    for i in range(100_000):
        connection.sendall(b"X-%d: %s\r\n" % (i, b"a" * 1000))


def drips_headers(connection: socket.socket, _: int) -> None:
    for byte in b"HTTP/1.1 101 Switching Protocols\r\nX: " + b"y" * 1000:
        connection.sendall(bytes([byte]))
        time.sleep(0.02)


def no_metadata(connection: socket.socket, _: int) -> None:
    protocol = ServerProtocol()
    while not (events := protocol.events_received()):
        protocol.receive_data(connection.recv(65536))
    protocol.send_response(protocol.accept(events[0]))
    connection.sendall(b"".join(protocol.data_to_send()))
    time.sleep(30)


def web_page(connection: socket.socket, _: int) -> None:
    connection.recv(65536)
    connection.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\nhi")


@pytest.mark.parametrize(
    "talk", [silent, closes, garbage, endless_headers, drips_headers, no_metadata, web_page]
)
def test_what_is_no_policy_server_is_named_in_time(talk: Any, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(client_module, "CONNECT_S", SHORT_S)
    with raw_server(talk) as url:
        began = time.monotonic()
        with pytest.raises(LostServerError, match=f"no policy server at {url}: ."):
            PolicyClient(url).connect()
        assert time.monotonic() - began < 10


def test_a_server_that_is_not_there_is_named():
    with socket.create_server(("127.0.0.1", 0)) as listening:
        port = listening.getsockname()[1]
    with pytest.raises(rc.IoError, match=f"no policy server at ws://127.0.0.1:{port}: Connection"):
        PolicyClient(f"ws://127.0.0.1:{port}").connect()


def frame(opcode: int, length: int, fin: bool = True) -> bytes:
    """The header of a frame that claims this length."""
    return bytes([(128 if fin else 0) | opcode, 127]) + struct.pack(">Q", length)


def answer_with(data: bytes, pause_s: float = 0.0) -> Callable[[socket.socket, int], None]:
    def talk(connection: socket.socket, _: int) -> None:
        greeted(connection)
        connection.recv(65536)
        step = 1 if pause_s else max(1, len(data))
        for at in range(0, len(data), step):
            connection.sendall(data[at : at + step])
            time.sleep(pause_s)
        time.sleep(30)

    return talk


def floods_with_pings(connection: socket.socket, _: int) -> None:
    greeted(connection)
    while True:
        connection.sendall(b"\x89\x02hi" * 1000)


def floods_with_empty_fragments(connection: socket.socket, _: int) -> None:
    greeted(connection)
    connection.sendall(b"\x02\x00")
    while True:
        connection.sendall(b"\x00\x00" * 1000)


def endless_fragments(connection: socket.socket, _: int) -> None:
    greeted(connection)
    connection.sendall(b"\x02\x00")
    while True:
        connection.sendall(frame(0, 1 << 20, fin=False) + b"\0" * (1 << 20))


def never_reads(connection: socket.socket, _: int) -> None:
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    greeted(connection)
    time.sleep(30)


def late(connection: socket.socket, number: int) -> None:
    protocol = greeted(connection)
    time.sleep(2 * SHORT_S if number == 0 else 0)
    protocol.send_binary(openpi_peer.packed(np.full((1, 8), float(number))))
    connection.sendall(b"".join(protocol.data_to_send()))
    time.sleep(1)


@pytest.mark.parametrize(
    ("talk", "said"),
    [
        (answer_with(frame(2, 2 << 30) + b"x"), "a message is too large"),
        (answer_with(frame(2, MOST_BYTES + 1)), "a message is too large"),
        (answer_with(frame(2, 1 << 63)), "a message is too large|does not speak WebSocket"),
        (answer_with(frame(2, 1000)), "no answer within 0.3 s"),
        (answer_with(b"\xff\xff\xff\xff"), "does not speak WebSocket"),
        (answer_with(frame(2, 1000) + b"x" * 500, pause_s=0.02), "no answer within 0.3 s"),
        (answer_with(b""), "no answer within 0.3 s"),
        (floods_with_pings, "no answer within 0.3 s|closed|broke"),
        (floods_with_empty_fragments, "no answer within 0.3 s"),
        (endless_fragments, "a message is too large|no answer within 0.3 s"),
        (never_reads, "no answer within 0.3 s"),
    ],
)
def test_a_server_that_misbehaves_ends_its_call_in_time(talk: Any, said: str):
    side = 2000 if talk is never_reads else 10
    with raw_server(talk) as url:
        client = PolicyClient(url, SHORT_S)
        client.connect()
        began = time.monotonic()
        with pytest.raises(PolicyServerError, match=said):
            client.infer({"image": np.zeros((side, side, 3), np.uint8)})
        assert time.monotonic() - began < 10
        client.close()


def test_a_late_answer_is_never_that_of_the_next_observation():
    with raw_server(late) as url:
        client = PolicyClient(url, SHORT_S)
        client.connect()
        with pytest.raises(PolicyServerError, match="no answer"):
            client.infer({})
        client.timeout_s = 10
        assert (client.infer({}).actions == 1).all()


def drops_first(times: int) -> Callable[[socket.socket, int], None]:
    """Closes the connection in the middle of an answer, for the first connections."""

    def talk(connection: socket.socket, number: int) -> None:
        protocol = greeted(connection)
        connection.recv(65536)
        if number < times:
            connection.sendall(frame(2, 1000) + b"x" * 10)
            connection.close()
            return
        protocol.send_binary(openpi_peer.packed(CHUNK))
        connection.sendall(b"".join(protocol.data_to_send()))
        time.sleep(1)

    return talk


def test_a_dropped_connection_is_tried_once_more():
    with raw_server(drops_first(1)) as url, PolicyClient(url, 5.0) as client:
        np.testing.assert_array_equal(client.infer({}).actions, CHUNK)
    with raw_server(drops_first(2)) as url, PolicyClient(url, 5.0) as client:
        with pytest.raises(LostServerError, match="the other end closed the connection"):
            client.infer({})
        np.testing.assert_array_equal(client.infer({}).actions, CHUNK, "it may come back")


def test_a_key_from_a_file_may_end_with_a_line_break(monkeypatch: pytest.MonkeyPatch):
    server = PolicyServer(lambda: None, port=0, api_key="secret")  # type: ignore[arg-type, return-value]
    threading.Thread(target=server.serve, daemon=True).start()
    try:
        monkeypatch.setenv(KEY, "secret\n")
        with PolicyClient(server.url, timeout_s=5) as client:
            assert client.metadata["server"] == "robocell"
    finally:
        server.close()
    for key in ("two\nlines", "schlüssel"):
        with pytest.raises(rc.ArgumentError, match="printable ASCII characters"):
            PolicyClient(server.url, api_key=key)


def test_a_new_connection_in_a_rollout_is_told_which_rollout_it_is():
    heard: list[tuple[int, dict[str, Any]]] = []

    class Session:
        count = 0

        def __init__(self) -> None:
            Session.count += 1
            self.number = Session.count

        def reset(self, info: Mapping[str, Any]) -> None:
            heard.append((self.number, dict(info)))

        def infer(self, observation: dict[str, Any]) -> dict[str, Any]:
            heard.append((self.number, {}))
            if self.number == 1 and len(heard) == 3:
                for channel in list(server._channels):
                    channel.abort()
            return {"actions": np.full((1, 8), float(self.number))}

    server = PolicyServer(Session, port=0)
    threading.Thread(target=server.serve, daemon=True).start()
    try:
        with PolicyClient(server.url, timeout_s=5) as client:
            client.reset({"prompt": "go", "seed": 7}, {"rollout": "s0000_e0000"})
            assert client.infer(OBSERVATION).actions[0, 0] == 1
            assert client.infer(OBSERVATION).actions[0, 0] == 2
            client.close()
            assert client.infer(OBSERVATION).actions[0, 0] == 3
    finally:
        server.close()
    begun = {"prompt": "go", "seed": 7, "rollout": "s0000_e0000"}
    assert heard == [(1, begun), (1, {}), (1, {}), (2, begun), (2, {}), (3, begun), (3, {})]


def test_an_evaluation_keeps_whatever_a_server_says_first():
    deep: Any = "end"
    for _ in range(400):
        deep = {b"in": [deep]}
    said = {"a": {b"k": np.arange(3), "nan": float("nan")}, b"b": [True, None, 2.5], "deep": deep}
    with openpi_server(lambda _: CHUNK, said) as url:
        kept = _greeting(url)
    assert kept["a"] == {"k": "[0 1 2]", "nan": "nan"}
    assert kept["b"] == [True, None, 2.5]
    assert json.loads(json.dumps(kept, allow_nan=False)) == kept
