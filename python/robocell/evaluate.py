"""Evaluates a policy, or an expert, in the cells of a run or of a dataset.

A dataset that an environment recorded is evaluated in that environment.

    result = evaluate("out/picks", "my_policy.py:Policy", episodes=100, workers=2)
    print(result.successes, result.interval, result.dataset)

Each episode is one rollout from a separate start. Starts depend only on the seed and the episode's
number, so that all policies get identical ones. Rollouts are stored as a dataset: failures too,
with their videos.
"""

from __future__ import annotations

import contextlib
import json
import math
import re
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from robocell._core import (
    ArgumentError,
    Dataset,
    EnvConfig,
    Error,
    IoError,
    NotFoundError,
    PlanItem,
    SpecError,
)
from robocell._dataset_run import (
    is_recorded_folder,
    naming_what_to_evaluate,
    plan_numbers,
    require_cell,
)
from robocell._env_job import EnvJob
from robocell._evaluated import breakdown_of, cell_of, difference_of, rollout_end
from robocell._generation.items import ItemRecord
from robocell._generation.job import Job
from robocell._generation.observer import Observer
from robocell._generation.protocol import Failure
from robocell._generation.run_source import RunSource
from robocell._generation.supervisor import Limits
from robocell._generation.totals import Totals, Unmade
from robocell._own_code import modules_of_one_run
from robocell._policy_calls import latency as latency_of
from robocell._policy_latency import CallDelays, Latency
from robocell._policy_options import PolicyOptions, is_url
from robocell._raised import without_names
from robocell._suggestions import did_you_mean
from robocell.policy import EXPERT, RANDOM, REPLAY, replayed_seed

__all__ = [
    "EXPERT",
    "RANDOM",
    "REPLAY",
    "SEED",
    "Comparison",
    "Evaluation",
    "compare",
    "default_output",
    "evaluate",
    "wilson_interval",
]

# Starts of evaluations are drawn from other seeds than those that datasets begin with.
SEED = 1_000_003
LONGEST_GREETING = 10_000  # characters of a server's metadata that are kept


def wilson_interval(successes: int, trials: int, z: float = 1.959964) -> tuple[float, float]:
    """Returns the 95 % score interval of a success rate (Wilson 1927): (low, high), each 0 to 1.

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
    """Result of an evaluation.

    Attributes:
        policy: Name of the policy.
        successes: Rollouts that succeeded.
        rollouts: Number of rollouts, each from its own start.
        interval: 95 % Wilson interval of the success rate.
        mean_length: Mean number of actions of a rollout; 0 without any.
        unmade: Starts without a rollout: none was accepted, or something raised.
        failures: Reason -> rollouts, most frequent first. Errors about a missing name count as one
            reason, with the names that the first rollout had.
        policy_errors: Rollouts that an error of the policy ended; they count as failures too.
        outcomes: Id of the start's episode -> success; `compare` pairs those of two policies.
        dataset: Folder of the rollouts.
        seed: Seed of the starts.
        errors: Id of a start without a rollout -> reason.
        latency: Number of calls of the policy, and their median, 99th percentile and maximum in
            milliseconds; {} for experts. `policy_calls/` beside the rollouts has every call.
        server: First message of a policy server; {} for other policies.
        cell: Field of the run or environment -> its value, and file of a model -> hash, without
            what belongs to the policy. `compare` takes only evaluations in the same cell.
        breakdown: What differs between the starts -> each of its values or ranges -> [successes,
            rollouts]: object, task, robot, and what is randomised.
    """

    policy: str
    successes: int
    rollouts: int
    interval: tuple[float, float]
    mean_length: float
    unmade: int
    failures: dict[str, int]
    policy_errors: int
    outcomes: dict[str, bool]
    dataset: str
    seed: int
    errors: dict[str, str]
    latency: dict[str, float] = field(default_factory=dict)
    server: dict[str, Any] = field(default_factory=dict)
    cell: dict[str, str] = field(default_factory=dict)
    breakdown: dict[str, dict[str, list[int]]] = field(default_factory=dict)

    @property
    def rate(self) -> float:
        """Successes per rollout; 0 without any."""
        return self.successes / self.rollouts if self.rollouts else 0.0

    @classmethod
    def load(cls, folder: str | Path) -> Evaluation:
        """Reads the `evaluation.json` that `robocell evaluate` wrote into the rollouts' folder."""
        path = Path(folder) / "evaluation.json"
        try:
            stored = json.loads(path.read_text())
            return cls(**stored | {"interval": tuple(stored["interval"])})
        except OSError as error:
            raise IoError(
                f"cannot read '{path}': {error.strerror}; `robocell evaluate` writes it"
            ) from error
        except (ValueError, TypeError, KeyError) as error:
            raise IoError(
                f"'{path}' is no evaluation of this version: {error}; repeat the command that made "
                "it"
            ) from error

    def to_json(self) -> str:
        """Returns a JSON object."""
        return json.dumps(asdict(self), indent=2)


@dataclass(frozen=True)
class Comparison:
    """Two policies, start by start.

    Attributes:
        both: Starts from which both policies succeeded.
        first_only: Starts from which only the first one succeeded.
        second_only: Starts from which only the second one succeeded.
        neither: Starts from which neither succeeded.
        p_value: Probability of a difference at least as large between equally good policies: the
            exact two-sided test of McNemar (1947).
    """

    both: int
    first_only: int
    second_only: int
    neither: int
    p_value: float


def compare(first: Evaluation, second: Evaluation) -> Comparison:
    """Compares two policies by the starts that both were evaluated from.

    Paired starts need far fewer rollouts than two separate success rates. Raises ArgumentError for
    evaluations with other seeds or in different cells, with the fields that differ, and for those
    without a common start.

    Examples:
        >>> better = rc.evaluate.compare(mine, baseline)  # doctest: +SKIP
        >>> better.first_only, better.second_only, better.p_value  # doctest: +SKIP
        (9, 1, 0.021484375)
    """
    if first.seed != second.seed:
        raise ArgumentError(
            f"the seeds of the evaluations are {first.seed} and {second.seed}, so their starts "
            "differ; evaluate both with one `seed`"
        )
    if first.cell and second.cell and (differing := difference_of(first.cell, second.cell)):
        raise ArgumentError(
            f"'{first.dataset}' and '{second.dataset}' are evaluations in different cells: "
            f"{differing}; evaluate both policies in the cell of one dataset or run"
        )
    common = first.outcomes.keys() & second.outcomes.keys()
    if not common:
        raise ArgumentError(
            f"'{first.dataset}' and '{second.dataset}' have no start in common; evaluate both "
            "policies in the cell of one dataset or run"
        )
    pairs = Counter((first.outcomes[start], second.outcomes[start]) for start in common)
    one, other = pairs[True, False], pairs[False, True]
    return Comparison(
        pairs[True, True], one, other, pairs[False, False], _sign_test(min(one, other), one + other)
    )


def _sign_test(fewer: int, differing: int) -> float:
    """Returns the two-sided probability of at most `fewer` of so many fair coin tosses."""
    tail = sum(math.comb(differing, k) for k in range(fewer + 1))
    return min(1.0, 2 * tail / 2**differing)


class _Watching(Observer):
    """Calls back for each rollout that ends, and prints warnings."""

    def __init__(self, dataset: Path, on_rollout: Callable[[int, int, bool], None] | None) -> None:
        self._dataset, self._on_rollout = dataset, on_rollout
        self._done = 0
        self._warned: set[str] = set()

    def episode(self, result: ItemRecord, totals: Totals) -> None:
        """Counts an episode. Prints an error of the policy at once, and once."""
        self._done += 1
        end = rollout_end(self._dataset, result.id)
        if end is not None and end.policy_error and without_names(end.reason) not in self._warned:
            self._warned.add(without_names(end.reason))
            self.warning(f"{result.id}: {end.reason}")
        if self._on_rollout is not None:
            self._on_rollout(totals.already + self._done, totals.planned, result.success)

    def warning(self, text: str) -> None:
        """Prints the warning to standard error."""
        print(f"warning: {text}", file=sys.stderr, flush=True)

    def unmade(self, unmade: Unmade, totals: Totals) -> None:
        """Prints the reason at once."""
        self.warning(f"{unmade.id}: {unmade.reason}")


def default_output(source: str | Path, policy: str, seed: int) -> Path:
    """Returns `<source>_evaluation/<policy>-<seed>`, beside the dataset or the run file.

    For 'out/picks' and 'my_policy.py:Mine' it is out/picks_evaluation/my_policy.Mine-1000003.
    """
    if is_url(policy):
        policy = re.sub(r"[^\w.-]+", "_", policy.partition("://")[2]).strip("_")
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
    """The plan items to evaluate: the first ones, or the dataset's."""

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
    on_rollout: Callable[[int, int, bool], None] | None = None,
    limits: Limits | None = None,
    preset: str | Path = "",
    horizon: int | None = None,
    ensemble: bool = False,
    policy_timeout_s: float | None = None,
    latency: float | str = 0.0,
    rollouts: bool = True,
    max_steps: int | None = None,
) -> Evaluation:
    """Evaluates a policy with one rollout from each of `episodes` starts.

    Args:
        source: A dataset, generated or recorded from an environment; a run file, or `module:name`
            of a RunConfig.
        policy: `module:Class` or `file.py:Class` of a `robocell.policy.Policy`; `expert` for the
            task's own expert; `random`; `replay`, the recorded actions of the dataset; or the URL
            of a policy server, such as `ws://127.0.0.1:8000`, or `zmq://127.0.0.1:5555` of GR00T.
        episodes: Number of rollouts, each from its own start: 100 unless given, or as many as the
            dataset has for `replay`.
        workers: Number of processes.
        seed: Seed of the starts. The default gives every policy the same starts, which differ from
            the dataset's. For `replay` it is the dataset's seed.
        output: Folder of the rollouts; `default_output` unless given. Repeating an evaluation
            continues it; a folder with another evaluation is rejected.
        cameras: False renders no images: for policies that need none; no videos are stored.
        imports: Modules to import first, which register tasks.
        on_rollout: Called as (done, of, success) after each rollout.
        limits: Time limit of a rollout, and the number of tries after a worker died.
        preset: Names and units that a policy server expects: a shipped preset or a YAML file.
        horizon: Actions of a chunk that are taken before the policy is called again. Default: that
            of the preset, or the whole chunk.
        ensemble: Take the mean of what all chunks say about a moment (temporal ensembling); the
            policy is then called before every action, or after `horizon` ones.
        policy_timeout_s: Longest time of a call of a policy server. Default: 120.
        latency: Simulated milliseconds from an observation to the actions that follow from it, in a
            run: actions of the last chunk are taken meanwhile. 0 lets the simulation wait,
            "measured" counts the time of each call, and "recorded:FOLDER" repeats the times of the
            calls of another evaluation.
        rollouts: False keeps the results, and no episodes: neither rows nor videos. For runs and
            generated datasets.
        max_steps: Actions after which a rollout fails. Default: those of the run; in a recorded
            environment the number of rows of the longest episode.

    A policy that raises, or returns an invalid action, fails in that rollout, with the error as its
    reason (`policy_errors`). Raises SpecError for errors in the run or the module, and Error, with
    the reason, if no rollout could be made; `errors` lists single ones that could not be made.
    Raises IoError if a policy server is gone; the same call continues the evaluation.
    """
    _require_there(source)
    with naming_what_to_evaluate():
        require_cell(source)
    recorded = is_recorded_folder(source)
    if policy == REPLAY:
        own_seed = 0 if recorded else replayed_seed(source)
        seed = own_seed if seed is None else seed
    seed = SEED if seed is None else seed
    late = Latency.parse(latency)
    if late and recorded:
        raise ArgumentError(
            "a latency is for the cells of runs and generated datasets: there a robot waits "
            "without an action, and recorded environments take whole actions only"
        )
    if not rollouts and recorded:
        raise ArgumentError(
            "--no-rollouts is for runs and generated datasets: rollouts in a recorded environment "
            "are always kept"
        )
    if episodes is not None and episodes < 1:
        raise ArgumentError(f"episodes must be at least 1, got {episodes}")
    if workers < 1:
        raise ArgumentError(f"workers must be at least 1, got {workers}")
    if max_steps is not None and max_steps < 1:
        raise ArgumentError(f"max_steps must be at least 1, got {max_steps}")
    output = default_output(source, policy, seed) if output is None else output
    starts = _Starts(100 if episodes is None else episodes)
    if policy == REPLAY and not recorded and seed == own_seed:
        starts = _Starts(episodes, Dataset(Path(source)).ids)
    overrides = [
        f"seed={seed}",
        starts.override,
        f"workers={workers}",
        f"output={json.dumps(str(output))}",
        *([] if cameras else ["cameras.draw=false"]),
        *([] if max_steps is None else [f"rates.max_steps={max_steps}"]),
    ]
    modules = (imports,) if isinstance(imports, str) else tuple(imports)
    # Workers may run in another folder, and the name is part of the evaluation's identity.
    acting = PolicyOptions(str(preset), horizon, ensemble, policy_timeout_s, late, rollouts)
    acting = acting.absolute()
    chosen = RunSource(str(source), modules, policy, acting)
    with modules_of_one_run():
        job: Job | EnvJob
        if recorded:
            job = EnvJob(
                chosen,
                Path(output),
                episodes=episodes,
                seed=seed,
                max_steps=max_steps,
                workers=workers,
                cameras=cameras,
            )
        else:
            with _naming_options(overrides), _naming_files_of_environments(source):
                job = Job(chosen, overrides, choose=starts.choose)
        if isinstance(job, Job):
            CallDelays(late, job.run.rates.policy_ms)
            late.require_recorded(item.id for item in job.items)
        server = _greeting(policy) if is_url(policy) else {}
        _warn_of_rate(acting, _rate_of(job))
        with _naming_options(overrides), _one_connection(policy, server, workers, acting):
            result = job.do(_Watching(job.dataset, on_rollout), limits)
    if result.outcome.interrupted:
        raise KeyboardInterrupt
    if result.outcome.fatal:
        fatal = result.outcome.fatal
        reasons = [unmade.reason for unmade in result.outcome.totals.unmade if unmade.reason]
        raise Failure(fatal.kind, _without_logs(fatal.message, reasons)).error()
    evaluation = _evaluation_of(job, policy, seed, result.outcome.totals)
    if not evaluation.rollouts and evaluation.errors:
        first = next(iter(evaluation.errors.values()))
        first = _without_logs(first, [first])
        raise Error(f"none of {len(job.items)} rollouts could be made: {first}")
    return replace(evaluation, server=server)


def _require_there(source: str | Path) -> None:
    """Raises NotFoundError, with the nearest name, for a path without a file or folder."""
    path = Path(source)
    if path.exists() or RunSource(str(source)).in_python:
        return
    there = list(path.parent.iterdir()) if path.parent.is_dir() else []
    names = [each.name for each in there if each.suffix in (".yaml", ".yml") or each.is_dir()]
    near = did_you_mean(path.name, [name for name in names if not name.startswith(".")])
    raise NotFoundError(
        f"no dataset or run file '{source}'.{near} Name the folder of a dataset, a run file, or "
        "module:name of a RunConfig"
    )


@contextlib.contextmanager
def _naming_files_of_environments(source: str | Path) -> Iterator[None]:
    """Context manager: an error about an environment's file says how to evaluate in it."""
    try:
        yield
    except SpecError as error:
        if not _is_of_environment(Path(source)):
            raise
        raise ArgumentError(
            f"'{source}' is the file of an environment, and policies are evaluated in a run, or in "
            "a dataset. Record episodes in the environment with robocell.data.EnvRecorder, then "
            "evaluate the folder of their dataset"
        ) from error


def _is_of_environment(file: Path) -> bool:
    if not file.is_file() or file.suffix not in (".yaml", ".yml"):
        return False
    try:
        EnvConfig.load(file)
    except Error:
        return False
    return True


# Options of `evaluate` by the field of the run that they set.
_OPTIONS = {
    "seed": "--seed",
    "episodes": "-n",
    "workers": "--workers",
    "output": "--output",
    "cameras.draw": "--no-cameras",
    "rates.max_steps": "--max-steps",
}


@contextlib.contextmanager
def _naming_options(overrides: Sequence[str]) -> Iterator[None]:
    """Context manager: errors about a field that an option set name the option, not `--set`."""
    try:
        yield
    except SpecError as error:
        text = str(error)
        for override in overrides:
            field, _, value = override.partition("=")
            if field in _OPTIONS:
                shown = "" if field == "cameras.draw" else f" {value.strip(chr(34))}"
                text = text.replace(f"--set {override}", f"{_OPTIONS[field]}{shown}")
        if text == str(error):
            raise
        raise SpecError(text) from None


def _rate_of(job: Job | EnvJob) -> float | None:
    """Returns the actions per second of a cell, if they have a fixed rate."""
    if isinstance(job, EnvJob):
        return job.rate
    policy_ms = job.run.rates.policy_ms
    return None if policy_ms is None else 1e3 / policy_ms


def _warn_of_rate(acting: PolicyOptions, own: float | None) -> None:
    """Prints a warning if the cell asks for actions much faster or slower than the preset says."""
    preset = acting.load_preset()
    if preset is None or preset.rate is None or own is None:
        return
    if abs(own / preset.rate - 1) < 0.1:
        return
    print(
        f"warning: {preset.place} is for {preset.rate:g} actions per second, and the cell has "
        f"{own:.3g}: set rates.policy_ms to {1e3 / preset.rate:.3g} (run), or sim.frequency to "
        f"{preset.rate:g} (environment)",
        file=sys.stderr,
        flush=True,
    )


def _greeting(url: str) -> dict[str, Any]:
    """Returns the first message of a policy server. Raises IoError if there is no server."""
    from robocell.policy_server._remote_policy import client_of
    from robocell.policy_server._wire import as_json

    with client_of(url) as client:
        greeting = as_json(client.metadata)
    text = json.dumps(greeting)
    return greeting if len(text) <= LONGEST_GREETING else {"cut": text[:LONGEST_GREETING]}


@contextlib.contextmanager
def _one_connection(
    policy: str, greeting: Mapping[str, Any], workers: int, acting: PolicyOptions
) -> Iterator[None]:
    """Context manager: workers share one connection to a policy server that takes batches."""
    if not greeting:
        yield
        return
    from robocell.policy_server._client import TIMEOUT_S
    from robocell.policy_server._relay import relaying

    with relaying(policy, greeting, workers, acting.timeout_s or TIMEOUT_S):
        yield


def _without_logs(message: str, reasons: Sequence[str]) -> str:
    """Shortens reasons that were printed before, with a worker's log, to their first line."""
    for reason in reasons:
        message = message.replace(reason, reason.splitlines()[0])
    return message


def _evaluation_of(job: Job | EnvJob, policy: str, seed: int, totals: Totals) -> Evaluation:
    """Builds the result from the rollouts on the disk, including those of earlier commands."""
    planned = [item.id for item in job.items]
    ends = {id: end for id in sorted(planned) if (end := rollout_end(job.dataset, id))}
    outcomes = {id: end.success for id, end in ends.items()}
    failures = _by_reason([end.reason for end in ends.values() if not end.success])
    successes = sum(outcomes.values())
    return Evaluation(
        policy=policy,
        successes=successes,
        rollouts=len(outcomes),
        interval=wilson_interval(successes, len(outcomes)),
        mean_length=sum(end.rows for end in ends.values()) / max(1, len(ends)),
        unmade=len(planned) - len(outcomes),
        failures=failures,
        policy_errors=sum(end.policy_error for end in ends.values()),
        outcomes=outcomes,
        dataset=str(job.dataset),
        seed=seed,
        errors={unmade.id: unmade.reason for unmade in totals.unmade},
        latency=latency_of(job.dataset, list(ends)),
        cell=cell_of(job),
        breakdown=breakdown_of(job.dataset, ends),
    )


def _by_reason(reasons: Sequence[str]) -> dict[str, int]:
    """Counts reasons, most frequent first; reasons that differ only in a list of names are one."""
    full: dict[str, str] = {}
    for reason in reasons:
        full.setdefault(without_names(reason), reason)
    counts = Counter(map(without_names, reasons))
    return {full[reason]: count for reason, count in counts.most_common()}
