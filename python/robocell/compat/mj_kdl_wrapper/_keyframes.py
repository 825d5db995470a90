"""Indices of keyframes as the models count them; robocell's scenes put ``home`` first.

A scene of the guide has the keyframes of its models one after the other: of each robot and its
tools, then of the objects, in the order of their files.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Iterator

import mujoco

from robocell import NotFoundError, Scene, models


def scene_number(scene: Scene, number: int) -> int:
    """Returns the index in ``scene.keyframes()`` of the models' keyframe with this number.

    Raises:
        NotFoundError: The models have no such keyframe; the message lists theirs.
    """
    known = scene.keyframes()
    own = list(_names(scene, known))
    if not own and number == 0:
        return 0  # models without keyframes are reset to the scene's home
    if not 0 <= number < len(own):
        listed = ", ".join(f"{i} {name}" for i, name in enumerate(own)) or "none"
        raise NotFoundError(f"no keyframe {number}. The keyframes of the models: {listed}")
    return known.index(own[number])


def _names(scene: Scene, known: list[str]) -> Iterator[str]:
    """Returns the scene's names of the keyframes of its models, in their order."""
    for name in _full_names(scene):
        if name in known:
            yield name


def _full_names(scene: Scene) -> Iterator[str]:
    spec = scene.copy_spec()
    for robot in spec.robots:
        if not robot.part_of:
            yield from _of_model(robot.config.model if robot.config else robot.path, robot.prefix)
        for tool in robot.attachments:
            yield from _of_model(tool.mjcf_path, robot.prefix + tool.prefix)
    for each in spec.objects:
        if each.mjcf_path:
            yield from _of_model(each.mjcf_path, f"{each.name}_")


def _of_model(model: str, prefix: str) -> Iterator[str]:
    path = models.resolve(model)
    for name in _keys_of_file(path, os.stat(path).st_mtime_ns):
        # The scene has one `home`, in which each part is at its own.
        yield name if name == "home" else prefix + name


@functools.lru_cache(maxsize=64)
def _keys_of_file(path: str, _changed: int) -> tuple[str, ...]:
    keys = mujoco.MjSpec.from_file(path).keys
    return tuple(key.name or f"key{i}" for i, key in enumerate(keys))
