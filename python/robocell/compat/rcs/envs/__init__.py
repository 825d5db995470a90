"""Environments: their configuration, and ready-made ones."""

from __future__ import annotations

from robocell.compat.rcs.envs import base, configs, scenes, tasks

__all__ = ["base", "configs", "scenes", "tasks"]
