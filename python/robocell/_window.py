"""Shows an environment: a view of its robots, and a window.

The window is MuJoCo's own viewer, which copies the state only on request.
"""

from __future__ import annotations

import os
import sys
import warnings
from typing import Any

import numpy as np

from robocell._core import EnvConfig, Scene

RENDER_SIZE = (480, 360)  # width, height in pixels
FRAME_RATE = 30  # Hz, where steps take as long as they need

NO_DISPLAY = (
    "no window: there is no display (see DISPLAY and WAYLAND_DISPLAY). The environment runs "
    "headless; render_mode='rgb_array' gives pictures"
)
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


def warn_once(message: str) -> None:
    """Logs a warning once per process."""
    if message not in _warned:
        _warned.add(message)
        warnings.warn(message, stacklevel=4)


def has_display() -> bool:
    """Returns True if there is a display; without one, MuJoCo's viewer would end the process."""
    if sys.platform != "linux":
        return True
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return False
    import glfw

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return bool(glfw.init())


class Window:
    """A window of a scene; closing it leaves the simulation as it is."""

    def __init__(self, scene: Scene, view: dict[str, Any]) -> None:
        import mujoco.viewer  # here: it looks for a display

        self._viewer = mujoco.viewer.launch_passive(
            scene.model, scene.data, show_left_ui=False, show_right_ui=False
        )
        for name, value in view.items():
            setattr(self._viewer.cam, name, value)

    @classmethod
    def open(cls, scene: Scene, view: dict[str, Any]) -> Window | None:
        """Opens a window, or logs a warning and returns None if there can be none."""
        if not has_display():
            warn_once(NO_DISPLAY)
            return None
        try:
            return cls(scene, view)
        except Exception as error:  # whatever the window system says
            warn_once(f"no window: {error}. The environment runs headless")
            return None

    def show(self) -> None:
        """Shows the present state; does nothing after the user closed the window."""
        if self._viewer.is_running():
            self._viewer.sync()

    def close(self) -> None:
        """Closes the window; may be repeated."""
        self._viewer.close()
