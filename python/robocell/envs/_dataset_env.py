"""Environments from datasets: the cell that a dataset was made in, with its schema.

A policy trained on the columns of the dataset acts here without any mapping. With `flat=True`
observations and actions are vectors in the order of the chosen names, as in
`robocell.data.rows(dataset, names)`.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from robocell._extras import needed_by

with needed_by("robocell.envs", "envs", "Without it: robocell.envs.RunEnv"):
    import gymnasium
    from gymnasium import spaces

import numpy as np
from numpy.typing import NDArray

from robocell._core import (
    ArgumentError,
    CameraSystemConfig,
    Dataset,
    Env,
    Feature,
    NotFoundError,
    RunConfig,
    RunEnv,
    make_plan,
)
from robocell._dataset_run import plan_numbers, require_cell, run_of_dataset
from robocell._generation.run_source import import_named
from robocell._placeholders import OF_THE_TCP, RELATIVE
from robocell._suggestions import did_you_mean, fitting, shortened
from robocell.data._recorder import cell_of_a_run
from robocell.envs._protocols import CellEnv
from robocell.envs._recorded_env import OWN, RecordedEnv, is_recorded

__all__ = ["DatasetEnv", "from_dataset"]

# Number of episodes whose features are compared: features that all of them have are observed.
LOOKED_AT = 50
# Share by which a step may last longer or shorter than a row: whole engine steps.
RATE_SLACK = 0.02
TURNS = 2 * np.pi  # range of hinges without limits, as in `Env`


def from_dataset(
    dataset: str | Path | Dataset,
    observations: Sequence[str] | None = None,
    actions: Sequence[str] | None = None,
    *,
    privileged: bool = False,
    cameras: bool = True,
    flat: bool = False,
    imports: Sequence[str] = (),
    env: Env | None = None,
) -> DatasetEnv:
    """Makes the environment of a dataset: its cell, task, rates, cameras and schema.

    With `env`, an environment of your own acts and observes by the schema of the dataset.

    Args:
        dataset: A dataset, or its folder.
        observations: Names of columns and image streams to observe; "*" stands for any part of a
            name, as in `robocell.data.rows`. Default: all columns that every episode has and that
            exist outside simulation too, and all streams; for a recorded environment, its
            observations (`observation/...`).
        actions: Names of the action columns that each step takes, all of them. A group without one
            keeps its target. Default: the absolute target of each group (`robots/...`); for a
            recorded environment, its own actions (`action/...`). Both kinds act in it.
        privileged: True adds columns that only simulation has, such as poses of objects, to the
            default.
        cameras: False renders no images.
        flat: True makes observations and actions vectors of float64: columns one after another, in
            the order of the names, without images.
        imports: Modules to import first, which register the task or features. A dataset never
            imports modules by itself.
        env: An environment that has the robots and the objects of the task under the names that the
            dataset uses. Its own task judges, and start i is that of seed i.

    Raises:
        ArgumentError: `dataset` is a file, was imported or was written row by row; a list of
            columns is empty; two of `actions` move one group, or are of two kinds; or `env` has
            `home_on_reset: false`: its starts depend on the episodes before.
        NotFoundError: The dataset has no such name (the message has the nearest), or the task is
            not registered.
        SpecError: The task's code differs from the code that made the dataset, or a module of that
            code is not imported.

    The first reset raises ArgumentError or NotFoundError with the first difference if the cell has
    other features than the dataset.

    Examples:
        >>> recorded = rc.envs.from_dataset("experiment_output/demo")
        >>> observation, info = recorded.reset(seed=0)
    """
    if not isinstance(dataset, Dataset) and Path(dataset).is_file():
        raise ArgumentError(f"'{dataset}' is a file; name the folder of a dataset")
    for name, columns in (("observations", observations), ("actions", actions)):
        if columns is not None and len(columns) == 0:
            raise ArgumentError(f"`{name}` is empty; leave it out for the default columns")
    if env is not None and not isinstance(env, Env):
        raise ArgumentError(
            f"from_dataset: `env` is an environment, rc.Env(EnvConfig.load(FILE)), got {env!r}"
        )
    opened = dataset if isinstance(dataset, Dataset) else Dataset(Path(dataset))
    require_cell(opened.folder)
    named = [imports] if isinstance(imports, str) else imports
    modules = [import_named(module, Path.cwd()) for module in named]
    shared = _shared_features(opened)
    images = cameras and not flat
    core = _core_of(opened, images, modules) if env is None else _core_of_own(opened, env)
    streams = _image_names(opened, core) if images else []
    own = is_recorded(opened)
    if observations is None:
        observations = [*_default_observations(own, shared, privileged), *streams]
    if actions is None:
        actions = _default_actions(own, shared)
    seen = _names_of("observation", observations, opened, shared, streams)
    done = _names_of("action", actions, opened, shared, streams)
    _require_one_action(done, shared, f"dataset '{opened.folder}'")
    return DatasetEnv(core, shared, seen, done, flat)


def _image_names(dataset: Dataset, core: CellEnv) -> list[str]:
    """Returns the recorded images that the cell draws: "wrist", "wrist.depth"."""
    cameras = core.cameras
    drawn = {stream.name for stream in cameras.streams} if cameras.draw else set()
    return [name for name in dataset[0].streams if name.partition(".")[0] in drawn]


class _RunCell(RunEnv):
    """The cell of a run, whose first starts are those of the episodes of a dataset."""

    def __init__(self, run: RunConfig, dataset: Dataset) -> None:
        super().__init__(run)
        self._dataset = dataset
        self._scenes = [item.scene for item in make_plan(run)]  # one of each: it names no number
        self._ids: dict[tuple[int, int], str] = {}
        for id in dataset.ids:
            for numbers in plan_numbers([id]):
                self._ids.setdefault(numbers, id)

    def reset(self, index: int, attempt: int | None = None) -> None:
        """Resets to start `index`; by default that of the item's recorded episode, if any."""
        super().reset(index, self._recorded_attempt(index) if attempt is None else attempt)

    def _recorded_attempt(self, index: int) -> int:
        episode, place = divmod(index, len(self._scenes))
        id = self._ids.get((self._scenes[place], episode))
        if id is None:
            return 0
        metadata: Any = self._dataset[id].metadata
        return int(metadata.get("attempt", 0))

    @property
    def cameras(self) -> CameraSystemConfig:
        return self.run.cameras


def _core_of(dataset: Dataset, images: bool, modules: Sequence[str]) -> _RunCell | RecordedEnv:
    if is_recorded(dataset):
        return RecordedEnv(dataset, images)
    run = run_of_dataset(dataset.folder, modules)
    if not images:
        run.cameras.draw = False  # the streams still belong to the start
    return _RunCell(run, dataset)


def _core_of_own(dataset: Dataset, env: Env) -> RecordedEnv:
    """Returns the caller's environment; warns if its steps last longer or shorter than rows."""
    metadata: Any = dataset[0].metadata
    row_ms, sim = metadata["rates"].get("policy_ms"), env.config.sim
    step_ms = 1000 / sim.frequency if sim.async_control else None
    if row_ms is not None and (step_ms is None or abs(step_ms / row_ms - 1) > RATE_SLACK):
        took = "until the arms have arrived" if step_ms is None else f"{step_ms:.4g} ms"
        # A decimal number would be a little off, and each step then one engine step too long.
        hz = Fraction(1000 / row_ms).limit_denominator(1000)
        warnings.warn(
            f"environment '{env.config.name}': its steps last {took}, and a row of "
            f"'{dataset.folder}' {row_ms:.4g} ms; set `sim: {{async_control: true, frequency: "
            f"{hz}}}`",
            stacklevel=3,
        )
    return RecordedEnv(dataset, True, env)


def _default_observations(
    own: bool, features: Mapping[str, Feature], privileged: bool
) -> list[str]:
    roles = ("observation", "privileged") if privileged else ("observation",)
    names = [name for name, feature in features.items() if feature.role in roles]
    if own:  # what the policy of the environment saw, not all that there is
        return [name for name in names if name.startswith("observation/")]
    return names


def _default_actions(own: bool, features: Mapping[str, Feature]) -> list[str]:
    names = _names(features, "action")
    if own and (recorded := [name for name in names if name.startswith(OWN)]):
        return recorded
    return [name for name in names if f"{name}_relative" in features]


CHOOSE = (
    "Choose other `observations` and `actions`, an `env` that has these features, or a dataset of "
    "this cell"
)

# These sentences say how a user names a robot or an object of an environment.
_NAMING = {
    "robots": "name the robot so in `robots` of the environment's configuration",
    "objects": "name it so in `root_frame_objects` and in `task.object`; objects that a task draws "
    "are observed as 'target' and 'goal'",
}


def _why_missing(name: str, known: Sequence[str]) -> str:
    """Returns what a feature of the dataset has that the cell has not, and the next step."""
    text = f"feature '{name}' is in the dataset and not in the cell here"
    for part, naming in _NAMING.items():
        element = re.compile(rf"(?:^|/){part}/([^/]+)/")
        wanted = element.search(name)
        here = {found[1] for each in known if (found := element.search(each))}
        if wanted and wanted[1] not in here:
            there = ", ".join(map(repr, sorted(here))) or "none"
            return f"{text}, whose {part} are: {there}. For '{wanted[1]}' {naming}"
    near = did_you_mean(name, known)
    return f"{text}{f'.{near}' if near else f': {shortened(known)}.'} {CHOOSE}"


class DatasetEnv(gymnasium.Env[Any, Any]):
    """An environment made by `from_dataset`; `core` is the `CellEnv` that it steps.

    `reset(seed=i)` goes to start i of the dataset's run, and later resets continue from there.
    Start i is that of item i of the run's plan: the first starts are those of the dataset's
    episodes again, those after failed rollouts included. Numbers beyond the plan are new starts, as
    are items without an episode: the first one that the sampler accepts. In a dataset of
    `EnvRecorder`, and in an environment of your own, start i is that of seed i. The spaces have the
    ranges of the dataset's schema; actions of hinges without limits have +-2 pi, as in `Env`.
    """

    metadata = {"render_modes": []}  # noqa: RUF012  (as in Gymnasium)

    def __init__(
        self,
        core: CellEnv,
        features: Mapping[str, Feature],
        observations: list[str],
        actions: list[str],
        flat: bool = False,
    ) -> None:
        self.core = core
        self.features = dict(features)
        self.observations, self.actions = observations, actions
        self._flat = flat
        self._start = -1
        self._checked = False
        seen = {name: self._space(name) for name in observations}
        done = {name: self._action_space(name) for name in actions}
        self._ranges = {
            name: space
            for name, space in seen.items()
            if name in self.features and self.features[name].lower
        }
        self.observation_space = _flattened(seen) if flat else spaces.Dict({**seen})
        self.action_space = _flattened(done) if flat else spaces.Dict({**done})

    def _space(self, name: str) -> spaces.Box:
        feature = self.features.get(name)
        if feature is not None:
            shape = feature.shape
            if not feature.lower:
                return spaces.Box(-np.inf, np.inf, shape, np.float64)
            lower, upper = (np.reshape(b, shape) for b in (feature.lower, feature.upper))
            return spaces.Box(lower, upper, shape, np.float64)
        stream, _, kind = name.partition(".")
        cameras = self.core.cameras
        (config,) = [s for s in cameras.streams if s.name == stream]
        width, height = (int(size) for size in cameras.resolution)
        shape = (config.height or height, config.width or width)
        if kind:
            return spaces.Box(0, 65535, shape, np.uint16)
        return spaces.Box(0, 255, (*shape, 3), np.uint8)

    def _action_space(self, name: str) -> spaces.Box:
        """Returns the range of an action: that of `Env` where hinges have no limits."""
        space = self._space(name)
        units = self.features[name].units.split(", ")  # one for all numbers, or one for each
        size = int(np.prod(space.shape))
        if len(units) not in (1, size):
            return space  # of the parts of a pose
        is_angle = np.broadcast_to(np.array([unit == "rad" for unit in units]), (size,))
        unlimited = ~(np.isfinite(space.low) & np.isfinite(space.high))
        turning = unlimited & is_angle.reshape(space.shape)
        lower = np.where(turning, -TURNS, space.low)
        upper = np.where(turning, TURNS, space.high)
        return spaces.Box(lower, upper, space.shape, np.float64)

    @property
    def recordable(self) -> Env:
        """The environment that `EnvRecorder` records; ArgumentError for the cell of a run."""
        env = getattr(self.core, "env", None)
        if isinstance(env, Env):
            return env
        raise ArgumentError(cell_of_a_run(type(self).__name__))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Resets to start number `seed`, or to the one after the last."""
        super().reset(seed=seed)
        if options:
            raise ArgumentError(f"reset takes no options here, got {', '.join(options)}")
        self._start = self._start + 1 if seed is None else int(seed)
        self.core.reset(self._start)
        if not self._checked:
            self._check_schema()
        info = {
            "start": self._start,
            "instruction": self.core.instruction,
            "object_kinds": self.core.object_kinds,
        }
        return self._observe(), info

    def _check_schema(self) -> None:
        """Checks that the chosen features are those of the dataset."""
        here = {f.name: f for f in [*self.core.observed, *self.core.commanded]}
        for name in [*self.observations, *self.actions]:
            recorded = self.features.get(name)
            if recorded is None:
                continue
            if name not in here:
                raise NotFoundError(_why_missing(name, sorted(here)))
            if difference := recorded.difference_from(here[name]):
                raise ArgumentError(f"{difference}: the dataset is of another cell. {CHOOSE}")
        self._checked = True

    def _observe(self) -> Any:
        row = self.core.row()
        missing = [name for name in self.observations if name not in row]
        if missing:
            raise NotFoundError(
                f"start {self._start} has no {', '.join(map(repr, missing))}: its objects are not "
                "those of the dataset's episodes. Choose `observations` that every start has"
            )
        for name, space in self._ranges.items():  # rows have numbers beyond it too
            row[name] = np.asarray(np.clip(row[name], space.low, space.high))
        if not self._flat:
            return {name: row[name] for name in self.observations}
        return np.concatenate([np.ravel(row[name]) for name in self.observations])

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Makes one step, a row of a dataset; `info["is_success"]` is True if the task is done."""
        if self._flat:
            action = self._split(np.asarray(action, dtype=np.float64))
        elif not isinstance(action, Mapping):
            raise ArgumentError(
                f"an action here is a dictionary of {', '.join(map(repr, self.actions))}, got "
                f"{type(action).__name__}; from_dataset(..., flat=True) takes one vector"
            )
        else:
            self._require_all(action)
        reward, terminated, truncated, info = self.core.act(dict(action))
        return self._observe(), reward, terminated, truncated, info

    def _require_all(self, action: Mapping[str, Any]) -> None:
        """Raises ArgumentError for a column that is missing, or that was not chosen."""
        missing = [name for name in self.actions if name not in action]
        more = [str(name) for name in action if name not in self.actions]
        if not missing and not more:
            return
        problems = [f"no {', '.join(map(repr, missing))}"] if missing else []
        problems += [f"{', '.join(map(repr, more))}, which is not among them"] if more else []
        raise ArgumentError(
            f"an action here has the columns {', '.join(map(repr, self.actions))}; got one with "
            f"{' and '.join(problems)}.{did_you_mean(more[0], missing) if more else ''} "
            "from_dataset(..., actions=[...]) chooses others; a group without one keeps its target"
        )

    def _split(self, action: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        sizes = [int(np.prod(self.features[name].shape)) for name in self.actions]
        if action.shape != (sum(sizes),):
            raise ArgumentError(f"an action has {sum(sizes)} numbers, got the shape {action.shape}")
        parts = np.split(action, np.cumsum(sizes)[:-1])
        return dict(zip(self.actions, parts, strict=True))


def _require_one_action(
    actions: Sequence[str], features: Mapping[str, Feature], place: str
) -> None:
    """Raises ArgumentError for actions that no step can take together."""
    own = [name for name in actions if name.startswith(OWN)]
    every = [name for name in _names(features, "action") if name.startswith(OWN)]
    if own and (others := [name for name in actions if name not in own]):
        raise ArgumentError(
            f"{place}: actions '{own[0]}' and '{others[0]}' are of two kinds: those of the "
            "environment (action/...) and those of its cell (robots/...); choose actions of one "
            "kind"
        )
    if own and (missing := [name for name in every if name not in own]):
        raise ArgumentError(
            f"{place}: the environment takes whole actions, and these lack "
            f"{', '.join(map(repr, missing))}. Choose all of action/..., or some of robots/..."
        )
    moved: dict[tuple[str, str], str] = {}
    for name, group in _moved_groups(features).items():
        if name in actions and (first := moved.setdefault(group, name)) != name:
            raise ArgumentError(
                f"{place}: actions '{first}' and '{name}' both move group '{group[1]}' of robot "
                f"'{group[0]}'; choose one of them"
            )


def _moved_groups(features: Mapping[str, Feature]) -> dict[str, tuple[str, str]]:
    """Returns the robot and group that each action of a cell moves.

    The schema lists the actions of a TCP after those of the arm that moves it.
    """
    groups: dict[str, tuple[str, str]] = {}
    robot, group = "", ""
    for name in _names(features, "action"):
        parts = name.split("/")
        if len(parts) != 4 or parts[0] != "robots":
            continue
        if parts[1] != robot or parts[3] not in OF_THE_TCP:
            robot, group = parts[1], parts[3].removesuffix(RELATIVE)
        groups[name] = (robot, group)
    return groups


def _flattened(parts: Mapping[str, spaces.Box]) -> spaces.Box:
    low = np.concatenate([np.ravel(part.low) for part in parts.values()])
    high = np.concatenate([np.ravel(part.high) for part in parts.values()])
    return spaces.Box(low, high, dtype=np.float64)


def _names(features: Mapping[str, Feature], role: str) -> list[str]:
    return [name for name, feature in features.items() if feature.role == role]


def _shared_features(dataset: Dataset) -> dict[str, Feature]:
    """Returns the features that all inspected episodes have, in the first one's order."""
    count = len(dataset)
    if not count:
        raise ArgumentError(
            f"'{dataset.folder}' has no episode, so its cell is unknown. Name a dataset with some"
        )
    step = max(1, count // LOOKED_AT)
    shared: dict[str, Feature] | None = None
    for index in range(0, count, step):
        features = {feature.name: feature for feature in dataset[index].features}
        shared = features if shared is None else {n: f for n, f in shared.items() if n in features}
    if not shared:
        raise ArgumentError(
            f"'{dataset.folder}' has no schema of its features: it was made by an older robocell; "
            "make a new dataset"
        )
    return shared


def _names_of(
    kind: str,
    names: Sequence[str],
    dataset: Dataset,
    features: Mapping[str, Feature],
    streams: list[str],
) -> list[str]:
    """Returns chosen names, which all have to be there; patterns become the names that fit."""
    if isinstance(names, str):
        raise ArgumentError(f"from_dataset: `{kind}s` is a list of names, got {names!r}")
    wanted = ("action",) if kind == "action" else ("observation", "privileged")
    known = [name for name, feature in features.items() if feature.role in wanted]
    known += streams if kind == "observation" else []
    place = f"dataset '{dataset.folder}'"
    chosen = fitting(place, names, known)
    for name in chosen:
        if name not in known and kind == "observation" and name in dataset[0].streams:
            raise ArgumentError(
                f"{place}: '{name}' is an image, and this environment draws none; leave out "
                "flat=True and cameras=False"
            )
        if name not in known:
            other = f" It has the role '{features[name].role}'." if name in features else ""
            raise NotFoundError(
                f"{place}: no {kind} '{name}' in all of its episodes."
                f"{other or did_you_mean(name, known)} There are: {', '.join(known)}"
            )
    return chosen
