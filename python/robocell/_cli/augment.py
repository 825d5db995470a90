"""`robocell augment`: many episodes from few, moved to new starts. See docs/augment.md."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robocell import RunConfig
from robocell._cli.common import require_run_source, require_spec_file
from robocell._cli.generate import Options, ProgressChoice, make_episodes
from robocell._dataset_run import naming_where_to_augment, seed_of_dataset
from robocell._generation.run_source import RunSource
from robocell._generation.supervisor import Limits


def augment(
    dataset: Annotated[
        str,
        typer.Argument(metavar="DATASET", help="The dataset with the source episodes."),
    ],
    episodes: Annotated[
        int, typer.Option("--episodes", "-n", min=1, help="Number of episodes to make.")
    ],
    output: Annotated[
        str | None,
        typer.Option(
            "--output",
            "-o",
            metavar="PATH",
            help="Folder of the new dataset. Default: DATASET_augmented.",
        ),
    ] = None,
    run: Annotated[
        str | None,
        typer.Option(
            metavar="RUN.yaml",
            help="The run file with robot, task and starts. Default: the run that made DATASET.",
        ),
    ] = None,
    imports: Annotated[
        list[str] | None,
        typer.Option(
            "--import",
            metavar="MODULE",
            help="A module or file.py to import first, which registers tasks.",
        ),
    ] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Worker processes.")] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            min=0,
            help="Seed of the starts. Default: that of the run file, else the dataset's plus 1.",
        ),
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
        typer.Option(
            "--set", metavar="FIELD=VALUE", help="Replace a field: augment.translation_noise=0.001"
        ),
    ] = None,
    progress: Annotated[
        ProgressChoice, typer.Option(help="auto: a bar on a terminal, else plain lines.")
    ] = ProgressChoice.AUTO,
    item_timeout: Annotated[
        float, typer.Option(min=1, help="Time limit per episode, s; it is then retried.")
    ] = Limits.item_timeout_s,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print the plan and an estimate; make nothing.")
    ] = False,
    no_report: Annotated[
        bool, typer.Option("--no-report", help="Print no table at the end.")
    ] = False,
) -> None:
    """Make many episodes from few: move their parts to new starts. Repeat it to continue.

    Exit codes:
    0    all episodes are made
    1    some could not be made
    2    wrong command or spec
    3    reading or writing failed
    130  interrupted
    """
    require_run_source(dataset)
    if not Path(dataset).is_dir():
        raise typer.BadParameter(f"'{dataset}' is not a dataset", param_hint="DATASET")
    source = RunSource(run or dataset, tuple(imports or ()), augment=dataset)
    if run is not None and not source.in_python:
        require_spec_file(Path(run), RunConfig)
    if run is None and seed is None:
        with naming_where_to_augment():
            seed = seed_of_dataset(dataset) + 1
    folder = output or f"{dataset.rstrip('/')}_augmented"
    if Path(folder).absolute() == Path(dataset).absolute():
        raise typer.BadParameter("is the source itself", param_hint="--output")
    named: Options = {"workers": workers, "output": folder, "episodes": episodes, "seed": seed}
    render = ["render=kept"] if render_kept else []
    make_episodes(
        source,
        ["keep=successes", *(set_ or []), *render],
        named,
        shard=shard,
        progress=progress,
        item_timeout=item_timeout,
        dry_run=dry_run,
        no_report=no_report,
    )
