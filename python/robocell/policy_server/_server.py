"""Serves policies over the openpi WebSocket protocol: one thread and one session a connection.

    server = PolicyServer(make_session, port=8000)
    server.serve()  # until server.close()

A client that sends garbage, reads slowly or disappears ends its own connection and nothing else.
`GET /healthz` answers OK. Browsers are refused: a page must not drive a robot.
"""

from __future__ import annotations

import contextlib
import hmac
import http
import socket
import sys
import threading
import time
import traceback
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from robocell._core import ArgumentError, Error, IoError
from robocell._extras import needed_by
from robocell._own_code import RAISED, raise_interrupt
from robocell.policy_server._batches import (
    BATCH,
    MOST_MESSAGES,
    RESET,
    Batches,
    InfersMany,
    endpoint_of,
)
from robocell.policy_server._channel import Channel, Deadline, DroppedError, MisbehavedError
from robocell.policy_server._client import key_of
from robocell.policy_server._wire import pack, unpack

with needed_by("robocell.policy_server", "policy"):
    from websockets.frames import CloseCode
    from websockets.http11 import Request
    from websockets.server import ServerProtocol

HOST, PORT = "127.0.0.1", 8000
MOST_BYTES = 64 << 20  # of an observation
MOST_CLIENTS = 32
MESSAGE_S = 30.0  # for a message, once its first byte is there, and for its answer to be read
HANDSHAKE_S = 10.0


class Session(Protocol):
    """What one client talks to. Errors of its methods are sent to the client as text."""

    def infer(self, observation: dict[str, Any]) -> Mapping[str, Any]:
        """Returns the reply to an observation."""

    def reset(self, info: Mapping[str, Any]) -> None:
        """Begins a rollout."""


class PassesOn:
    """A session that answers messages as they are."""

    def infer(self, observation: dict[str, Any]) -> Mapping[str, Any]:
        """Is never called."""
        raise NotImplementedError

    def reset(self, info: Mapping[str, Any]) -> None:
        """Is never called."""
        raise NotImplementedError

    def answer(self, message: bytes | str) -> bytes | str:
        """Returns the answer to a message."""
        raise NotImplementedError


class PolicyServer:
    """Listens from its construction on.

    Args:
        make_session: Makes the session of a connection.
        metadata: First message to each client.
        host: Address to listen at; only this machine reaches the default.
        port: 0 for a free one; see `port`.
        api_key: Clients must send it as `Authorization: Api-Key`. Default: the variable
            ROBOCELL_POLICY_API_KEY; "" for none.
        most_bytes: Largest observation.
        end_session: Called with a session when its client has gone.
        batch: Acts in several rollouts at once; clients may then send several observations in one
            message (endpoint `batch`).
        most_clients: Clients at one time.

    Attributes:
        host: The address.
        port: The port.

    Raises:
        IoError: The address or the port cannot be used.
    """

    def __init__(
        self,
        make_session: Callable[[], Session],
        metadata: Mapping[str, Any] | None = None,
        *,
        host: str = HOST,
        port: int = PORT,
        api_key: str | None = None,
        most_bytes: int = MOST_BYTES,
        end_session: Callable[[Session], None] | None = None,
        batch: InfersMany | None = None,
        most_clients: int | None = None,
    ) -> None:
        if not 0 <= port < 65536:
            raise ArgumentError(f"port must be from 0 to 65535, got {port}")
        self._make_session, self._end_session = make_session, end_session
        self._batch = batch
        self._most_clients = most_clients or MOST_CLIENTS
        own: dict[str, Any] = {"server": "robocell", "endpoints": ["infer", "reset"]}
        if batch is not None:
            own |= {"endpoints": ["infer", "reset", BATCH], BATCH: MOST_MESSAGES}
        self._metadata = pack(own | dict(metadata or {}))
        self._key = key_of(api_key)
        self._most_bytes = most_bytes
        self._channels: set[Channel] = set()
        self._lock = threading.Lock()
        self._closed = False
        self._socket = _listening(host, port)
        self.host, self.port = self._socket.getsockname()[:2]

    @property
    def url(self) -> str:
        """URL for clients on this machine or, with another host, elsewhere.

        Example:
            >>> from robocell.policy_server import PolicyServer
            >>> PolicyServer(session, host="127.0.0.1", port=8000).url  # doctest: +SKIP
            'ws://127.0.0.1:8000'
        """
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"ws://{host}:{self.port}"

    @property
    def has_key(self) -> bool:
        """True if clients need a key."""
        return bool(self._key)

    def serve(self) -> None:
        """Answers clients until `close` is called from another thread or a signal handler."""
        while not self._closed:
            try:
                connection, _ = self._socket.accept()
            except OSError:
                if self._closed:
                    return
                time.sleep(0.05)  # out of file descriptors, for example
                continue
            self._begin(connection)

    def _begin(self, connection: socket.socket) -> None:
        """Starts the thread of a connection."""
        protocol = ServerProtocol(origins=[None], max_size=self._most_bytes)
        channel = Channel(connection, protocol)
        with self._lock:
            others = len(self._channels)
            if others < 2 * self._most_clients:
                self._channels.add(channel)
        if others >= 2 * self._most_clients:  # also of those that say nothing
            channel.abort()
            return
        threading.Thread(
            target=self._serve_client,
            args=(channel, protocol, others >= self._most_clients),
            name="policy client",
            daemon=True,
        ).start()

    def close(self) -> None:
        """Stops listening and ends all connections."""
        self._closed = True
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()
        with self._lock:
            channels = list(self._channels)
        for channel in channels:
            channel.abort()

    def _serve_client(
        self, channel: Channel, protocol: ServerProtocol, is_one_too_many: bool
    ) -> None:
        try:
            if self._accepts(channel, protocol, is_one_too_many):
                self._converse(channel)
        except (DroppedError, MisbehavedError, TimeoutError):
            pass  # the client's end of the connection
        finally:
            channel.close()
            with self._lock:
                self._channels.discard(channel)

    def _accepts(self, channel: Channel, protocol: ServerProtocol, is_one_too_many: bool) -> bool:
        """Answers the HTTP request of a client. Returns True if it may speak WebSocket."""
        deadline = Deadline(HANDSHAKE_S, "request")
        request = channel.handshake(deadline)
        if not isinstance(request, Request) or protocol.parser_exc is not None:
            return False
        if request.path.partition("?")[0] == "/healthz":
            response = protocol.reject(http.HTTPStatus.OK, "OK\n")
        elif is_one_too_many:
            response = protocol.reject(
                http.HTTPStatus.SERVICE_UNAVAILABLE,
                f"There are {self._most_clients} clients already.\n",
            )
        elif not self._has_key(request):
            response = protocol.reject(
                http.HTTPStatus.UNAUTHORIZED, "Send the header 'Authorization: Api-Key KEY'.\n"
            )
        else:
            response = protocol.accept(request)
        protocol.send_response(response)
        channel.flush(deadline)
        return response.status_code == http.HTTPStatus.SWITCHING_PROTOCOLS

    def _has_key(self, request: Request) -> bool:
        if not self._key:
            return True
        given = request.headers.get_all("Authorization")
        wanted = f"Api-Key {self._key}".encode()
        # The time of this comparison says nothing about the key.
        return len(given) == 1 and hmac.compare_digest(
            given[0].encode("utf-8", "surrogateescape"), wanted
        )

    def _converse(self, channel: Channel) -> None:
        channel.send(self._metadata, Deadline(MESSAGE_S, "reader"))
        session: Session | None = None
        batches = None if self._batch is None else Batches(self._batch, _text_of)
        try:
            while True:
                message = channel.receive(Deadline(MESSAGE_S, "message"), idle=True)
                try:
                    envelope = None if batches is None else _envelope(message)
                    if batches is not None and envelope is not None:
                        answer: bytes | str = batches.answer(envelope)
                    else:
                        if session is None:
                            session = self._make_session()
                        answer = _answer(session, message)
                except DroppedError:  # of the server that a relay asks
                    raise
                except RAISED as error:
                    raise_interrupt(error)
                    channel.send(_text_of(error), Deadline(MESSAGE_S, "reader"))
                    channel.close(CloseCode.INTERNAL_ERROR, "The error is in the message before.")
                    return
                channel.send(answer, Deadline(MESSAGE_S, "reader"))
        finally:
            if session is not None and self._end_session is not None:
                self._end_session(session)


def _listening(host: str, port: int) -> socket.socket:
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        listening = socket.socket(family, kind, protocol)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind(address)
        listening.listen(MOST_CLIENTS)
    except OSError as error:
        raise IoError(
            f"cannot listen at {host}:{port}: {error.strerror or error}. Choose another --port, or "
            "0 for a free one"
        ) from error
    return listening


def _envelope(message: bytes | str) -> dict[str, Any] | None:
    """Returns a message with several messages in it; None for an ordinary one."""
    if isinstance(message, str) or BATCH.encode() not in message:
        return None
    content = unpack(message)
    is_batch = isinstance(content, dict) and content.get("endpoint") == BATCH
    return content if is_batch else None


def _answer(session: Session, message: bytes | str) -> bytes | str:
    """Returns the answer to a message of a client."""
    if isinstance(session, PassesOn):
        return session.answer(message)
    endpoint, observation = endpoint_of(message)
    if endpoint == "reset":
        session.reset(observation)
        return RESET
    began = time.perf_counter()
    reply = dict(session.infer(observation))
    reply["server_timing"] = {"infer_ms": 1e3 * (time.perf_counter() - began)}
    return pack(reply)


def _text_of(error: BaseException) -> str:
    """Returns "error: KeyError: 'x' (mine.py:12, in act)"; the traceback is printed here."""
    from robocell._raised import is_of_own_code, place_of, text_of

    if is_of_own_code(error) or not isinstance(error, Error):
        traceback.print_exception(error, file=sys.stderr)
        return f"error: {place_of(error)}"
    print(f"error: {text_of(error)}", file=sys.stderr, flush=True)
    return f"error: {text_of(error)}"
