"""What stable-baselines3 asks of a vector environment, where it is not installed (gigabytes).

Written after the base class of version 2.9: which attributes it makes, what it calls, and what is
abstract. With the package itself its own class is used.
"""

from __future__ import annotations

import importlib.util
import sys
from abc import ABC, abstractmethod
from types import ModuleType


class VecEnv(ABC):
    def __init__(self, num_envs, observation_space, action_space):
        self.num_envs = num_envs
        self.observation_space = observation_space
        self.action_space = action_space
        self.reset_infos = [{} for _ in range(num_envs)]
        self._reset_seeds()
        self._reset_options()
        (self.render_mode,) = set(self.get_attr("render_mode"))

    def _reset_seeds(self):
        self._seeds = [None] * self.num_envs

    def _reset_options(self):
        self._options = [{} for _ in range(self.num_envs)]

    def seed(self, seed):
        self._seeds = [seed + i for i in range(self.num_envs)]
        return self._seeds

    def set_options(self, options):
        one = isinstance(options, dict)
        self._options = [dict(options) for _ in range(self.num_envs)] if one else options

    def step(self, actions):
        self.step_async(actions)
        return self.step_wait()

    def _get_indices(self, indices):
        if indices is None:
            return range(self.num_envs)
        return [indices] if isinstance(indices, int) else indices

    @abstractmethod
    def reset(self): ...
    @abstractmethod
    def step_async(self, actions): ...
    @abstractmethod
    def step_wait(self): ...
    @abstractmethod
    def close(self): ...
    @abstractmethod
    def get_attr(self, attr_name, indices=None): ...
    @abstractmethod
    def set_attr(self, attr_name, value, indices=None): ...
    @abstractmethod
    def env_method(self, method_name, *method_args, indices=None, **method_kwargs): ...
    @abstractmethod
    def env_is_wrapped(self, wrapper_class, indices=None): ...


def stand_in() -> None:
    """Puts this in the place of the package, unless that is there."""
    if importlib.util.find_spec("stable_baselines3"):
        return
    modules = {name: ModuleType(name) for name in ("stable_baselines3", "common", "vec_env")}
    package, common, vec_env = modules.values()
    package.common, common.vec_env, vec_env.VecEnv = common, vec_env, VecEnv
    sys.modules["stable_baselines3"] = package
    sys.modules["stable_baselines3.common"] = common
    sys.modules["stable_baselines3.common.vec_env"] = vec_env


def leave() -> None:
    """As if it had never been there."""
    if getattr(sys.modules.get("stable_baselines3"), "__file__", None) is None:
        for name in [*sys.modules]:
            if name.split(".")[0] == "stable_baselines3" or name == "robocell.sb3":
                del sys.modules[name]
