"""Behaviour cloning from a dataset, with scikit-learn (`pip install ".[learning]"`).

The built-in arm picks up cylinders 200 times. Trees learn which eight actions it takes from each
state on, and act in the environment of the dataset, from starts that it has not.
Run: python examples/learning/clone.py
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from sklearn.ensemble import ExtraTreesRegressor

import robocell as rc
from robocell.envs import from_dataset

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
    trees = ExtraTreesRegressor(60, random_state=0)
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


def main(episodes: int = 200, trials: int = 50) -> float:
    """The share of trials that succeed."""
    with tempfile.TemporaryDirectory() as folder:
        dataset = demonstrate(f"{folder}/picks", episodes)
        picked = evaluate(dataset, clone(dataset), trials)
    print(f"picked up {picked} of {trials} cylinders after {episodes} demonstrations")
    return picked / trials


if __name__ == "__main__":
    main()
