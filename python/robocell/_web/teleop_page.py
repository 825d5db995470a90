"""The page of a teleoperated session: the scene, cameras, buttons, and the web device."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from robocell._core import Scene
from robocell._teleop.device import Device, Motion
from robocell._teleop.web_device import WebDevice, checked_command, checked_input
from robocell._web.frame_hub import FrameHub, HubVisit
from robocell._web.live_scene import CHECKS, SceneFrames
from robocell._web.web_server import Reply


class TeleopPage:
    """A site, and the screen of an `Operator`.

    Args:
        title: Title of the page.
        device: Gets the motions of the page; None if another device drives.
        streams: Names of the run's image streams.
        help: What the device's keys do.
    """

    def __init__(
        self, title: str, device: WebDevice | None, streams: list[str], help: str = ""
    ) -> None:
        self._title, self._device, self._streams, self._help = title, device, streams, help
        self._buttons = WebDevice() if device is None else device
        self.hub = FrameHub()
        self.frames = SceneFrames(self.hub)

    @property
    def buttons(self) -> WebDevice:
        """Gets the commands of the page's buttons, also if another device drives."""
        return self._buttons

    def page(self, query: Mapping[str, str]) -> tuple[str, str]:
        """Returns the page's part for teleoperation, and the title."""
        return "teleop", self._title

    def get(self, path: str, query: Mapping[str, str]) -> Reply | None:
        """Returns the geometry."""
        return self.hub.geometry() if path == "geometry" else None

    def visit(self) -> HubVisit:
        """Returns the session of a page."""
        checks = {"camera": CHECKS["camera"], "command": checked_command}
        if self._device is not None:
            checks["input"] = checked_input
        return HubVisit(self.hub, checks)

    def pump(self) -> None:
        """Hands the commands of pages to the device and to the cameras."""
        for page, command in self.hub.take():
            self._buttons.apply(page, command)
            self.frames.apply(page, command)

    def show(self, scene: Scene, status: Mapping[str, Any], row: Mapping[str, Any]) -> None:
        """Publishes the state, with the recorded images of the cameras that pages show."""
        images = {}
        for name in self.frames.wanted:
            if name in self._streams and name in row:
                images[name] = np.asarray(row[name])
        extra = {
            "streams": self._streams,
            "drives": self._device is not None,
            "driver": self._buttons.driver,
            "help": self._help,
        }
        self.frames.publish(scene, {**status, **extra}, images)


class PageDevice(WebDevice):
    """The web device of a page: it asks the page for news before it is read."""

    def __init__(self) -> None:
        super().__init__()
        self.site: TeleopPage | None = None

    def read(self, seconds: float) -> Motion | None:
        """Returns the motion of the page that drives."""
        if self.site is not None:
            self.site.pump()
        return super().read(seconds)


class WithPage(Device):
    """Another device, with the buttons of a page.

    Args:
        device: The device that moves the arm.
        site: The page.
    """

    def __init__(self, device: Device, site: TeleopPage) -> None:
        self._device, self._site = device, site
        self.help, self.arms = device.help, device.arms

    def start(self) -> None:
        """Opens the device."""
        self._device.start()

    def read(self, seconds: float) -> Motion | None:
        """Returns the device's motion with the commands of the page."""
        self._site.pump()
        motion, page = self._device.read(seconds), self._site.buttons.read(seconds)
        commands = () if page is None else page.commands
        if not commands:
            return motion
        motion = motion or Motion(clutch=False)
        return replace(motion, commands=(*motion.commands, *commands))

    def begin(self) -> None:
        """Begins an episode."""
        self._device.begin()

    def reset_origin(self) -> None:
        """Makes the present pose of the device its zero."""
        self._device.reset_origin()

    def close(self) -> None:
        """Releases the device."""
        self._device.close()
