"""A running scene for pages: it steps in real time, and pages pause it and move its joints.

    live = LiveScene(scene, "cell")
    with WebServer(live) as server: ...
    live.run()      # in the thread that owns the scene, until stop() or Ctrl-C

The scene stands still while no page is open.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from robocell import _core
from robocell._channel import MisbehavedError
from robocell._core import CtrlMode, Error, Robot, Scene
from robocell._notebook import has_arm
from robocell._web.frame_hub import FrameHub, HubVisit
from robocell._web.packed import Packed
from robocell._web.scene_geometry import body_poses, geometry_of, joints_of
from robocell._web.soft_parts import SoftParts
from robocell._web.web_server import Reply, number_of, text_of

FRAME_S = 1 / 30
IMAGE_S = 0.1  # between the images of a camera
IMAGE_SIZE = (320, 240)
MOST_IMAGES = 4  # cameras at one time
MOST_SHOWN = 64  # cameras that a page asks for
MOST_LAG_S = 0.1  # simulated at once; a slower machine shows a slower simulation
MOST_SPEED = 100.0
MEASURED_S = 1.0  # window of the measured speed


def _nothing(_message: dict[str, Any]) -> dict[str, Any]:
    return {}


def _switch(message: dict[str, Any]) -> dict[str, Any]:
    if not isinstance(message.get("on"), bool):
        raise MisbehavedError(f"`on` of '{message['op']}' is true or false")
    return {"on": message["on"]}


def _speed(message: dict[str, Any]) -> dict[str, Any]:
    return {"value": min(max(number_of(message, "value"), 0.0), MOST_SPEED)}


def _named(message: dict[str, Any]) -> dict[str, Any]:
    return {"name": text_of(message, "name"), "value": number_of(message, "value")}


CHECKS: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
    "pause": _switch,
    "step": _nothing,
    "reset": _nothing,
    "speed": _speed,
    "joint": _named,
    "opening": _named,
    "camera": lambda message: {"name": text_of(message, "name"), **_switch(message)},
}


class SceneFrames:
    """Packs the states of a scene, and images of its cameras, for pages.

    Args:
        hub: Where frames go.

    Attributes:
        hub: As given.
        message: What the page asked wrongly; "" otherwise.
    """

    def __init__(self, hub: FrameHub) -> None:
        self.hub = hub
        self._generation = -1
        self._shown: dict[int, set[str]] = {}  # cameras of each page
        self._renderer: Any = None
        self._drawn: dict[str, tuple[float, Any]] = {}
        self._qpos: Any = np.zeros(0, int)
        self._model: object = None
        self._soft = SoftParts()
        self.message = ""

    def apply(self, page: int, command: Mapping[str, Any]) -> bool:
        """Acts on `camera` and `gone`. Returns True if the command was one of them."""
        if command["op"] == "gone":
            self._shown.pop(page, None)
            return True
        if command["op"] != "camera":
            return False
        shown = self._shown.setdefault(page, set())
        if not command["on"]:
            shown.discard(command["name"])
        elif len(shown) < MOST_SHOWN:  # a page may send any names
            shown.add(command["name"])
        return True

    @property
    def wanted(self) -> list[str]:
        """Cameras that pages show."""
        names = sorted(set[str]().union(*self._shown.values()))
        return names[:MOST_IMAGES]

    def publish(
        self, scene: Scene, status: Mapping[str, Any], images: Mapping[str, Any] | None = None
    ) -> None:
        """Publishes the present state. Without `images`, the wanted cameras are drawn."""
        model = scene.model
        if model is not self._model or scene.generation != self._generation:
            self._model, self._generation = model, scene.generation
            self._renderer, self._drawn = None, {}
            self._qpos = np.array([joint["qpos"] for joint in joints_of(scene)], int)
            self._soft = SoftParts(model)
            self.hub.publish_geometry(geometry_of(scene, self._soft))
        packed = Packed()
        if images is None:
            images = self._images(scene)
        header = {
            "generation": self._generation,
            "time": float(scene.time()),
            "poses": packed.add(body_poses(scene)),
            "points": packed.add(self._soft.points(scene.data)),
            "joints": packed.add(np.asarray(scene.data.qpos)[self._qpos]),
            "openings": [_opening(robot) for robot in scene.robots if robot.has_gripper],
            "images": [
                {"name": name, "pixels": packed.add(pixels, "u1")}
                for name, pixels in images.items()
            ],
            "message": self.message,
            **status,
        }
        self.hub.publish(packed.block(header))

    def _images(self, scene: Scene) -> dict[str, Any]:
        """Draws the wanted cameras, each as often as `IMAGE_S` allows."""
        now = time.monotonic()
        found = {}
        for name in self.wanted:
            drawn_at, pixels = self._drawn.get(name, (0.0, None))
            if now - drawn_at >= IMAGE_S:
                try:
                    self._renderer = self._renderer or _core.Renderer(scene)
                    pixels = self._renderer.render(name, *IMAGE_SIZE)["rgb"]
                except Error as error:
                    self.message = str(error)
                    for shown in self._shown.values():
                        shown.discard(name)
                    continue
                self._drawn[name] = (now, pixels)
                found[name] = pixels
        return found


class LiveScene:
    """A site with a scene that its owner steps.

    Args:
        scene: The scene.
        title: Title of the page.
        speed: Simulated seconds per second; 0 is as fast as possible.
        restart: Brings the scene to its start; default `scene.reset()`.

    Attributes:
        paused: True while time stands still.
        speed: As given, or as a page chose.
    """

    def __init__(
        self,
        scene: Scene,
        title: str,
        speed: float = 1.0,
        restart: Callable[[], object] | None = None,
    ) -> None:
        self._title, self.speed, self.paused = title, min(max(speed, 0.0), MOST_SPEED), False
        self._scene = scene
        self._restart = restart or scene.reset
        self.hub = FrameHub()
        self.frames = SceneFrames(self.hub)
        self._ends = threading.Event()
        self._diverged = ""
        self._measured: list[tuple[float, float]] = []
        self._work_s = 0.0

    def page(self, query: Mapping[str, str]) -> tuple[str, str]:
        """Returns the page's part for running scenes, and the title."""
        return "live", self._title

    def get(self, path: str, query: Mapping[str, str]) -> Reply | None:
        """Returns the geometry."""
        return self.hub.geometry() if path == "geometry" else None

    def visit(self) -> HubVisit:
        """Returns the session of a page."""
        return HubVisit(self.hub, CHECKS)

    def stop(self) -> None:
        """Ends `run`; may be called from any thread."""
        self._ends.set()

    def run(self) -> None:
        """Steps and publishes until `stop`. Ctrl-C ends it with KeyboardInterrupt."""
        self._publish()
        published = before = time.monotonic()
        while not self._ends.is_set():
            for page, command in self.hub.take():
                self._do(page, command)
            now = time.monotonic()
            if not self.hub.watched:
                self.hub.rest(0.1)
                before = time.monotonic()
                continue
            self._advance(min(now - before, MOST_LAG_S))
            before = now
            if now - published >= FRAME_S:
                published = now
                self._publish()
            self._work_s = 0.9 * self._work_s + 0.1 * (time.monotonic() - now)
            if self.paused or self.speed > 0:
                self.hub.rest(FRAME_S / 3)

    def _advance(self, seconds: float) -> None:
        """Steps for so many seconds of the clock."""
        if self.paused or self._diverged:
            return
        end = self._scene.time() + seconds * self.speed
        stop = time.monotonic() + FRAME_S
        while time.monotonic() < stop and (self.speed == 0 or self._scene.time() < end - 1e-9):
            self._step()
            if self._diverged:
                return

    def _step(self) -> None:
        for robot in self._scene.robots:
            robot.update()
        result = self._scene.step()
        if result.diverged:
            self._diverged = result.message

    def _publish(self) -> None:
        now, time_s = time.monotonic(), self._scene.time()
        self._measured.append((now, time_s))
        while now - self._measured[0][0] > MEASURED_S:
            self._measured.pop(0)
        (first, first_s) = self._measured[0]
        measured = (time_s - first_s) / (now - first) if now > first else 0.0
        status = {
            "paused": self.paused,
            "speed": self.speed,
            "measured": round(max(measured, 0.0), 3),
            "work_ms": round(1e3 * self._work_s, 2),
            "diverged": self._diverged,
        }
        self.frames.publish(self._scene, status)

    def _do(self, page: int, command: dict[str, Any]) -> None:
        """Acts on a command; what a page asks wrongly is its message."""
        if self.frames.apply(page, command):
            return
        try:
            self.frames.message = ""
            match command["op"]:
                case "pause":
                    self.paused = command["on"]
                case "step":
                    self.paused = True
                    self._step()
                case "reset":
                    self._restart()
                    self._diverged = ""
                case "speed":
                    self.speed = command["value"]
                case "joint":
                    move_joint(self._scene, command["name"], command["value"])
                case "opening":
                    self._scene.robot(command["name"]).gripper.opening = command["value"]
        except Error as error:
            self.frames.message = str(error)


def move_joint(scene: Scene, name: str, value: float) -> None:
    """Puts a hinge or slide to a position within its limits; a robot's arm then holds it there.

    Raises NotFoundError for an unknown joint.
    """
    joints = joints_of(scene)
    found = next((joint for joint in joints if joint["name"] == name), None)
    if found is None:
        scene.joint_pos(name)  # raises with the nearest names
        raise MisbehavedError(f"joint '{name}' is no hinge or slide")
    value = min(max(value, found["lower"]), found["upper"])
    for robot in scene.robots:
        if has_arm(robot) and name in robot.joint_names and robot.ctrl_mode == CtrlMode.POSITION:
            q = np.array(robot.arm.joint_pos)
            q[robot.joint_names.index(name)] = value
            robot.set_joint_pos(q)
            return
    scene.data.qpos[found["qpos"]] = value
    scene.forward()


def _opening(robot: Robot) -> dict[str, Any]:
    return {"robot": robot.name, "value": round(float(robot.gripper.opening), 4)}
