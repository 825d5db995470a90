"""Policies over a socket: the openpi WebSocket protocol, as client and as server; GR00T's client.

    robocell evaluate out/picks --policy ws://127.0.0.1:8000 --preset droid
    robocell serve-policy my_policy.py:Mine --run examples/demo.yaml

docs/policy_server.md describes messages, presets and limits.
"""

from __future__ import annotations

from robocell.policy_server._client import (
    LostServerError,
    PolicyClient,
    PolicyServerError,
    Reply,
)
from robocell.policy_server._groot_client import GrootClient
from robocell.policy_server._remote_policy import RemotePolicy
from robocell.policy_server._served import policy_server
from robocell.policy_server._server import PolicyServer, Session
from robocell.policy_server._wire import WireError, pack, unpack

__all__ = [
    "GrootClient",
    "LostServerError",
    "PolicyClient",
    "PolicyServer",
    "PolicyServerError",
    "RemotePolicy",
    "Reply",
    "Session",
    "WireError",
    "pack",
    "policy_server",
    "unpack",
]
