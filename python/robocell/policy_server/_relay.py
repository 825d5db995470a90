"""One connection to a policy server for all workers of an evaluation.

The relay listens on this machine. Observations that arrive while the server is busy are its next
batch, so batches grow with the time of a call, and no observation waits for others to come.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import queue
import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from robocell._channel import DroppedError
from robocell._core import Error
from robocell.policy_server._batches import BATCH, MOST_MESSAGES
from robocell.policy_server._client import LostServerError, PolicyClient, PolicyServerError
from robocell.policy_server._server import MOST_BYTES, PassesOn, PolicyServer
from robocell.policy_server._wire import WireError, unpack

RELAY = (
    "ROBOCELL_POLICY_RELAY"  # environment variable of workers: URL of the server, and the relay's
)
MOST_ANSWER_BYTES = 256 << 20
SPARE_CLIENTS = 8  # of workers that died a moment ago


@contextlib.contextmanager
def relaying(
    url: str, greeting: Mapping[str, Any], workers: int, timeout_s: float
) -> Iterator[None]:
    """Lets processes that start inside the block share a connection, if the server takes batches.

    Args:
        url: The server's.
        greeting: Its metadata.
        workers: Number of processes.
        timeout_s: Longest time of a call.
    """
    most = greeting.get(BATCH)
    if workers < 2 or type(most) is not int or most < 2 or not url.startswith(("ws://", "wss://")):
        yield
        return
    relay = Relay(url, workers, timeout_s, most)
    before = os.environ.get(RELAY)
    os.environ[RELAY] = f"{url} {relay.url}"
    try:
        yield
    finally:
        os.environ.pop(RELAY)
        if before is not None:
            os.environ[RELAY] = before
        relay.close()


def relay_of(url: str) -> str:
    """Returns the URL of the relay to a server; "" without one."""
    server, _, relay = os.environ.get(RELAY, "").partition(" ")
    return relay if server == url else ""


@dataclass
class _Request:
    """A message of a client, and its answer once `done` is set."""

    session: int
    connection: int
    message: bytes
    done: threading.Event = field(default_factory=threading.Event)
    answer: bytes | str = b""
    error: Exception | None = None


class Relay:
    """Passes messages of several clients on to one policy server, as many as there are at a time.

    When the connection to the server drops, those of all clients do: they connect again, and say
    which rollout they are in.

    Args:
        url: The server's.
        workers: Number of clients.
        timeout_s: Longest time of a call.
        most: Messages of an envelope that the server takes.

    Attributes:
        url: The relay's.
    """

    def __init__(self, url: str, workers: int, timeout_s: float, most: int) -> None:
        self._most = min(most, MOST_MESSAGES)
        self._client = PolicyClient(url, timeout_s, most_bytes=MOST_ANSWER_BYTES)
        self._requests: queue.SimpleQueue[_Request | None] = queue.SimpleQueue()
        self._numbers = itertools.count()
        self._ended: queue.SimpleQueue[int] = queue.SimpleQueue()
        self._connection = 0  # number of the connection to the server
        metadata = {k: v for k, v in self._client.connect().items() if k != BATCH}
        self._server = PolicyServer(
            lambda: _Passing(self),
            metadata | {"endpoints": ["infer", "reset"]},
            port=0,
            end_session=lambda session: (
                self._ended.put(session.number) if isinstance(session, _Passing) else None
            ),
            most_clients=workers + SPARE_CLIENTS,
        )
        self.url = self._server.url
        self._threads = [
            threading.Thread(target=work, name="policy relay", daemon=True)
            for work in (self._server.serve, self._pass_on)
        ]
        for thread in self._threads:
            thread.start()

    @property
    def connection(self) -> int:
        """Number of the present connection to the server."""
        return self._connection

    def new_number(self) -> int:
        """Returns the number of a new session."""
        return next(self._numbers)

    def ask(self, session: int, connection: int, message: bytes) -> bytes | str:
        """Returns the server's answer to a message of a session, which began in a connection.

        Raises:
            DroppedError: The connection to the server is gone.
            PolicyServerError: The server answers with something else than a batch, or too late.
        """
        request = _Request(session, connection, message)
        self._requests.put(request)
        request.done.wait()
        if request.error is not None:
            raise request.error
        return request.answer

    def close(self) -> None:
        """Ends all connections."""
        self._server.close()
        self._requests.put(None)
        for thread in self._threads:
            thread.join(5.0)
        self._client.close()

    def _pass_on(self) -> None:
        """Runs the thread that talks to the server."""
        held: list[_Request] = []  # for the next envelope: this one is full
        while True:
            first = held.pop(0) if held else self._requests.get()
            if first is None:
                return self._refuse()
            requests, size = [first], len(first.message)
            while len(requests) < self._most and (held or not self._requests.empty()):
                following = held.pop(0) if held else self._requests.get()
                if following is None:
                    self._requests.put(None)
                    break
                size += len(following.message)
                if size > MOST_BYTES // 2:
                    held.insert(0, following)
                    break
                requests.append(following)
            self._answer(requests)
            for request in requests:
                request.done.set()

    def _answer(self, requests: Sequence[_Request]) -> None:
        # A server that was connected to again knows nothing of the sessions before.
        known = [each for each in requests if each.connection == self._connection]
        for request in requests:
            request.error = DroppedError("the connection to the server was lost")
        if not known:
            return
        try:
            answers = self._exchange(known)
        except Exception as error:
            for request in known:
                request.error = error
            return
        for request, answer in zip(known, answers, strict=True):
            request.answer, request.error = answer, None

    def _refuse(self) -> None:
        """Ends the calls that nobody answers any more."""
        while not self._requests.empty():
            request = self._requests.get()
            if request is not None:
                request.error = DroppedError("the evaluation has ended")
                request.done.set()

    def _exchange(self, requests: Sequence[_Request]) -> list[bytes | str]:
        ended = []
        while not self._ended.empty():
            ended.append(self._ended.get())
        envelope = {
            "endpoint": BATCH,
            "sessions": [request.session for request in requests],
            "messages": [request.message for request in requests],
            "ended": ended,
        }
        try:
            answer = self._client.exchange(envelope)
        except LostServerError as error:
            raise DroppedError(str(error)) from error
        except (DroppedError, PolicyServerError):
            self._connection += 1
            raise
        return _answers(answer, len(requests))


def _answers(answer: bytes | str, count: int) -> list[bytes | str]:
    """Returns the answers in an envelope."""
    if isinstance(answer, str):
        raise PolicyServerError(f"the server has an error: {answer[:500]}")
    content: Any = unpack(answer)
    answers = content.get("answers") if isinstance(content, dict) else None
    if (
        not isinstance(answers, list)
        or len(answers) != count
        or not all(isinstance(each, bytes | str) for each in answers)
    ):
        raise WireError(f"the server was sent {count} messages in a batch, and did not answer each")
    return answers


class _Passing(PassesOn):
    """One client of the relay."""

    def __init__(self, relay: Relay) -> None:
        self.number = relay.new_number()
        self._relay = relay
        self._connection = relay.connection

    def answer(self, message: bytes | str) -> bytes | str:
        """Returns the server's answer to a message."""
        if isinstance(message, str):
            raise Error("an observation is a binary message of msgpack, not a text")
        return self._relay.ask(self.number, self._connection, message)
