"""The module `robocell._generation.work`: a worker process, which the supervisor starts.

It loads the run itself, and ends if the run, a model file or a version differs from the start of
the dataset.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from pathlib import Path

from robocell import RunConfig
from robocell._dataset_run import recorded_attempts, seed_of_dataset
from robocell._generation.items import Item, ItemRecord
from robocell._generation.run_source import RunSource
from robocell._generation.worker import MakeEpisode
from robocell._generation.worker_entry import run_worker, worker_command
from robocell.generate import PlanItem, Runner, StopFlag, make_plan, require_same_run


def command(source: RunSource, overrides: Sequence[str]) -> list[str]:
    """Returns the command that starts a worker for a run."""
    sets = [f"--set={override}" for override in overrides]
    return worker_command("robocell._generation.work", source, sets)


def open_run(
    source: RunSource, overrides: Sequence[str]
) -> tuple[RunConfig, Runner, dict[str, PlanItem]]:
    """Loads a run, compares it with its dataset, and returns it with its runner and plan."""
    run = source.load(overrides)
    run.output = str(Path(run.output).absolute())  # a task may change the working folder
    if run.augment:
        run.augment.dataset = str(Path(run.augment.dataset).absolute())
    require_same_run(run)
    return run, Runner(run, stores=source.acting.stores), {item.id: item for item in make_plan(run)}


def _open_maker(arguments: argparse.Namespace, stop: StopFlag) -> MakeEpisode:
    source = RunSource.of(arguments).absolute()
    run, runner, plan = open_run(source, arguments.set)
    if not source.policy:
        return lambda item: ItemRecord.from_core(runner.run(plan[item.id], stop=stop))
    from robocell._generation.unstored import UnstoredRollout
    from robocell._policy_calls import present
    from robocell.policy import REPLAY

    if source.policy == REPLAY:
        _begin_as_recorded(plan.values(), source.run, run.seed)
    stores = source.acting.stores

    def evaluate(item: Item) -> ItemRecord:
        present.rollout, present.seed, present.calls = item.id, run.seed, []
        result = runner.run(plan[item.id], stop=stop)
        record = ItemRecord.from_core(result, stores=stores)
        if not stores and record.complete:
            UnstoredRollout(record, result.failure).save(present, Path(run.output))
        elif present.calls:
            present.save(Path(run.output))
        return record

    return evaluate


def _begin_as_recorded(items: Iterable[PlanItem], dataset: str, seed: int) -> None:
    """Lets items begin at the attempt that the dataset has recorded, if `seed` is the dataset's."""
    if seed != seed_of_dataset(dataset):
        return
    attempts = recorded_attempts(dataset)
    for item in items:
        item.first_attempt = attempts.get((item.scene, item.episode), 0)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="robocell._generation.work", description=__doc__)
    parser.add_argument("--set", action="append", default=[])
    return parser


if __name__ == "__main__":
    run_worker(_parser(), _open_maker)
