"""Env: a scene with one reset hook, and robots that are made from it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from robocell import ClosedError, Scene, SceneSpec
from robocell.compat.mj_kdl_wrapper.calls import told
from robocell.compat.mj_kdl_wrapper.forward import Forwarding
from robocell.compat.mj_kdl_wrapper.robot import Robot
from robocell.robots import ToolFrameSpec
from robocell.scene import ResetContext

Hook = Callable[[ResetContext], Any]


class Env(Forwarding):
    """A scene that is reset with a hook. Everything else is the scene's: steps, frames, files.

    Attributes:
        scene: The scene itself.
    """

    __slots__ = ("_hook", "_hook_id", "scene")
    _wraps = "scene"
    scene: Scene
    _hook: Hook | None
    _hook_id: int | None

    def __init__(self, scene: Scene) -> None:
        """Of a scene that is built already."""
        if not isinstance(scene, Scene):
            raise TypeError(
                f"Env takes a Scene that is built, got {type(scene).__name__}. "
                "To build one from a SceneSpec: Env.build(spec)"
            )
        self.scene = scene
        self._hook = None
        self._hook_id = None

    @classmethod
    @told
    def build(cls, spec: SceneSpec) -> Env:
        """Compiles the scene."""
        return cls(Scene.build(spec))

    def __enter__(self) -> Env:
        """Itself; the scene is closed at the end of the block."""
        return self

    def __exit__(self, *exception: object) -> None:
        """Closes the scene."""
        self.scene.close()

    def _require_open(self, name: str) -> None:
        if self.scene.closed and name not in ("name", "close", "closed"):
            raise ClosedError(f"env is closed: scene '{self.scene.name}' was closed")

    @told
    def create_robot(
        self, base_body: str, tip_body: str, prefix: str = "", tool: ToolFrameSpec | None = None
    ) -> Robot:
        """The chain between two bodies; it follows resets and rebuilds of the scene."""
        self._require_open("create_robot")
        return Robot.from_scene(self.scene, base_body, tip_body, prefix=prefix, tool=tool)

    @property
    def on_reset(self) -> Hook | None:
        """Called in every reset after the state was restored, before commands are re-seeded."""
        return self._hook

    @on_reset.setter
    def on_reset(self, hook: Hook | None) -> None:
        if hook is not None and not callable(hook):
            raise TypeError(
                f"on_reset: expected a function that takes one ResetContext, or None; got {hook!r}"
            )
        self._require_open("on_reset")
        if self._hook_id is not None:
            self.scene.remove_reset_hook(self._hook_id)
        self._hook = hook
        self._hook_id = None if hook is None else self.scene.on_reset(hook)
