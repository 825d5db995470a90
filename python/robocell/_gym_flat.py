"""Vector environments with vectors in the place of dictionaries."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from robocell._core import ArgumentError, EnvConfig
from robocell._gym_vector import VectorGymEnv


class FlatVectorGymEnv(VectorGymEnv):
    """A ``VectorGymEnv`` for learning code that takes boxes, such as CleanRL's.

    Observations are (num_envs, m) float32: the numbers of the dictionaries, one part after another
    (``observation_parts`` of ``core``), in metres and radians. Actions are (num_envs, n), between
    -1 and 1 for the ranges of the dictionaries; what is beyond is cut. All else, final observations
    too, is as there. There are no images.

    Args:
        config: what all copies are; without image streams.
        num_envs: number of copies.
        max_episode_steps: after so many an episode is truncated; never without.
        autoreset_mode: when ended episodes begin anew.
        threads: for the work, the caller's included; 0 for one for each core.
    """

    def __init__(
        self,
        config: EnvConfig,
        num_envs: int = 1,
        max_episode_steps: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int = 0,
    ) -> None:
        if config.cameras.streams:
            names = ", ".join(stream.name for stream in config.cameras.streams)
            raise ArgumentError(
                f"environment '{config.name}': flat observations have no images; leave the "
                f"streams out of cameras ({names}), or use the environment that is not flat"
            )
        super().__init__(config, num_envs, max_episode_steps, autoreset_mode, threads)
        self._low, self._high = self.core.action_range
        lower, upper = (ends.astype(np.float32) for ends in self.core.observation_range)
        # Rounding of the numbers must not leave the space.
        self.single_observation_space = spaces.Box(
            np.nextafter(lower, np.float32(-np.inf)), np.nextafter(upper, np.float32(np.inf))
        )
        self.single_action_space = spaces.Box(-1, 1, self._low.shape, np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def _flat(self, actions: Any) -> NDArray[np.float64]:
        shares = np.asarray(actions, dtype=np.float64)
        if shares.shape != (self.num_envs, len(self._low)):
            raise ArgumentError(
                f"environment '{self._name}': action must have a row of {len(self._low)} numbers "
                f"for each of {self.num_envs} copies, it is of shape {shares.shape}"
            )
        return self._low + (shares.clip(-1, 1) + 1) / 2 * (self._high - self._low)

    def _observation(self, flat: NDArray[np.float64]) -> NDArray[np.float32]:
        return flat.astype(np.float32)
