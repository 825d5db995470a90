"""Behaviour cloning in a vector environment, with nothing but numpy.

Demonstrations lead the TCP of the built-in robot to a point above a cube, which lies somewhere else
in every episode. A linear policy is fitted to them by least squares and acts on its own; the reward
is that of the pick task, half of which is for being near.
Run: python examples/learning/clone.py
"""

from __future__ import annotations

from collections.abc import Callable

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

import robocell.gym

gym.register_envs(robocell.gym)

COPIES, EPISODE = 16, 40
ABOVE = np.array([0, 0, 0.06])  # m, where the demonstrations lead to from the cube
MOST = 0.05  # m, the farthest that one action moves the TCP: `max_relative_movement`
WAY = 0.2  # of what is left, in one action

Numbers = NDArray[np.float64]
Policy = Callable[[Numbers], Numbers]


def demonstrate(seen: Numbers) -> Numbers:
    """Towards the point above the cube, without turning, with the gripper open."""
    tcp, cube = seen[:, :3], seen[:, 21:24]
    actions = np.zeros((len(seen), 8))
    actions[:, :3] = (WAY * (cube + ABOVE - tcp) / MOST).clip(-1, 1)
    actions[:, 6] = 1  # the quaternion that turns nothing
    actions[:, 7] = 1
    return actions


def rollout(vector: gym.vector.VectorEnv, policy: Policy, seed: int) -> tuple[Numbers, ...]:
    """An episode of each copy: observations, actions, and each copy's sum of rewards."""
    seen, _ = vector.reset(seed=seed)
    observed, acted, total = [], [], np.zeros(vector.num_envs)
    for _ in range(EPISODE):
        actions = policy(seen)
        observed.append(seen)
        acted.append(actions)
        seen, rewards, *_ = vector.step(actions)
        total += rewards
    return np.concatenate(observed), np.concatenate(acted), total


def fit(observed: Numbers, acted: Numbers) -> Policy:
    """The linear policy that does most nearly what was demonstrated."""
    mean, scale = observed.mean(axis=0), observed.std(axis=0) + 1e-3

    def features(seen: Numbers) -> Numbers:
        return np.hstack([(seen - mean) / scale, np.ones((len(seen), 1))])

    x = features(observed)
    weights = np.linalg.solve(x.T @ x + 1e-3 * len(x) * np.eye(x.shape[1]), x.T @ acted)
    return lambda seen: features(seen) @ weights


def compare() -> dict[str, float]:
    """Mean reward of an episode: of random actions, of the demonstrations, of their clone."""
    vector = gym.make_vec("robocell/PickCube-v0", num_envs=COPIES, flat=True)
    rng = np.random.default_rng(0)
    chance = rollout(vector, lambda seen: rng.uniform(-1, 1, (len(seen), 8)), seed=1000)
    *demonstrations, shown = rollout(vector, demonstrate, seed=0)
    clone = fit(*demonstrations)
    own = rollout(vector, clone, seed=1000)  # starts that it has not seen
    vector.close()
    sums = {"chance": chance[-1], "demonstrations": shown, "clone": own[-1]}
    return {name: float(total.mean()) for name, total in sums.items()}


if __name__ == "__main__":
    for name, reward in compare().items():
        print(f"{name}: {reward:.2f} of {EPISODE}")
