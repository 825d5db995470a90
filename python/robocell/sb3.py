"""Vector environments for stable-baselines3, which does not use those of Gymnasium.

from stable_baselines3 import PPO
from robocell.gym import pick_cube_config
from robocell.sb3 import VecEnv

model = PPO("MlpPolicy", VecEnv(pick_cube_config(), 8, max_episode_steps=200))

``make_vec_env("robocell/PickCube-v0", env_kwargs={"flat": True})`` works too, but steps single
environments one after the other. This module needs the extra ``sb3``:
``pip install 'robocell[sb3]'``, in a checkout ``pip install gymnasium stable-baselines3``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._extras import needed_by

with needed_by("robocell.sb3", "sb3", "Without it: robocell.gym.FlatVectorGymEnv"):
    from gymnasium.vector import AutoresetMode
    from stable_baselines3.common import vec_env

from robocell._core import ArgumentError, EnvConfig
from robocell._gym_env import KEYFRAME, options_of
from robocell._gym_flat import FlatVectorGymEnv

__all__ = [
    "VecEnv",
]


class VecEnv(vec_env.VecEnv):
    """Copies of one environment on C++ threads; ``vector`` is their ``FlatVectorGymEnv``.

    Observations and actions are vectors, as there. An ended episode restarts in the same step; the
    info contains its last observation as ``terminal_observation``. With a task the info contains
    ``is_success``. Wrap it in ``VecMonitor`` to count rewards of episodes.

    Args:
        config: configuration of all copies; without image streams.
        num_envs: number of copies.
        max_episode_steps: number of steps after which an episode is truncated.
        threads: number of threads, including the caller's; 0 for one per core.
        render_mode: None or "rgb_array", for ``VecVideoRecorder``.
    """

    def __init__(
        self,
        config: EnvConfig,
        num_envs: int = 1,
        max_episode_steps: int | None = None,
        threads: int = 0,
        render_mode: str | None = None,
    ) -> None:
        self.vector = FlatVectorGymEnv(
            config, num_envs, max_episode_steps, AutoresetMode.SAME_STEP, threads, render_mode
        )
        self._actions: Any = None
        super().__init__(
            num_envs, self.vector.single_observation_space, self.vector.single_action_space
        )

    def reset(self) -> NDArray[np.float32]:
        """Resets all copies: to the starts of ``seed``, once, else to the next ones.

        ``set_options({"keyframe": ...})`` starts the robots of this reset there.
        """
        options = self._options
        self._reset_options()
        if any(each != options[0] for each in options):
            raise ArgumentError(f"all copies take the same options, got {options}")
        given = dict(options_of(options[0], KEYFRAME))
        observation, infos = self.vector.reset(seed=self._seeds, options=given)
        self.reset_infos = [_of_copy(infos, i) for i in range(self.num_envs)]
        self._reset_seeds()
        return observation

    def step_async(self, actions: NDArray[Any]) -> None:
        """Stores the actions for ``step_wait``."""
        self._actions = actions

    def step_wait(
        self,
    ) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], list[dict[str, Any]]]:
        """Makes one step of every copy."""
        observation, rewards, terminated, truncated, infos = self.vector.step(self._actions)
        ended = terminated | truncated
        out = []
        for i in range(self.num_envs):
            info = _of_copy(infos["final_info"] if ended[i] else infos, i)
            info["TimeLimit.truncated"] = bool(truncated[i] and not terminated[i])
            if ended[i]:
                info["terminal_observation"] = infos["final_obs"][i]
            out.append(info)
        return observation, rewards, ended, out

    def get_images(self) -> list[NDArray[np.uint8]]:
        """Returns a picture of each copy, or none without a render mode."""
        return list(self.vector.render() or ())

    def close(self) -> None:
        """Closes all copies; may be repeated."""
        self.vector.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Returns the attribute of ``vector``, the same for each copy."""
        return [getattr(self.vector, attr_name)] * len(self._chosen(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Raises ArgumentError: copies have no attributes of their own."""
        raise ArgumentError(f"copies have no separate attributes, {attr_name} cannot be set")

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> Any:
        """Raises ArgumentError: copies have no methods of their own."""
        raise ArgumentError(f"copies have no separate methods, such as {method_name}")

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Any = None) -> list[bool]:
        """Returns False for each copy: nothing is wrapped."""
        return [False] * len(self._chosen(indices))

    def _chosen(self, indices: int | Iterable[int] | None) -> Sequence[int]:
        chosen: Sequence[int] = self._get_indices(indices)
        return chosen


def _of_copy(infos: dict[str, Any], i: int) -> dict[str, Any]:
    """Returns the part of masked infos that belongs to copy i."""
    return {
        key: _of_copy(infos[key], i) if isinstance(infos[key], dict) else infos[key][i]
        for key in infos
        if not key.startswith(("_", "final_")) and infos[f"_{key}"][i]
    }
