"""Serves policies over the openpi WebSocket protocol: one thread and one session a connection.

    server = PolicyServer(make_session, port=8000)
    server.serve()  # until server.close()

A client that sends garbage, reads slowly or disappears ends its own connection and nothing else.
`GET /healthz` answers OK. Browsers are refused: a page must not drive a robot.
"""

from __future__ import annotations

import hmac
import http
import sys
import time
import traceback
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from robocell._channel import Channel, ChannelServer, Deadline, DroppedError
from robocell._core import Error
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


class PolicyServer(ChannelServer):
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
        self._make_session, self._end_session = make_session, end_session
        self._batch = batch
        own: dict[str, Any] = {"server": "robocell", "endpoints": ["infer", "reset"]}
        if batch is not None:
            own |= {"endpoints": ["infer", "reset", BATCH], BATCH: MOST_MESSAGES}
        self._metadata = pack(own | dict(metadata or {}))
        self._key = key_of(api_key)
        self._most_bytes = most_bytes
        super().__init__(host, port, most_clients or MOST_CLIENTS, "policy client")

    @property
    def url(self) -> str:
        """URL for clients on this machine or, with another host, elsewhere.

        Example:
            >>> from robocell.policy_server import PolicyServer
            >>> PolicyServer(session, host="127.0.0.1", port=8000).url  # doctest: +SKIP
            'ws://127.0.0.1:8000'
        """
        return f"ws://{self.netloc}"

    @property
    def has_key(self) -> bool:
        """True if clients need a key."""
        return bool(self._key)

    def protocol(self) -> ServerProtocol:
        """Returns the state of a new connection, which no browser may open."""
        return ServerProtocol(origins=[None], max_size=self._most_bytes)

    def serve_client(
        self, channel: Channel, protocol: ServerProtocol, is_one_too_many: bool
    ) -> None:
        """Answers the messages of a client."""
        if self._accepts(channel, protocol, is_one_too_many):
            self._converse(channel)

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
