"""The state of the simulation in every row of a generated episode, from its recorded controls."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._core import ArgumentError, Episode, Scene, recorded_scene

TOLERANCE = 1e-6  # rad, m


def states_of(episode: Episode) -> NDArray[Any]:
    """Returns time, qpos and qvel in every row, (rows, 1 + nq + nv).

    Raises:
        ArgumentError: As replayed.
    """
    rows = [
        np.array([scene.data.time, *scene.data.qpos, *scene.data.qvel])
        for scene in replayed(episode)
    ]
    return np.array(rows)


def full_states_of(episode: Episode) -> NDArray[Any]:
    """Returns the engine's full state in every row, (rows, n), as Scene.set_state takes it.

    Raises:
        ArgumentError: As replayed.
    """
    return np.array([scene.state() for scene in replayed(episode)])


def replayed(episode: Episode) -> Iterator[Scene]:
    """Yields the scene in the state of every row.

    The recorded controls are simulated again from the recorded start.

    Raises:
        ArgumentError: The episode does not record its scene and controls, or the simulation does
            not follow the recorded joints.
    """
    for name in ("initial_state", "control/ctrl", "control/time", "time"):
        if name not in episode:
            raise ArgumentError(f"episode '{episode.id}' has no column '{name}'")
    metadata: Any = episode.metadata or {}
    if "environment" in metadata:
        raise ArgumentError(f"episode '{episode.id}' was recorded by an environment")
    control_ms = metadata.get("rates", {}).get("control_ms")
    if not isinstance(control_ms, int | float):
        raise ArgumentError(f"episode '{episode.id}' does not have its rates in the metadata")
    scene = Scene.build(recorded_scene(episode))
    start = episode["initial_state"]
    if start.shape != np.shape(scene.state()):
        raise ArgumentError(f"episode '{episode.id}': its scene has another state than recorded")
    steps = round(control_ms / (1000 * scene.timestep()))
    scene.set_state(start)
    data = scene.data
    times, controls = episode["control/time"], episode["control/ctrl"]
    begins = np.searchsorted(times, episode["time"] - scene.timestep() / 2)
    groups = _groups(episode, scene)
    ends = [*begins[1:], len(times)]
    for row, (begin, end) in enumerate(zip(begins, ends, strict=True)):
        for name, group, recorded in groups:
            error = np.abs(group.joint_pos - recorded[row]).max(initial=0)
            if not error <= TOLERANCE:
                raise ArgumentError(
                    f"episode '{episode.id}': replaying its controls differs from '{name}' by "
                    f"{error:.3g} in row {row}; `robocell replay` says more"
                )
        yield scene
        for tick in range(begin, end):
            data.ctrl[:] = controls[tick]
            scene.step_n(steps)


def _groups(episode: Episode, scene: Scene) -> list[tuple[str, Any, NDArray[Any]]]:
    """Returns the column, the move group and the recorded joint positions of each group."""
    found = []
    for name in episode.columns:
        parts = name.split("/")
        if len(parts) == 4 and parts[0] == "robots" and parts[3] == "qpos":
            found.append((name, scene.robot(parts[1]).group(parts[2]), episode[name]))
    return found
