"""A short training run of PPO (stable-baselines3, `pip install stable-baselines3`) on a CPU.

The built-in robot learns to come near a cube that lies somewhere else in every episode; the reward
is that of the pick task, half of which is for being near.
Run: python examples/learning/ppo.py [steps]
"""

from __future__ import annotations

import sys

from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecMonitor

from robocell.gym import pick_cube_config
from robocell.sb3 import VecEnv

COPIES, EPISODE = 8, 40


def vector(copies: int) -> VecMonitor:
    """Copies of the environment, as stable-baselines3 has them."""
    config = pick_cube_config()
    return VecMonitor(VecEnv(config, copies, max_episode_steps=EPISODE))


def main(steps: int) -> None:
    """Trains, and compares the mean reward of an episode before and after."""
    model = PPO("MlpPolicy", vector(COPIES), n_steps=128, batch_size=256, seed=0, device="cpu")
    evaluation = vector(1)
    evaluation.seed(1000)
    before, _ = evaluate_policy(model, evaluation, n_eval_episodes=10)
    model.learn(steps)
    evaluation.seed(1000)
    after, _ = evaluate_policy(model, evaluation, n_eval_episodes=10)
    print(
        f"reward of an episode: {before:.2f} before, {after:.2f} after {model.num_timesteps} steps"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 60_000)
