"""Behaviour cloning in a vector environment, with scikit-learn (`pip install ".[learning]"`).

Demonstrations pick up a cube, which lies somewhere else in every episode. A neural network learns
what they do in each state, and then picks up cubes that lie where it has seen none.
Run: python examples/learning/clone.py
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from threadpoolctl import threadpool_limits

import robocell.gym

gym.register_envs(robocell.gym)

COPIES, STEPS = 64, 40
# Seeds of the first copy's start; the other copies have the next ones.
SHOWN = (0, 64, 128, 192)
UNSEEN = 1000
ITERATIONS = 300
WAY = 0.5  # of what is left, in one action
MOST = 0.05  # m, the farthest that one action moves the TCP: `max_relative_movement`

Numbers = NDArray[np.float64]
Policy = Callable[[Numbers], Numbers]


def demonstrate(seen: Numbers) -> Numbers:
    """To the cube from above, closes the gripper around it, and lifts it."""
    tcp, opening, cube = seen[:, :3], seen[:, 20], seen[:, 21:24]
    way = cube - tcp
    aside, gap = np.linalg.norm(way[:, :2], axis=1), np.linalg.norm(way, axis=1)
    way[:, 2] += (4 * (aside - 0.01)).clip(0, 0.1)  # farther up while not above it
    closing = gap < np.where(opening < 0.9, 0.03, 0.012)
    lift = ((0.8 - opening) / 0.3).clip(0, 1) * MOST  # the more, the more it has closed
    way[closing] = np.outer(lift[closing], [0, 0, 1])

    actions = np.zeros((len(seen), 8))
    actions[:, :3] = (WAY * way / MOST).clip(-1, 1)
    actions[:, 6] = 1  # the quaternion that turns nothing
    actions[:, 7] = np.where(closing, -1, 1)
    return actions


@dataclass
class Episodes:
    """An episode of each copy: its steps, and whether the copy held the cube up at its end."""

    observed: Numbers
    acted: Numbers
    succeeded: NDArray[np.bool_]


def rollout(vector: gym.vector.VectorEnv, policy: Policy, seed: int) -> Episodes:
    """Until the first episode of every copy has ended; the next ones that begin are left out."""
    seen, _ = vector.reset(seed=seed)
    going, succeeded = np.ones(vector.num_envs, bool), np.zeros(vector.num_envs, bool)
    observed, acted = [], []
    while going.any():
        actions = policy(seen)
        observed.append(seen[going])
        acted.append(actions[going])
        seen, _, terminated, truncated, infos = vector.step(actions)
        succeeded |= going & infos["is_success"]
        going &= ~(terminated | truncated)
    return Episodes(np.concatenate(observed), np.concatenate(acted), succeeded)


def fit(shown: list[Episodes], iterations: int) -> Any:
    """A network that was trained so long to do what was demonstrated."""
    network = MLPRegressor(
        hidden_layer_sizes=(64, 64), solver="lbfgs", random_state=0, max_fun=10 * ITERATIONS
    )
    network.set_params(max_iter=iterations)
    observed = np.concatenate([each.observed for each in shown])
    acted = np.concatenate([each.acted for each in shown])
    # Matrices are so small that threads only wait for each other. That it ends before it has
    # converged is meant.
    with threadpool_limits(1, "blas"), warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        return make_pipeline(StandardScaler(), network).fit(observed, acted)


def compare() -> dict[str, float]:
    """Shares of episodes that pick up the cube, on the same starts, of which none was shown."""
    # The gripper is observed as far as it is open: whether it holds the cube yet is seen by that.
    config = robocell.gym.pick_cube_config(wrappers=robocell.WrapperConfig(binary_gripper=False))
    vector = gym.make_vec(
        "robocell/Env-v0", num_envs=COPIES, config=config, flat=True, max_episode_steps=STEPS
    )
    shown = [rollout(vector, demonstrate, seed) for seed in SHOWN]
    policies = {
        "demonstrations": demonstrate,
        "before training": fit(shown, 1).predict,  # scikit-learn has none that is not trained
        "after training": fit(shown, ITERATIONS).predict,
    }
    shares = {
        name: float(rollout(vector, policy, UNSEEN).succeeded.mean())
        for name, policy in policies.items()
    }
    vector.close()
    return shares


if __name__ == "__main__":
    for name, share in compare().items():
        print(f"{name}: {share:.0%} of {COPIES} episodes pick up the cube")
