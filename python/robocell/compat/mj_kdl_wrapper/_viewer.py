"""SimulateViewer: robocell's viewer under the names of the guide."""

from __future__ import annotations

from typing import Any

import robocell
from robocell._arguments import with_hints
from robocell.compat.mj_kdl_wrapper._env import Env
from robocell.compat.mj_kdl_wrapper._forward import Forwarding
from robocell.viewer import Viewer


class SimulateViewer(Forwarding):
    """A window of a robot or a scene. Everything else is the viewer's: frames, paths, panels."""

    __slots__ = ("viewer",)
    _wraps = "viewer"
    viewer: Viewer

    def __init__(self, viewer: Viewer | None = None) -> None:
        """Wraps an open viewer; use `open`."""
        if not isinstance(viewer, Viewer):
            given = "" if viewer is None else f", got {type(viewer).__name__}"
            raise TypeError(
                f"SimulateViewer takes a robocell.viewer.Viewer{given}. To open a window: "
                "SimulateViewer.open(robot) or SimulateViewer.open(scene)"
            )
        self.viewer = viewer

    @classmethod
    @with_hints
    def open(
        cls, target: robocell.Robot | robocell.Scene | Env, title: str = "MuJoCo"
    ) -> SimulateViewer:
        """Opens a window of a robot, or of a scene or Env without one."""
        scene = target.scene if isinstance(target, Env) else target
        return cls(Viewer.open(scene, title))

    def _require_open(self, name: str) -> None:
        if self.viewer.scene.closed and name not in ("close", "step", "is_running", "viewer"):
            raise robocell.ClosedError("viewer is closed: its scene was closed")

    def is_running(self) -> bool:
        """Returns False once the window was closed."""
        return self.viewer.is_running

    def step_n(self, n: int) -> bool:
        """Makes n steps as `step` does. Returns False once the window was closed."""
        return all(self.viewer.step() for _ in range(n))

    @with_hints
    def use_camera(self, name: str = "") -> bool:
        """Selects a camera of the scene, or the free one. Returns False for an unknown name."""
        self._require_open("use_camera")
        try:
            self.viewer.use_camera(name)
        except robocell.NotFoundError:
            return False
        return True

    @with_hints
    def start_recording(self, path: str, fps: int = 30, width: int = 0, height: int = 0) -> None:
        """Begins a video; 1280 x 720 pixels unless a size is given."""
        self._require_open("start_recording")
        self.viewer.start_recording(str(path), fps, width or 1280, height or 720)

    def stop_recording(self) -> Any:
        """Completes the video and returns its path."""
        return self.viewer.stop_recording()
