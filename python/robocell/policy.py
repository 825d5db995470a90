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
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robocell._acting_policy import ActingPolicy
from robocell._action_chunks import Chunks
from robocell._arguments import with_hints
from robocell._core import (
    ArgumentError,
    CellFeatures,
    Dataset,
    EnvConfig,
    Episode,
    EpisodeStart,
    Expert,
    Feature,
    GroupCommand,
    NotFoundError,
    RelativeTo,
    Rng,
    RunConfig,
    Scene,
    SpecError,
)
from robocell._dataset_run import (
    is_recorded_folder,
    naming_what_to_evaluate,
    seed_of_dataset,
)
from robocell._own_code import RAISED, calling_module, paths_of, raise_interrupt
from robocell._policy_latency import CallDelays, Latency
from robocell._policy_options import PolicyOptions, is_url
from robocell._raised import LostPolicyError, UnmadePolicyError, text_of_hook
from robocell._registering import (
    arguments_of,
    require_hooks,
    require_name,
    require_takes,
    takes,
)
from robocell._suggestions import did_you_mean, shortened
from robocell.tasks import expert_registration

__all__ = [
    "Action",
    "Context",
    "Observation",
    "Policy",
    "PolicyExpert",
    "register_policy",
]

Observation = dict[str, NDArray[Any]]
_AS_IT_IS = PolicyOptions()
Action = Mapping[str, ArrayLike]
CellConfig = RunConfig | EnvConfig
MakePolicy = Callable[[CellConfig], "Policy"]


@dataclass(frozen=True)
class Context:
    """Context of a rollout for a policy.

    Attributes:
        instruction: The task, in words.
        run: The cell's configuration: the RunConfig of a run, or the EnvConfig of a recorded
            environment. Both have `cameras`.
        seed: Seed for policies that draw random numbers; it follows from run, episode and attempt.
        features: Features that the policy observes and may command, with unit, frame, names, range.
    """

    instruction: str
    run: CellConfig
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

    def act_batch(
        self, observations: Sequence[Observation], contexts: Sequence[Context]
    ) -> Sequence[Action]:
        """Returns the actions of several rollouts at once, for networks that take batches.

        `robocell serve-policy` calls it instead of `act` and `reset` for the workers of an
        evaluation. A policy that defines it keeps nothing of a rollout between two calls.

        Args:
            observations: One for each rollout, as for `act`.
            contexts: What `reset` would get in each rollout.

        Returns:
            What `act` would return, for each rollout.
        """
        raise NotImplementedError


class PolicyExpert(Expert):
    """Lets a policy act in rollouts. The policy gets what a dataset records, not the simulation.

    Errors of the policy, and errors about its return values, are raised. `chunks` decides how many
    actions of a chunk are taken before the policy is called again, and `delays` how late they come.
    """

    def __init__(
        self,
        run: RunConfig,
        start: EpisodeStart,
        policy: Policy,
        chunks: Chunks | None = None,
        delays: CallDelays | None = None,
    ) -> None:
        super().__init__()
        self.policy = policy
        self._run, self._task = run, start.task
        self._code_of = policy  # messages about act() say where the policy's is written
        self._acting = ActingPolicy(policy, chunks, delays)
        self._row: Observation = {}

    def begin(self, scene: Scene, rng: Rng) -> None:
        """Resets the policy."""
        self._features = CellFeatures(scene, self._task, list(self._run.features))
        self._acting.begin(
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
        self._row = self._acting.name_in(row, bool(cameras.streams), cameras.draw)

    def act(self, scene: Scene, rng: Rng) -> dict[str, dict[str, GroupCommand]]:
        """Returns the next action of the policy's chunk, or of a new chunk."""
        action: dict[str, ArrayLike] = {**self._acting.next(self._row)}
        return self._features.to_action(action)

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


@with_hints
def register_policy(
    name: str,
    make: MakePolicy,
    files: str | Path | Sequence[str | Path] = (),
    *,
    horizon: int | None = None,
    ensemble: bool = False,
    latency: float | str | Latency = 0.0,
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
        latency: Simulated milliseconds from an observation to the actions that follow from it;
            actions of the last chunk are taken meanwhile. 0 lets the simulation wait for the
            policy, "measured" counts the time of each call, and "recorded:FOLDER" repeats, in an
            evaluation, the times of another one's calls.
    """
    registering = calling_module()
    require_name("register_policy", name, "name")
    call = f"register_policy({name!r})"
    Chunks(horizon, ensemble)
    late = Latency.parse(latency).absolute()
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
            text = f"policy '{name}' cannot be made: {text_of_hook(errors[0])}"
            raise UnmadePolicyError(text) from errors[0]
        delays = CallDelays(late, run.rates.policy_ms)
        chunks = Chunks(horizon, ensemble, delays.fixed)
        return PolicyExpert(run, start, made[0], chunks, delays)

    module = getattr(make, "__module__", None)
    expert.__module__ = module or __name__
    expert_registration(name, files, registering)(expert)


@dataclass(frozen=True)
class NamedPolicy:
    """A policy by the name that `robocell evaluate` takes.

    Attributes:
        kind: Name with its options, which distinguishes evaluations.
        make: Makes the policy for a cell.
        files: Files that it uses beside its code.
        horizon: Actions of a chunk that are taken before the policy is called again.
        ensemble: Average the predictions of several chunks for the same moment.
        latency: Simulated time from an observation to its actions.
    """

    kind: str
    make: MakePolicy
    files: Sequence[Path] = ()
    horizon: int | None = None
    ensemble: bool = False
    latency: Latency = field(default_factory=Latency)

    def register(self) -> str:
        """Registers it as a kind of expert, and returns the kind."""
        register_policy(
            self.kind,
            self.make,
            self.files,
            horizon=self.horizon,
            ensemble=self.ensemble,
            latency=self.latency,
        )
        return self.kind


def register_named_policy(name: str, folder: Path, acting: PolicyOptions = _AS_IT_IS) -> str:
    """Registers `module:Class`, `file.py:Class` or `file.py:function`, and returns its kind."""
    return _policy_of_module(name, folder, acting).register()


def _policy_of_module(name: str, folder: Path, acting: PolicyOptions) -> NamedPolicy:
    make, files = maker_of_policy(name, folder)
    return NamedPolicy(
        f"{name}{acting.suffix}",
        make,
        files,
        acting.horizon,
        acting.ensemble,
        acting.latency,
    )


def maker_of_policy(name: str, folder: Path) -> tuple[MakePolicy, list[Path]]:
    """Returns the maker of `module:Class`, `file.py:Class` or `file.py:function`, and its files.

    The policy is made as `Class(run)` if the class requires an argument or calls its first one
    `run`, else as `Class()`. Raises SpecError for anything that is no policy.
    """
    from robocell._generation.run_source import import_module

    module_name, _, attribute = name.rpartition(":")
    module = import_module(module_name, folder)
    maker = getattr(module, attribute, None)
    if not callable(maker):
        raise SpecError(
            f"policy '{name}': module '{module_name}' has no class or function '{attribute}'."
            f"{did_you_mean(attribute, named := _policies_of(module))}"
            f"{f' It has: {shortened(named)}' if named else ''}"
        )
    if takes(maker, 0) is False and takes(maker, 1) is False:
        raise SpecError(
            f"policy '{name}': it is made as {attribute}() or {attribute}(run), which does not fit "
            f"its arguments {arguments_of(maker)}"
        )

    if inspect.isclass(maker):
        _require_policy(f"policy '{name}'", maker)

    def make(run: CellConfig) -> Policy:
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

ENV_ACTION = "action/"  # begins the names of the actions of recorded environments

# The reason of a rollout that an error of its policy or expert ended begins with this
# (src/robocell/rollout/expert_calls.cc).
POLICY_ERROR = "policy error: "


def expert_of_policy(policy: str, source: str | Path, acting: PolicyOptions = _AS_IT_IS) -> str:
    """Registers a policy by its name, and returns the `expert` of a run for it.

    `source` is the dataset to replay.
    """
    if policy == EXPERT:
        _refuse_server_options(policy, acting)
        if acting != _AS_IT_IS:
            raise ArgumentError(
                "policy 'expert': --horizon, --ensemble and --latency are for policies that return "
                "chunks"
            )
        return ""
    return named_policy(policy, source, acting).register()


def named_policy(policy: str, source: str | Path, acting: PolicyOptions = _AS_IT_IS) -> NamedPolicy:
    """Returns the policy of a name: `random`, `replay`, `module:Class` or the URL of a server.

    `source` is the dataset to replay. Raises ArgumentError for other names.
    """
    if is_url(policy):
        return _remote_policy(policy, acting)
    _refuse_server_options(policy, acting)
    chunks: dict[str, Any] = {
        "horizon": acting.horizon,
        "ensemble": acting.ensemble,
        "latency": acting.latency,
    }
    if policy == RANDOM:
        return NamedPolicy(RANDOM + acting.suffix, RandomPolicy, **chunks)
    if policy == REPLAY:
        if not is_recorded_folder(source):
            replayed_seed(source)
        return NamedPolicy(REPLAY + acting.suffix, lambda _run: ReplayPolicy(source), **chunks)
    if ":" in policy:
        return _policy_of_module(policy, Path.cwd(), acting)
    if policy.endswith(".py") and Path(policy).is_file():
        raise ArgumentError(f"policy '{policy}': {_classes_to_name(policy)}")
    raise ArgumentError(
        f"policy '{policy}': expected module:Class, file.py:Class, the URL of a policy server "
        f"(ws://... or zmq://...), '{EXPERT}', '{RANDOM}' or '{REPLAY}'."
        f"{did_you_mean(policy, (EXPERT, RANDOM, REPLAY))}"
    )


def _refuse_server_options(policy: str, acting: PolicyOptions) -> None:
    if acting.preset or acting.timeout_s is not None:
        option = "--preset" if acting.preset else "--policy-timeout"
        raise ArgumentError(
            f"policy '{policy}': {option} is for a policy server, such as ws://127.0.0.1:8000"
        )


def _remote_policy(url: str, acting: PolicyOptions) -> NamedPolicy:
    """Returns the policy of a server."""
    from robocell.policy_server._client import TIMEOUT_S
    from robocell.policy_server._remote_policy import RemotePolicy, require_url

    require_url(url)
    preset = acting.load_preset()
    horizon = acting.horizon
    if horizon is None and preset is not None and not acting.ensemble:
        horizon = preset.horizon
    timeout_s = acting.timeout_s or TIMEOUT_S
    return NamedPolicy(
        f"{url}{acting.suffix}",
        lambda _run: RemotePolicy(url, preset, timeout_s),
        preset.files if preset else (),
        horizon,
        acting.ensemble,
        acting.latency,
    )


def _classes_to_name(file: str) -> str:
    """Returns "name its class too: pol.py:Mine", for a file without a class."""
    from robocell._generation.run_source import import_module

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


def _chosen_actions(features: Iterable[Feature]) -> list[Feature]:
    """Returns the actions that command a whole cell: absolute targets, or an environment's own."""
    actions = {f.name: f for f in features if f.role == "action"}
    of_env = [f for name, f in actions.items() if name.startswith(ENV_ACTION)]
    return of_env or [f for name, f in actions.items() if f"{name}_relative" in actions]


class ReplayPolicy(Policy):
    """Takes the recorded actions of the episode that began in the same state."""

    def __init__(self, source: str | Path) -> None:
        self._dataset = Dataset(Path(source))
        self._episode: Episode | None = None
        self._row = 0
        self._features: list[Feature] = []
        self._names: list[str] = []

    def reset(self, context: Context) -> None:
        """Looks up the episode again."""
        self._episode, self._row = None, 0
        self._features = list(context.features)

    def act(self, observation: Observation) -> Action:
        """The next recorded action; the last one again after the end."""
        if self._episode is None:
            self._episode = self._starting_at(observation)
            # An environment may have been stepped by names: it then has no actions of its own.
            recorded = set(self._episode.columns)
            there = [feature for feature in self._features if feature.name in recorded]
            self._names = [feature.name for feature in _chosen_actions(there)]
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
        folder = self._dataset.folder
        seed = "" if is_recorded_folder(folder) else seed_of_dataset(folder)
        own = f". Its own starts are those of --seed {seed}" if seed != "" else ""
        raise NotFoundError(
            f"policy '{REPLAY}': no episode of '{folder}' starts like this one{own}"
        )


class RandomPolicy(Policy):
    """Moves all joints at random around their targets, as a baseline.

    In a recorded environment it moves what the environment's actions command.
    """

    STEP = 0.1  # rad or m, at most

    def __init__(self, run: CellConfig) -> None:
        self._rng = np.random.default_rng(0)
        self._targets: list[Feature] = []
        self._is_relative = isinstance(run, EnvConfig) and run.relative_to != RelativeTo.NONE

    def reset(self, context: Context) -> None:
        """Restarts the random stream."""
        self._rng = np.random.default_rng(context.seed)
        self._targets = _chosen_actions(context.features)

    def act(self, observation: Observation) -> Action:
        """A step of up to 0.1 rad or m for each joint, and any opening, within their ranges."""
        return {feature.name: self._draw(feature, observation) for feature in self._targets}

    def _draw(self, feature: Feature, observation: Observation) -> NDArray[np.float64]:
        size = feature.shape[0]
        lower = np.array(feature.lower or [-np.inf] * size)
        upper = np.array(feature.upper or [np.inf] * size)
        if feature.names == ["opening"] or feature.name.endswith("/gripper"):
            return self._rng.uniform(lower, upper)
        step = self._rng.uniform(-self.STEP, self.STEP, size)
        if feature.names and feature.names[-1] == "qw":  # positions move, orientations stay
            step[3:] = 0
        return np.clip(self._present(feature, observation) + step, lower, upper)

    def _present(self, feature: Feature, observation: Observation) -> NDArray[np.float64]:
        """Returns the action that holds still."""
        if not feature.name.startswith(ENV_ACTION):
            robot, _, group = feature.name.partition("/action/")
            return np.asarray(observation[f"{robot}/{group}/target"], dtype=np.float64)
        if not self._is_relative:
            path = feature.name.removeprefix(ENV_ACTION)
            return np.array(observation[f"observation/{path}"], dtype=np.float64)
        still = np.zeros(feature.shape[0])
        if feature.names and feature.names[-1] == "qw":
            still[-1] = 1
        return still
