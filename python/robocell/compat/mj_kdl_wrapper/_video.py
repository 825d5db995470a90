"""Recorders that take a scene or an Env, and are closed."""

from __future__ import annotations

from numbers import Integral
from pathlib import Path

import robocell
from robocell._arguments import with_hints
from robocell.compat.mj_kdl_wrapper._env import Env
from robocell.compat.mj_kdl_wrapper._forward import Forwarding


class VideoRecorder(Forwarding):
    """A recorder of robocell's, whose `finish` is called `close`: camera_names, frames ..."""

    __slots__ = ("_closed", "recorder")
    _wraps = "recorder"
    recorder: robocell.render.VideoRecorder
    _closed: bool

    def __init__(self, recorder: robocell.render.VideoRecorder | None = None) -> None:
        """Wraps an open recorder; use `open` or `open_preset`."""
        if not isinstance(recorder, robocell.render.VideoRecorder):
            given = "" if recorder is None else f", got {type(recorder).__name__}"
            raise TypeError(
                "VideoRecorder takes a robocell.render.VideoRecorder"
                f"{given}. To begin a video: VideoRecorder.open(env, 'video.mp4'), or with one "
                "of the usual sizes VideoRecorder.open_preset(env, 'video.mp4')"
            )
        self.recorder = recorder
        self._closed = False

    @classmethod
    @with_hints
    def open(
        cls,
        target: robocell.Scene | Env,
        path: str | Path,
        width: int = 1280,
        height: int = 720,
        fps: int = 60,
    ) -> VideoRecorder:
        """Opens a recorder with a size in pixels; odd sizes are rounded down to even ones."""
        size = _even("width", width), _even("height", height)
        return cls(robocell.render.VideoRecorder(_scene(target), path, *size, fps))

    @classmethod
    @with_hints
    def open_preset(
        cls,
        target: robocell.Scene | Env,
        path: str | Path,
        resolution: robocell.render.VideoResolution = robocell.render.VideoResolution.R720p,
        fps: int = 60,
    ) -> VideoRecorder:
        """Opens a recorder with a standard size."""
        return cls(robocell.render.VideoRecorder.open_preset(_scene(target), path, resolution, fps))

    def _require_open(self, name: str) -> None:
        if self._closed and name.startswith(("record_", "set_", "use_")):
            raise robocell.ClosedError(
                "recorder is closed: its video is finished; open another one with "
                "VideoRecorder.open"
            )

    def close(self) -> None:
        """Completes the file, which does not exist before. Further calls do nothing."""
        if not self._closed:
            self._closed = True
            self.recorder.finish()

    @with_hints
    def use_camera(self, name: str = "") -> bool:
        """Selects a camera of camera_names(), or the free one. Returns False for an unknown name.

        An unknown name changes nothing. "Tracking" is an error before `set_tracking_camera`.
        """
        self._require_open("use_camera")
        try:
            self.recorder.use_camera(name)
        except robocell.NotFoundError:
            return False
        return True

    def record_frame(self) -> bool:
        """Records the present scene as a frame. Returns True; errors are raised."""
        self._require_open("record_frame")
        self.recorder.record_frame()
        return True


def _even(name: str, size: int) -> int:
    """Rounds down to an even size; sizes below 2 stay, for the later error."""
    if not isinstance(size, Integral):
        raise TypeError(f"VideoRecorder.open(): {name}: expected a whole number, got {size!r}")
    return int(size) - size % 2 if size > 1 else int(size)


def _scene(target: robocell.Scene | Env) -> robocell.Scene:
    return target.scene if isinstance(target, Env) else target
