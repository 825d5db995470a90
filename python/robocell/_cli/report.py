"""`robocell report`: content of a dataset and the effort of making it."""

from __future__ import annotations

import json
import math
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

import robocell
from robocell import _core
from robocell._cli.common import (
    ExitCode,
    fail,
    print_error,
    print_warning,
    print_wide,
    require_folder,
)
from robocell._generation.items import ItemRecord, counts_text
from robocell._generation.report import (
    DamagedReportError,
    RunReport,
    load,
    report_paths,
    unreported_shards,
    whole,
)
from robocell._generation.summary import Summary
from robocell._generation.totals import Totals, percent, size
from robocell._report.facts import EpisodeFacts, read
from robocell._suggestions import counted

# Keys of an episode in `--json`.
SHOWN = ("id", "object_kind", "success", "end_reason", "rows", "frames", "bytes")


def report(
    dataset: Annotated[Path, typer.Argument(metavar="DATASET", help="Folder of the dataset.")],
    episodes: Annotated[
        bool, typer.Option("--episodes", help="Also print a table of all episodes.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead.")] = False,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="FILE.html", help="Write a page with charts and pictures."
        ),
    ] = None,
    sample: Annotated[
        int | None,
        typer.Option(
            min=1,
            metavar="N",
            help="Read the time series of at most N episodes for the page. Default: 500.",
        ),
    ] = None,
    max_speed: Annotated[
        float | None,
        typer.Option(
            metavar="SPEED",
            help="On the page, count rows in which a joint is faster, rad/s or m/s.",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing page.")] = False,
) -> None:
    """Count the episodes of a dataset and show how they were made.

    With --output the report is one HTML file that needs no network.

    Exit codes:
    0  ok
    2  wrong command
    3  a file cannot be read or written; the others are counted
    """
    require_folder(dataset, "dataset")
    _core.require_dataset(dataset)
    if output:
        _require_page(output, force, {"--episodes": episodes, "--json": as_json}, max_speed)
    elif sample or max_speed is not None or force:
        fail("--sample, --max-speed and --force belong to a page: add --output FILE.html")
    found, damaged, misnamed = read(dataset)
    reports, unreadable = _load_all(dataset)
    if unreadable and not (found or reports or damaged):
        fail("\n".join(unreadable), ExitCode.OUTPUT)
    if not found and not reports and not damaged:
        fail(
            f"'{dataset}' holds no episodes and no report: give the `robocell generate` command of "
            "this dataset again, it goes on"
        )
    if output:
        contents = (dataset, found, reports, [*damaged.values(), *unreadable], misnamed)
        unreadable += _write_page(output, contents, sample, max_speed)
    elif as_json:
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


def _require_page(
    path: Path, force: bool, printed: Mapping[str, bool], max_speed: float | None
) -> None:
    """Ends the command unless a page can be written to `path`."""
    if others := [option for option, given in printed.items() if given]:
        fail(f"{' and '.join(others)} print, and --output writes a page: give one of them")
    if max_speed is not None and not 0 < max_speed < math.inf:
        fail(f"--max-speed {max_speed:g} is not a speed: give rad/s or m/s above 0")
    if path.is_dir():
        fail(f"'{path}' is a folder; give the page a name: '{path / 'report.html'}'")
    if path.suffix.lower() not in (".html", ".htm"):
        fail(f"reports are HTML files: give '{path.with_suffix('.html')}' instead of '{path}'")
    if os.path.lexists(path) and not force:
        fail(f"'{path}' exists. Replace it with --force, or give another name with -o")
    if not path.parent.is_dir():
        fail(f"cannot write '{path}': there is no folder '{path.parent}'", ExitCode.OUTPUT)
    if not os.access(path.parent, os.W_OK):
        fail(f"cannot write '{path}': the folder is not writable", ExitCode.OUTPUT)


def _write_page(
    path: Path, contents: tuple[Any, ...], sample: int | None, max_speed: float | None
) -> list[str]:
    """Writes the page, prints what it has, and returns the problems of what it could not read."""
    # With numpy, plotly and jinja2, which take longer to load than the printed form takes.
    from robocell._report.page import MOST_READ, Contents, load_packages, write

    try:
        load_packages()
    except ModuleNotFoundError as error:
        fail(str(error))
    whole = Contents(*contents)
    with Console(stderr=True).status("episodes") as status:
        try:
            page = write(
                whole,
                path,
                most_read=sample or MOST_READ,
                most_speed=max_speed,
                on_stage=lambda stage: status.update(stage),
            )
        except robocell.IoError as error:
            status.stop()
            fail(str(error), ExitCode.OUTPUT)
    print(
        f"{path}: {counted(len(whole.episodes), 'episode')}, time series of {page.read}, "
        f"pictures of {page.pictured}, {size(page.bytes)}"
    )
    return page.problems


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
    """Returns True if a report belongs to the dataset's run; warns about any other."""
    run = _core.other_run_of(report.read_bytes().decode(errors="replace"), dataset)
    if run is not None:
        print_warning(
            f"'{report}' is of another run ('{run}'), and nothing in it counts: `robocell verify "
            "--repair` sets it aside"
        )
    return run is None


def _totals(reports: Sequence[RunReport]) -> Totals | None:
    """Returns the totals of all commands with a report; None without any."""
    return whole(reports) if reports else None


def _summary(dataset: Path, found: Sequence[EpisodeFacts], reports: Sequence[RunReport]) -> Summary:
    good = sum(episode.success for episode in found)
    totals = _totals(reports)
    if totals is None and not report_paths(dataset) and not _is_unreported(dataset, found):
        print_warning(
            "no report.json, so only the contents of the disk are reported: `robocell generate` "
            "writes one when it ends; a Runner writes none, nor does a command that still runs or "
            "was killed"
        )
    if totals is None:
        totals = Totals(planned=0)  # nobody knows
    ends = Counter(command.end for report in reports for command in report.commands)
    more = {
        **({} if totals.attempts else {"success": _share_of(found)}),
        "commands": ", ".join(f"{number} {end}" for end, number in ends.items()),
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
    return Summary(
        name, dataset, good, totals, more, max(1, len(reports)), unreported_shards(reports)
    )


def _is_unreported(dataset: Path, found: Sequence[EpisodeFacts]) -> bool:
    """Returns True if an environment recorded the episodes, or an import made them.

    No command writes a report about them.
    """
    if not found:
        return False
    metadata: Any = robocell.Dataset(dataset)[found[0].id].metadata
    recorded = "environment" in metadata and not (dataset / "dataset.json").exists()
    return recorded or "imported" in metadata


def _share_of(found: Sequence[EpisodeFacts]) -> str:
    """Returns '67 % (3 episodes)', or "" without any."""
    good = sum(episode.success for episode in found)
    share = good / len(found) if found else None
    return f"{percent(share)} ({counted(len(found), 'episode')})" if found else ""


def _contents(found: Sequence[EpisodeFacts]) -> str:
    rows, frames = sum(e.rows for e in found), sum(e.frames for e in found)
    stored = sum(e.bytes for e in found)
    text = f"{counted(len(found), 'episode')}, {counted(rows, 'row')}, {counted(frames, 'frame')}"
    return f"{text}, {size(stored)}"


def _reasons(found: Sequence[EpisodeFacts]) -> dict[str, int]:
    """Returns end reason -> number of stored episodes without success."""
    reasons = [episode.end_reason for episode in found if not episode.success]
    return {reason: reasons.count(reason) for reason in dict.fromkeys(reasons)}


def _versions(reports: Sequence[RunReport]) -> dict[str, str]:
    return {part: number for report in reports for part, number in report.versions.items()}


def _episode_table(found: Sequence[EpisodeFacts], reports: Sequence[RunReport]) -> Table:
    table = Table(box=SIMPLE)
    texts = ("episode", "robot", "object", "end")
    for title in (*texts, "rows", "frames", "size", "attempts", "seconds"):
        table.add_column(title, justify="left" if title in texts else "right")
    records: dict[str, ItemRecord] = {}
    for report in reports:
        records |= report.episodes
    for episode in found:
        known = records.get(episode.id)
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
    for known in records.values():
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


def _randomized(found: Sequence[EpisodeFacts]) -> dict[str, Any]:
    """Returns the values that `randomize` drew, those first that explain most of the failures."""
    if not any(episode.randomized for episode in found):
        return {}
    from robocell._report import variation  # with numpy

    effects = [
        {
            "name": effect.name,
            "range": effect.range,
            "explained": effect.share,
            "groups": [
                {
                    "name": group.name,
                    "successes": group.successes,
                    "rollouts": group.rollouts,
                    "interval": group.interval,
                }
                for group in effect.groups
            ],
        }
        for effect in variation.effects(found)
    ]
    return {"randomized": effects}


def _json(
    found: Sequence[EpisodeFacts], damaged: dict[str, str], reports: Sequence[RunReport]
) -> dict[str, Any]:
    totals = _totals(reports)
    return {
        "on_disk": [{key: getattr(episode, key) for key in SHOWN} for episode in found],
        "damaged": damaged,
        "totals": totals.record() if totals else None,
        **_randomized(found),
        "reports": [report.to_json() for report in reports],
    }
