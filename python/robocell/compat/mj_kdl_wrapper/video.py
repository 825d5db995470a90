"""Recorders that take a scene or an Env, and are closed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import robocell
from robocell.compat.mj_kdl_wrapper.env import Env


class VideoRecorder:
    """A recorder of robocell's, whose `finish` is called `close`."""

    def __init__(self, recorder: robocell.VideoRecorder) -> None:
        """Of a recorder that is open."""
        self.recorder = recorder

    @classmethod
    def open(
        cls, target: robocell.Scene | Env, path: str | Path, width: int, height: int, fps: int
    ) -> VideoRecorder:
        """With a size of one's own, in pixels."""
        return cls(robocell.VideoRecorder(_scene(target), path, width, height, fps))

    @classmethod
    def open_preset(
        cls,
        target: robocell.Scene | Env,
        path: str | Path,
        resolution: robocell.VideoResolution,
        fps: int = 60,
    ) -> VideoRecorder:
        """With one of the usual sizes."""
        return cls(robocell.VideoRecorder.open_preset(_scene(target), path, resolution, fps))

    def close(self) -> None:
        """Ends the file; without it there is none."""
        self.recorder.finish()

    def use_camera(self, name: str = "") -> bool:
        """Chooses a camera by name, or the free one: False, and no change, when there is none."""
        try:
            self.recorder.use_camera(name)
        except robocell.NotFoundError:
            return False
        return True

    def record_frame(self) -> bool:
        """The scene as it is now becomes a frame; never False, what goes wrong is raised."""
        self.recorder.record_frame()
        return True

    def __getattr__(self, name: str) -> Any:
        """The recorder's: set_free_camera, frames."""
        if name.startswith("_") or name == "recorder":
            raise AttributeError(name)
        return getattr(self.recorder, name)


def _scene(target: robocell.Scene | Env) -> robocell.Scene:
    return target.scene if isinstance(target, Env) else target
