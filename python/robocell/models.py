"""The built-in models: robots, objects to pick, equipment of cells, and scenes.

Cells are ready-made environments of these robots and of robots of the MuJoCo Menagerie.
"""

from __future__ import annotations

from robocell import _core

__all__ = [
    "cell_file",
    "cells",
    "equipment",
    "objects",
    "resolve",
    "robot_file",
    "robots",
    "root",
    "scenes",
]

robots = _core.builtin_robots
objects = _core.builtin_objects
equipment = _core.builtin_equipment
scenes = _core.builtin_scenes
robot_file = _core.builtin_robot_file
cells = _core.builtin_cells
cell_file = _core.builtin_cell_file
root = _core.models_root
resolve = _core.resolve_model
