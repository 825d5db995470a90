"""The built-in models: robots, objects and scenes of robocell's own."""

from __future__ import annotations

from robocell import _core

__all__ = ["objects", "resolve", "robot_file", "robots", "root", "scenes"]

robots = _core.builtin_robots
objects = _core.builtin_objects
scenes = _core.builtin_scenes
robot_file = _core.builtin_robot_file
root = _core.models_root
resolve = _core.resolve_model
