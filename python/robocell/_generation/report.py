"""`report.json`: the results of the commands that made a dataset, for people and programs.

It is stored beside the episodes, which do not depend on it: the number of episodes is counted on
the disk. A shard has its own report, `report-3-of-8.json`.
"""

from __future__ import annotations

import hashlib
import json
import socket
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from robocell import _core
from robocell._generation.items import ItemRecord
from robocell._generation.totals import Totals, Unmade, one_after_the_other, side_by_side

FORMAT = "robocell-report"
FORMAT_VERSION = 1
UNSIGNED = {"json_sha256": "0" * 64}  # becomes the hash, see base/checked_json.h


class DamagedReportError(Exception):
    """A file has a report's name and is none."""


@dataclass(frozen=True)
class Command:
    """One invocation of `robocell generate`.

    Attributes:
        started, finished: UTC, ISO 8601.
        host: Name of the machine.
        end: 'complete', 'incomplete', 'interrupted' or 'failed'.
        reason: Reason of the failure, or ''.
        totals: Counts of the command.
    """

    started: str
    finished: str
    host: str
    end: str
    reason: str
    totals: Totals

    def to_json(self) -> dict[str, Any]:
        """Returns a JSON object."""
        return {**vars(self), "totals": self.totals.record()}

    @classmethod
    def from_json(cls, values: Mapping[str, Any]) -> Command:
        """Reads a JSON object."""
        return cls(**{**values, "totals": Totals.from_record(values["totals"])})


@dataclass
class RunReport:
    """The report of a run, or of a shard of it.

    Attributes:
        run: Its name.
        identity: SHA-256 of what identifies the run (`robocell.generate.run_identity`).
        shard: (i, N) of 'i/N'.
        versions: Versions of the software that makes the episodes.
        commands: The commands, oldest first, without killed ones.
        episodes: Results of the decided items, by id, in the plan's order.
        houses: `scenes.houses` of the last command; None in a report of an older robocell version.
    """

    run: str
    identity: str
    shard: tuple[int, int]
    versions: Mapping[str, str]
    commands: list[Command] = field(default_factory=list)
    episodes: dict[str, ItemRecord] = field(default_factory=dict)
    houses: list[int] | None = None

    @property
    def totals(self) -> Totals:
        """Totals over all commands."""
        totals = [command.totals for command in self.commands]
        return one_after_the_other(totals) if totals else Totals(planned=0, started=0.0, ended=0.0)

    @property
    def places(self) -> range:
        """Positions of its items in the plan; empty without a command."""
        index, count = self.shard
        planned = self.commands[-1].totals.planned if self.commands else 0
        return range(index, index + count * planned, count)

    def add(self, command: Command, results: Sequence[ItemRecord], order: Sequence[str]) -> None:
        """Appends a command; `order` are the ids of the plan."""
        self.commands.append(command)
        known = {**self.episodes, **{result.id: result for result in results}}
        self.episodes = {name: known[name] for name in order if name in known}

    def to_json(self) -> dict[str, Any]:
        """Returns a JSON object."""
        return {
            "format": FORMAT,
            "format_version": FORMAT_VERSION,
            "run": self.run,
            "identity": self.identity,
            "shard": list(self.shard),
            "versions": dict(self.versions),
            **({} if self.houses is None else {"houses": self.houses}),
            "commands": [command.to_json() for command in self.commands],
            "episodes": [result.to_json() for result in self.episodes.values()],
        }

    @classmethod
    def from_json(cls, values: Mapping[str, Any]) -> RunReport:
        """Reads a JSON object. Raises DamagedReportError for anything else."""
        try:
            if values["format"] != FORMAT or values["format_version"] != FORMAT_VERSION:
                raise DamagedReportError(f"it is no {FORMAT} of version {FORMAT_VERSION}")
            shard, count = values["shard"]
            results = [ItemRecord.from_json(result) for result in values["episodes"]]
            houses = values.get("houses")
            return cls(
                run=str(values["run"]),
                identity=str(values["identity"]),
                shard=(int(shard), int(count)),
                versions=dict(values["versions"]),
                commands=[Command.from_json(command) for command in values["commands"]],
                episodes={result.id: result for result in results},
                houses=None if houses is None else [int(house) for house in houses],
            )
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise DamagedReportError(f"{type(error).__name__}: {error}") from error


def report_path(dataset: Path, shard: tuple[int, int] = (0, 1)) -> Path:
    """Returns the path of a shard's report."""
    index, count = shard
    return dataset / ("report.json" if count == 1 else f"report-{index}-of-{count}.json")


def report_paths(dataset: Path) -> list[Path]:
    """Returns the reports of a dataset, the whole run's first."""
    whole = report_path(dataset)
    return [path for path in (whole, *sorted(dataset.glob("report-*-of-*.json"))) if path.is_file()]


def load(path: Path) -> RunReport:
    """Reads a report. Raises OSError without a file, DamagedReportError with its path."""
    try:
        text = path.read_bytes().decode()
        if damage := _core.json_damage(text):
            raise DamagedReportError(damage)
        return RunReport.from_json(json.loads(text))
    except (ValueError, DamagedReportError) as error:
        raise DamagedReportError(f"'{path}' is damaged: {error}") from error


def load_former(path: Path, warn: Callable[[str], object]) -> RunReport | None:
    """Reads the report of earlier commands; None without one.

    Sets a damaged one aside and warns of it. Raises OSError if that fails.
    """
    try:
        return load(path)
    except OSError:  # none
        return None
    except DamagedReportError as error:
        kept = set_aside(path)
        warn(f"{error}. It is kept as '{kept}'; the new one begins with this command")
        return None


def save(path: Path, report: RunReport) -> None:
    """Replaces a report in one step. Raises OSError if the disk fails."""
    values = {**report.to_json(), **UNSIGNED}
    text = _core.self_hashed_json(json.dumps(values, indent=1) + "\n")
    _core.atomic_write(path, text.encode())


def set_aside(path: Path) -> Path:
    """Moves a report to its dataset's folder of damaged files. Raises OSError on failure."""
    return path.parent / _core.set_aside(path.parent, path.name)


def whole(reports: Sequence[RunReport]) -> Totals:
    """Returns the totals of all reports of a dataset; counts each item once.

    Shards ran in parallel. If several reports contain an item, a later command retried it, for
    example the command printed for a failed item.
    """
    planned: set[int] = set()
    shards: list[Totals] = []
    later: list[Totals] = []
    for report in sorted(reports, key=lambda report: len(report.places), reverse=True):
        new = report.places and not planned.issuperset(report.places)
        (shards if new or not shards else later).append(report.totals)
        planned.update(report.places)
    totals = one_after_the_other([side_by_side(shards), *later])
    totals.planned = len(planned)
    totals.unmade = _unmade(reports)
    return totals


def unreported_shards(reports: Sequence[RunReport]) -> list[str]:
    """Returns the shards that others belong to and that have no report: ['1/2'].

    None is missing beside a report of the whole run.
    """
    shards = {report.shard for report in reports if report.commands}
    counts = {count for _, count in shards}
    if 1 in counts:
        return []
    return [
        f"{index}/{count}"
        for count in sorted(counts)
        for index in range(count)
        if (index, count) not in shards
    ]


def _unmade(reports: Sequence[RunReport]) -> list[Unmade]:
    """Returns the items that no report lists as made."""
    given_up = [unmade for report in reports for unmade in report.totals.unmade]
    made = {item.id for report in reports for item in report.episodes.values() if item.success}
    return list({unmade.id: unmade for unmade in given_up if unmade.id not in made}.values())


def identity_hash(identity: str) -> str:
    """Returns the SHA-256 of the text that identifies a run."""
    return hashlib.sha256(identity.encode()).hexdigest()


def utc_now() -> str:
    """Returns the time as '2026-01-31T12:00:00+00:00'."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def host_name() -> str:
    """This machine."""
    return socket.gethostname()
