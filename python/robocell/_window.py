"""Shows an environment: a view of its robots, and a window.

The window is robocell's viewer (docs/viewer.md), which draws only on request here.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from robocell._core import EnvConfig, Error, Scene, Viewer

RENDER_SIZE = (480, 360)  # width, height in pixels
FRAME_RATE = 30  # Hz, where steps take as long as they need

NO_WINDOW = "no window"  # subject of a warning
_warned: set[str] = set()


def frame_rate(config: EnvConfig) -> int:
    """Returns the number of pictures per second of its steps, at least 1."""
    return max(1, round(config.sim.frequency)) if config.sim.async_control else FRAME_RATE


def side_view(scene: Scene, config: EnvConfig) -> dict[str, Any]:
    """Returns OrbitCamera arguments that show all robots and their reach from the side."""
    robots = [scene.robot(name) for name in config.robots]
    bases = np.array([robot.base_in_world.translation for robot in robots])
    reach = max(robot.reach for robot in robots)
    forward = scene.root_frame_to_world.rotation[:, 0]
    lookat = bases.mean(axis=0) + 0.3 * reach * forward + [0, 0, 0.3 * reach]
    spread = float(np.ptp(bases, axis=0).max())
    azimuth = float(np.degrees(np.arctan2(forward[1], forward[0]))) + 135
    return {
        "lookat": lookat.tolist(),
        "distance": 1.6 * reach + spread,
        "azimuth": azimuth,
        "elevation": -20.0,
    }


def warn_once(message: str, subject: str = "") -> None:
    """Logs a warning once per process, or one of its subject."""
    if (subject or message) not in _warned:
        _warned.add(subject or message)
        warnings.warn(message, stacklevel=4)


class Window:
    """A window of a scene; closing it leaves the simulation as it is."""

    def __init__(self, scene: Scene, view: dict[str, Any]) -> None:
        self._viewer = Viewer.open(
            scene, width=960, height=720, stops_scene=False, draws_steps=False
        )
        self._viewer.panels_shown = False
        self._viewer.set_free_camera(**view)

    @classmethod
    def open(cls, scene: Scene, view: dict[str, Any]) -> Window | None:
        """Opens a window, or logs a warning and returns None if there can be none."""
        try:
            return cls(scene, view)
        except Error as error:
            hint = "The environment runs headless; render_mode='rgb_array' gives pictures"
            warn_once(f"{error}\n{hint}", NO_WINDOW)
            return None

    def show(self) -> None:
        """Shows the present state; does nothing after the user closed the window."""
        self._viewer.show()

    def close(self) -> None:
        """Closes the window; may be repeated."""
        self._viewer.close()
