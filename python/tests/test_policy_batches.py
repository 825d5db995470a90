"""Many rollouts share one connection to a policy server, and each gets what it would get alone."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

from openpi_peer import OpenpiClient
from robocell.policy import Policy
from robocell.policy_server import (
    LostServerError,
    PolicyClient,
    PolicyServer,
    PolicyServerError,
    RemotePolicy,
    pack,
    unpack,
)
from robocell.policy_server._batches import MOST_MESSAGES
from robocell.policy_server._relay import relay_of, relaying
from robocell.policy_server._served import BatchedPolicy, PolicySession
from test_policy_server import ARM, GRIPPER, cell, context, serving

QPOS = "robots/a/arm/qpos"


class Doubles(Policy):
    """Commands twice the positions, and as opening the seed of the rollout."""

    def __init__(self, pause_s: float = 0.0) -> None:
        self.sizes: list[int] = []
        self._pause_s = pause_s

    def act(self, observation: Any) -> Any:
        raise AssertionError("the policy takes batches")

    def act_batch(self, observations: Any, contexts: Any) -> Any:
        self.sizes.append(len(observations))
        time.sleep(self._pause_s)
        stacked = np.stack([observation[QPOS] for observation in observations])
        return [
            {ARM: np.stack([row, 2 * row]), GRIPPER: np.full((2, 1), float(one.seed))}
            for row, one in zip(stacked, contexts, strict=True)
        ]


@contextlib.contextmanager
def batching(policy: Policy, **options: Any) -> Iterator[PolicyServer]:
    made = lambda: PolicySession(policy, cell())  # noqa: E731
    with serving(made, batch=BatchedPolicy(policy, cell()), **options) as server:
        yield server


@contextlib.contextmanager
def relayed(server: PolicyServer, workers: int = 8, timeout_s: float = 5.0) -> Iterator[None]:
    with PolicyClient(server.url) as client:
        greeting = client.metadata
    with relaying(server.url, greeting, workers, timeout_s):
        assert relay_of(server.url)
        yield
    assert not relay_of(server.url)


def rollout(url: str, seed: int, calls: int = 6) -> list[Any]:
    """The actions of a rollout whose observations depend on its seed alone."""
    remote = RemotePolicy(url)
    start = context("lift")
    start.seed = seed
    remote.reset(start)
    found = [remote.act({QPOS: np.full(7, 0.1 * seed + call)}) for call in range(calls)]
    remote.client.close()
    return found


def test_rollouts_in_batches_get_what_each_gets_alone():
    policy = Doubles(pause_s=0.02)
    with batching(policy) as server, relayed(server), ThreadPoolExecutor(8) as pool:
        together = list(pool.map(lambda seed: rollout(server.url, seed), range(8)))
    assert max(policy.sizes) > 2, "observations that wait are one batch"
    assert sum(policy.sizes) == 8 * 6
    for seed, actions in enumerate(together):
        for call, action in enumerate(actions):
            row = np.full(7, 0.1 * seed + call)
            np.testing.assert_array_equal(action[ARM], [row, 2 * row])
            np.testing.assert_array_equal(action[GRIPPER], [[seed], [seed]])


def test_a_wrong_observation_fails_alone():
    with batching(Doubles(0.01)) as server, relayed(server), ThreadPoolExecutor(4) as pool:
        good = [pool.submit(rollout, server.url, seed) for seed in range(3)]
        remote = RemotePolicy(server.url)
        remote.reset(context())
        with pytest.raises(PolicyServerError, match=r"has no 'robots/a/arm/qpos'") as caught:
            remote.act({"time": np.zeros(1)})
        assert server.url in str(caught.value), "the server is named, not the relay"
        for seed, each in enumerate(good):
            assert each.result(10)[0][GRIPPER][0, 0] == seed
        remote.reset(context())  # the next rollout of this worker
        assert remote.act({QPOS: np.zeros(7)})[GRIPPER][0, 0] == 5
        remote.client.close()


@pytest.mark.parametrize("returned", [None, [], [{ARM: np.zeros(7)}] * 3])
def test_a_batch_has_an_action_for_each_rollout(returned: Any):
    class Wrong(Doubles):
        def act_batch(self, observations: Any, contexts: Any) -> Any:
            return returned

    with batching(Wrong()) as server, relayed(server):
        remote = RemotePolicy(server.url)
        remote.reset(context())
        with pytest.raises(
            PolicyServerError, match=r"Wrong\.act_batch\(\) must return a list of 1 action"
        ):
            remote.act({QPOS: np.zeros(7)})
        remote.client.close()


def test_a_lost_connection_is_made_again_and_the_rollouts_go_on():
    policy = Doubles()
    with batching(policy) as server, relayed(server):
        remote = RemotePolicy(server.url)
        remote.reset(context())
        remote.act({QPOS: np.zeros(7)})
        for channel in list(server._channels):
            channel.abort()
        assert remote.act({QPOS: np.ones(7)})[GRIPPER][0, 0] == 5, "the seed of the rollout"
        server.close()
        with pytest.raises(LostServerError, match=f"policy server {server.url}: "):
            remote.act({QPOS: np.ones(7)})
        remote.client.close()


@pytest.mark.parametrize(
    "changes",
    [
        {"sessions": [1, 1]},
        {"sessions": [1]},
        {"messages": [b"", "text"]},
        {"sessions": "all"},
        {"ended": [None]},
        {"sessions": [*range(MOST_MESSAGES + 1)], "messages": [b""] * (MOST_MESSAGES + 1)},
    ],
)
def test_an_envelope_that_is_none_ends_its_connection(changes: dict[str, Any]):
    with batching(Doubles()) as server:
        client = PolicyClient(server.url)
        message = pack({QPOS: np.zeros(7)})
        envelope = {"endpoint": "batch", "sessions": [0, 1], "messages": [message] * 2}
        answer = client.exchange(envelope | changes)
        assert isinstance(answer, str)
        assert "a batch has `sessions`" in answer
        fresh = client.exchange(envelope) if not client.close() else None
        assert len(unpack(fresh)["answers"]) == 2  # type: ignore[arg-type]
        client.close()


def test_garbage_in_an_envelope_is_answered_alone():
    with batching(Doubles()) as server, PolicyClient(server.url) as client:
        good = pack({QPOS: np.zeros(7)})
        envelope = {"endpoint": "batch", "sessions": [0, 1, 2], "messages": [b"\xc1", good, b""]}
        first, second, third = unpack(client.exchange(envelope))["answers"]
        assert isinstance(first, str)
        assert isinstance(third, str)
        np.testing.assert_array_equal(unpack(second)["actions"][0], np.zeros(8))


def test_clients_of_openpi_know_nothing_of_batches():
    class Both(Doubles):
        def act(self, observation: Any) -> Any:
            return {ARM: observation[QPOS], GRIPPER: 1.0}

    with batching(Both()) as server:
        client = OpenpiClient(server.url)
        assert client.metadata["batch"] == MOST_MESSAGES
        assert client.infer({QPOS: np.ones(7), "prompt": "batch"})["actions"].shape == (1, 8)


def test_one_worker_and_other_servers_need_no_relay():
    before = set(threading.enumerate())
    with batching(Doubles()) as server:
        with relaying(server.url, {"batch": 64}, 1, 5.0):
            assert not relay_of(server.url)
        with relaying(server.url, {"batch": True}, 4, 5.0):
            assert not relay_of(server.url)
        with relaying("zmq://127.0.0.1:1", {"batch": 64}, 4, 5.0):
            assert not relay_of("zmq://127.0.0.1:1")
    started = set(threading.enumerate()) - before
    for thread in started:
        thread.join(timeout=10)
    assert not [thread.name for thread in started if thread.is_alive()]
