"""The module `robocell._generation.mixture_work`: a worker process for the runs of a mixture.

It holds one run at a time, that of the item in hand.
"""

from __future__ import annotations

import argparse
import re
from dataclasses import replace

from robocell._generation.items import Item, ItemRecord
from robocell._generation.mixture import Mixture, load_mixture
from robocell._generation.run_source import RunSource
from robocell._generation.work import open_run
from robocell._generation.worker import MakeEpisode
from robocell._generation.worker_entry import run_worker
from robocell.generate import PlanItem, Runner, StopFlag

ITEM = re.compile(r"s\d+_e\d+")  # ids of items, see rollout/plan.h


class _Maker:
    """Makes episodes of the runs of a mixture."""

    def __init__(self, mixture: Mixture, stop: StopFlag) -> None:
        self._parts = {part.name: part for part in mixture.parts}
        self._stop = stop
        self._name = ""
        self._opened: tuple[Runner, dict[str, PlanItem]] | None = None

    def __call__(self, item: Item) -> ItemRecord:
        """Makes one episode."""
        name, own = self._split(item.id)
        if self._opened is None or name != self._name:
            self._opened = None  # frees the scenes first
            part = self._parts[name]
            _, runner, plan = open_run(part.source.absolute(), part.overrides)
            self._name, self._opened = name, (runner, plan)
        runner, plan = self._opened
        result = ItemRecord.from_core(runner.run(plan[own], stop=self._stop))
        return replace(result, id=item.id)

    def _split(self, item_id: str) -> tuple[str, str]:
        """Returns the run of an item, and the item's id there."""
        split = [(name, item_id.removeprefix(f"{name}_")) for name in self._parts]
        # Another name may begin like an item's: those of 'pick' are 'pick_s0000_e0000' and so on.
        return next(each for each in split if ITEM.fullmatch(each[1]))


def _open_maker(arguments: argparse.Namespace, stop: StopFlag) -> MakeEpisode:
    source = RunSource.of(arguments).absolute()
    mixture = load_mixture(
        source.run, imports=source.imports, overrides=arguments.set, output=arguments.output
    )
    return _Maker(mixture, stop)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="robocell._generation.mixture_work", description=__doc__)
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--output")
    return parser


if __name__ == "__main__":
    run_worker(_parser(), _open_maker)
