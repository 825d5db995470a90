"""Asks a policy server for actions, over the openpi WebSocket protocol.

    with PolicyClient("ws://127.0.0.1:8000") as client:
        reply = client.infer({"observation/state": state, "prompt": "pick up the cube"})
        reply.actions  # (10, 8)

The server's first message is its metadata; then every binary message with an observation is
answered by one with actions, or by a text with an error. Servers of RoboArena begin with their
configuration and take an `endpoint` in each observation.
"""

from __future__ import annotations

import contextlib
import math
import os
import socket
import ssl
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._channel import Channel, Deadline, DroppedError, MisbehavedError
from robocell._core import ArgumentError, Error
from robocell._extras import needed_by
from robocell._raised import LostPolicyError
from robocell._suggestions import shortened
from robocell.policy_server._wire import WireError, name_of, pack, unpack

with needed_by("robocell.policy_server", "policy"):
    from websockets.client import ClientProtocol
    from websockets.exceptions import InvalidURI
    from websockets.http11 import Response
    from websockets.uri import WebSocketURI, parse_uri

KEY = "ROBOCELL_POLICY_API_KEY"  # environment variable of both ends
TIMEOUT_S = 120.0  # a server may compile its network at the first observation
CONNECT_S = 10.0
MOST_BYTES = 16 << 20  # of a reply: actions are small
MOST_ACTIONS = 4096  # rows of a chunk
LONGEST_ERROR = 500
ROBOARENA = {"action_space", "n_external_cameras"}  # fields of its configuration


class PolicyServerError(Error):
    """The server answered with an error, with something else than actions, or too late."""


class LostServerError(LostPolicyError):
    """There is no connection to the server, also after another try."""


def key_of(given: str | None) -> str:
    """Returns the key of one end; without `given`, that of the environment, or "".

    Raises:
        ArgumentError: It cannot be part of a header.
    """
    # A key from a file often ends with a line break.
    key = (os.environ.get(KEY, "") if given is None else given).strip()
    if not (key.isascii() and key.isprintable()):
        raise ArgumentError(f"the key of a policy server, {KEY}, has printable ASCII characters")
    return key


def parse_url(url: str) -> WebSocketURI:
    """Returns the parts of a server's URL. Raises ArgumentError for another text."""
    try:
        uri = parse_uri(url)
    except (InvalidURI, ValueError) as error:
        raise ArgumentError(
            f"policy '{url}': expected the URL of a policy server, such as ws://127.0.0.1:8000"
        ) from error
    if uri.username or uri.password:
        raise ArgumentError(
            f"policy server '{uri.host}': a key in the URL would be stored with the results; put "
            f"it into the environment variable {KEY}"
        )
    return uri


@dataclass(frozen=True)
class Reply:
    """Answer of a server.

    Attributes:
        actions: One action (n,), or a chunk (k, n).
        columns: Name and size of each part of an action, if the server names them.
        server_ms: Time that the server says it needed; NaN if it says nothing.
        call_ms: Time of the whole call.
    """

    actions: NDArray[Any]
    columns: tuple[tuple[str, int], ...] = ()
    server_ms: float = math.nan
    call_ms: float = math.nan


@dataclass
class PolicyClient:
    """Client of one policy server; for one thread.

    A call that finds the connection dropped connects once more, begins the rollout again if the
    server takes `endpoint: reset`, and repeats itself. Every call ends within `timeout_s`, and 10 s
    more if it has to connect.

    Attributes:
        url: `ws://host:port`, or `wss://` for TLS.
        timeout_s: Longest time of a call, from the observation to the actions.
        api_key: Sent as `Authorization: Api-Key`; default: the variable ROBOCELL_POLICY_API_KEY.
        most_bytes: Largest message that is accepted.
        metadata: First message of the server.

    Examples:
        >>> client = PolicyClient("ws://127.0.0.1:8000")  # doctest: +SKIP
        >>> client.infer({"observation/state": state, "prompt": "stack"}).actions  # doctest: +SKIP
    """

    url: str
    timeout_s: float = TIMEOUT_S
    api_key: str | None = field(default=None, repr=False)
    most_bytes: int = MOST_BYTES
    metadata: dict[str, Any] = field(default_factory=dict, init=False)
    _channel: Channel | None = field(default=None, init=False, repr=False)
    _begun: dict[str, Any] | None = field(default=None, init=False, repr=False)  # the last reset

    def __post_init__(self) -> None:
        self._uri = parse_url(self.url)
        if not self.timeout_s > 0:
            raise ArgumentError(f"timeout_s must be above 0, got {self.timeout_s}")
        self.api_key = key_of(self.api_key)

    def __enter__(self) -> PolicyClient:
        self.connect()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def has_endpoints(self) -> bool:
        """True if the server takes `endpoint: infer` and `endpoint: reset`."""
        return self.metadata.keys() >= ROBOARENA or "endpoints" in self.metadata

    def connect(self) -> dict[str, Any]:
        """Connects anew and returns the server's metadata.

        Raises:
            LostServerError: There is no policy server.
            PolicyServerError: The server wants another key, or its first message is wrong.
        """
        self.close()
        deadline = Deadline(CONNECT_S, "handshake")
        try:
            self._channel = self._open(deadline)
            first = self._channel.receive(deadline)
        except (OSError, DroppedError, MisbehavedError) as error:
            self.close()
            remedy = (
                ". Start it; `robocell serve-policy` serves a policy of yours"
                if isinstance(error, ConnectionRefusedError)
                else ""
            )
            raise LostServerError(
                f"no policy server at {self.url}: {getattr(error, 'strerror', None) or error}"
                f"{remedy}"
            ) from error
        if isinstance(first, str):
            raise self._refused(f"the server's first message is an error: {_brief(first)}")
        metadata = self._unpacked(first)
        if not isinstance(metadata, dict):
            raise self._refused(f"the server's metadata are no map but {type(metadata).__name__}")
        self.metadata = {name_of(name): value for name, value in metadata.items()}
        return self.metadata

    def close(self) -> None:
        """Closes the connection."""
        channel, self._channel = self._channel, None
        if channel is not None:
            channel.close()

    def reset(
        self, info: Mapping[str, Any] | None = None, own: Mapping[str, Any] | None = None
    ) -> None:
        """Begins a rollout: a server with endpoints hears `info`, one of robocell also `own`.

        Another server gets a new connection: some keep the state of a policy for each.
        """
        self._begun = None
        if self._channel is None or not self.has_endpoints:
            self.connect()
        if self.has_endpoints:
            is_own = self.metadata.get("server") == "robocell"
            more = own if own is not None and is_own else {}
            begun = {**(info or {}), **more, "endpoint": "reset"}
            self._require_reset(self._ask(begun))
            self._begun = begun

    def infer(self, observation: Mapping[str, Any]) -> Reply:
        """Returns the server's actions for an observation.

        Raises:
            LostServerError: The connection is gone and cannot be made again.
            PolicyServerError: The server answers with an error, with something else than actions,
                or too late.
        """
        began = time.perf_counter()
        message = dict(observation)
        if self._channel is None and self._begun is None:
            self.connect()
        if self.has_endpoints:
            message["endpoint"] = "infer"
        answer = self._ask(message)
        if isinstance(answer, str):
            raise self._refused(f"the server has an error: {_brief(answer)}")
        try:
            reply = _reply(self._unpacked(answer))
        except WireError as error:
            raise self._refused(str(error)) from error
        elapsed = 1e3 * (time.perf_counter() - began)
        return Reply(reply.actions, reply.columns, reply.server_ms, elapsed)

    def _ask(self, message: Mapping[str, Any]) -> bytes | str:
        """Sends a message and returns its answer; tries once more on a new connection."""
        data = pack(message)
        deadline = Deadline(self.timeout_s, "answer")
        for last in (False, True):
            try:
                if self._channel is None:
                    self.connect()
                    self._begin_again(deadline)
                assert self._channel is not None
                self._channel.send(data, deadline)
                return self._channel.receive(deadline)
            except (TimeoutError, MisbehavedError) as error:
                # A late answer would be taken for that of the next observation.
                raise self._refused(str(error)) from error
            except DroppedError as error:
                self.close()
                if last:
                    raise LostServerError(f"policy server {self.url}: {error}") from error
        raise AssertionError("unreachable")

    def exchange(self, message: Mapping[str, Any]) -> bytes | str:
        """Sends a message as it is, and returns its answer; connects first if needed.

        Raises:
            DroppedError: The connection is gone; the next call makes a new one.
            LostServerError: There is no policy server.
            PolicyServerError: The answer is no message, or late.
        """
        if self._channel is None:
            self.connect()
        assert self._channel is not None
        deadline = Deadline(self.timeout_s, "answer")
        try:
            self._channel.send(pack(message), deadline)
            return self._channel.receive(deadline)
        except (TimeoutError, MisbehavedError) as error:
            raise self._refused(str(error)) from error
        except DroppedError:
            self.close()
            raise

    def _begin_again(self, deadline: Deadline) -> None:
        """Announces the rollout to a connection that is made in the middle of it."""
        if self._begun is not None and self.has_endpoints and self._channel is not None:
            self._channel.send(pack(self._begun), deadline)
            self._require_reset(self._channel.receive(deadline))

    def _require_reset(self, answer: bytes | str) -> None:
        if isinstance(answer, str) and answer.startswith(("Traceback", "error:")):
            raise self._refused(f"the server cannot reset: {_brief(answer)}")

    def _refused(self, text: str) -> PolicyServerError:
        """Closes the connection and returns the error."""
        self.close()
        return PolicyServerError(f"policy server {self.url}: {text}")

    def _unpacked(self, data: bytes | str) -> Any:
        try:
            return unpack(data if isinstance(data, bytes) else data.encode())
        except WireError as error:
            raise self._refused(str(error)) from error

    def _open(self, deadline: Deadline) -> Channel:
        uri = self._uri
        sock = socket.create_connection((uri.host, uri.port), timeout=deadline.left())
        try:
            if uri.secure:
                context = ssl.create_default_context()
                sock = context.wrap_socket(sock, server_hostname=uri.host)
            protocol = ClientProtocol(uri, max_size=self.most_bytes)
            request = protocol.connect()
            if self.api_key:
                request.headers["Authorization"] = f"Api-Key {self.api_key}"
            protocol.send_request(request)
            channel = Channel(sock, protocol)
            channel.flush(deadline)
            response = channel.handshake(deadline)
        except BaseException:
            with contextlib.suppress(OSError):
                sock.close()
            raise
        if protocol.handshake_exc is None:
            return channel
        channel.abort()
        status = response.status_code if isinstance(response, Response) else 0
        if status in (401, 403):
            raise PolicyServerError(
                f"policy server {self.url} refuses the connection ({status}): set the variable "
                f"{KEY} to its key"
            )
        raise DroppedError(f"{protocol.handshake_exc}")


def _brief(text: str) -> str:
    """Returns the last line of a traceback, or the beginning of another text."""
    lines = [line.strip() for line in text.strip().splitlines() if line.strip()]
    answer = lines[-1] if lines and lines[0].startswith("Traceback") else " ".join(lines)
    return answer[:LONGEST_ERROR] + (" ..." if len(answer) > LONGEST_ERROR else "")


def _reply(message: object) -> Reply:
    """Reads {"actions": array, ...}, {"action": array} or an array alone."""
    if not isinstance(message, dict):
        return Reply(_actions(message))
    name = next((name for name in ("actions", "action") if name in message), None)
    if name is None:
        known = [str(key) for key in message]
        raise WireError(f"the reply has no 'actions'. It has: {shortened(known) or 'nothing'}")
    timing = message.get("server_timing")
    server_ms = timing.get("infer_ms") if isinstance(timing, dict) else None
    known_ms = isinstance(server_ms, int | float | np.number) and math.isfinite(server_ms)
    return Reply(
        _actions(message[name]),
        _columns(message.get("action_columns")),
        float(server_ms) if known_ms and server_ms is not None else math.nan,
    )


def _actions(values: object) -> NDArray[Any]:
    if isinstance(values, list):
        try:
            values = np.array(values, dtype=np.float64)
        except (ValueError, TypeError) as error:
            raise WireError("the actions are a list of something else than numbers") from error
    if not isinstance(values, np.ndarray):
        raise WireError(f"the actions are no array but {type(values).__name__}")
    if values.ndim not in (1, 2) or not values.size:
        raise WireError(f"actions have the shape (n,) or (k, n); got {values.shape}")
    if values.ndim == 2 and len(values) > MOST_ACTIONS:
        raise WireError(f"a chunk has {len(values)} actions; at most {MOST_ACTIONS}")
    if not np.isfinite(values).all():
        at = tuple(int(i) for i in np.argwhere(~np.isfinite(values))[0])
        raise WireError(f"an action is not finite: entry {list(at)} is {values[at]}")
    return values


def _columns(listed: object) -> tuple[tuple[str, int], ...]:
    if listed is None:
        return ()
    if not isinstance(listed, list) or not all(
        isinstance(each, list)
        and len(each) == 2
        and isinstance(each[0], str)
        and type(each[1]) is int
        and each[1] > 0
        for each in listed
    ):
        raise WireError("'action_columns' is a list of [name, size]")
    return tuple((name, size) for name, size in listed)
