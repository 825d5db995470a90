"""A single environment with Gymnasium's interface."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from numpy.typing import NDArray

from robocell._core import ArgumentError, Env, EnvConfig, OrbitCamera, Renderer
from robocell._spaces import frame_space, space_of
from robocell._window import RENDER_SIZE, Window, frame_rate, side_view

KEYFRAME = "keyframe"  # the option of resets


def options_of(options: Any, *takes: str) -> Mapping[str, Any]:
    """Checks the options of a reset, which accepts only those of the names ``takes``."""
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise ArgumentError(
            f"options of reset must be a dict or None, got {type(options).__name__}"
        )
    if unknown := [str(key) for key in options if key not in takes]:
        known = " and ".join(f"'{name}'" for name in takes)
        what = f"the option{'s' if len(takes) > 1 else ''} {known}" if takes else "no options"
        raise ArgumentError(f"reset takes {what} here, got {', '.join(unknown)}")
    return options


class GymEnv(gymnasium.Env[Any, Any]):
    """A Gymnasium environment of a configuration; ``unwrapped.core`` is its ``rc.Env``.

    Spaces are dictionaries by robot, as in ``rc.Env``; the robots give the ranges of joints and
    positions. ``render_mode`` is None, "rgb_array" (``render`` returns pictures) or "human" (a
    window follows every step, as with ``headless: false`` in the configuration). Without a display
    "human" logs one warning and opens no window. Pictures show the robots from the side and in
    front, or the view of ``render_camera``: a camera of the scene, "" for the whole model, or an
    OrbitCamera and similar.

    Examples:
        >>> gym_env = rc.gym.GymEnv(rc.gym.pick_cube_config())
        >>> observation, info = gym_env.reset(seed=0)
    """

    metadata = {  # noqa: RUF012  (as in Gymnasium)
        "render_modes": ["human", "rgb_array"],
        "render_fps": 30,
    }

    def __init__(
        self,
        config: EnvConfig,
        render_mode: str | None = None,
        render_camera: Any = None,
        render_size: tuple[int, int] = RENDER_SIZE,
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ArgumentError(
                f"render_mode must be None, 'human' or 'rgb_array', got {render_mode!r}"
            )
        self._generator: np.random.Generator | None = None
        self.core = Env(config)
        self.render_mode = render_mode
        self.action_space = space_of(self.core.commanded, self.core.action_parts)
        self.observation_space = space_of(
            self.core.observed, self.core.observation_parts, frame_space(config)
        )
        self.metadata = {**self.metadata, "render_fps": frame_rate(config)}
        view = side_view(self.core.scene, config)
        self._camera = OrbitCamera(**view) if render_camera is None else render_camera
        self._size = render_size
        self._renderer: Renderer | None = None
        self._seeded = False
        self._window: Window | None = None
        if render_mode == "human" or not config.headless:
            self._window = Window.open(self.core.scene, view)

    # Gymnasium's generator. Nothing here draws from it after the first seed, and making it takes
    # longer than a whole reset, so it is made on first use.
    @property
    def _np_random(self) -> np.random.Generator | None:
        if self._generator is None and self._np_random_seed is not None:
            self._generator, _ = seeding.np_random(self._np_random_seed)
        return self._generator

    @_np_random.setter
    def _np_random(self, generator: np.random.Generator | None) -> None:
        self._generator = generator

    def _seed(self, seed: int) -> None:
        if not isinstance(seed, int) or seed < 0:
            seeding.np_random(seed)  # Gymnasium's error
        self._generator, self._np_random_seed = None, seed

    @property
    def recordable(self) -> Env:
        """What `robocell.data.EnvRecorder` records."""
        return self.core

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Resets to the start of the seed, or to the next start of the last seed.

        Without any seed so far, it uses a random one. ``options={"keyframe": ...}`` starts the
        robots at a keyframe of the scene (see ``Scene.reset``) instead of at home.
        """
        if seed is not None:
            self._seed(seed)
        given = options_of(options, KEYFRAME)
        if seed is None and not self._seeded:
            seed = int(self.np_random.integers(2**63))
        observation, info = self.core.reset(seed, given.get(KEYFRAME))
        self._seeded = True
        if self._window:
            self._window.show()
        return observation, info

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Makes one step; ``info["reason"]`` is the reason for its end."""
        result = self.core.step(action)
        if self._window:
            self._window.show()
        return result

    def row(self) -> dict[str, NDArray[Any]]:
        """Returns the present state by the names of columns in datasets, as ``Env.row``.

        ``step`` takes the names of action columns too.
        """
        return self.core.row()

    def render(self) -> Any:
        """Returns a picture (H, W, 3) uint8 of the present state; None in other modes."""
        if self.render_mode != "rgb_array":
            return None
        if self._renderer is None:
            self._renderer = Renderer(self.core.scene)
        width, height = self._size
        return self._renderer.render(self._camera, width=width, height=height)["rgb"]

    def close(self) -> None:
        """Closes the environment; may be repeated."""
        self._renderer = None
        if self._window:
            self._window.close()
            self._window = None
        self.core.close()
