"""Configurations: robots, cameras, samplers of tasks, experiments."""

from robocell.compat.molmo_spaces.configs.task_sampler_configs import PickTaskSamplerConfig

__all__ = ["PickTaskSamplerConfig"]
