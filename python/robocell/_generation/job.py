"""A run file with its plan and its dataset: lists the remaining items and makes them."""

from __future__ import annotations

import json
import platform
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from robocell import IoError
from robocell._dataset_run import manifest_of_dataset
from robocell._generation import work
from robocell._generation.check import Found, check_in_child
from robocell._generation.disk import require_writable
from robocell._generation.items import Item, ItemRecord
from robocell._generation.observer import Observer
from robocell._generation.report import (
    Command,
    DamagedReportError,
    RunReport,
    host_name,
    identity_hash,
    load,
    load_former,
    report_path,
    save,
    utc_now,
)
from robocell._generation.resume import DamagedEpisodesError, made_items, result_of
from robocell._generation.run_source import RunSource, require_utf8
from robocell._generation.supervised_job import Result, SupervisedJob
from robocell._generation.supervisor import Limits, Outcome, StartWorker
from robocell._generation.unstored import UnstoredRollout
from robocell.generate import (
    PlanItem,
    make_plan,
    parse_shard,
    prepare_dataset,
    require_same_run,
    run_identity,
    shard_plan,
    validate_dataset,
)

if TYPE_CHECKING:
    from robocell._generation.ray_engine import RayEngine

TRIES = Limits().tries


def first_few(names: Sequence[str], most: int = 5) -> str:
    """Returns 'a, b, c', or 'a, b, c, d, e and 3 more'."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def _decoded(override: str) -> str:
    """Returns the value of an override as a text, without the quotes of a JSON string."""
    text = override.partition("=")[2]
    try:
        value = json.loads(text)
    except ValueError:
        return text
    return value if isinstance(value, str) else text


class Job(SupervisedJob):
    """The items of a run, or of a shard of it.

    Args:
        source: The run file or the origin of the configuration, with the modules to import.
        overrides: Replaced fields, as in 'task.lift_height=0.05'.
        shard: 'i/N': every N-th item, beginning with the i-th. None: all.
        choose: Chooses the items of the plan that are made. None: all.
        engine: Makes the episodes on other machines. None: on this one.
        workers: Number of workers of the engine.

    Raises SpecError for errors in the files, ArgumentError for the shard.
    """

    def __init__(
        self,
        source: RunSource | Path,
        overrides: Sequence[str],
        shard: str | None = None,
        choose: Callable[[list[PlanItem]], list[PlanItem]] | None = None,
        engine: RayEngine | None = None,
        workers: int = 0,
    ) -> None:
        self.engine = engine
        self._workers = workers
        self.source = source if isinstance(source, RunSource) else RunSource(str(source))
        self.overrides = tuple(overrides)
        for override in self.overrides:
            require_utf8(_decoded(override))
        self.run = self.source.load(overrides)
        self.dataset = Path(self.run.output)
        plan = make_plan(self.run)
        plan = choose(plan) if choose else plan
        self.plan_size = len(plan)
        self.shard = parse_shard(shard) if shard is not None else (0, 1)
        self._chosen = shard_plan(plan, *self.shard) if shard is not None else plan
        self.items = [Item(item.id, item.index) for item in self._chosen]
        self._by_id = {item.id: item for item in self._chosen}
        self.shares_folder = self.shard[1] > 1

    def made(self) -> set[str]:
        """Returns the items on the disk. Raises DamagedEpisodesError for unreadable ones."""
        if not self.dataset.is_dir():
            return set()
        made = made_items(self.run, self._chosen)
        return made if self.source.acting.stores else made | self._unstored()

    def _unstored(self) -> set[str]:
        """Returns the items of an evaluation whose results are there without their rollouts."""
        return {item.id for item in self.items if UnstoredRollout.find(self.dataset, item.id)}

    def check(self, longest_s: float = Limits.item_timeout_s) -> list[str]:
        """Checks the run and its dataset, and returns the warnings.

        The problems are those of the run (see `robocell.diagnose.check_run`) and of a dataset of
        another run. Writes nothing. Returns warnings: valid but probably unintended settings, a
        model that crashed the engine, or an unfinished check after `longest_s` seconds.
        Raises IoError if the dataset is not writable, or if the check itself failed.
        """
        return self._look_through(longest_s).warnings

    def _look_through(self, longest_s: float) -> Found:
        require_writable(self.dataset, self._place_of_output())
        found = check_in_child(self.source, self.overrides, longest_s)
        validate_dataset(self.run)
        return found

    def _place_of_output(self) -> str:
        """Returns 'run.yaml:3:9: '; "" for a folder that the command names."""
        named = any(override.startswith("output=") for override in self.overrides)
        return "" if named else f"{self.run.location('output')}: "

    def reproduce(self, item: Item) -> str:
        """Returns the command that makes one item alone, in a folder beside the dataset.

        The dataset itself may be in use, and would reject the item as a shard of another count.
        """
        if self.source.policy:
            return self._reproduce_evaluation(item)
        kept = [override for override in self.overrides if not override.startswith("output=")]
        sets = [part for override in kept for part in ("--set", override)]
        alone = ["--output", str(self.dataset.with_name(f"{self.dataset.name}_alone"))]
        shard = ["--shard", f"{item.index}/{self.plan_size}"]
        imports = [part for module in self.source.imports for part in ("--import", module)]
        command = ["robocell", "generate", self.source.run, *imports, *sets, *alone, *shard]
        return shlex.join(command)

    def _reproduce_evaluation(self, item: Item) -> str:
        fields = [override.partition("=")[0] for override in self.overrides]
        most = self.run.rates.max_steps if "rates.max_steps" in fields else None
        cameras = self.run.cameras.draw or "cameras.draw" not in fields
        return self.reproduce_evaluation(item, self.run.seed, most, cameras)

    @property
    def workers(self) -> int:
        """Number of processes."""
        return self._workers or self.run.workers

    @contextmanager
    def elsewhere(self) -> Iterator[StartWorker | None]:
        """Context manager: starts workers on the machines of the engine."""
        if self.engine is None:
            yield None
            return
        overrides = tuple(each for each in self.overrides if not each.startswith("output="))
        with self.engine.workers(
            self.source, overrides, self.dataset, self.logs(), self.workers
        ) as start:
            yield start

    def prepare(self, observer: Observer, limits: Limits) -> Mapping[str, str]:
        """Raises SpecError like `check`, before anything is written."""
        environment = self.inspect(observer, limits)
        self.begin_dataset()
        return environment

    def inspect(self, observer: Observer, limits: Limits) -> Mapping[str, str]:
        """Checks the run like `check`, and returns environment variables of the workers."""
        found = self._look_through(limits.item_timeout_s)
        for warning in found.warnings:
            observer.warning(warning)
        return found.environment

    def begin_dataset(self) -> None:
        """Makes the folder of the dataset, of a run that was checked."""
        prepare_dataset(self.run, validate=False)

    def claim(self) -> None:
        """Compares the dataset with the run: another command may have been quicker."""
        require_same_run(self.run)

    def result_of(self, item_id: str) -> ItemRecord | None:
        """Returns the result of an item on the disk; None for one that is not made."""
        found = result_of(self.run, self._by_id[item_id])
        if found is None and not self.source.acting.stores:
            unstored = UnstoredRollout.find(self.dataset, item_id)
            return unstored.record if unstored else None
        return found

    def worker_command(self) -> list[str]:
        """Returns the command that starts a worker."""
        return work.command(self.source, self.overrides)

    def tried_once(self, made: Set[str], observer: Observer) -> Set[str]:
        """Returns the items that the last command gave up, and warns of them."""
        given_up = self._given_up_before() - made
        if given_up:
            observer.warning(
                f"given up before for errors, and tried once now instead of {TRIES} times: "
                + first_few(sorted(given_up))
            )
        return given_up

    def finish(self, outcome: Outcome, started: str, observer: Observer) -> Result:
        """Writes the report. Raises DamagedEpisodesError for episodes damaged meanwhile."""
        damaged: DamagedEpisodesError | None = None
        try:
            on_disk = self.made()
        except DamagedEpisodesError as error:  # it came meanwhile; the report goes first
            damaged, on_disk = error, error.made
        result = Result(outcome, len(on_disk))
        try:
            self._report(result, started, observer)
        except OSError as error:  # the episodes are there all the same
            observer.warning(f"the report could not be written: {error}")
        if damaged:
            raise damaged
        return result

    def _given_up_before(self) -> set[str]:
        """Returns the items that the last command gave up and that still have no result."""
        try:
            report = load(report_path(self.dataset, self.shard))
        except (OSError, DamagedReportError):
            return set()
        if report.identity != identity_hash(run_identity(self.run)) or not report.commands:
            return set()
        unmade = {unmade.id for unmade in report.commands[-1].totals.unmade}
        return unmade - report.episodes.keys()

    def _report(self, result: Result, started: str, observer: Observer) -> None:
        """Adds this command to the dataset's report; one that had nothing to do is not listed."""
        outcome, path = result.outcome, report_path(self.dataset, self.shard)
        report = self._former_report(path, observer)
        idle = outcome.totals.already == outcome.totals.planned
        if idle and report.commands:
            return
        command = Command(
            started=started,
            finished=utc_now(),
            host=host_name(),
            end=result.end,
            reason=outcome.fatal.message if outcome.fatal else "",
            totals=outcome.totals,
        )
        report.add(command, outcome.results, [item.id for item in self.items])
        report.houses = list(self.run.scenes.houses)
        save(path, report)

    def _former_report(self, path: Path, observer: Observer) -> RunReport:
        """Returns the report of earlier commands of the same run; an empty one without any.

        A damaged report is set aside with a warning.
        """
        manifest = manifest_of_dataset(self.dataset)
        if manifest is None:
            raise IoError(f"'{self.dataset / 'dataset.json'}' is gone")
        versions = {**manifest["versions"], "python": platform.python_version()}
        identity = identity_hash(run_identity(self.run))
        report = RunReport(self.run.run, identity, self.shard, versions)
        former = load_former(path, observer.warning)
        if former is not None and former.identity == identity:
            report.commands, report.episodes = former.commands, former.episodes
            report.houses = former.houses
        return report

    def logs(self) -> Path:
        """Returns the folder of the workers' logs, and makes it."""
        shard, count = self.shard
        name = ".logs" if count == 1 else f".logs/shard-{shard}-of-{count}"
        folder = self.dataset / name
        folder.mkdir(parents=True, exist_ok=True)
        return folder
