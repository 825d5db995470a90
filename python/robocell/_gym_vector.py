"""Copies of one environment as a Gymnasium vector environment."""

from __future__ import annotations

import operator
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from robocell._core import ArgumentError, EnvBatch, EnvConfig, OrbitCamera, _is_by_name
from robocell._gym_env import KEYFRAME, options_of
from robocell._spaces import Part, frame_space, space_of
from robocell._suggestions import counted
from robocell._window import RENDER_SIZE, frame_rate, side_view, warn_once

Observation = dict[str, Any]
Action = Mapping[str, Any]

RESET_OPTION = "reset_mask"
NO_WINDOWS = (
    "no window: copies in a vector have none, headless: false is for a single environment. "
    "render_mode='rgb_array' gives a picture of each"
)


class VectorGymEnv(VectorEnv[Any, Any, Any]):
    """Copies of one environment on one model, on C++ threads. One Python call steps all copies.

    Observations, rewards and ends are those of separate ``GymEnv``. All three autoreset modes of
    Gymnasium are supported. Infos have ``reason``, ``time``, ``robots`` (the remaining motion of
    each robot, arrays under the keys that ``Env.step`` documents) and, with a task, ``is_success``,
    ``progress``, ``subtask`` and ``instruction``, each with a mask (``_reason`` ...) of the copies
    that made a step. With SAME_STEP, the infos of copies that ended are in ``final_info``, beside
    ``final_obs``. One renderer draws the images, one copy after the other.

    Args:
        config: configuration of all copies.
        num_envs: number of copies.
        max_episode_steps: number of steps after which an episode is truncated; None: never.
        autoreset_mode: when ended episodes restart.
        threads: number of threads, including the caller's; 0 for one per core.
        render_mode: None or "rgb_array": ``render`` returns a picture of each copy. Copies have no
            windows.
        render_camera: camera of the pictures, as in ``GymEnv``.
        render_size: width and height of the pictures, pixels.

    Examples:
        >>> vector = rc.gym.VectorGymEnv(rc.gym.pick_cube_config(), num_envs=4)
        >>> observations, infos = vector.reset(seed=0)
        >>> actions = vector.action_space.sample()
        >>> observations, rewards, terminated, truncated, infos = vector.step(actions)
        >>> rewards.shape
        (4,)
    """

    def __init__(
        self,
        config: EnvConfig,
        num_envs: int = 1,
        max_episode_steps: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int = 0,
        render_mode: str | None = None,
        render_camera: Any = None,
        render_size: tuple[int, int] = RENDER_SIZE,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ArgumentError(
                f"render_mode of a vector must be None or 'rgb_array', got {render_mode!r}: its "
                "copies have no windows"
            )
        mode = _autoreset_mode(autoreset_mode)
        if not config.headless:
            warn_once(NO_WINDOWS)
        self.core = EnvBatch(config, num_envs, threads, max_episode_steps)
        self._name = config.name
        self._has_task = config.task is not None
        self._action_parts = self.core.action_parts
        self._observation_parts = self.core.observation_parts
        self._observation_shapes = [feature.shape for feature in self.core.observed]
        self._action_keys = list(_keys_of(self._action_parts))
        self.single_action_space = space_of(self.core.commanded, self._action_parts)
        self.single_observation_space = space_of(
            self.core.observed, self._observation_parts, frame_space(config)
        )
        self.num_envs = num_envs
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.autoreset_mode = mode
        self.render_mode = render_mode
        self.metadata = {
            "autoreset_mode": self.autoreset_mode,
            "render_modes": ["rgb_array"],
            "render_fps": frame_rate(config),
        }
        self._camera = render_camera
        if render_mode and render_camera is None:
            self._camera = OrbitCamera(**side_view(self.core.scene, config))
        self._size = render_size
        self._ended = np.zeros(num_envs, dtype=bool)
        self._seeded = np.zeros(num_envs, dtype=bool)

    @property
    def recordable(self) -> EnvBatch:
        """What `robocell.data.EnvRecorder` records."""
        return self.core

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Any, dict[str, Any]]:
        """Resets all copies, or with ``options={"reset_mask": (num_envs,) bool}`` some of them.

        Copy i gets ``seed + i``, or the i-th of num_envs seeds. Without a seed it gets the next
        start of its last seed, or a random one at first. ``options={"keyframe": ...}`` starts the
        robots at a keyframe (see ``Scene.reset``) instead of at home; episodes that begin in
        ``step`` begin at home.
        """
        given = options_of(options, RESET_OPTION, KEYFRAME)
        which = self._which(given)
        seeds = self._seeds(seed, which)
        observations = self.core.reset(seeds, which.tolist(), given.get(KEYFRAME))
        self._seeded |= which
        self._ended[which] = False
        return self._observation(observations), self._instructions(which)

    def step(
        self, actions: Any
    ) -> tuple[Any, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Makes one step of every copy; the autoreset mode determines when ended copies restart.

        Actions may have the names of action columns in datasets, as in ``Env.step``:
        ``{"robots/left/action/arm": (num_envs, n) numbers}``. After an error during the step, or
        Ctrl-C, reset all copies.
        """
        if self.autoreset_mode == AutoresetMode.DISABLED and self._ended.any():
            raise ArgumentError(
                f"episodes of {np.flatnonzero(self._ended).tolist()} have ended: reset them with "
                f"options={{'{RESET_OPTION}': ...}} before the next step"
            )
        again = self._ended & (self.autoreset_mode == AutoresetMode.NEXT_STEP)
        flat, rewards, terminated, truncated, times, reasons = self.core.step(
            actions if _is_by_name(actions) else self._flat(actions), again.tolist()
        )
        ends = terminated.astype(bool), truncated.astype(bool)
        self._ended = ends[0] | ends[1]
        infos: dict[str, Any] = {}
        stepped = ~again
        if self.autoreset_mode == AutoresetMode.SAME_STEP and self._ended.any():
            infos["final_obs"] = self._objects(self._observation(flat), self._ended)
            infos["final_info"] = self._infos(times, reasons, ends[0], self._ended)
            infos["_final_obs"] = infos["_final_info"] = self._ended.copy()
            flat = self.core.reset((), self._ended.tolist())
            stepped = ~self._ended
        infos |= self._infos(times, reasons, ends[0], stepped)
        infos |= self._instructions(np.ones(self.num_envs, dtype=bool))
        return self._observation(flat), rewards, *ends, infos

    def row(self) -> dict[str, NDArray[Any]]:
        """Returns the present state of all copies by the names of columns in datasets.

        Arrays have the copies as the first axis; see ``Env.row``.
        """
        return self.core.row()

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Returns a picture (H, W, 3) uint8 of each copy's present state; None in other modes."""
        if self.render_mode is None:
            return None
        width, height = self._size
        return tuple(self.core.render(self._camera, width, height))

    def close_extras(self, **kwargs: Any) -> None:
        """Closes all copies."""
        if hasattr(self, "core"):  # not when it could not be made
            self.core.close()

    def _which(self, given: Mapping[str, Any]) -> NDArray[np.bool_]:
        if RESET_OPTION not in given:
            return np.ones(self.num_envs, dtype=bool)
        which = np.asarray(given[RESET_OPTION])
        if which.dtype != np.bool_ or which.shape != (self.num_envs,):
            raise ArgumentError(
                f"{RESET_OPTION} must be {self.num_envs} bools, one for each copy; got "
                f"{which.dtype} of shape {which.shape}"
            )
        return which.copy()

    def _seeds(
        self, seed: int | Sequence[int | None] | None, which: NDArray[np.bool_]
    ) -> list[int | None]:
        if seed is None:
            seeds: list[int | None] = [None] * self.num_envs
        elif isinstance(seed, int | np.integer):
            first = _seed(seed)
            super().reset(seed=first)
            seeds = [first + i for i in range(self.num_envs)]
        else:
            seeds = [None if s is None else _seed(s) for s in seed]
        if len(seeds) == self.num_envs:
            for i in np.flatnonzero(which & ~self._seeded):
                if seeds[i] is None:
                    seeds[i] = int(self.np_random.integers(2**63))
        return seeds

    def _flat(self, actions: Any) -> NDArray[np.float64]:
        """Returns the actions as a matrix with a row for each copy."""
        for path, keys in self._action_keys:
            self._check_keys(_at(actions, path), path, keys)
        return np.concatenate([self._rows(actions, part) for part in self._action_parts], axis=1)

    def _check_keys(self, given: Any, path: tuple[str, ...], keys: list[str]) -> None:
        name = ".".join(("action", *path))
        if not isinstance(given, Mapping):
            flat = "" if path else ". With flat=True actions are a matrix, a row for each copy"
            raise ArgumentError(
                f"environment '{self._name}': {name} must be a dict, got {type(given).__name__}; "
                f"it takes {', '.join(keys)}{flat}"
            )
        wrong = [f"no '{key}'" for key in given if key not in keys]
        wrong += [f"'{key}' is missing" for key in keys if key not in given]
        if wrong:
            raise ArgumentError(
                f"environment '{self._name}': {name}: {', '.join(wrong)}; it takes "
                f"{', '.join(keys)}"
            )

    def _rows(self, actions: Action, part: Part) -> NDArray[np.float64]:
        path, _, size = part
        shape = (self.num_envs, size)
        try:
            rows = np.asarray(_at(actions, path), dtype=np.float64)
        except (TypeError, ValueError) as error:
            rows, problem = np.empty(0), f"no array: {error}"
        else:
            problem = f"of shape {rows.shape}"
        if size == 1 and rows.shape == shape[:1]:
            return rows[:, None]
        if rows.shape != shape:
            raise ArgumentError(
                f"environment '{self._name}': {'.'.join(('action', *path))} must have a row of "
                f"{counted(size, 'number')} for each copy ({self.num_envs}), it is {problem}"
            )
        return rows

    def _observation(self, flat: NDArray[np.float64]) -> Any:
        """Returns the numbers of all copies, and their last frames."""
        out = _split(self._observation_parts, self._observation_shapes, flat)
        if frames := self.core.frames:
            out["frames"] = frames
        return out

    def _objects(self, observation: Any, which: NDArray[np.bool_]) -> NDArray[Any]:
        out = np.full(self.num_envs, None, dtype=object)
        for i in np.flatnonzero(which):
            out[i] = _of_copy(observation, int(i))
        return out

    def _infos(
        self,
        times: NDArray[np.float64],
        reasons: list[str],
        success: NDArray[np.bool_],
        which: NDArray[np.bool_],
    ) -> dict[str, Any]:
        """Returns the infos of the copies for which ``which`` is true; others have no values."""
        infos: dict[str, Any] = {
            "time": times,
            "reason": _texts(reasons, which),
        }
        if self._has_task:
            infos["is_success"] = success
            infos["progress"] = self.core.progress
            infos["subtask"] = self.core.subtasks
        infos["robots"] = self.core.motions
        return _masked(infos, which)

    def _instructions(self, which: NDArray[np.bool_]) -> dict[str, Any]:
        if not self._has_task:
            return {}
        return {
            "instruction": _texts(self.core.instructions, which),
            "_instruction": which.copy(),
        }


def _masked(infos: dict[str, Any], which: NDArray[np.bool_]) -> dict[str, Any]:
    """Infos with the mask of each, at every level, as Gymnasium has them; zeros for the others."""
    out: dict[str, Any] = {}
    for key, value in infos.items():
        if isinstance(value, dict):
            out[key] = _masked(value, which)
        elif value.dtype == object:
            out[key] = value
        else:
            out[key] = np.where(which, value, np.zeros_like(value))
        out[f"_{key}"] = which.copy()
    return out


def _of_copy(value: Any, i: int) -> Any:
    """Returns copy i's part of dictionaries of arrays that have the copies in front."""
    if isinstance(value, dict):
        return {key: _of_copy(item, i) for key, item in value.items()}
    return value[i].copy()


def _texts(texts: Sequence[str], which: NDArray[np.bool_]) -> NDArray[Any]:
    """Returns the texts; None for the copies for which ``which`` is false."""
    shown = [text if keep else None for text, keep in zip(texts, which, strict=True)]
    return np.array(shown, dtype=object)


def _autoreset_mode(given: AutoresetMode | str) -> AutoresetMode:
    try:
        return AutoresetMode(given)
    except ValueError:
        pass
    known = ", ".join(f"'{mode.value}'" for mode in AutoresetMode)
    raise ArgumentError(
        f"autoreset_mode must be {known}, or an AutoresetMode of Gymnasium's, got {given!r}"
    )


def _seed(seed: Any) -> int:
    number = operator.index(seed)
    if number < 0:
        raise ArgumentError(f"seed must be 0 or more, got {number}")
    return number


def _at(tree: Any, path: tuple[str, ...]) -> Any:
    for key in path:
        tree = tree[key]
    return tree


def _keys_of(parts: Sequence[Part]) -> Iterator[tuple[tuple[str, ...], list[str]]]:
    """Returns the keys of nested dictionaries, outermost first."""
    keys: dict[tuple[str, ...], dict[str, None]] = {}
    for path, _, _ in parts:
        for depth, key in enumerate(path):
            keys.setdefault(path[:depth], {})[key] = None
    return ((path, list(keys[path])) for path in sorted(keys, key=len))


def _split(
    parts: Sequence[Part], shapes: Sequence[tuple[int, ...]], flat: NDArray[np.float64]
) -> Observation:
    """Splits a vector, or rows of vectors, into dictionaries of separate arrays."""
    out: Observation = {}
    for (path, begin, size), shape in zip(parts, shapes, strict=True):
        at = out
        for key in path[:-1]:
            at = at.setdefault(key, {})
        at[path[-1]] = flat[..., begin : begin + size].copy().reshape(flat.shape[:-1] + shape)
    return out
