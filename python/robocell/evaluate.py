"""Evaluates a policy, or an expert, in the cells of a run or of a dataset.

    result = evaluate("out/picks", "my_policy.py:Policy", episodes=100, workers=2)
    print(result.successes, result.interval)

Each episode is one rollout from a start of its own; starts follow from the seed and the episode's
number alone, so that several policies see the same ones. Rollouts are kept as a dataset: failures
too, with their videos.
"""

from __future__ import annotations

import json
import math
import multiprocessing
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from robocell._core import (
    ArgumentError,
    Dataset,
    Keep,
    RunConfig,
    Runner,
    make_plan,
    prepare_dataset,
)
from robocell.dataset_run import run_of
from robocell.policy import RandomPolicy, register_named_policy, register_policy

# Starts of evaluations are drawn from other seeds than those that datasets begin with.
SEED = 1_000_003
EXPERT, RANDOM = "expert", "random"


def wilson_interval(successes: int, trials: int, z: float = 1.959964) -> tuple[float, float]:
    """The 95 % score interval of a success rate (Wilson 1927): (low, high), each 0 to 1."""
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
        unmade: Episodes without a rollout: no start was accepted.
        failures: Reason -> rollouts.
        outcomes: Episode -> success, for comparing policies start by start.
        dataset: Folder of the rollouts.
        seed: Of the starts.
    """

    policy: str
    successes: int
    trials: int
    interval: tuple[float, float]
    unmade: int
    failures: dict[str, int]
    outcomes: dict[str, bool]
    dataset: str
    seed: int

    def to_json(self) -> str:
        """As a JSON object."""
        return json.dumps(asdict(self), indent=2)


@dataclass(frozen=True)
class _Trial:
    id: str
    success: bool = False
    rolled_out: bool = False
    failures: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class _Job:
    source: str
    imports: tuple[str, ...]
    policy: str
    episodes: int
    seed: int
    output: str
    cameras: bool

    def load(self) -> RunConfig:
        run = run_of(self.source, self.imports)
        run.expert = register(self.policy)
        run.keep = Keep.FIRST
        run.seed = self.seed
        run.episodes = self.episodes
        run.output = self.output
        if not self.cameras:
            run.cameras.streams.clear()
        return run


def register(policy: str) -> str:
    """Makes a policy known by its name; what a run's `expert` says for it."""
    if policy == EXPERT:
        return ""
    if policy == RANDOM:
        register_policy(RANDOM, RandomPolicy)
        return RANDOM
    if ":" in policy:
        register_named_policy(policy, Path.cwd())
        return policy
    raise ArgumentError(
        f"policy '{policy}': expected module:Class, file.py:Class, '{EXPERT}' or '{RANDOM}'"
    )


def evaluate(
    source: str | Path,
    policy: str,
    *,
    episodes: int = 100,
    workers: int = 1,
    seed: int = SEED,
    output: str | Path,
    cameras: bool = True,
    imports: Sequence[str] = (),
    on_trial: Callable[[int, int, bool], None] | None = None,
) -> Evaluation:
    """One rollout of each of `episodes` starts.

    Args:
        source: A dataset, a run file, or `module:name` of a RunConfig.
        policy: `module:Class` or `file.py:Class` of a `robocell.policy.Policy`; `expert` for the
            task's own expert; `random`.
        episodes: How many starts.
        workers: Processes.
        seed: Starts follow from it and from their number: the same for every policy.
        output: Folder of the rollouts. The same evaluation again goes on there.
        cameras: False draws no image: for policies that need none, and no videos are kept.
        imports: Modules to import first, which register tasks.
        on_trial: Called as (done, of, success) after each rollout.
    """
    if episodes < 1:
        raise ArgumentError(f"episodes must be at least 1, got {episodes}")
    if workers < 1:
        raise ArgumentError(f"workers must be at least 1, got {workers}")
    job = _Job(str(source), tuple(imports), policy, episodes, seed, str(output), cameras)
    run = job.load()
    prepare_dataset(run)
    count = len(make_plan(run))
    trials: list[_Trial] = []
    for trial in _trials(job, count, min(workers, count)):
        trials.append(trial)
        if on_trial is not None:
            on_trial(len(trials), count, trial.success)
    rolled_out = [trial for trial in trials if trial.rolled_out]
    successes = sum(trial.success for trial in rolled_out)
    failures: Counter[str] = Counter()
    for trial in rolled_out:
        failures.update(trial.failures)
    return Evaluation(
        policy=policy,
        successes=successes,
        trials=len(rolled_out),
        interval=wilson_interval(successes, len(rolled_out)),
        unmade=len(trials) - len(rolled_out),
        failures=dict(failures.most_common()),
        outcomes={trial.id: trial.success for trial in sorted(rolled_out, key=lambda t: t.id)},
        dataset=str(output),
        seed=seed,
    )


def _trials(job: _Job, count: int, workers: int) -> Any:
    if workers == 1:
        _open(job)
        yield from map(_roll_out, range(count))
        return
    # Forking would share what libraries hold: graphics, threads, a policy's network.
    context = multiprocessing.get_context("spawn")
    with context.Pool(workers, _open, (job,)) as pool:
        yield from pool.imap_unordered(_roll_out, range(count))


_state: dict[str, Any] = {}


def _open(job: _Job) -> None:
    run = job.load()
    _state["runner"] = Runner(run)
    _state["plan"] = make_plan(run)
    _state["run"] = run


def _roll_out(index: int) -> _Trial:
    item = _state["plan"][index]
    report = _state["runner"].run(item)
    if report.resumed:
        episode = Dataset(_state["run"].output)[item.id]
        failures = {} if episode.success else {str(episode.end_reason): 1}
        return _Trial(item.id, episode.success, True, failures)
    return _Trial(item.id, report.success, report.committed, dict(report.failures))
