"""Asks a GR00T server for actions, over its ZeroMQ protocol.

    with GrootClient("zmq://127.0.0.1:5555") as client:
        client.modalities["action"]  # ("arm", "gripper"): the parts of an action, in order
        client.infer({"video": {"wrist": image}, "state": {"arm": q}, "language": {...}}).actions

A request is a map with `endpoint` and `data`. Arrays are files of numpy in bytes; observations have
a batch and a time before their own shape. A map with `error` is an error.
"""

from __future__ import annotations

import socket
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlsplit

import numpy as np
from numpy.typing import NDArray

from robocell._channel import Deadline, DroppedError, MisbehavedError
from robocell._core import ArgumentError
from robocell.policy_server._client import (
    CONNECT_S,
    KEY,
    MOST_BYTES,
    TIMEOUT_S,
    LostServerError,
    PolicyServerError,
    Reply,
    _actions,
    _brief,
    key_of,
)
from robocell.policy_server._wire import WireError, name_of, pack, unpack
from robocell.policy_server._zmtp import RequestSocket

SCHEME = "zmq"
PORT = 5555
MODALITIES = ("video", "state", "language", "action")


def parse_groot_url(url: str) -> tuple[str, int]:
    """Returns host and port of `zmq://host:port`. Raises ArgumentError for another text."""
    try:
        parts = urlsplit(url)
        host, port = parts.hostname, parts.port or PORT
    except ValueError:
        host = None
    if host is None or parts.scheme != SCHEME or parts.path not in ("", "/"):
        raise ArgumentError(
            f"policy '{url}': expected the URL of a GR00T server, such as zmq://127.0.0.1:{PORT}"
        )
    if parts.username or parts.password:
        raise ArgumentError(
            f"policy server '{host}': a key in the URL would be stored with the results; put it "
            f"into the environment variable {KEY}"
        )
    return host, port


@dataclass
class GrootClient:
    """Client of one GR00T server; for one thread.

    A call that finds the connection dropped connects once more and repeats itself. Every call ends
    within `timeout_s`, and 10 s more if it has to connect.

    Attributes:
        url: `zmq://host:port`.
        timeout_s: Longest time of a call.
        api_key: Sent as `api_token`; default: the variable ROBOCELL_POLICY_API_KEY.
        most_bytes: Largest reply that is accepted.
        modalities: Names of the parts of `video`, `state`, `language` and `action`, in order, as
            the server lists them.
        metadata: The same, for the result of an evaluation.

    Examples:
        >>> client = GrootClient("zmq://127.0.0.1:5555")  # doctest: +SKIP
    """

    url: str
    timeout_s: float = TIMEOUT_S
    api_key: str | None = field(default=None, repr=False)
    most_bytes: int = MOST_BYTES
    modalities: dict[str, tuple[str, ...]] = field(default_factory=dict, init=False)
    metadata: dict[str, Any] = field(default_factory=dict, init=False)
    _socket: RequestSocket | None = field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        self._address = parse_groot_url(self.url)
        if not self.timeout_s > 0:
            raise ArgumentError(f"timeout_s must be above 0, got {self.timeout_s}")
        self.api_key = key_of(self.api_key)

    def __enter__(self) -> GrootClient:
        self.connect()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def connect(self) -> dict[str, Any]:
        """Connects anew and returns what the server says about its modalities.

        Raises:
            LostServerError: There is no GR00T server.
            PolicyServerError: The server refuses, or lists no modalities.
        """
        self._open()
        listed = self._call("get_modality_config", retries=False)
        if not isinstance(listed, dict):
            raise self._refused("its modalities are no map")
        self.modalities = {}
        for name in MODALITIES:
            self.modalities[name] = self._modality(name, listed.get(name))
        self.metadata = {name: list(keys) for name, keys in self.modalities.items()}
        return self.metadata

    def close(self) -> None:
        """Closes the connection."""
        connection, self._socket = self._socket, None
        if connection is not None:
            connection.close()

    def reset(
        self, info: Mapping[str, Any] | None = None, own: Mapping[str, Any] | None = None
    ) -> None:
        """Begins a rollout."""
        if not self.modalities:
            self.connect()
        self._call("reset", {"options": None})

    def infer(self, observation: Mapping[str, Any]) -> Reply:
        """Returns the server's actions for `video`, `state` and `language`.

        Parts of actions stand side by side, in the order of `modalities["action"]`.

        Raises:
            LostServerError: The connection is gone and cannot be made again.
            PolicyServerError: The server answers with an error, with something else than actions,
                or too late.
        """
        began = time.perf_counter()
        if not self.modalities:
            self.connect()
        answer = self._call("get_action", {"observation": _batched(observation), "options": None})
        parts = answer[0] if isinstance(answer, list) and answer else answer
        if not isinstance(parts, dict):
            raise self._refused(f"the reply has no actions but {type(answer).__name__}")
        try:
            actions = self._joined(parts)
        except WireError as error:
            raise self._refused(str(error)) from error
        return Reply(actions, call_ms=1e3 * (time.perf_counter() - began))

    def _joined(self, parts: Mapping[Any, Any]) -> NDArray[Any]:
        """Returns a chunk (k, n) of parts (1, k, n_i)."""
        named = {name_of(key): value for key, value in parts.items()}
        columns = []
        for name in self.modalities["action"]:
            value = named.get(name)
            if not isinstance(value, np.ndarray) or value.ndim != 3 or len(value) != 1:
                shape = value.shape if isinstance(value, np.ndarray) else "nothing"
                raise WireError(f"action '{name}' has the shape (1, k, n); got {shape}")
            columns.append(_actions(value[0]))
        lengths = {len(column) for column in columns}
        if len(lengths) != 1:
            raise WireError(f"the parts of an action have different lengths: {sorted(lengths)}")
        return np.concatenate(columns, axis=1)

    def _modality(self, name: str, config: object) -> tuple[str, ...]:
        """Returns the keys of a modality. Observations have one time: the present."""
        fields = config.get("as_json", config) if isinstance(config, dict) else None
        keys = fields.get("modality_keys") if isinstance(fields, dict) else None
        if not isinstance(keys, list) or not keys or not all(isinstance(key, str) for key in keys):
            raise self._refused(f"it lists no keys of '{name}'")
        times = fields.get("delta_indices") if isinstance(fields, dict) else None
        if name != "action" and isinstance(times, list) and len(times) != 1:
            raise self._refused(
                f"its {name} has {len(times)} times, and observations have only the present one"
            )
        return tuple(keys)

    def _call(
        self, endpoint: str, data: Mapping[str, Any] | None = None, *, retries: bool = True
    ) -> Any:
        request: dict[str, Any] = {"endpoint": endpoint}
        if data is not None:
            request["data"] = data
        if self.api_key:
            request["api_token"] = self.api_key
        message = pack(request, npy=True)
        deadline = Deadline(self.timeout_s, "answer")
        for last in (False, True) if retries else (True,):
            try:
                if self._socket is None:
                    self._open()
                assert self._socket is not None
                answer = unpack(self._socket.request(message, deadline))
                break
            except (TimeoutError, MisbehavedError, WireError) as error:
                # A late answer would be taken for that of the next observation.
                raise self._refused(str(error)) from error
            except DroppedError as error:
                self.close()
                if last:
                    raise LostServerError(f"policy server {self.url}: {error}") from error
        if isinstance(answer, dict) and "error" in answer:
            text = str(answer["error"])
            remedy = f": set the variable {KEY}" if text.startswith("Unauthorized") else ""
            raise self._refused(f"the server has an error: {_brief(text)}{remedy}")
        return answer

    def _open(self) -> None:
        self.close()
        deadline = Deadline(CONNECT_S, "handshake")
        try:
            sock = socket.create_connection(self._address, timeout=deadline.left())
            try:
                self._socket = RequestSocket(sock, self.most_bytes, deadline)
            except BaseException:
                sock.close()
                raise
        except (OSError, DroppedError, MisbehavedError) as error:
            text = getattr(error, "strerror", None) or error
            raise LostServerError(f"no GR00T server at {self.url}: {text}") from error

    def _refused(self, text: str) -> PolicyServerError:
        """Closes the connection and returns the error."""
        self.close()
        return PolicyServerError(f"policy server {self.url}: {text}")


def _batched(observation: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the observation with a batch of one and the present time before each shape."""
    batched: dict[str, Any] = {}
    for modality, parts in observation.items():
        batched[modality] = {
            name: [[value]] if isinstance(value, str) else np.asarray(value)[None, None]
            for name, value in parts.items()
        }
    return batched
