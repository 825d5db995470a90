"""Policies: a policy trained on a dataset acts in the cells of that dataset.

    class Mine(Policy):
        def act(self, observation):
            q = self.network(observation["robots/rc7/arm/qpos"], observation["objects/target/pose"])
            return {"robots/rc7/action/arm": q}  # (n,): one action, (k, n): a chunk of k

Observations and actions have the names of a dataset's columns, so that nothing has to be mapped:
an observation is the row of state that the dataset records before each action, and its image
streams; an action is one or more of the columns `robots/<robot>/action/...`.
"""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robocell._arguments import with_hints
from robocell._core import (
    ArgumentError,
    CellFeatures,
    Dataset,
    Episode,
    EpisodeStart,
    Expert,
    Feature,
    GroupCommand,
    NotFoundError,
    Rng,
    RunConfig,
    Scene,
    SpecError,
)
from robocell._own_code import RAISED, calling_module, paths_of, raise_interrupt
from robocell._raised import LostPolicyError, UnmadePolicyError, text_of_hook
from robocell._registering import (
    arguments_of,
    require_hooks,
    require_name,
    require_takes,
    takes,
)
from robocell._rows import Row
from robocell._suggestions import counted, did_you_mean, shortened
from robocell.action_chunks import Chunks
from robocell.dataset_run import naming_what_to_evaluate, seed_of_dataset
from robocell.policy_calls import present
from robocell.policy_options import PolicyOptions, is_url
from robocell.tasks import expert_registration

Observation = dict[str, NDArray[Any]]
_AS_IT_IS = PolicyOptions()
Action = Mapping[str, ArrayLike]


@dataclass(frozen=True)
class Context:
    """Context of a rollout for a policy.

    Attributes:
        instruction: The task, in words.
        run: The cell's configuration.
        seed: Seed for policies that draw random numbers; it follows from run, episode and attempt.
        features: Features that the policy observes and may command, with unit, frame, names, range.
    """

    instruction: str
    run: RunConfig
    seed: int
    features: list[Feature]


class Policy:
    """Acts from observations alone. Subclasses define `act`, and `reset` if they have state.

    Attributes:
        files: Files or folders that the policy uses beside its code, such as weights, relative to
            the module. Their content is part of an evaluation: with other files it does not
            continue in the same folder.

    Examples:
        >>> class Wait(rc.policy.Policy):
        ...     def act(self, observation):
        ...         return {}
    """

    files: ClassVar[str | Path | Sequence[str | Path]] = ()

    def reset(self, context: Context) -> None:
        """Clears the state of the last rollout."""

    def act(self, observation: Observation) -> Action:
        """Returns the next action, or a chunk of actions.

        Args:
            observation: The row that a dataset records of the present state:
                `time`, `robots/<robot>/<group>/qpos`, `/qvel` and `/target` (rad, m),
                `base_pose`, `tcp_pose`, `tcp_pose_in_base` (xyz in metres, quaternion xyzw),
                `opening`, `objects/<object>/pose`, sensors, registered features; an image
                (height, width, 3) for each stream, and `<stream>.depth` (uint16, mm) and
                `<stream>.segmentation` if the cell has them. Images are drawn when one of them is
                first read; read them before `act` returns.

        Returns:
            Columns `robots/<robot>/action/...` of a dataset, one for each group that moves:
            `<group>`, absolute joint positions or an opening; `<group>_relative`, added to the
            present targets; `tcp_pose`, the TCP in the robot's base frame; `tcp_displacement`, from
            the present TCP. An array with one more dimension is a chunk: its actions are taken one
            after the other before `act` is called again.
        """
        raise NotImplementedError


class PolicyExpert(Expert):
    """Lets a policy act in rollouts. The policy gets what a dataset records, not the simulation.

    Errors of the policy, and errors about its return values, are raised. `chunks` decides how many
    actions of a chunk are taken before the policy is called again.
    """

    def __init__(
        self,
        run: RunConfig,
        start: EpisodeStart,
        policy: Policy,
        chunks: Chunks | None = None,
    ) -> None:
        super().__init__()
        self.policy = policy
        self._run, self._task = run, start.task
        self._code_of = policy  # messages about act() say where the policy's is written
        self._chunks = chunks or Chunks()
        self._row: Observation = {}

    def begin(self, scene: Scene, rng: Rng) -> None:
        """Resets the policy."""
        self._features = CellFeatures(scene, self._task, list(self._run.features))
        self._sizes = {
            feature.name: (feature.shape or (1,))[0] for feature in self._features.commanded
        }
        self._chunks.clear()
        present.begin()
        self.policy.reset(
            Context(
                instruction=self._task.instruction(),
                run=self._run,
                seed=rng.integer(2**31),
                features=[*self._features.observed, *self._features.commanded],
            )
        )

    def see(self, row: Observation) -> None:
        """Stores the row that a dataset records of this state, with its images."""
        cameras = self._run.cameras
        if isinstance(row, Row):
            row.said_as = f"{type(self.policy).__name__}.act(): the observation"
            if not (cameras.draw and cameras.streams):
                row.without_images = (
                    " The rollouts draw no images: leave out --no-cameras for those of a stream."
                )
        self._row = row

    def act(self, scene: Scene, rng: Rng) -> dict[str, dict[str, GroupCommand]]:
        """Returns the next action of the policy's chunk, or of a new chunk."""
        if self._chunks.need_call():
            began = time.perf_counter()
            action = self.policy.act(self._row)
            elapsed_ms = 1e3 * (time.perf_counter() - began)
            actions = self._actions(action)
            timing = getattr(self.policy, "timing", {})
            present.add(self._chunks.step, len(actions), elapsed_ms, timing)
            self._chunks.add(actions)
        return self._features.to_action(dict(self._chunks.next()))

    def _actions(self, action: Action) -> list[dict[str, NDArray[np.float64]]]:
        """Splits a chunk into single actions."""
        who = f"{type(self.policy).__name__}.act()"
        if not isinstance(action, Mapping) or not action:
            raise TypeError(
                f"{who} must return a dict of columns 'robots/.../action/...' to numbers, "
                f"got {action!r}"
            )
        if odd := [name for name in action if not isinstance(name, str)]:
            raise TypeError(f"{who}: the names of actions are texts, got {odd[0]!r}")
        arrays = {name: _real(who, name, values) for name, values in action.items()}
        lengths: dict[str, int] = {}
        for name, array in arrays.items():
            size = self._size(name)
            if array.shape == () and size == 1:
                array = arrays[name] = array.reshape(1)
            if array.ndim not in (1, 2) or array.shape[-1] != size or not array.size:
                raise ArgumentError(
                    f"{who}: '{name}' has {counted(size, 'number')}, or (k, {size}) for a chunk; "
                    f"got the shape {array.shape}"
                )
            if not np.isfinite(array).all():
                bad = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
                raise ArgumentError(
                    f"{who}: '{name}' is not finite: entry [{', '.join(map(str, bad))}] is "
                    f"{array[bad]}"
                )
            lengths[name] = array.shape[0] if array.ndim == 2 else 0
        if set(lengths.values()) == {0, 1}:  # a chunk of one beside single actions is one, too
            arrays = {name: np.reshape(array, -1) for name, array in arrays.items()}
            lengths = dict.fromkeys(lengths, 0)
        if len(set(lengths.values())) > 1:
            found = ", ".join(f"'{name}' {length or 1}" for name, length in lengths.items())
            raise ArgumentError(f"{who}: columns of one chunk differ in length: {found}")
        length = next(iter(lengths.values()))
        if length == 0:
            return [arrays]
        return [{name: array[i] for name, array in arrays.items()} for i in range(length)]

    def _size(self, name: str) -> int:
        if name not in self._sizes:
            raise NotFoundError(
                f"{type(self.policy).__name__}.act(): no action '{name}'."
                f"{did_you_mean(name, self._sizes)} The actions of this cell: "
                f"{', '.join(self._sizes)}"
            )
        return self._sizes[name]

    def done(self) -> bool:
        """Returns False: the rollout ends at success or when its steps are used up."""
        return False

    def ends_at_success(self) -> bool:
        """Returns True: a policy does not know when it is done."""
        return True

    def failure(self) -> str:
        """Returns "": the task decides the result."""
        return ""

    def phase(self) -> int:
        """Returns 0, the only phase."""
        return 0

    def phase_names(self) -> list[str]:
        """Returns no names."""
        return []


def _real(who: str, name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Returns real numbers.

    NumPy would convert texts and times to numbers, and drop masks and the imaginary part of complex
    numbers.
    """
    array = np.asanyarray(values)
    kind = ""
    if np.iscomplexobj(array):
        kind = f"complex ones: {array.dtype}"
    elif array.dtype.kind not in "biufO":
        kind = f"{_KINDS.get(array.dtype.kind, 'other values')}: {array.dtype}"
    elif array.dtype.kind == "O" and (odd := [v for v in array.flat if isinstance(v, str | bytes)]):
        kind = f"texts: {odd[0]!r}"
    elif np.ma.is_masked(array):
        kind = "a masked array: fill its masked entries"
    if kind:
        raise TypeError(f"{who}: '{name}' must be real numbers, got {kind}")
    return np.array(array, dtype=np.float64)  # a copy: policies may write to theirs again


_KINDS = {"U": "texts", "S": "texts", "M": "times", "m": "times", "V": "records"}


@with_hints
def register_policy(
    name: str,
    make: Callable[[RunConfig], Policy],
    files: str | Path | Sequence[str | Path] = (),
    *,
    horizon: int | None = None,
    ensemble: bool = False,
) -> None:
    """Registers a policy as a kind of expert, for the `expert` of a run.

    `make(run)` makes it once in each process; it is reset for each rollout. An error of the policy
    counts like one of any expert: in an evaluation it ends the rollout as a failure. After an error
    of `make`, each rollout raises Error.

    Args:
        name: Name of the kind.
        make: Makes the policy.
        files: Files that it uses beside its code, such as weights.
        horizon: Actions of a chunk that are taken before the policy is called again. Default: all.
        ensemble: Call the policy after every `horizon` actions, by default after each one, and take
            the mean of what all chunks say about the moment (temporal ensembling).
    """
    registering = calling_module()
    require_name("register_policy", name, "name")
    call = f"register_policy({name!r})"
    Chunks(horizon, ensemble)
    if not callable(make):
        raise TypeError(f"{call}: expected a function (run) -> Policy, got {make!r}")
    require_takes(call, make, ["run"])
    if inspect.isclass(make):
        _require_policy(call, make)
    made: list[Policy] = []
    errors: list[BaseException] = []

    def expert(run: RunConfig, start: EpisodeStart) -> Expert:
        if not made and not errors:
            try:
                policy = make(run)
                _require_policy(call, policy)
                made.append(policy)
            except RAISED as error:
                raise_interrupt(error)
                errors.append(error)
        if errors and isinstance(errors[0], LostPolicyError):
            raise errors[0]
        if errors:
            said = f"policy '{name}' cannot be made: {text_of_hook(errors[0])}"
            raise UnmadePolicyError(said) from errors[0]
        return PolicyExpert(run, start, made[0], Chunks(horizon, ensemble))

    module = getattr(make, "__module__", None)
    expert.__module__ = module or __name__
    expert_registration(name, files, registering)(expert)


def register_named_policy(name: str, folder: Path, acting: PolicyOptions = _AS_IT_IS) -> str:
    """Registers `module:Class`, `file.py:Class` or `file.py:function`, and returns its kind."""
    make, files = maker_of_policy(name, folder)
    kind = f"{name}{acting.suffix}"
    register_policy(kind, make, files, horizon=acting.horizon, ensemble=acting.ensemble)
    return kind


def maker_of_policy(name: str, folder: Path) -> tuple[Callable[[RunConfig], Policy], list[Path]]:
    """Returns the maker of `module:Class`, `file.py:Class` or `file.py:function`, and its files.

    The policy is made as `Class(run)` if the class requires an argument or calls its first one
    `run`, else as `Class()`. Raises SpecError for anything that is no policy.
    """
    from robocell.generate.run_source import import_module

    module_name, _, attribute = name.rpartition(":")
    module = import_module(module_name, folder)
    maker = getattr(module, attribute, None)
    if not callable(maker):
        raise SpecError(
            f"policy '{name}': module '{module_name}' has no class or function '{attribute}'."
            f"{did_you_mean(attribute, _policies_of(module))}"
        )
    if takes(maker, 0) is False and takes(maker, 1) is False:
        raise SpecError(
            f"policy '{name}': it is made as {attribute}() or {attribute}(run), which does not fit "
            f"its arguments {arguments_of(maker)}"
        )

    if inspect.isclass(maker):
        _require_policy(f"policy '{name}'", maker)

    def make(run: RunConfig) -> Policy:
        return maker(run) if _takes_run(maker) else maker()

    make.__module__ = module.__name__
    files = paths_of(f"policy '{name}'", getattr(maker, "files", ()), module.__name__)
    for file in files:
        if not file.exists():
            raise SpecError(f"policy '{name}': its `files` name '{file}', where there is no file")
    return make, files


def _takes_run(maker: Callable[..., Any]) -> bool:
    """Returns whether an argument is meant for the run: a required one, or a first one named so."""
    if takes(maker, 0) is False:
        return True
    try:
        parameters = inspect.signature(maker).parameters
    except (TypeError, ValueError):
        return False
    return next(iter(parameters), "") == "run"


def _require_policy(call: str, made: object) -> None:
    """Raises SpecError or TypeError for a class, or an object, that is no policy."""
    kind = made if inspect.isclass(made) else type(made)
    lacking = [
        f"def {hook}(self, {given})"
        for hook, given in (("act", "observation"), ("reset", "context"))
        if getattr(made, hook, None) is None
        or inspect.getattr_static(made, hook, None) is Policy.act
    ]
    if lacking:
        raise SpecError(
            f"{call}: class {kind.__name__}{_place_of(kind)} lacks methods that a Policy must "
            f"define: add {', '.join(lacking)}"
        )
    require_hooks(call, made, Policy)


def _place_of(kind: type) -> str:
    """Returns " (pol.py:12)", where a class is written; "" if that is unknown."""
    try:
        file, (_, line) = inspect.getsourcefile(kind), inspect.getsourcelines(kind)
    except (OSError, TypeError):  # of a notebook, or of a class without a file
        return ""
    return f" ({file}:{line})"


def _policies_of(module: ModuleType) -> list[str]:
    """Returns the names of a module that may be a policy: its own classes and functions."""
    return [
        name
        for name, value in vars(module).items()
        if callable(value) and getattr(value, "__module__", None) == module.__name__
    ]


EXPERT, RANDOM, REPLAY = "expert", "random", "replay"


def expert_of_policy(policy: str, source: str | Path, acting: PolicyOptions = _AS_IT_IS) -> str:
    """Registers a policy by its name, and returns the `expert` of a run for it.

    `source` is the dataset to replay.
    """
    if is_url(policy):
        return _register_remote_policy(policy, acting)
    if acting.preset or acting.timeout_s is not None:
        option = "--preset" if acting.preset else "--policy-timeout"
        raise ArgumentError(
            f"policy '{policy}': {option} is for a policy server, such as ws://127.0.0.1:8000"
        )
    if policy == EXPERT:
        if acting != _AS_IT_IS:
            raise ArgumentError(
                "policy 'expert': --horizon and --ensemble are for policies that return chunks"
            )
        return ""
    how: dict[str, Any] = {"horizon": acting.horizon, "ensemble": acting.ensemble}
    if policy == RANDOM:
        register_policy(RANDOM + acting.suffix, RandomPolicy, **how)
        return RANDOM + acting.suffix
    if policy == REPLAY:
        replayed_seed(source)
        register_policy(REPLAY + acting.suffix, lambda _run: ReplayPolicy(source), **how)
        return REPLAY + acting.suffix
    if ":" in policy:
        return register_named_policy(policy, Path.cwd(), acting)
    if policy.endswith(".py") and Path(policy).is_file():
        raise ArgumentError(f"policy '{policy}': {_classes_to_name(policy)}")
    raise ArgumentError(
        f"policy '{policy}': expected module:Class, file.py:Class, the URL of a policy server "
        f"(ws://...), '{EXPERT}', '{RANDOM}' or '{REPLAY}'."
        f"{did_you_mean(policy, (EXPERT, RANDOM, REPLAY))}"
    )


def _register_remote_policy(url: str, acting: PolicyOptions) -> str:
    """Registers the policy of a server, and returns its kind."""
    from robocell.policy_server.client import TIMEOUT_S, parse_url
    from robocell.policy_server.remote_policy import RemotePolicy

    parse_url(url)
    preset = acting.load_preset()
    horizon = acting.horizon
    if horizon is None and preset is not None and not acting.ensemble:
        horizon = preset.horizon
    timeout_s = acting.timeout_s or TIMEOUT_S
    register_policy(
        f"{url}{acting.suffix}",
        lambda _run: RemotePolicy(url, preset, timeout_s),
        preset.files if preset else (),
        horizon=horizon,
        ensemble=acting.ensemble,
    )
    return f"{url}{acting.suffix}"


def _classes_to_name(file: str) -> str:
    """Returns "name its class too: pol.py:Mine", for a file without a class."""
    from robocell.generate.run_source import import_module

    module = import_module(file, Path.cwd())
    classes = [
        f"{file}:{name}"
        for name in _policies_of(module)
        if inspect.isclass(kind := getattr(module, name)) and hasattr(kind, "act")
    ]
    if not classes:
        return f"name the class of a robocell.policy.Policy in it, as {file}:Class; it has none yet"
    return f"name the class of the policy too: {shortened(classes)}"


def replayed_seed(source: str | Path) -> int:
    """Returns the seed of a dataset's run. Raises ArgumentError without episodes to replay."""
    if not Path(source).is_dir():
        raise ArgumentError(
            f"policy '{REPLAY}' takes the actions of a dataset, and '{source}' is not one: name "
            "the folder of the dataset instead of its run file"
        )
    with naming_what_to_evaluate():
        return seed_of_dataset(source)


class ReplayPolicy(Policy):
    """Takes the recorded actions of the episode that began in the same state."""

    def __init__(self, source: str | Path) -> None:
        self._dataset = Dataset(Path(source))
        self._episode: Episode | None = None
        self._row = 0
        self._names: list[str] = []

    def reset(self, context: Context) -> None:
        """Looks up the episode again."""
        self._episode, self._row = None, 0
        actions = [f.name for f in context.features if f.role == "action"]
        self._names = [name for name in actions if f"{name}_relative" in actions]

    def act(self, observation: Observation) -> Action:
        """The next recorded action; the last one again after the end."""
        if self._episode is None:
            self._episode = self._starting_at(observation)
        row = min(self._row, len(self._episode) - 1)
        self._row += 1
        return {name: self._episode[name][row] for name in self._names}

    def _starting_at(self, observation: Observation) -> Episode:
        for episode in self._dataset:
            state = [f.name for f in episode.features if f.role in ("observation", "privileged")]
            if all(
                name in observation and np.allclose(episode[name][0], observation[name], atol=1e-9)
                for name in state
            ):
                return episode
        raise NotFoundError(
            f"policy '{REPLAY}': no episode of '{self._dataset.folder}' starts like this one. Its "
            f"own starts are those of --seed {seed_of_dataset(self._dataset.folder)}"
        )


class RandomPolicy(Policy):
    """Moves all joints at random around their targets, as a baseline."""

    STEP = 0.1  # rad or m, at most

    def __init__(self, run: RunConfig) -> None:
        self._rng = np.random.default_rng(0)
        self._targets: list[Feature] = []

    def reset(self, context: Context) -> None:
        """Restarts the random stream."""
        self._rng = np.random.default_rng(context.seed)
        actions = {f.name: f for f in context.features if f.role == "action"}
        self._targets = [f for name, f in actions.items() if f"{name}_relative" in actions]

    def act(self, observation: Observation) -> Action:
        """A step of up to 0.1 rad or m for each joint, and any opening, within their ranges."""
        return {feature.name: self._draw(feature, observation) for feature in self._targets}

    def _draw(self, feature: Feature, observation: Observation) -> NDArray[np.float64]:
        lower = np.array(feature.lower or [-np.inf] * feature.shape[0])
        upper = np.array(feature.upper or [np.inf] * feature.shape[0])
        if feature.names == ["opening"]:
            return self._rng.uniform(lower, upper)
        robot, _, group = feature.name.partition("/action/")
        target = observation[f"{robot}/{group}/target"]
        return np.clip(
            target + self._rng.uniform(-self.STEP, self.STEP, target.shape), lower, upper
        )
