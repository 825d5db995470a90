"""A mixture: several runs whose episodes make one dataset, with shared workers.

    run: kitchen
    runs:
      - pick.yaml
      - {run: stack.yaml, episodes: 200}
    output: experiment_output/kitchen
    workers: 4

Each run fills a dataset of its own below `.parts` of the output, exactly as alone. The output holds
links to their episodes, with the name of the run in front of the id.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence, Set
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from robocell import ArgumentError, SpecError
from robocell._core import Dataset
from robocell._dataset_run import PARTS, manifest_of_dataset
from robocell._durable import flush_path
from robocell._generation.items import Item, ItemRecord
from robocell._generation.job import Job
from robocell._generation.observer import Observer
from robocell._generation.report import (
    Command,
    RunReport,
    host_name,
    identity_hash,
    load_former,
    report_path,
    save,
    utc_now,
)
from robocell._generation.resume import DamagedEpisodesError
from robocell._generation.run_source import RunSource
from robocell._generation.supervised_job import Result, SupervisedJob
from robocell._generation.supervisor import Limits, Outcome, StartWorker
from robocell._generation.worker_entry import worker_command
from robocell._own_code import modules_now, set_modules_of_run
from robocell._suggestions import did_you_mean
from robocell._yaml import Place, read_yaml
from robocell.data import DatasetLock, remove_leftovers
from robocell.data.derive import extend
from robocell.generate import run_identity

FIELDS = ("run", "runs", "output", "workers")
FIELDS_OF_PART = ("run", "episodes", "name")
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]*")


@dataclass(frozen=True)
class Part:
    """One run of a mixture.

    Attributes:
        name: Its name, which the ids of its episodes begin with.
        source: Its run file.
        overrides: Replaced fields, with the folder of its own dataset.
    """

    name: str
    source: RunSource
    overrides: tuple[str, ...]


@dataclass(frozen=True)
class Mixture:
    """What a mixture file says; `workers` is 0 without that field."""

    file: str
    name: str
    parts: tuple[Part, ...]
    output: Path
    workers: int = 0


def is_mixture(file: str) -> bool:
    """Returns True for a YAML file with the field `runs`."""
    try:
        return bool(re.search(r"^runs\s*:", Path(file).read_text(), re.MULTILINE))
    except (OSError, ValueError):
        return False


def load_mixture(
    file: str,
    *,
    imports: Sequence[str] = (),
    overrides: Sequence[str] = (),
    output: str | None = None,
    workers: int | None = None,
) -> Mixture:
    """Reads a mixture file.

    Args:
        file: The file.
        imports: Modules that all runs import first.
        overrides: Fields that are replaced in all runs.
        output: Replaces the field.
        workers: Replaces the field.

    Raises SpecError with file and line.
    """
    content, place = read_yaml(Path(file), "mixture", "a file with `runs:`", "export")
    if not isinstance(content, dict):
        raise SpecError(f"{place}: expected fields {', '.join(FIELDS)}")
    _require_fields(content, FIELDS, place)
    for override in overrides:
        if override.partition("=")[0] in ("episodes", "output", "workers"):
            raise ArgumentError(
                f"--set {override}: the runs of a mixture have their own; write `episodes` beside "
                "a run in the file, and give --output or --workers for all"
            )
    folder = Path(output) if output else Path(_text(content, "output", place))
    name = str(content.get("run", Path(file).stem))
    given = content["runs"]
    if not isinstance(given, list) or not given:
        raise SpecError(f"{place.at('runs')} is not a list of run files")
    parts: list[Part] = []
    for index, entry in enumerate(given):
        part = _part(entry, place.at("runs", index), Path(file).parent, imports, overrides, folder)
        if any(each.name == part.name for each in parts):
            raise SpecError(
                f"{place.at('runs', index)}: another run is called '{part.name}', too. Add a name, "
                f"as in {{run: {part.source.run}, name: {part.name}_2}}"
            )
        parts.append(part)
    count = content.get("workers", 0) if workers is None else workers
    if not isinstance(count, int) or count < 0:
        raise SpecError(f"{place.at('workers')} is not a number of processes: {count!r}")
    return Mixture(file, name, tuple(parts), folder, count)


def _part(
    entry: Any,
    place: Place,
    folder: Path,
    imports: Sequence[str],
    overrides: Sequence[str],
    output: Path,
) -> Part:
    fields = {"run": entry} if isinstance(entry, str) else entry
    if not isinstance(fields, dict):
        raise SpecError(f"{place} is neither a run file nor {{run: FILE, episodes: N}}")
    _require_fields(fields, FIELDS_OF_PART, place)
    file = folder / _text(fields, "run", place)
    if not file.is_file():
        raise SpecError(f"{place}: there is no run file '{file}'")
    if is_mixture(str(file)):
        raise SpecError(f"{place}: '{file}' has `runs`, too. List its runs here")
    name = str(fields.get("name", file.stem))
    if not NAME.fullmatch(name):
        raise SpecError(
            f"{place}: the name '{name}' begins ids of episodes, so that it has letters, digits, _ "
            "and -. Add one, as in {run: FILE, name: pick}"
        )
    episodes = fields.get("episodes")
    if episodes is not None and (not isinstance(episodes, int) or episodes < 1):
        raise SpecError(f"{place.at('episodes')} is not a number of episodes: {episodes!r}")
    own = [*overrides, *([] if episodes is None else [f"episodes={episodes}"])]
    own.append(f"output={json.dumps(str(output / PARTS / name))}")
    return Part(name, RunSource(str(file), tuple(imports)), tuple(own))


def _require_fields(content: Mapping[str, Any], known: Sequence[str], place: Place) -> None:
    for key in content:
        if key not in known:
            near = did_you_mean(str(key), known)
            raise SpecError(f"{place.at(key)}: no such field. Fields: {', '.join(known)}.{near}")


def _text(content: Mapping[str, Any], key: str, place: Place) -> str:
    value = content.get(key)
    if not isinstance(value, str) or not value:
        raise SpecError(f"{place}: the field `{key}` is missing; it names a path")
    return value


class MixtureJob(SupervisedJob):
    """The items of all runs of a mixture.

    Args:
        mixture: The mixture.
        overrides: Fields that are replaced in all runs, as the workers need them.
        most_workers: At most so many workers are started.

    Raises SpecError for errors in the files.
    """

    def __init__(
        self, mixture: Mixture, overrides: Sequence[str] = (), most_workers: int = 10**6
    ) -> None:
        first = mixture.parts[0].source
        self.source = RunSource(mixture.file, first.imports)
        self.mixture = mixture
        self.dataset = mixture.output
        self.shares_folder = False
        self.parts = {part.name: PartJob(part) for part in mixture.parts}
        self._overrides = tuple(overrides)
        self._of = {
            f"{name}_{item.id}": (part, item)
            for name, part in self.parts.items()
            for item in part.items
        }
        self.items = [Item(name, index) for index, name in enumerate(self._of)]
        asked = mixture.workers or max(part.run.workers for part in self.parts.values())
        self._workers = min(asked, most_workers)
        for part in self.parts.values():
            part.share(self._workers)
        self._locks = ExitStack()

    @property
    def workers(self) -> int:
        """Number of processes."""
        return self._workers

    def check(self) -> list[str]:
        """Checks all runs, and returns the warnings with the names of their runs."""
        return [
            f"{name}: {text}"
            for name, part in self.parts.items()
            for text in part.in_turn().check()
        ]

    def prepare(self, observer: Observer, limits: Limits) -> Mapping[str, str]:
        """Raises SpecError like `check`, before anything is written."""
        self._require_same_parts()
        environment: dict[str, str] = {}
        for part in self.parts.values():
            environment |= part.in_turn().inspect(observer, limits)
        for part in self.parts.values():
            part.in_turn().begin_dataset()
        return environment

    def claim(self) -> None:
        """Locks and compares the datasets of the runs."""
        with ExitStack() as locks:
            for part in self.parts.values():
                locks.enter_context(DatasetLock(part.dataset))
                part.in_turn().claim()
                remove_leftovers(part.dataset, folders_only=False)
            self._locks = locks.pop_all()

    def flush(self) -> None:
        """Flushes the folders that hold the episodes. Raises OSError on failure."""
        for part in self.parts.values():
            flush_path(part.dataset)

    @contextmanager
    def elsewhere(self) -> Iterator[StartWorker | None]:
        """Context manager: unlocks the datasets of the runs at its end."""
        with self._locks:
            yield None

    def made(self) -> set[str]:
        """Returns the items on the disk. Raises DamagedEpisodesError for unreadable ones."""
        made: set[str] = set()
        damaged: list[str] = []
        for name, part in self.parts.items():
            try:
                own = part.in_turn().made()
            except DamagedEpisodesError as error:
                damaged.append(str(error))
                own = error.made
            made |= {f"{name}_{item}" for item in own}
        if damaged:
            raise DamagedEpisodesError("\n".join(damaged), made)
        return made

    def result_of(self, item_id: str) -> ItemRecord | None:
        """Returns the result of an item on the disk; None for one that is not made."""
        part, item = self._of[item_id]
        result = part.in_turn().result_of(item.id)
        return result and replace(result, id=item_id)

    def worker_command(self) -> list[str]:
        """Returns the command that starts a worker."""
        sets = [f"--set={override}" for override in self._overrides]
        output = f"--output={self.dataset.absolute()}"
        return worker_command("robocell._generation.mixture_work", self.source, [*sets, output])

    def reproduce(self, item: Item) -> str:
        """Returns the command that makes an item alone, from its run file."""
        part, own = self._of[item.id]
        return part.reproduce(own)

    def clean_up(self, item_id: str, pid: int, observer: Observer) -> None:
        """Removes the remains of a worker that died."""
        part, item = self._of[item_id]
        part.clean_up(item.id, pid, observer)

    def tried_once(self, made: Set[str], observer: Observer) -> Set[str]:
        """Returns no items: all have all tries."""
        return set()

    def finish(self, outcome: Outcome, started: str, observer: Observer) -> Result:
        """Links the episodes of all runs into the dataset, and writes the report.

        Raises DamagedEpisodesError for episodes damaged meanwhile.
        """
        damaged: DamagedEpisodesError | None = None
        try:
            made = self.made()
        except DamagedEpisodesError as error:  # it came meanwhile; the others are linked first
            damaged, made = error, error.made
        result = Result(outcome, len(made))
        parts = [(Dataset(str(part.dataset)), name) for name, part in self.parts.items()]
        extend(self.dataset, parts, {"mixture": [part.name for part in self.mixture.parts]})
        try:
            self._report(result, started, observer)
        except OSError as error:
            observer.warning(f"the report could not be written: {error}")
        if damaged:
            raise damaged
        return result

    def _report(self, result: Result, started: str, observer: Observer) -> None:
        path = report_path(self.dataset)
        identities = [run_identity(part.in_turn().run) for part in self.parts.values()]
        identity = identity_hash("\n".join(identities))
        versions = (manifest_of_dataset(next(iter(self.parts.values())).dataset) or {})["versions"]
        report = RunReport(self.mixture.name, identity, (0, 1), versions)
        if (former := load_former(path, observer.warning)) is not None:
            report.commands, report.episodes = former.commands, former.episodes
        outcome = result.outcome
        if report.commands and outcome.totals.already == outcome.totals.planned:
            return  # it had nothing to do
        reason = outcome.fatal.message if outcome.fatal else ""
        command = Command(started, utc_now(), host_name(), result.end, reason, outcome.totals)
        report.add(command, outcome.results, list(self._of))
        save(path, report)

    def _require_same_parts(self) -> None:
        """Raises SpecError if the dataset is of something else, or of more runs."""
        manifest = manifest_of_dataset(self.dataset)
        if manifest is None:
            return
        before = manifest.get("derived", {}).get("mixture")
        if before is None:
            raise SpecError(
                f"output '{self.dataset}' holds another dataset, not that of a mixture. Name "
                "another folder (--output)"
            )
        if missing := [name for name in before if name not in self.parts]:
            raise SpecError(
                f"{self.mixture.file}: the dataset '{self.dataset}' was begun with the run "
                f"'{missing[0]}', which the file no longer has. Add it again, or name another "
                "folder (--output)"
            )


class PartJob(Job):
    """The job of one run of a mixture."""

    def __init__(self, part: Part) -> None:
        super().__init__(part.source, part.overrides)
        self._modules = modules_now()

    def share(self, workers: int) -> None:
        """Takes the workers of the mixture for its own."""
        self._workers = workers

    def in_turn(self) -> PartJob:
        """Returns this job, whose modules are now those of the run in work."""
        set_modules_of_run(self._modules)
        return self
