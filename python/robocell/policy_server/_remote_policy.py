"""A policy behind a socket, for `robocell evaluate --policy ws://127.0.0.1:8000`."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError
from robocell._policy_calls import present
from robocell._policy_presets import Bound, Preset
from robocell._suggestions import counted
from robocell.policy import Action, Context, Observation, Policy
from robocell.policy_server._client import (
    TIMEOUT_S,
    LostServerError,
    PolicyClient,
    PolicyServerError,
    parse_url,
)
from robocell.policy_server._groot_client import SCHEME, GrootClient, parse_groot_url
from robocell.policy_server._groot_preset import groot_preset
from robocell.policy_server._relay import relay_of

PROMPT = "prompt"
RELAY_S = 10.0  # more than the calls of a relay take
ROLLOUT, RUN_SEED = "rollout", "run_seed"  # the start of a rollout, for servers of robocell


def require_url(url: str) -> None:
    """Raises ArgumentError for a text that is not the URL of a policy server."""
    if url.startswith(f"{SCHEME}://"):
        parse_groot_url(url)
    else:
        parse_url(url)


def client_of(url: str, timeout_s: float = TIMEOUT_S) -> PolicyClient | GrootClient:
    """Returns a client of the server at a URL, which is not connected yet."""
    kind = GrootClient if url.startswith(f"{SCHEME}://") else PolicyClient
    return kind(url, timeout_s)


class RemotePolicy(Policy):
    """Sends each observation to a policy server and returns its actions.

    Without a preset the server is sent the row of the dataset by the names of its columns, with
    the instruction as `prompt`, and names the columns of its actions: `robocell serve-policy` does.
    A server of GR00T is sent the parts that it lists, by the names of `robocell export`.

    Args:
        url: `ws://host:port`, or `zmq://host:port` of GR00T.
        preset: Names and units that the server expects.
        timeout_s: Longest time of a call.
    """

    def __init__(
        self, url: str, preset: Preset | None = None, timeout_s: float = TIMEOUT_S
    ) -> None:
        self.client = client_of(url, timeout_s)
        self._url = url
        if relay := relay_of(url):  # a call waits for the one before, which has its own deadline
            self.client = client_of(relay, 2 * timeout_s + RELAY_S)
        self.timing: dict[str, float] = {}  # of the last call
        self._preset = preset
        self._bound: Bound | None = None
        self._instruction = ""
        self._session = 0

    def reset(self, context: Context) -> None:
        """Begins a rollout at the server."""
        self._instruction = context.instruction
        self._session = context.seed
        info = {PROMPT: context.instruction, "seed": context.seed}
        # An expert must know the start; others get what every server of RoboArena understands.
        start = {ROLLOUT: present.rollout, RUN_SEED: present.seed}
        with self._naming_server():
            self.client.reset(info, start)
        preset = self._preset
        cameras = context.run.cameras
        streams = [stream.name for stream in cameras.streams] if cameras.draw else []
        if preset is None and isinstance(self.client, GrootClient):
            preset = groot_preset(self.client.modalities, context.features, self.client.url)
        if preset is None:
            return
        self._bound = preset.bind(context.features, streams)
        self._adapt(self._bound)

    def act(self, observation: Observation) -> Action:
        """Returns the server's actions."""
        if self._bound is None:
            message: dict[str, Any] = {**observation, PROMPT: self._instruction}
        else:
            message = self._bound.message(observation, self._instruction)
        if self.client.metadata.get("needs_session_id") is True:
            message["session_id"] = np.array([self._session], np.int32)
        with self._naming_server():
            reply = self.client.infer(message)
        self.timing = {"round_trip_ms": reply.call_ms, "server_ms": reply.server_ms}
        try:
            if self._bound is not None:
                return self._bound.columns(reply.actions)
            return _by_name(reply.actions, reply.columns)
        except ArgumentError as error:
            raise PolicyServerError(f"policy server {self.client.url}: {error}") from error

    @contextlib.contextmanager
    def _naming_server(self) -> Iterator[None]:
        """Context manager: errors of a relay name the server behind it."""
        try:
            yield
        except (LostServerError, PolicyServerError) as error:
            if self.client.url == self._url:
                raise
            raise type(error)(str(error).replace(self.client.url, self._url)) from error

    def _adapt(self, bound: Bound) -> None:
        """Follows the configuration of a server of RoboArena."""
        metadata = self.client.metadata
        space = metadata.get("action_space")
        own = bound.preset.action_space
        if isinstance(space, str) and own and space != own:
            raise PolicyServerError(
                f"policy server {self.client.url}: its actions are {space!r}, and those of "
                f"{bound.preset.place} {own!r}: choose another preset"
            )
        if "image_resolution" not in metadata:
            return
        wanted = metadata["image_resolution"]  # height and width, or None for no resizing
        bound.image_size = None
        if isinstance(wanted, list) and len(wanted) == 2:
            height, width = wanted
            if type(height) is int and type(width) is int and 0 < min(wanted) <= max(wanted) < 4097:
                bound.image_size = width, height


def _by_name(actions: NDArray[Any], columns: tuple[tuple[str, int], ...]) -> dict[str, Any]:
    """Splits actions into the columns that the server names."""
    width = actions.shape[-1]
    if not columns:
        raise ArgumentError(
            f"the server returned {counted(width, 'number')} per action without their names; say "
            "what they are with --preset, such as --preset droid"
        )
    if sum(size for _, size in columns) != width:
        raise ArgumentError(
            f"the server returned {counted(width, 'number')} per action, and names columns of "
            f"{sum(size for _, size in columns)}"
        )
    found: dict[str, Any] = {}
    start = 0
    for name, size in columns:
        found[name] = actions[..., start : start + size]
        start += size
    return found
