"""Observations of many rollouts in one message, for policies that take them together.

An envelope is the map {"endpoint": "batch", "sessions": [3, 8], "messages": [bytes, bytes],
"ended": [2]}: ordinary messages of several clients, and the clients that have gone. Its answer is
{"answers": [...]} with the bytes or the text that each message alone would get.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from robocell._own_code import RAISED, raise_interrupt
from robocell.policy_server._wire import WireError, name_of, pack, unpack

BATCH = "batch"  # the endpoint, and the metadata's number of messages
MOST_MESSAGES = 64  # of an envelope
MOST_SESSIONS = 256  # of a connection
RESET = "reset successful"


Reply = Mapping[str, Any] | BaseException


class BatchSession(Protocol):
    """One rollout of those that a policy acts in together."""

    def begin(self, info: Mapping[str, Any]) -> None:
        """Begins a rollout."""


class InfersMany(Protocol):
    """A policy that acts in several rollouts at once."""

    def session(self) -> BatchSession:
        """Returns the session of a client."""

    def infer_many(
        self, sessions: Sequence[Any], observations: Sequence[dict[str, Any]]
    ) -> Sequence[Reply]:
        """Returns the reply to each observation, or the error of this one alone."""


class Batches:
    """The sessions of one connection that sends envelopes.

    Args:
        policy: Answers observations of several sessions.
        text_of: Returns the text that a client gets for an error.
    """

    def __init__(self, policy: InfersMany, text_of: Callable[[BaseException], str]) -> None:
        self._policy, self._text_of = policy, text_of
        self._sessions: dict[int, BatchSession] = {}

    def answer(self, envelope: Mapping[str, Any]) -> bytes:
        """Returns the answer to an envelope.

        Raises WireError for an envelope that is none. An error of one message is its answer.
        """
        numbers, messages = envelope.get("sessions"), envelope.get("messages")
        ended = envelope.get("ended", [])
        if not (
            isinstance(numbers, list)
            and isinstance(messages, list)
            and isinstance(ended, list)
            and len(numbers) == len(messages) <= MOST_MESSAGES
            and len({*numbers}) == len(numbers)
            and all(type(number) is int for number in (*numbers, *ended))
            and all(isinstance(message, bytes) for message in messages)
        ):
            raise WireError(
                "a batch has `sessions`, different whole numbers, and as many `messages` in bytes, "
                f"at most {MOST_MESSAGES}"
            )
        for number in ended:
            self._sessions.pop(number, None)
        answers: dict[int, bytes | str] = {}
        waiting: dict[int, tuple[BatchSession, dict[str, Any]]] = {}
        for number, message in zip(numbers, messages, strict=True):
            try:
                endpoint, content = endpoint_of(message)
                session = self._session(number)
                if endpoint == "reset":
                    session.begin(content)
                    answers[number] = RESET
                else:
                    waiting[number] = (session, content)
            except RAISED as error:
                answers[number] = self._failed(number, error)
        began = time.perf_counter()
        replies = self._replies(list(waiting.values()))
        elapsed = {"infer_ms": 1e3 * (time.perf_counter() - began)}
        for number, reply in zip(waiting, replies, strict=True):
            if isinstance(reply, BaseException):
                answers[number] = self._failed(number, reply)
            else:
                answers[number] = pack({**reply, "server_timing": elapsed})
        return pack({"answers": [answers[number] for number in numbers]})

    def _session(self, number: int) -> BatchSession:
        if number not in self._sessions:
            if len(self._sessions) >= MOST_SESSIONS:
                raise WireError(f"there are {MOST_SESSIONS} sessions already")
            self._sessions[number] = self._policy.session()
        return self._sessions[number]

    def _replies(self, waiting: Sequence[tuple[BatchSession, dict[str, Any]]]) -> Sequence[Reply]:
        if not waiting:
            return []
        try:
            sessions, contents = zip(*waiting, strict=True)
            return self._policy.infer_many(sessions, contents)
        except RAISED as error:
            raise_interrupt(error)
            return [error] * len(waiting)

    def _failed(self, number: int, error: BaseException) -> str:
        """Ends a session, and returns the text of its error."""
        raise_interrupt(error)
        self._sessions.pop(number, None)
        return self._text_of(error)


def endpoint_of(message: bytes | str) -> tuple[str, dict[str, Any]]:
    """Returns the endpoint that a message is for, and its content. Raises WireError."""
    if isinstance(message, str):
        raise WireError("an observation is a binary message of msgpack, not a text")
    observation = unpack(message)
    if not isinstance(observation, dict):
        raise WireError(f"an observation is a map, got {type(observation).__name__}")
    content = {name_of(key): value for key, value in observation.items()}
    endpoint = content.pop("endpoint", "infer")
    if endpoint not in ("infer", "reset"):
        raise WireError(f"no endpoint {str(endpoint)[:40]!r}; there are 'infer' and 'reset'")
    return endpoint, content
