"""Behaviour cloning from a dataset, with scikit-learn (`pip install ".[learning]"`).

The built-in arm picks up cylinders 200 times. Trees learn which eight actions it takes from each
state on, and act in the environment of the dataset, from starts that it has not; then once more
as `robocell evaluate` sees them, behind a policy server.
Run: python examples/learning/clone.py
"""

from __future__ import annotations

import os
import pickle
import tempfile
import threading
from pathlib import Path
from typing import Any

import numpy as np
from sklearn.ensemble import ExtraTreesRegressor

import robocell as rc
from robocell.envs import from_dataset
from robocell.evaluate import wilson_interval
from robocell.policy import Policy
from robocell.policy_server import policy_server

DEMO = Path(__file__).resolve().parent.parent / "demo.yaml"
SEEN = [
    "robots/rc7/tcp_pose_in_base",
    "robots/rc7/objects/target/pose_in_tcp",
    "robots/rc7/objects/target/pose_in_base",
    "robots/rc7/opening",
    "robots/rc7/gripper/target",
]
DONE = ["robots/rc7/action/tcp_displacement", "robots/rc7/action/gripper"]
CHUNK = 8  # actions that are taken before the policy looks again
TREES = "CLONE_TREES"  # environment variable with the file that the served policy loads
UNSEEN = 1000  # the first start that is evaluated; the dataset has those before 200


def demonstrate(folder: str, episodes: int) -> rc.Dataset:
    """Picks of cylinders, without images."""
    run = rc.RunConfig.load(DEMO)
    run.task.objects = ["cylinder"]
    run.start.base_distance, run.start.base_height_noise = [0.38, 0.45], [-0.02, 0.02]
    run.cameras.streams.clear()
    run.output, run.episodes = folder, episodes
    rc.generate.prepare_dataset(run)
    runner = rc.generate.Runner(run)
    for item in rc.generate.make_plan(run):
        runner.run(item)
    return rc.Dataset(folder)


def clone(dataset: rc.Dataset) -> ExtraTreesRegressor:
    """A policy that does what was demonstrated in each state."""
    trees = ExtraTreesRegressor(60, min_samples_leaf=2, random_state=0)
    chunks = rc.data.rows(dataset, DONE, horizon=CHUNK)
    return trees.fit(rc.data.rows(dataset, SEEN), chunks.reshape(len(chunks), -1))


def evaluate(dataset: rc.Dataset, policy: ExtraTreesRegressor, trials: int) -> int:
    """How many of so many unseen starts end with the cylinder in the hand."""
    env = from_dataset(dataset, SEEN, DONE, flat=True)
    picked = 0
    for trial in range(trials):
        seen, info = env.reset(seed=UNSEEN + trial)
        ended = False
        while not ended:
            for action in policy.predict([seen]).reshape(CHUNK, -1):
                seen, _, terminated, truncated, info = env.step(action)
                if ended := terminated or truncated:
                    break
        picked += info["is_success"]
    return picked


class Cloned(Policy):
    """The trees, as a policy by the names of columns."""

    def __init__(self) -> None:
        self.trees = pickle.loads(Path(os.environ[TREES]).read_bytes())

    def act(self, observation: Any) -> Any:
        """A chunk of eight actions."""
        seen = np.concatenate([np.ravel(observation[name]) for name in SEEN])
        chunk = self.trees.predict([seen]).reshape(CHUNK, -1)
        displacements, openings = np.hsplit(chunk, [6])
        return dict(zip(DONE, (displacements, openings), strict=True))


def evaluate_served(dataset: rc.Dataset, policy: ExtraTreesRegressor, trials: int) -> int:
    """The same behind a server, from other unseen starts, with one rollout for each."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / "trees.pkl").write_bytes(pickle.dumps(policy))
        os.environ[TREES] = str(place / "trees.pkl")
        server = policy_server(f"{Path(__file__).resolve()}:Cloned", port=0)
        threading.Thread(target=server.serve, daemon=True).start()
        result = rc.evaluate.evaluate(
            dataset.folder, server.url, episodes=trials, output=place / "rollouts", cameras=False
        )
        server.close()
    return result.successes


def told(way: str, picked: int, trials: int) -> str:
    """A success rate with its interval, in words."""
    low, high = wilson_interval(picked, trials)
    return f"{way}: picked up {picked} of {trials}, 95 % interval {low:.0%} ... {high:.0%}"


def main(episodes: int = 200, trials: int = 50, served: int = 10) -> float:
    """The share of trials that succeed, of those without a server."""
    with tempfile.TemporaryDirectory() as folder:
        dataset = demonstrate(f"{folder}/picks", episodes)
        trees = clone(dataset)
        picked = evaluate(dataset, trees, trials)
        print(f"{episodes} demonstrations; {told('in the environment', picked, trials)}")
        print(told("through a server", evaluate_served(dataset, trees, served), served))
    return picked / trials


if __name__ == "__main__":
    main()
