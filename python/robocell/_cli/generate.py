"""`robocell generate`: episodes from a run file, with worker processes. See docs/generate.md."""

from __future__ import annotations

import contextlib
import json
import os
import shlex
import sys
from collections.abc import Iterator, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated, NoReturn

import typer

from robocell import Error, RunConfig
from robocell._cli.common import ExitCode, fail, print_warning, print_wide, require_spec_file
from robocell._generation.disk import free_bytes
from robocell._generation.estimate import ProbeError, estimate
from robocell._generation.job import Job, Result
from robocell._generation.mixture import MixtureJob, is_mixture, load_mixture
from robocell._generation.procfs import age_s
from robocell._generation.progress import make_progress
from robocell._generation.ray_engine import RayEngine
from robocell._generation.resume import DamagedEpisodesError
from robocell._generation.run_source import RunSource
from robocell._generation.signals import interrupted_by_signals
from robocell._generation.summary import Summary
from robocell._generation.supervisor import Limits
from robocell._generation.totals import agreeing, size
from robocell._suggestions import counted

EXIT_CODES = {"spec": ExitCode.USAGE, "io": ExitCode.OUTPUT, "other": ExitCode.INCOMPLETE}


Options = dict[str, str | int | None]


class ProgressChoice(StrEnum):
    """`--progress`."""

    AUTO = "auto"
    BAR = "bar"
    PLAIN = "plain"
    JSONL = "jsonl"


class EngineChoice(StrEnum):
    """`--engine`."""

    LOCAL = "local"
    RAY = "ray"


WORKERS_PER_CORE = 8


def generate(
    run: Annotated[
        str,
        typer.Argument(
            metavar="RUN.yaml",
            help="The run file; or module:name or file.py:name of a RunConfig, or of a function "
            "that makes one.",
        ),
    ],
    imports: Annotated[
        list[str] | None,
        typer.Option(
            "--import",
            metavar="MODULE",
            help="A module or file.py to import first, which registers tasks and experts.",
        ),
    ] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Worker processes.")] = None,
    # A string, since Path("") would silently mean the working folder.
    output: Annotated[
        str | None,
        typer.Option(metavar="PATH", help="Folder of the dataset, relative to the working folder."),
    ] = None,
    episodes: Annotated[int | None, typer.Option(min=1, help="Number of episodes.")] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Seed of all random numbers of the run.")
    ] = None,
    render_kept: Annotated[
        bool,
        typer.Option(
            "--render-kept",
            help="Draw images only of kept rollouts, after they end; the same episodes.",
        ),
    ] = False,
    shard: Annotated[
        str | None,
        typer.Option(metavar="i/N", help="Make only every N-th episode, from the i-th on."),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="FIELD=VALUE", help="Replace a field: task.lift_height=0.05"),
    ] = None,
    engine: Annotated[
        EngineChoice,
        typer.Option(help="ray: make the episodes on the machines of a Ray cluster."),
    ] = EngineChoice.LOCAL,
    address: Annotated[
        str | None,
        typer.Option(metavar="HOST:PORT", help="Address of the Ray cluster."),
    ] = None,
    fetch: Annotated[
        bool,
        typer.Option(
            "--fetch",
            help="Fetch episodes from the machines' own disks, even if they see the dataset.",
        ),
    ] = False,
    progress: Annotated[
        ProgressChoice, typer.Option(help="auto: a bar on a terminal, else plain lines.")
    ] = ProgressChoice.AUTO,
    item_timeout: Annotated[
        float, typer.Option(min=1, help="Time limit per episode, s; it is then retried.")
    ] = Limits.item_timeout_s,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print the plan and an estimate; make nothing.")
    ] = False,
    cores: Annotated[
        int | None,
        typer.Option(
            min=1, help="With --dry-run: estimate the time on so many cores like this machine's."
        ),
    ] = None,
    no_report: Annotated[
        bool, typer.Option("--no-report", help="Print no table at the end.")
    ] = False,
) -> None:
    """Make the episodes of a run. Repeat the command to continue a run.

    Exit codes:
    0    all episodes are made
    1    some could not be made
    2    wrong command or spec
    3    reading or writing failed
    130  interrupted
    """
    source = RunSource(str(run), tuple(imports or ()))
    if not source.in_python:
        require_spec_file(Path(run), RunConfig)
    named = {"workers": workers, "output": output, "episodes": episodes, "seed": seed}
    render = ["render=kept"] if render_kept else []
    if cores is not None and not dry_run:
        fail("--cores is of the estimate: add --dry-run, or choose --workers")
    if engine is not EngineChoice.RAY and (address is not None or fetch):
        fail("--address and --fetch are of a Ray cluster: add --engine ray")
    if not source.in_python and is_mixture(run):
        if engine is EngineChoice.RAY:
            fail("--engine ray makes the episodes of one run: give it each run of the mixture")
        if shard is not None or episodes is not None:
            fail(
                "--shard and --episodes are of one run: write `episodes` beside a run in "
                f"'{run}', or generate its runs one by one"
            )
        make_mixture(
            source,
            [*(set_ or []), *render, *overrides({"seed": seed})],
            output=output,
            workers=workers,
            progress=progress,
            item_timeout=item_timeout,
            dry_run=dry_run,
            cores=cores,
            no_report=no_report,
        )
        return
    make_episodes(
        source,
        [*(set_ or []), *render],
        named,
        engine=RayEngine(address, fetch) if engine is EngineChoice.RAY else None,
        shard=shard,
        progress=progress,
        item_timeout=item_timeout,
        dry_run=dry_run,
        no_report=no_report,
        cores=cores,
    )


def make_episodes(
    source: RunSource,
    replaced: list[str],
    named: Options,
    *,
    shard: str | None,
    progress: ProgressChoice,
    item_timeout: float,
    dry_run: bool,
    no_report: bool,
    engine: RayEngine | None = None,
    cores: int | None = None,
) -> None:
    """Makes the episodes of a run and ends the command.

    Args:
        source: The run.
        replaced: Replaced fields, `--set` texts.
        named: Options that replace the fields of their names.
        shard: `--shard`.
        progress: How progress is shown.
        item_timeout: Time limit of an episode, seconds.
        dry_run: Print the plan and an estimate only.
        no_report: Print no table at the end.
        engine: Makes the episodes on other machines; None makes them on this one.
        cores: Cores of the estimate, each with a worker; None: those of this machine or the engine.
    """
    try:
        with interrupted_by_signals(), naming_typed_options(named):
            job = _open_job(source, [*replaced, *overrides(named)], shard, named, engine)
            if dry_run:
                for warning in job.check():
                    print_warning(warning)
                if cores is None and engine is not None:
                    cores = job.workers
                _say_plan(job, cores, as_json=progress is ProgressChoice.JSONL)
                return
            result = job.do(make_progress(progress.value), Limits(item_timeout_s=item_timeout))
    except KeyboardInterrupt:
        end_early()
    except ModuleNotFoundError as error:
        if engine is None or error.name != "ray":
            raise
        fail(str(error))
    except DamagedEpisodesError as error:
        fail(text_of_damage(str(error), job.dataset), ExitCode.OUTPUT)
    show_end(job.run.run, job.dataset, result, progress, no_report=no_report)


def show_end(
    name: str, dataset: Path, result: Result, progress: ProgressChoice, *, no_report: bool
) -> None:
    """Prints the table at the end of a run, and exits with its code."""
    nothing_tried = result.outcome.fatal and not result.outcome.totals.attempts
    if progress is not ProgressChoice.JSONL and not no_report and not nothing_tried:
        print_wide(Summary(name, dataset, result.on_disk, result.outcome.totals).table())
    _end(result, has_seen_items=progress is not ProgressChoice.JSONL)


def make_mixture(
    source: RunSource,
    replaced: list[str],
    *,
    output: str | None,
    workers: int | None,
    progress: ProgressChoice,
    item_timeout: float,
    dry_run: bool,
    cores: int | None,
    no_report: bool,
) -> None:
    """Makes the episodes of all runs of a mixture and ends the command.

    Args:
        source: The mixture file.
        replaced: Fields replaced in all runs, `--set` texts.
        output: `--output`.
        workers: `--workers`.
        progress: How progress is shown.
        item_timeout: Time limit of an episode, seconds.
        dry_run: Print the plans and estimates only.
        cores: `--cores`.
        no_report: Print no table at the end.
    """
    try:
        with interrupted_by_signals():
            mixture = load_mixture(
                source.run,
                imports=source.imports,
                overrides=replaced,
                output=output,
                workers=workers,
            )
            job = MixtureJob(mixture, replaced, most_workers())
            if dry_run:
                for warning in job.check():
                    print_warning(warning)
                as_json = progress is ProgressChoice.JSONL
                for part in job.parts.values():
                    _say_plan(part.in_turn(), cores, as_json=as_json)
                return
            result = job.do(make_progress(progress.value), Limits(item_timeout_s=item_timeout))
    except KeyboardInterrupt:
        end_early()
    except ModuleNotFoundError as error:
        fail(str(error))
    except DamagedEpisodesError as error:
        fail(text_of_damage(str(error), mixture.output), ExitCode.OUTPUT)
    show_end(mixture.name, job.dataset, result, progress, no_report=no_report)


def _open_job(
    source: RunSource,
    replaced: list[str],
    shard: str | None,
    named: Options,
    engine: RayEngine | None,
) -> Job:
    """Opens the job: at most `most_workers()` workers here, or one for each core of a cluster."""
    if engine is not None:
        asked = named.get("workers")
        cores = engine.connect()
        return Job(source, replaced, shard, engine=engine, workers=int(asked or max(1, cores)))
    job = Job(source, replaced, shard)
    if too_many := many_workers(job.run.workers):
        print_warning(too_many)
    if job.run.workers > most_workers():
        return Job(source, [*replaced, f"workers={most_workers()}"], shard)
    return job


def end_early() -> NoReturn:
    """Ends the command after Ctrl-C, or a signal like it, before workers exist."""
    again = resume_command(sys.argv[1:])
    print_warning(f"interrupted before the first episode.\nTo restart: {again}")
    raise typer.Exit(ExitCode.INTERRUPTED)


def text_of_damage(problems: str, dataset: Path) -> str:
    """Describes entries that block episodes, with the remedy."""
    text = f"these entries block episodes of the run:\n{problems}"
    if all(line.endswith("move it away yourself") for line in problems.splitlines()):
        return text
    remedy = shlex.join(["robocell", "verify", "--repair", str(dataset)])
    return f"{text}\nTo set damaged ones aside: {remedy}"


def many_workers(workers: int) -> str:
    """Returns a warning if there are more workers than cores; else ""."""
    cores = len(os.sched_getaffinity(0))
    if workers <= 2 * cores:
        return ""
    many = "1 core" if cores == 1 else f"{cores} cores"
    most = most_workers()
    started = f"{most} are started, and " if workers > most else ""
    return (
        f"{workers} workers on {many}: more workers than cores are not faster, and each needs its "
        f"own memory; "
        f"{started}--workers {cores} is enough"
    )


def most_workers() -> int:
    """Returns the largest number of workers that this machine can run."""
    return WORKERS_PER_CORE * len(os.sched_getaffinity(0))


def overrides(named: Options) -> list[str]:
    """Returns the given options as `--set` texts: {'workers': 2} -> ['workers=2']."""
    # A quoted JSON string is also a YAML string, whatever is in the path.
    return [
        f"{field}={json.dumps(value) if isinstance(value, str) else value}"
        for field, value in named.items()
        if value is not None
    ]


@contextlib.contextmanager
def naming_typed_options(named: Options) -> Iterator[None]:
    """Errors name the options as they were typed: `--output x`, not `--set output="x"`."""
    try:
        yield
    except Error as error:
        text = str(error)
        given = [(field, value) for field, value in named.items() if value is not None]
        for (field, value), override in zip(given, overrides(named), strict=True):
            typed = f"--{field} {shlex.quote(str(value))}"
            text = text.replace(f"--set {override}:", f"{typed}:")
        if text == str(error):
            raise
        raise type(error)(text) from None


def _say_plan(job: Job, cores: int | None, *, as_json: bool) -> None:
    """Prints the remaining work and an estimate, for which it makes a few episodes aside."""
    workers = cores or job.workers
    made = job.made()
    to_do = [item.index for item in job.items if item.id not in made]
    if not as_json:
        print(f"run:      {job.run.run}")
        print(f"dataset:  {job.dataset.absolute()}")
        print(f"episodes: {len(job.items)} planned, {len(made)} on the disk, {len(to_do)} to make")
        if job.run.randomize:
            print("randomize:")
            for line in job.run.randomize.describe():
                print(f"  {line}")
        print(f"workers:  {workers}", flush=True)
    if not to_do:
        return
    try:
        # Up to here it did what it does before it starts workers.
        found = estimate(job.source, job.overrides, to_do, workers, before_s=age_s(), cores=cores)
    except ProbeError as error:
        fail(f"no episode can be made: {error}", EXIT_CODES[error.failure.kind])
    if too_small := too_little_room(found.bytes, job.dataset):
        print_warning(too_small)
    if as_json:
        print(json.dumps({"event": "estimate", **found.to_json()}))
        return
    with_cameras = (
        f", {found.seen} with cameras" if job.run.cameras.draw and job.run.cameras.streams else ""
    )
    print(f"estimate (from {counted(found.tried, 'episode')}{with_cameras}):")
    for label, text in found.rows_of_text().items():
        print(f"  {label + ':':<10}{text}")
    if not found.successes:
        fail(f"none of the {found.tried} trials succeeded: see the reasons", ExitCode.INCOMPLETE)


def too_little_room(needed: int, dataset: Path) -> str:
    """Returns a warning if the disk has too little space; else ""."""
    free = free_bytes(dataset)
    if needed <= free:
        return ""
    return (
        f"the disk of '{dataset.absolute()}' is too small: about {size(needed)} are needed "
        f"({needed} bytes), {size(free)} are free there ({free} bytes). Make room, or name another "
        "folder (--output)"
    )


def _end(result: Result, *, has_seen_items: bool = True) -> None:
    """Prints the end of the run and exits with its code.

    `has_seen_items`: the errors of its items stand above.
    """
    outcome, planned = result.outcome, result.outcome.totals.planned
    verb = agreeing(result.on_disk, "is", "are")
    if outcome.fatal:
        there = counted(result.on_disk, "episode")
        kept = f"\n{there} {verb} on the disk." if result.on_disk else ""
        text = (has_seen_items and outcome.fatal.summary) or outcome.fatal.message
        fail(text + kept, EXIT_CODES[outcome.fatal.kind])
    if outcome.interrupted:
        again = resume_command(sys.argv[1:])
        print_warning(
            f"interrupted: {result.on_disk} of {planned} episodes {verb} on the disk.\n"
            f"To continue: {again}"
        )
        raise typer.Exit(ExitCode.INTERRUPTED)
    if result.on_disk < planned:
        missing = planned - result.on_disk
        fail(f"{missing} of {planned} episodes could not be made, see above", ExitCode.INCOMPLETE)


def resume_command(arguments: Sequence[str]) -> str:
    """Returns the command that continues the run: the one that was given."""
    return shlex.join(["robocell", *arguments])
