"""The module `robocell.generate.work`: a worker process. Started by the supervisor, not by people.

It loads the run itself and refuses to go on when that, a model file or a version is not what
the dataset was begun with.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from robocell import RunConfig
from robocell.generate import ItemResult as CoreResult
from robocell.generate import PlanItem, Runner, StopFlag, make_plan, require_same_run
from robocell.generate.items import Item, ItemResult
from robocell.generate.own_process import own_process
from robocell.generate.run_source import RunSource
from robocell.generate.worker import MakeEpisode, serve


def command(source: RunSource, overrides: Sequence[str]) -> list[str]:
    """The command that starts a worker for a run."""
    sets = [f"--set={override}" for override in overrides]
    options = [*source.options(), *sets, "--", source.run]
    return [*own_process("robocell.generate.work"), *options]


def _open_maker(arguments: argparse.Namespace, stop: StopFlag) -> MakeEpisode:
    source = RunSource.of(arguments).absolute()
    run = source.load(arguments.set)
    run.output = str(Path(run.output).absolute())  # a task may change the working folder
    require_same_run(run)
    run_item = _evaluating(run, source.policy) if source.policy else Runner(run).run
    plan = {item.id: item for item in make_plan(run)}

    def make(item: Item) -> ItemResult:
        return ItemResult.from_core(run_item(plan[item.id], stop=stop))

    return make


def _evaluating(run: RunConfig, policy: str) -> Callable[..., CoreResult]:
    """Returns what makes an item of an evaluation: one rollout, of its first accepted start."""
    from robocell.evaluated import ExplainedStart, ending_at_errors, expert_of_python
    from robocell.policy import EXPERT

    maker = expert_of_python(run)
    if maker is None:
        return Runner(run).run
    start = ExplainedStart(ending_at_errors(maker) if policy == EXPERT else maker)
    runner = Runner(run, expert=start)

    def run_item(item: PlanItem, stop: StopFlag | None = None) -> CoreResult:
        with start.explained():
            return runner.run(item, stop=stop)

    return run_item


def main() -> int:
    """The process."""
    parser = argparse.ArgumentParser(prog="robocell.generate.work", description=__doc__)
    parser.add_argument("--set", action="append", default=[])
    RunSource.add_options(parser)
    arguments = parser.parse_args()
    stop = StopFlag()
    return serve(lambda: _open_maker(arguments, stop), stop)


if __name__ == "__main__":
    sys.exit(main())
