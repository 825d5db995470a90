"""The server of policies: openpi's clients use it, and no client can hold it up."""

from __future__ import annotations

import contextlib
import http.client
import json
import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

import openpi_peer
import robocell as rc
from openpi_peer import OpenpiClient
from robocell._policy_presets import Preset
from robocell.policy import Policy
from robocell.policy_server import (
    PolicyClient,
    PolicyServer,
    PolicyServerError,
    RemotePolicy,
)
from robocell.policy_server import (
    _server as server,
)
from robocell.policy_server._served import PolicySession, ServedCell, policy_server

ARM, GRIPPER = "robots/a/action/arm", "robots/a/action/gripper"


class Counts:
    """A session that says how often it was asked."""

    def __init__(self) -> None:
        self.calls = 0

    def reset(self, info: Mapping[str, Any]) -> None:
        self.calls = int(info.get("calls", 0))

    def infer(self, observation: dict[str, Any]) -> dict[str, Any]:
        if "raise" in observation:
            raise KeyError("left")
        self.calls += 1
        return {"actions": np.full((2, 3), float(self.calls)), "seen": sorted(observation)}


@contextlib.contextmanager
def serving(
    make: Callable[[], Any] = Counts, metadata: dict[str, Any] | None = None, **options: Any
) -> Iterator[PolicyServer]:
    made = PolicyServer(make, metadata, port=0, **options)
    thread = threading.Thread(target=made.serve, daemon=True)
    thread.start()
    yield made
    made.close()
    thread.join(5)
    assert not thread.is_alive()


def test_a_client_of_openpi_gets_metadata_and_chunks():
    with serving(metadata={"model": "mine"}) as made:
        client = OpenpiClient(made.url)
        assert client.metadata["model"] == "mine"
        for calls in (1, 2):
            reply = client.infer({"observation/state": np.zeros(3), "prompt": "go"})
            np.testing.assert_array_equal(reply["actions"], np.full((2, 3), calls))
            assert reply["seen"] == ["observation/state", "prompt"]
            assert reply["server_timing"]["infer_ms"] >= 0
        other = OpenpiClient(made.url)
        assert other.infer({})["actions"][0, 0] == 1, "its own session"


def test_the_own_client_resets_a_session():
    with serving() as made, PolicyClient(made.url) as client:
        client.reset({"calls": 7})
        assert client.infer({}).actions[0, 0] == 8
        client.reset()
        assert client.infer({}).actions[0, 0] == 1


def test_an_error_is_a_text_and_ends_the_connection():
    with serving() as made:
        client = OpenpiClient(made.url)
        with pytest.raises(
            RuntimeError, match=r"error: KeyError: 'left' \(.*policy_server\.py:\d+"
        ):
            client.infer({"raise": 1})
        with pytest.raises(ConnectionClosed):
            client.infer({})
        own = PolicyClient(made.url)
        with pytest.raises(PolicyServerError, match="the server has an error: error: KeyError"):
            own.infer({"raise": 1})
        assert own.infer({}).actions[0, 0] == 1, "a new connection"
        own.close()


def get(made: PolicyServer, path: str, **headers: str) -> tuple[int, bytes]:
    connection = http.client.HTTPConnection(made.host, made.port, timeout=5)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    return answer.status, answer.read()


def test_health_needs_no_key_and_everything_else_does():
    with serving(api_key="secret") as made:
        assert get(made, "/healthz") == (200, b"OK\n")
        assert get(made, "/")[0] == 401
        assert get(made, "/", Authorization="Api-Key \xff")[0] == 401
        for key in (None, "other", "secret2", "secre"):
            with pytest.raises(InvalidStatus) as caught:
                OpenpiClient(made.url, key)
            assert caught.value.response.status_code == 401
            with pytest.raises(PolicyServerError, match="ROBOCELL_POLICY_API_KEY"):
                PolicyClient(made.url, api_key=key or "").connect()
        assert OpenpiClient(made.url, "secret").infer({})["actions"][0, 0] == 1
        assert PolicyClient(made.url, api_key="secret").infer({}).actions[0, 0] == 1


def test_pages_in_a_browser_are_refused():
    with serving() as made:
        with pytest.raises(InvalidStatus) as caught:
            connect(made.url, origin="http://evil.example")
        assert caught.value.response.status_code == 403


def test_only_this_machine_reaches_a_server_without_host():
    with serving() as made:
        assert made.host == "127.0.0.1"
        with pytest.raises(rc.IoError, match=f"cannot listen at 127.0.0.1:{made.port}: Address"):
            PolicyServer(Counts, port=made.port)


# ---- clients that misbehave ----------------------------------------------------------------------


def raw(made: PolicyServer) -> socket.socket:
    return socket.create_connection((made.host, made.port), timeout=5)


def upgraded(made: PolicyServer) -> socket.socket:
    connection = raw(made)
    connection.sendall(
        b"GET / HTTP/1.1\r\nHost: x\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n"
    )
    assert connection.recv(65536).startswith(b"HTTP/1.1 101")
    return connection


def header(length: int) -> bytes:
    return b"\x82\xff" + struct.pack(">Q", length) + b"\0\0\0\0"


@pytest.mark.parametrize(
    "data",
    [
        header(2 << 30),
        header(1 << 62),
        b"\x82\x05hello",  # without a mask
        b"\xff" * 100,
        header(200) + b"\xdd\x7f\xff\xff\xff" * 40,
        header(5) + b"\x81\xa1a\x01\x01",
        b"\x81\x82\0\0\0\0hi",  # a text
        header(3) + b"\x93\x01\x02",
    ],
)
def test_a_client_that_sends_garbage_ends_its_own_connection_only(data: bytes):
    with serving() as made:
        good = OpenpiClient(made.url)
        connection = upgraded(made)
        connection.sendall(data)
        if data.startswith(header(3)):
            connection.close()
        else:
            while connection.recv(65536):
                pass
        assert good.infer({})["actions"][0, 0] == 1


def test_garbage_before_the_handshake_ends_its_connection():
    with serving() as made:
        for data in (b"\0" * 100, b"POST / HTTP/1.1\r\n\r\n", b"GET / HTTP/1.1\r\n" + b"a" * 9000):
            connection = raw(made)
            connection.sendall(data + b"\r\n\r\n")
            answer = b""
            with contextlib.suppress(ConnectionError):
                while received := connection.recv(65536):
                    answer += received
            assert b"101" not in answer
        assert OpenpiClient(made.url).infer({})["actions"][0, 0] == 1


def test_a_message_that_stays_incomplete_times_out(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(server, "MESSAGE_S", 0.2)
    with serving() as made:
        idle = OpenpiClient(made.url)
        connection = upgraded(made)
        connection.sendall(header(1000) + b"x")
        began = time.monotonic()
        with contextlib.suppress(ConnectionError):
            while connection.recv(65536):
                connection.sendall(b"x")
        assert time.monotonic() - began < 4.5, "the socket's own timeout is 5 s"
        time.sleep(0.3)
        assert idle.infer({})["actions"][0, 0] == 1, "a client may take its time between messages"


def test_too_many_clients_are_turned_away(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(server, "MOST_CLIENTS", 2)
    with serving() as made:
        clients = [OpenpiClient(made.url) for _ in range(2)]
        with pytest.raises(InvalidStatus) as caught:
            OpenpiClient(made.url)
        assert caught.value.response.status_code == 503
        clients.pop().socket.close()
        for _ in range(50):
            with contextlib.suppress(InvalidStatus):
                assert OpenpiClient(made.url).infer({})["actions"][0, 0] == 1
                return
            time.sleep(0.05)
        pytest.fail("the place of a client that left stays taken")


# ---- policies ------------------------------------------------------------------------------------


class Follows(Policy):
    """Returns what it sees, so that a test knows what it saw."""

    def __init__(self) -> None:
        self.contexts: list[Any] = []

    def reset(self, context: Any) -> None:
        self.contexts.append(context)

    def act(self, observation: Any) -> Any:
        arm = observation["robots/a/arm/qpos"]
        return {ARM: np.stack([arm, 2 * arm]), GRIPPER: np.full((2, 1), observation["time"])}


class Single(Policy):
    def act(self, observation: Any) -> Any:
        return {ARM: np.arange(7.0), GRIPPER: 0.25}


def features() -> list[Any]:
    """The features of a cell with one arm of seven joints and a gripper."""
    named = {
        "time": ("observation", ()),
        "robots/a/arm/qpos": ("observation", (7,)),
        "robots/a/opening": ("observation", ()),
        "robots/a/tcp_pose_in_base": ("observation", (7,)),
        "robots/a/gripper/qpos": ("observation", (2,)),
        ARM: ("action", (7,)),
        f"{ARM}_relative": ("action", (7,)),
        GRIPPER: ("action", (1,)),
        f"{GRIPPER}_relative": ("action", (1,)),
        "robots/a/action/tcp_displacement": ("action", (6,)),
    }
    return [
        SimpleNamespace(
            name=name, role=role, shape=shape, names=["opening"] if name.startswith(GRIPPER) else []
        )
        for name, (role, shape) in named.items()
    ]


CAMERAS = ("wrist", "exo")


def cell() -> ServedCell:
    return ServedCell(features=tuple(features()), cameras=CAMERAS)


@contextlib.contextmanager
def remote_policy(url: str, preset: str = "") -> Iterator[RemotePolicy]:
    remote = RemotePolicy(url, Preset.load(preset) if preset else None)
    yield remote
    remote.client.close()


def context(prompt: str = "lift") -> Any:
    streams = [SimpleNamespace(name=name) for name in CAMERAS]
    cameras = SimpleNamespace(draw=True, streams=streams)
    return SimpleNamespace(
        instruction=prompt, seed=5, features=features(), run=SimpleNamespace(cameras=cameras)
    )


def test_a_policy_over_the_socket_sees_and_does_what_it_does_here():
    made_policies: list[Follows] = []

    def make() -> PolicySession:
        made_policies.append(Follows())
        return PolicySession(made_policies[-1], cell())

    row = {"robots/a/arm/qpos": np.linspace(-1, 1, 7), "time": np.array(0.3)}
    with serving(make) as made, remote_policy(made.url) as remote:
        remote.reset(context())
        action = remote.act(row)
        here = Follows().act(row)
        assert action.keys() == here.keys()
        for name in here:
            np.testing.assert_array_equal(action[name], here[name])
        remote.reset(context("push"))
    (policy,) = made_policies
    assert [each.instruction for each in policy.contexts] == ["lift", "push"]
    assert policy.contexts[0].seed == 5


def test_a_missing_column_is_named_to_the_client():
    with (
        serving(lambda: PolicySession(Follows(), cell())) as made,
        remote_policy(made.url) as remote,
    ):
        remote.reset(context())
        with pytest.raises(PolicyServerError, match=r"observation has no 'robots/a/arm/qpos'"):
            remote.act({"robots/a/arm/qvel": np.zeros(7)})


def test_an_action_without_names_needs_a_preset():
    with (
        openpi_peer.openpi_server(lambda _: np.zeros((10, 8))) as url,
        remote_policy(url) as remote,
    ):
        remote.reset(context())
        with pytest.raises(PolicyServerError, match=r"8 numbers per action .* --preset droid"):
            remote.act({})


@pytest.mark.parametrize("name", ["droid", "roboarena", "libero"])
def test_a_preset_on_both_sides_is_none(name: str):
    """A policy with robocell's names, served by a preset, is used by a client of that preset."""
    bound = Preset.load(name).bind(features(), CAMERAS)
    wanted = {each.column: np.full(each.size, 0.02) for each in bound.actions}
    wanted[GRIPPER] = np.ones(1)

    class Acts(Policy):
        def act(self, observation: Any) -> Any:
            assert observation["exo"].shape == (224, 224, 3)
            for key in {each.column for parts in bound.observation.values() for each in parts}:
                np.testing.assert_allclose(np.ravel(row[key]), observation[key], atol=1e-6)
            return {key: np.stack([value, value]) for key, value in wanted.items()}

    images = {key: np.full((48, 64, 3), 7, np.uint8) for key in CAMERAS}
    pose = np.array([0.4, 0, 0.3, 0, 0, 0, 1.0])
    row = {
        "robots/a/arm/qpos": ROW,
        "robots/a/opening": np.array(0.75),
        "robots/a/tcp_pose_in_base": pose,
        "robots/a/gripper/qpos": np.array([0.01, -0.01]),
        **images,
    }
    with serving(lambda: PolicySession(Acts(), cell(), bound)) as made:
        client = OpenpiClient(made.url)
        reply = client.infer(bound.message(row, "lift"))
        assert reply["actions"].shape == (2, bound.width)
        with remote_policy(made.url, name) as remote:
            remote.reset(context())
            action = remote.act(row)
        for key, value in action.items():
            np.testing.assert_allclose(value, np.stack([wanted[key]] * 2), atol=1e-6)


ROW = np.linspace(-1, 1, 7)


def test_a_server_of_roboarena_says_sizes_and_actions():
    seen: list[dict[str, Any]] = []

    def infer(observation: dict[str, Any]) -> Any:
        seen.append(observation)
        return np.zeros((4, 8), np.float32)

    row = {
        "robots/a/arm/qpos": ROW,
        "robots/a/opening": np.array(0.75),
        **{key: np.zeros((48, 64, 3), np.uint8) for key in CAMERAS},
    }
    config = vars(openpi_peer.RoboArenaConfig())
    with (
        openpi_peer.openpi_server(infer, config, lambda _: None) as url,
        remote_policy(url, "roboarena") as remote,
        remote_policy(url, "droid") as wrong,
    ):
        remote.reset(context())
        action = remote.act(row)
        assert action[GRIPPER].tolist() == [[1.0]] * 4
        assert seen[0]["observation/exterior_image_0_left"].shape == (96, 128, 3)
        assert seen[0]["session_id"].tolist() == [5]
        assert seen[0]["prompt"] == "lift"
        with pytest.raises(PolicyServerError, match="'joint_position', and those of preset 'dro"):
            wrong.reset(context())


def test_a_served_policy_may_write_into_its_observation():
    class Writes(Policy):
        def act(self, observation: Any) -> Any:
            observation["q"] += 1
            return {ARM: observation["q"], GRIPPER: observation["time"]}

    with serving(lambda: PolicySession(Writes(), cell())) as made:
        reply = OpenpiClient(made.url).infer({"q": np.zeros(2), "time": np.float64(0.5)})
        assert reply["actions"].tolist() == [[1.0, 1.0, 0.5]]


def test_silent_connections_do_not_pile_up(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(server, "MOST_CLIENTS", 2)
    with serving() as made:
        silent = [raw(made) for _ in range(5)]
        assert silent[-1].recv(10) == b""
        assert len(made._channels) == 4


def test_a_single_action_is_a_chunk_of_one():
    with serving(lambda: PolicySession(Single(), cell())) as made:
        reply = OpenpiClient(made.url).infer({"prompt": "go"})
        assert reply["actions"].shape == (1, 8)
        assert reply["action_columns"] == [[ARM, 7], [GRIPPER, 1]]


def test_a_policy_serves_one_client_after_the_other(tmp_path: Path):
    (tmp_path / "served_policy.py").write_text(
        "from robocell.policy import Policy\n"
        "MADE = []\n"
        "class Mine(Policy):\n"
        "    def __init__(self):\n"
        "        MADE.append(self)\n"
        "    def act(self, observation):\n"
        "        return {'x': [float(len(MADE))]}\n"
    )
    made = policy_server(f"{tmp_path / 'served_policy.py'}:Mine", port=0)
    thread = threading.Thread(target=made.serve, daemon=True)
    thread.start()
    first = OpenpiClient(made.url)
    assert first.infer({})["actions"].tolist() == [[1.0]], "made before the first client"
    second = OpenpiClient(made.url)
    assert second.infer({})["actions"].tolist() == [[2.0]], "two clients have two policies"
    first.socket.close()
    second.socket.close()
    for _ in range(100):
        third = OpenpiClient(made.url)
        if third.infer({})["actions"].tolist() == [[2.0]]:
            break
        third.socket.close()
        time.sleep(0.02)
    else:
        pytest.fail("a free policy is not used again")
    made.close()
    thread.join(5)


def test_what_cannot_be_served_is_explained(tmp_path: Path):
    def refused(*arguments: Any, **options: Any) -> str:
        with pytest.raises(rc.Error) as caught:
            policy_server(*arguments, port=0, **options)
        return str(caught.value)

    assert "needs the cell: name a dataset with --run" in refused("replay")
    assert "needs the cell: name a run file or a dataset" in refused("random")
    assert "--preset droid needs the cell" in refused("mine.py:Mine", preset="droid")
    assert "expected module:Class" in refused("mine")
    assert "there is no such file" in refused(f"{tmp_path / 'no.py'}:Mine")


def test_metadata_can_be_read_without_robocell():
    with serving(metadata={"policy": "x"}) as made:
        greeting = OpenpiClient(made.url).metadata
        assert json.loads(json.dumps(greeting)) == {
            "server": "robocell",
            "endpoints": ["infer", "reset"],
            "policy": "x",
        }


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"observation/joint_position": np.full(7, np.nan, np.float32)}, "not finite"),
        ({"observation/joint_position": np.zeros(5, np.float32)}, "has 7 numbers, got 5"),
        ({"observation/joint_position": "left"}, "is no array of numbers"),
        ({"observation/joint_position": None}, "has 7 numbers, got 1"),
        ({"observation/wrist_image_left": np.zeros((4, 4), np.uint8)}, "height, width, 3"),
        ({"observation/wrist_image_left": np.zeros((4, 4, 3))}, "of uint8"),
    ],
)
def test_a_wrong_observation_is_explained_and_others_are_served(changes: dict[str, Any], said: str):
    bound = Preset.load("droid").bind(features(), CAMERAS)

    class Still(Policy):
        def act(self, observation: Any) -> Any:
            return {each.column: np.zeros((1, each.size)) for each in bound.actions}

    row = {
        "robots/a/arm/qpos": ROW,
        "robots/a/opening": np.array(0.75),
        **{key: np.zeros((48, 64, 3), np.uint8) for key in CAMERAS},
    }
    with serving(lambda: PolicySession(Still(), cell(), bound)) as made:
        good, bad = OpenpiClient(made.url), OpenpiClient(made.url)
        message = bound.message(row, "lift")
        with pytest.raises(RuntimeError, match=said):
            bad.infer(message | changes)
        assert good.infer(message)["actions"].shape == (1, 8)


def test_an_array_of_objects_is_never_unpickled():
    pickled = {b"__ndarray__": True, b"data": b"\x80\x04.", b"dtype": "|O", b"shape": [1]}
    with serving() as made:
        client = OpenpiClient(made.url)
        with pytest.raises(RuntimeError, match=r"dtype '\|O'"):
            client.infer({"observation/state": pickled})
        assert OpenpiClient(made.url).infer({})["actions"][0, 0] == 1
