"""The names of the Python package ``mj_kdl_wrapper`` 0.2, for programs that were written for it.

    import robocell.compat.mj_kdl_wrapper as mjk

Almost all of it is robocell under the same name. This module adds `Env`, frames of robots as
PyKDL.Frame, objects whose model file takes precedence, the log levels as an enumeration,
`menagerie` with the variables ``MJ_KDL_*``, and the command ``mj-kdl-fetch-menagerie``. Nothing
here simulates.

Unlike the original, errors are subclasses of RuntimeError that name problem and place, and a scene
keeps the names of its parts: see docs/compat.md.
"""

from __future__ import annotations

import difflib

from robocell import (
    RobotSpec,
    Scene,
    SceneSpec,
    Shape,
    __mujoco_version__,
    __version__,
)
from robocell._elsewhere import no_such
from robocell.compat.mj_kdl_wrapper import menagerie
from robocell.compat.mj_kdl_wrapper._env import Env
from robocell.compat.mj_kdl_wrapper._log import LogLevel, get_log_level, set_log_level
from robocell.compat.mj_kdl_wrapper._names import Condim, scene_object_site_name
from robocell.compat.mj_kdl_wrapper._objects import SceneObject
from robocell.compat.mj_kdl_wrapper._robot import Robot
from robocell.compat.mj_kdl_wrapper._video import VideoRecorder
from robocell.compat.mj_kdl_wrapper._viewer import SimulateViewer
from robocell.control import CtrlMode
from robocell.diagnose import mujoco_version
from robocell.render import CameraSpec, VideoResolution
from robocell.robots import (
    AttachKind,
    AttachmentSpec,
    AttachTarget,
    ForceTorqueSensorSpec,
    ToolFrameSpec,
)
from robocell.scene import ResetContext, ResetInfo, ResetOptions

__all__ = [
    "AttachKind",
    "AttachTarget",
    "AttachmentSpec",
    "CameraSpec",
    "Condim",
    "CtrlMode",
    "Env",
    "ForceTorqueSensorSpec",
    "LogLevel",
    "ResetContext",
    "ResetInfo",
    "ResetOptions",
    "Robot",
    "RobotSpec",
    "Scene",
    "SceneObject",
    "SceneSpec",
    "Shape",
    "SimulateViewer",
    "ToolFrameSpec",
    "VideoRecorder",
    "VideoResolution",
    "__mujoco_version__",
    "__version__",
    "get_log_level",
    "menagerie",
    "mujoco_version",
    "scene_object_site_name",
    "set_log_level",
]


def __getattr__(name: str) -> object:
    """Raises AttributeError with the nearest name."""
    near = difflib.get_close_matches(name, __all__, 1)
    hint = f"Did you mean '{near[0]}'?" if near else f"It has {', '.join(__all__)}"
    raise no_such(f"module '{__name__}' has no '{name}'. {hint}", name)
