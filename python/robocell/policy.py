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

from collections import deque
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
from robocell._own_code import RAISED, calling_module
from robocell._registering import arguments_of, require_name, require_takes, takes
from robocell._suggestions import did_you_mean
from robocell.dataset_run import run_metadata
from robocell.evaluated import ending_at_errors
from robocell.tasks import expert_registration

Observation = dict[str, NDArray[Any]]
Action = Mapping[str, ArrayLike]


@dataclass(frozen=True)
class Context:
    """What a policy gets at the beginning of a rollout.

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
        files: Files that the policy uses beside its code, such as weights, relative to the module.
            Their content is part of an evaluation: with other files it does not continue in the
            same folder.

    Examples:
        >>> class Wait(rc.policy.Policy):
        ...     def act(self, observation):
        ...         return {}
    """

    files: ClassVar[Sequence[str | Path]] = ()

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
                `<stream>.segmentation` if the cell has them.

        Returns:
            Columns `robots/<robot>/action/...` of a dataset, one for each group that moves:
            `<group>`, absolute joint positions or an opening; `<group>_relative`, added to the
            present targets; `tcp_pose`, the TCP in the robot's base frame; `tcp_twist`, relative to
            the present TCP. An array with one more dimension is a chunk: its actions are taken one
            after the other before `act` is called again.
        """
        raise NotImplementedError


class PolicyExpert(Expert):
    """Lets a policy act in rollouts. The policy gets what a dataset records, not the simulation.

    What the policy raises, and what is wrong with what it returns, is raised here too; the experts
    of `register_policy` end the rollout with it.
    """

    def __init__(self, run: RunConfig, start: EpisodeStart, policy: Policy) -> None:
        super().__init__()
        self.policy = policy
        self._run, self._task = run, start.task
        self._code_of = policy  # messages about act() say where the policy's is written
        self._chunk: deque[dict[str, NDArray[np.float64]]] = deque()
        self._row: Observation = {}

    def begin(self, scene: Scene, rng: Rng) -> None:
        """Resets the policy."""
        self._features = CellFeatures(scene, self._task, list(self._run.features))
        self._sizes = {
            feature.name: (feature.shape or (1,))[0] for feature in self._features.commanded
        }
        self._chunk.clear()
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
        self._row = row

    def act(self, scene: Scene, rng: Rng) -> dict[str, dict[str, GroupCommand]]:
        """Returns the next action of the policy's chunk, or of a new chunk."""
        if not self._chunk:
            self._chunk.extend(self._actions(self.policy.act(self._row)))
        return self._features.to_action(dict(self._chunk.popleft()))

    def _actions(self, action: Action) -> list[dict[str, NDArray[np.float64]]]:
        """Splits a chunk into single actions."""
        who = f"{type(self.policy).__name__}.act()"
        if not isinstance(action, Mapping) or not action:
            raise TypeError(
                f"{who} must return a dict of columns 'robots/.../action/...' to numbers, "
                f"got {action!r}"
            )
        arrays = {name: _real(who, name, values) for name, values in action.items()}
        lengths = set()
        for name, array in arrays.items():
            size = self._size(name)
            if array.shape == () and size == 1:
                array = arrays[name] = array.reshape(1)
            if array.ndim not in (1, 2) or array.shape[-1] != size or not array.size:
                raise ArgumentError(
                    f"{who}: '{name}' has {size} numbers, or (k, {size}) for a chunk; got the "
                    f"shape {array.shape}"
                )
            if not np.isfinite(array).all():
                bad = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
                raise ArgumentError(
                    f"{who}: '{name}' is not finite: entry [{', '.join(map(str, bad))}] is "
                    f"{array[bad]}"
                )
            lengths.add(array.shape[0] if array.ndim == 2 else 0)
        if len(lengths) > 1:
            raise ArgumentError(f"{who}: columns of one chunk differ in length: {sorted(lengths)}")
        (length,) = lengths
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
    """Returns real numbers. NumPy only warns when it drops the imaginary part of complex ones."""
    if np.iscomplexobj(array := np.asarray(values)):
        raise TypeError(f"{who}: '{name}' must be real numbers, got complex ones: {array.dtype}")
    return np.asarray(values, dtype=np.float64)


@with_hints
def register_policy(
    name: str, make: Callable[[RunConfig], Policy], files: Sequence[str | Path] = ()
) -> None:
    """Registers a policy as a kind of expert, for the `expert` of a run.

    `make(run)` makes it once in each process; it is reset for each rollout. `files`: files that it
    uses beside its code, such as weights. An error of the policy ends the rollout as a failure;
    one of `make` leaves nobody to act, and is raised for each rollout.
    """
    registering = calling_module()
    require_name("register_policy", name, "name")
    call = f"register_policy({name!r})"
    if not callable(make):
        raise TypeError(f"{call}: expected a function (run) -> Policy, got {make!r}")
    require_takes(call, make, ["run"])
    made: list[Policy] = []
    errors: list[BaseException] = []
    acting = ending_at_errors(lambda run, start: PolicyExpert(run, start, made[0]))

    def expert(run: RunConfig, start: EpisodeStart) -> Expert:
        if errors:
            raise errors[0]
        if not made:
            try:
                made.append(make(run))
            except RAISED as error:
                errors.append(error)
                raise
        return acting(run, start)

    module = getattr(make, "__module__", None)
    expert.__module__ = module or __name__
    expert_registration(name, files, registering)(expert)


def register_named_policy(name: str, folder: Path) -> None:
    """Registers `module:Class`, `file.py:Class` or `file.py:function` under that text.

    The policy is made as `Class()`, or as `Class(run)` if the class takes an argument.
    """
    import inspect

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

    def make(run: RunConfig) -> Policy:
        try:
            takes_run = bool(inspect.signature(maker).parameters)
        except ValueError:
            takes_run = False
        policy = maker(run) if takes_run else maker()
        if not hasattr(policy, "act") or not hasattr(policy, "reset"):
            raise SpecError(
                f"policy '{name}': expected an object with reset(context) and act(observation), "
                f"as robocell.policy.Policy has, got a {type(policy).__name__}"
            )
        return policy

    make.__module__ = module.__name__
    beside = Path(getattr(module, "__file__", None) or folder / "module").parent
    files = [beside / file for file in getattr(maker, "files", ())]
    for file in files:
        if not file.is_file():
            raise SpecError(f"policy '{name}': its `files` name '{file}', where there is no file")
    register_policy(name, make, files)


def _policies_of(module: ModuleType) -> list[str]:
    """Returns the names of a module that may be a policy: its own classes and functions."""
    return [
        name
        for name, value in vars(module).items()
        if callable(value) and getattr(value, "__module__", None) == module.__name__
    ]


EXPERT, RANDOM, REPLAY = "expert", "random", "replay"


def expert_of_policy(policy: str, source: str | Path) -> str:
    """Registers a policy by its name, and returns the `expert` of a run for it.

    `source` is the dataset to replay.
    """
    if policy == EXPERT:
        return ""
    if policy == RANDOM:
        register_policy(RANDOM, RandomPolicy)
        return RANDOM
    if policy == REPLAY:
        replayed_seed(source)
        register_policy(REPLAY, lambda _run: ReplayPolicy(source))
        return REPLAY
    if ":" in policy:
        register_named_policy(policy, Path.cwd())
        return policy
    raise ArgumentError(
        f"policy '{policy}': expected module:Class, file.py:Class, '{EXPERT}', "
        f"'{RANDOM}' or '{REPLAY}'"
    )


def replayed_seed(source: str | Path) -> int:
    """Returns the seed of a dataset's run. ArgumentError when there is nothing to replay."""
    if not Path(source).is_dir():
        raise ArgumentError(
            f"policy '{REPLAY}' takes the actions of a dataset, and '{source}' is not one: name "
            "the folder of the dataset instead of its run file"
        )
    return int(run_metadata(Dataset(Path(source)))["seed"])


class ReplayPolicy(Policy):
    """Takes the recorded actions of the episode that began in the same state."""

    def __init__(self, source: str | Path) -> None:
        self._dataset = Dataset(Path(source))
        self._episode: Episode | None = None
        self._row = 0
        self._names: list[str] = []

    def reset(self, context: Context) -> None:
        """Looks for the episode anew."""
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
            f"policy '{REPLAY}': no episode of '{self._dataset.folder}' starts like this one. "
            "Leave --seed out, so that its own starts are taken"
        )


class RandomPolicy(Policy):
    """Moves all joints at random around their targets: what a policy has to beat."""

    STEP = 0.1  # rad or m, at most

    def __init__(self, run: RunConfig) -> None:
        self._rng = np.random.default_rng(0)
        self._targets: list[Feature] = []

    def reset(self, context: Context) -> None:
        """Begins its numbers anew."""
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
