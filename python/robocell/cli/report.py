"""`robocell report`: what is in a dataset, and what making it took."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any, cast

import typer
from rich.box import SIMPLE
from rich.table import Table

import robocell
from robocell import _core
from robocell.cli.common import (
    ExitCode,
    fail,
    print_error,
    print_warning,
    print_wide,
    require_folder,
)
from robocell.generate.items import ItemResult, counts_text, recorded_frames
from robocell.generate.report import DamagedReportError, RunReport, load, report_paths, whole
from robocell.generate.summary import Summary
from robocell.generate.totals import Totals, counted, size


@dataclass(frozen=True)
class OnDisk:
    """One episode as its files say."""

    id: str
    object_kind: str
    success: bool
    end_reason: str
    rows: int
    frames: int
    bytes: int

    @classmethod
    def of(cls, episode: robocell.data.Episode) -> OnDisk:
        """Counts an episode."""
        described = cast(dict[str, Any], episode.json)
        files = sum(facts["bytes"] for facts in described["files"].values())
        return cls(
            id=episode.id,
            object_kind=next(iter(described.get("metadata", {}).get("object_kinds", [])), ""),
            success=episode.success,
            end_reason=episode.end_reason,
            rows=episode.rows(),
            frames=recorded_frames(described),
            bytes=files + (episode.folder / "episode.json").stat().st_size,
        )


def report(
    dataset: Annotated[Path, typer.Argument(metavar="DATASET", help="Folder of the dataset.")],
    episodes: Annotated[
        bool, typer.Option("--episodes", help="Also print a table of all episodes.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead.")] = False,
) -> None:
    """Count the episodes of a dataset and show how they were made.

    Exit codes:
    0  counted
    2  wrong command
    3  a file cannot be read; the others are counted
    """
    require_folder(dataset, "dataset")
    _core.require_dataset(dataset)
    found, damaged, misnamed = _read(dataset)
    reports, unreadable = _load_all(dataset)
    if unreadable and not (found or reports or damaged):
        fail("\n".join(unreadable), ExitCode.OUTPUT)
    if not found and not reports and not damaged:
        fail(f"'{dataset}' holds no episodes and no report")
    if as_json:
        content = {**_json(found, damaged, reports), "misnamed": misnamed}
        print(json.dumps(content, indent=1))
    else:
        print_wide(_summary(dataset, found, reports).table())
        if episodes:
            print_wide(_episode_table(found, reports))
    for problem in (*damaged.values(), *unreadable):
        print_error(problem)
    if damaged or unreadable:
        raise typer.Exit(ExitCode.OUTPUT)


def _read(dataset: Path) -> tuple[list[OnDisk], dict[str, str], dict[str, str]]:
    """The episodes, what keeps the damaged ones, by their ids, from being read, and the misnamed.

    The latter are folders that were copied or renamed, with the ids of their episodes.
    """
    found, damaged = [], {}
    episodes = robocell.Dataset(dataset)
    for name in episodes.ids:
        try:
            found.append(OnDisk.of(episodes[name]))
        except robocell.IoError as error:
            damaged[name] = str(error)
    return found, damaged, dict(episodes.misnamed)


def _load_all(dataset: Path) -> tuple[list[RunReport], list[str]]:
    """Returns the reports, and the problems of those that are damaged."""
    reports, damaged = [], []
    for path in report_paths(dataset):
        try:
            if _is_its_own(dataset, path):
                reports.append(load(path))
        except DamagedReportError as error:
            damaged.append(f"{error}\nThe next `robocell generate` writes a new one")
    return reports, damaged


def _is_its_own(dataset: Path, report: Path) -> bool:
    """Whether a report is of the dataset's run; warns of another one."""
    run = _core.other_run_of(report.read_bytes().decode(errors="replace"), dataset)
    if run is not None:
        print_warning(
            f"'{report}' is of another run ('{run}'), and nothing in it counts: `robocell verify "
            "--repair` sets it aside"
        )
    return run is None


def _totals(reports: Sequence[RunReport]) -> Totals | None:
    """Of all commands that left a report; None without any."""
    return whole(reports) if reports else None


def _summary(dataset: Path, found: Sequence[OnDisk], reports: Sequence[RunReport]) -> Summary:
    good = sum(episode.success for episode in found)
    totals = _totals(reports)
    if totals is None and not report_paths(dataset):
        print_warning(
            "no report.json, so only the contents of the disk are reported: `robocell generate` "
            "writes one when it ends; a Runner writes none, nor does a command that still runs or "
            "was killed"
        )
    if totals is None:
        totals = Totals(planned=0)  # nobody knows
    more = {
        "commands": ", ".join(command.end for report in reports for command in report.commands),
        "on the disk": _contents(found),
        "ended": counts_text(_reasons(found)),
        "versions": ", ".join(f"{part} {number}" for part, number in _versions(reports).items()),
    }
    unrecorded = good - totals.made
    if reports and unrecorded > 0:
        more["not reported"] = (
            f"{counted(unrecorded, 'episode')}, made by commands that were killed"
        )
    name = reports[0].run if reports else dataset.name
    return Summary(name, dataset, good, totals, more)


def _contents(found: Sequence[OnDisk]) -> str:
    rows, frames = sum(e.rows for e in found), sum(e.frames for e in found)
    stored = sum(e.bytes for e in found)
    text = f"{counted(len(found), 'episode')}, {counted(rows, 'row')}, {counted(frames, 'frame')}"
    return f"{text}, {size(stored)}"


def _reasons(found: Sequence[OnDisk]) -> dict[str, int]:
    """End reason -> episodes, of those kept without success."""
    reasons = [episode.end_reason for episode in found if not episode.success]
    return {reason: reasons.count(reason) for reason in dict.fromkeys(reasons)}


def _versions(reports: Sequence[RunReport]) -> dict[str, str]:
    return {part: number for report in reports for part, number in report.versions.items()}


def _episode_table(found: Sequence[OnDisk], reports: Sequence[RunReport]) -> Table:
    table = Table(box=SIMPLE)
    texts = ("episode", "robot", "object", "end")
    for title in (*texts, "rows", "frames", "size", "attempts", "seconds"):
        table.add_column(title, justify="left" if title in texts else "right")
    told: dict[str, ItemResult] = {}
    for report in reports:
        told |= report.episodes
    for episode in found:
        known = told.get(episode.id)
        table.add_row(
            episode.id,
            (known.robot if known else "") or "-",
            episode.object_kind or "-",
            "success" if episode.success else episode.end_reason,
            str(episode.rows),
            str(episode.frames),
            size(episode.bytes),
            str(known.attempts) if known else "-",
            f"{sum(known.seconds.values()):.2f}" if known else "-",
        )
    kept = {episode.id for episode in found}
    for known in told.values():
        if known.success or known.stopped or known.id in kept:
            continue
        table.add_row(
            known.id,
            known.robot or "-",
            ", ".join(known.kinds) or "-",
            "given up",
            *("-",) * 3,
            str(known.attempts),
            f"{sum(known.seconds.values()):.2f}",
        )
    return table


def _json(
    found: Sequence[OnDisk], damaged: dict[str, str], reports: Sequence[RunReport]
) -> dict[str, Any]:
    totals = _totals(reports)
    return {
        "on_disk": [asdict(episode) for episode in found],
        "damaged": damaged,
        "totals": totals.record() if totals else None,
        "reports": [report.to_json() for report in reports],
    }
