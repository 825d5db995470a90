"""Evaluates a policy, or an expert, in the cells of a run or of a dataset.

    result = evaluate("out/picks", "my_policy.py:Policy", episodes=100, workers=2)
    print(result.successes, result.interval, result.dataset)

Each episode is one rollout from a start of its own; starts follow from the seed and the episode's
number alone, so that several policies see the same ones. Rollouts are kept as a dataset: failures
too, with their videos.
"""

from __future__ import annotations

import json
import math
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from robocell._core import ArgumentError, Dataset, Error, PlanItem
from robocell._own_code import modules_of_one_run
from robocell.dataset_run import plan_numbers
from robocell.evaluated import POLICY_ERROR
from robocell.generate.items import ItemResult
from robocell.generate.job import Job
from robocell.generate.observer import Observer
from robocell.generate.protocol import Failure
from robocell.generate.run_source import RunSource
from robocell.generate.supervisor import Limits
from robocell.generate.totals import Totals, Unmade
from robocell.policy import EXPERT, RANDOM, REPLAY, replayed_seed

__all__ = [
    "EXPERT",
    "RANDOM",
    "REPLAY",
    "SEED",
    "Evaluation",
    "default_output",
    "evaluate",
    "wilson_interval",
]

# Starts of evaluations are drawn from other seeds than those that datasets begin with.
SEED = 1_000_003


def wilson_interval(successes: int, trials: int, z: float = 1.959964) -> tuple[float, float]:
    """The 95 % score interval of a success rate (Wilson 1927): (low, high), each 0 to 1.

    Examples:
        >>> [round(bound, 2) for bound in rc.evaluate.wilson_interval(18, 20)]
        [0.7, 0.97]
    """
    if trials == 0:
        return 0.0, 1.0
    rate = successes / trials
    scale = 1 + z * z / trials
    middle = (rate + z * z / (2 * trials)) / scale
    half = z / scale * math.sqrt(rate * (1 - rate) / trials + z * z / (4 * trials * trials))
    low = 0.0 if successes == 0 else max(0.0, middle - half)
    high = 1.0 if successes == trials else min(1.0, middle + half)
    return low, high


@dataclass(frozen=True)
class Evaluation:
    """What came of an evaluation.

    Attributes:
        policy: As it was named.
        successes: Rollouts that succeeded.
        trials: Rollouts.
        interval: 95 % Wilson interval of the success rate.
        mean_length: Mean number of actions of a rollout; 0 without any.
        unmade: Episodes without a rollout: no start was accepted, or something raised.
        failures: Reason -> rollouts.
        policy_errors: Rollouts that an error of the policy ended; they are among the failures.
        outcomes: Episode -> success, for comparing policies start by start.
        dataset: Folder of the rollouts.
        seed: Of the starts.
        errors: Episode without a rollout -> why.
    """

    policy: str
    successes: int
    trials: int
    interval: tuple[float, float]
    mean_length: float
    unmade: int
    failures: dict[str, int]
    policy_errors: int
    outcomes: dict[str, bool]
    dataset: str
    seed: int
    errors: dict[str, str]

    @property
    def rate(self) -> float:
        """Successes per rollout; 0 without any."""
        return self.successes / self.trials if self.trials else 0.0

    def to_json(self) -> str:
        """As a JSON object."""
        return json.dumps(asdict(self), indent=2)


class _Watching(Observer):
    """Calls back for each rollout that ends, and prints warnings."""

    def __init__(self, told: Callable[[int, int, bool], None] | None) -> None:
        self._told = told
        self._done = 0
        self._warned: set[str] = set()

    def episode(self, result: ItemResult, totals: Totals) -> None:
        """One more. An error of the policy is worth knowing at once, and once."""
        self._done += 1
        for reason in result.failures:
            if reason.startswith(POLICY_ERROR) and reason not in self._warned:
                self._warned.add(reason)
                self.warning(f"{result.id}: {reason}")
        if self._told is not None:
            self._told(totals.already + self._done, totals.planned, result.success)

    def warning(self, text: str) -> None:
        """On standard error, as other warnings are."""
        print(f"warning: {text}", file=sys.stderr, flush=True)

    def unmade(self, unmade: Unmade, totals: Totals) -> None:
        """The reason is worth knowing at once."""
        self.warning(f"{unmade.id}: {unmade.reason}")


def default_output(source: str | Path, policy: str, seed: int) -> Path:
    """Returns `<source>_evaluation/<policy>-<seed>`, beside the dataset or the run file.

    For 'out/picks' and 'my_policy.py:Mine' it is out/picks_evaluation/my_policy.Mine-1000003.
    """
    module, colon, name = policy.rpartition(":")
    who = f"{_module_name(module)}.{name}" if colon else policy
    path = Path(source)
    if not path.exists() and ":" in path.name:  # module:name of a configuration
        module, _, name = str(source).rpartition(":")
        return Path(f"{_module_name(module)}.{name}_evaluation") / f"{who}-{seed}"
    if path.name in ("", ".."):
        path = path.resolve()
    name = path.name if path.is_dir() else path.stem
    return path.parent / f"{name}_evaluation" / f"{who}-{seed}"


def _module_name(module: str) -> str:
    """Returns 'mine' for 'here/mine.py'; a dotted name stays."""
    return Path(module).stem if module.endswith(".py") else module


class _Starts:
    """Which items of the plan are evaluated: the first ones, of a dataset's or of all."""

    def __init__(self, most: int | None, of_dataset: Sequence[str] = ()) -> None:
        self._most = most
        self._numbers = set(plan_numbers(of_dataset))

    @property
    def override(self) -> str:
        """The field that makes the plan long enough."""
        if self._numbers:
            return f"episodes_per_scene={1 + max(episode for _, episode in self._numbers)}"
        return f"episodes={self._most}"

    def choose(self, plan: list[PlanItem]) -> list[PlanItem]:
        """Returns the items in the order of the plan."""
        numbers = self._numbers
        mine = [item for item in plan if not numbers or (item.scene, item.episode) in numbers]
        return mine[: self._most]


def evaluate(
    source: str | Path,
    policy: str,
    *,
    episodes: int | None = None,
    workers: int = 1,
    seed: int | None = None,
    output: str | Path | None = None,
    cameras: bool = True,
    imports: Sequence[str] = (),
    on_trial: Callable[[int, int, bool], None] | None = None,
    limits: Limits | None = None,
) -> Evaluation:
    """One rollout of each of `episodes` starts.

    Args:
        source: A dataset, a run file, or `module:name` of a RunConfig.
        policy: `module:Class` or `file.py:Class` of a `robocell.policy.Policy`; `expert` for the
            task's own expert; `random`; `replay`, the recorded actions of the dataset.
        episodes: How many starts: 100 unless given, or as many as the dataset has for `replay`.
        workers: Processes.
        seed: Starts follow from it and from their number: the same for every policy, and none of
            a dataset's, unless given. For `replay` the dataset's own.
        output: Folder of the rollouts; `default_output` unless given. The same evaluation again
            goes on there; one of other starts, of another policy or cell is refused.
        cameras: False draws no image: for policies that need none, and no videos are kept.
        imports: Modules to import first, which register tasks.
        on_trial: Called as (done, of, success) after each rollout.
        limits: How long a rollout may take, and how often one is tried whose worker died.

    A policy that raises, or returns what is no action, fails in that rollout, with the error as
    its reason (`policy_errors`). Raises SpecError for what the run or the module says, and Error
    when no rollout could be made at all, with the reason; single ones that could not be made are in
    `errors`.
    """
    if policy == REPLAY:
        own_seed = replayed_seed(source)
        seed = own_seed if seed is None else seed
    seed = SEED if seed is None else seed
    if episodes is not None and episodes < 1:
        raise ArgumentError(f"episodes must be at least 1, got {episodes}")
    if workers < 1:
        raise ArgumentError(f"workers must be at least 1, got {workers}")
    output = default_output(source, policy, seed) if output is None else output
    starts = _Starts(100 if episodes is None else episodes)
    if policy == REPLAY and seed == own_seed:
        starts = _Starts(episodes, Dataset(Path(source)).ids)
    overrides = [
        f"seed={seed}",
        starts.override,
        f"workers={workers}",
        f"output={json.dumps(str(output))}",
        *([] if cameras else ["cameras.streams=[]"]),
    ]
    modules = (imports,) if isinstance(imports, str) else tuple(imports)
    with modules_of_one_run():
        job = Job(RunSource(str(source), modules, policy), overrides, choose=starts.choose)
        result = job.do(_Watching(on_trial), limits)
    if result.outcome.interrupted:
        raise KeyboardInterrupt
    if result.outcome.fatal:
        fatal = result.outcome.fatal
        said = [unmade.reason for unmade in result.outcome.totals.unmade if unmade.reason]
        raise Failure(fatal.kind, _without_logs(fatal.message, said)).error()
    evaluation = _evaluation_of(job, policy, seed, result.outcome.totals)
    if not evaluation.trials and evaluation.errors:
        first = next(iter(evaluation.errors.values()))
        first = _without_logs(first, [first])
        raise Error(f"none of {len(job.items)} rollouts could be made: {first}")
    return evaluation


def _without_logs(message: str, said: Sequence[str]) -> str:
    """Shortens reasons that were said before, with a worker's log, to their first line."""
    for reason in said:
        message = message.replace(reason, reason.splitlines()[0])
    return message


def _evaluation_of(job: Job, policy: str, seed: int, totals: Totals) -> Evaluation:
    """From what is on the disk: what an earlier command made counts like the rest."""
    dataset = Dataset(job.dataset)
    planned = {item.id for item in job.items}
    episodes = {e.id: e for e in dataset if e.id in planned}
    outcomes = {id: bool(episodes[id].success) for id in sorted(episodes)}
    failures = Counter(str(e.end_reason) for e in episodes.values() if not e.success)
    successes = sum(outcomes.values())
    return Evaluation(
        policy=policy,
        successes=successes,
        trials=len(outcomes),
        interval=wilson_interval(successes, len(outcomes)),
        mean_length=sum(map(len, episodes.values())) / max(1, len(episodes)),
        unmade=len(planned) - len(outcomes),
        failures=dict(failures.most_common()),
        policy_errors=sum(n for why, n in failures.items() if why.startswith(POLICY_ERROR)),
        outcomes=outcomes,
        dataset=str(job.dataset),
        seed=seed,
        errors={unmade.id: unmade.reason for unmade in totals.unmade},
    )
