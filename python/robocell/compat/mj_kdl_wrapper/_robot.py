"""Robot: its frames are those of KDL."""

from __future__ import annotations

from typing import Any

import robocell
from robocell._arguments import no_attribute, with_hints
from robocell.compat.mj_kdl_wrapper._calls import closed_as


@closed_as("robot", robocell.Robot)
class Robot(robocell.Robot):
    """A robot whose `fk_frame`, `tip_to_tcp` and `ft_sensor_frame` are PyKDL.Frame.

    The rest is robocell's, also where the guide has no equivalent (`tcp_in_world` is a Pose).
    """

    __slots__ = ()

    def __setattr__(self, name: str, value: object) -> None:
        """Sets a known attribute. Raises AttributeError with the nearest name for any other."""
        attribute = getattr(type(self), name, None)
        if attribute is None:
            raise AttributeError(no_attribute(type(self), name))
        if not hasattr(attribute, "__set__"):
            raise AttributeError(f"'{name}' of a {type(self).__name__} cannot be set")
        attribute.__set__(self, value)  # as Python itself does; C++'s own refuses subclasses

    @staticmethod
    @with_hints
    def of(scene: robocell.Scene, name: str) -> Robot:
        """Returns a configured robot by its name in the scene."""
        return Robot(robocell.Robot.of(scene, name))

    @staticmethod
    @with_hints
    def from_scene(
        scene: robocell.Scene,
        base_body: str,
        tip_body: str,
        prefix: str = "",
        tool: robocell.robots.ToolFrameSpec | None = None,
    ) -> Robot:
        """Makes a robot without configuration: the chain between two bodies."""
        return Robot(robocell.Robot.from_scene(scene, base_body, tip_body, prefix, tool))

    @with_hints
    def fk_frame(self, q: Any = None) -> Any:
        """Returns the TCP in the robot base frame, a PyKDL.Frame; at joint values or now."""
        return super().fk_frame(q).to_kdl()

    @property
    def tip_to_tcp(self) -> Any:
        """The TCP in the tip body, a PyKDL.Frame."""
        return super().tip_to_tcp.to_kdl()

    @with_hints
    def ft_sensor_frame(self, name: str) -> Any:
        """Returns the frame of a sensor's reading in the world, a PyKDL.Frame."""
        return super().ft_sensor_frame(name).to_kdl()
