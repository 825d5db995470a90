"""Env: a scene with one reset hook, and robots that are made from it."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from numbers import Integral
from typing import Any

from robocell import ClosedError, Scene, SceneSpec
from robocell._arguments import with_hints
from robocell.compat.mj_kdl_wrapper._forward import Forwarding
from robocell.compat.mj_kdl_wrapper._keyframes import scene_number
from robocell.compat.mj_kdl_wrapper._robot import Robot
from robocell.robots import ToolFrameSpec
from robocell.scene import ResetContext, ResetInfo, ResetOptions

Hook = Callable[[ResetContext], Any]


class _Call:
    """The hook that the scene calls; it lives as long as the scene has it among its hooks."""

    def __init__(self, hook: Hook) -> None:
        self.hook = hook

    def __call__(self, context: ResetContext) -> Any:
        return self.hook(context)


class Env(Forwarding):
    """A scene that is reset with a hook. Everything else is the scene's: steps, frames, files.

    Attributes:
        scene: The scene itself.
    """

    __slots__ = ("_call", "_call_id", "scene")
    _wraps = "scene"
    scene: Scene
    _call: weakref.ref[_Call] | None
    _call_id: int

    def __init__(self, scene: Scene) -> None:
        """Wraps a built scene."""
        if not isinstance(scene, Scene):
            raise TypeError(
                f"Env takes a Scene that is built, got {type(scene).__name__}. "
                "To build one from a SceneSpec: Env.build(spec)"
            )
        self.scene = scene
        self._call = None
        self._call_id = 0

    @classmethod
    @with_hints
    def build(cls, spec: SceneSpec) -> Env:
        """Compiles the scene."""
        return cls(Scene.build(spec))

    def __enter__(self) -> Env:
        """Returns itself; the end of the block closes the scene."""
        return self

    def __exit__(self, *exception: object) -> None:
        """Closes the scene."""
        self.scene.close()

    def _require_open(self, name: str) -> None:
        if self.scene.closed and name not in ("name", "close", "closed"):
            raise ClosedError(f"env is closed: scene '{self.scene.name}' was closed")

    @with_hints
    def create_robot(
        self, base_body: str, tip_body: str, prefix: str = "", tool: ToolFrameSpec | None = None
    ) -> Robot:
        """Makes a robot of the chain between two bodies; it follows resets and rebuilds."""
        self._require_open("create_robot")
        return Robot.from_scene(self.scene, base_body, tip_body, prefix=prefix, tool=tool)

    def reset(self, options: ResetOptions | None = None, **fields: Any) -> ResetInfo:
        """Restores a state, calls the hook, and lets robots take their commands from the result.

        A number as the keyframe is that of the models, counted as in their files from 0; the
        returned info and the hook have the place in ``keyframes()``, whose first is ``home``.

        Args:
            options: What to do, or
            **fields: the fields of `ResetOptions` by name.
        """
        self._require_open("reset")
        if options is None:
            fields = self._counted(fields)
        elif isinstance(options, ResetOptions) and not fields:
            names = ("keyframe", "use_keyframe", "seed", "body_poses")
            given = {name: getattr(options, name) for name in names}
            options = ResetOptions(**self._counted(given))
        return self.scene.reset(options, **fields)

    def _counted(self, fields: dict[str, Any]) -> dict[str, Any]:
        """Returns the fields with the scene's index of the models' keyframe."""
        number = fields.get("keyframe")
        if isinstance(number, bool):
            raise TypeError(f"keyframe: expected a number, a name or {{part: name}}; got {number}")
        if not isinstance(number, Integral) or not fields.get("use_keyframe", True):
            return fields
        return fields | {"keyframe": scene_number(self.scene, int(number))}

    @property
    def on_reset(self) -> Hook | None:
        """Called in every reset after the state was restored, before commands are re-seeded.

        None after ``clear_reset_hooks()``, which removes it too.
        """
        call = self._call and self._call()
        return call.hook if call else None

    @on_reset.setter
    def on_reset(self, hook: Hook | None) -> None:
        if hook is not None and not callable(hook):
            raise TypeError(
                f"on_reset: expected a function that takes one ResetContext, or None; got {hook!r}"
            )
        self._require_open("on_reset")
        if self.on_reset is not None:
            self.scene.remove_reset_hook(self._call_id)
        self._call = None
        if hook is not None:
            call = _Call(hook)
            self._call_id = self.scene.on_reset(call)
            self._call = weakref.ref(call)
