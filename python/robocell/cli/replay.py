"""`robocell replay`: do the recorded controls give the recorded episode?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import robocell
from robocell import _core
from robocell._cells import load_cell
from robocell.cli.common import ExitCode, fail, print_error, require_file, require_folder
from robocell.generate.totals import counted

RECORD_SUFFIX = ".npy"


def replay(
    dataset: Annotated[
        Path,
        typer.Argument(
            metavar="DATASET", help="Folder of the dataset, or a record of an environment."
        ),
    ],
    episode: Annotated[
        str | None, typer.Argument(metavar="EPISODE", help="Its id; all of them unless given.")
    ] = None,
    _check: Annotated[
        bool, typer.Option("--check", hidden=True, help="What it does anyway.")
    ] = True,
    tolerance: Annotated[
        float, typer.Option(min=0, help="Differences up to this count as none: m, rad, m/s, s.")
    ] = 1e-9,
    env: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Of a record: the environment's configuration, or the name of a ready-made cell.",
        ),
    ] = None,
) -> None:
    """Simulate episodes again from their start and their recorded controls, and compare.

    The first step that comes out otherwise is named; an episode that cannot be read or replayed is
    told, and the others go on. A record is a file that EnvRecord.save wrote; it has no
    configuration, which --env gives. Exit codes: 0 all the same, 1 some differ, 2 wrong command or
    an episode that cannot be replayed, 3 a file cannot be read.
    """
    meant_as_file = env is not None or dataset.suffix == RECORD_SUFFIX
    if dataset.is_file() or (meant_as_file and not dataset.is_dir()):
        _replay_record(dataset, episode, env, tolerance)
    else:
        _replay_dataset(dataset, episode, env, tolerance)


def _replay_dataset(dataset: Path, episode: str | None, env: str | None, tolerance: float) -> None:
    require_folder(dataset, "dataset")
    if env is not None:
        fail(f"--env is for a record of an environment, a file; '{dataset}' is a folder")
    _core.require_dataset(dataset)
    episodes = robocell.Dataset(dataset)
    if episode is not None and episode not in episodes:
        episodes[episode]  # says which there are
    ids = [episode] if episode is not None else episodes.ids
    if not ids:
        fail(f"'{dataset}' has no episodes")
    differing, unread, unplayed = 0, 0, 0
    for name in ids:
        try:
            report = robocell.data.check_replay(episodes[name], tolerance)
        except robocell.IoError as error:
            print_error(str(error))
            unread += 1
        except robocell.Error as error:
            print_error(f"{name} cannot be replayed: {error}")
            unplayed += 1
        else:
            print(report, flush=True)
            differing += not report.ok
    _end(len(ids), differing=differing, unplayed=unplayed, unread=unread)


def _replay_record(file: Path, episode: str | None, env: str | None, tolerance: float) -> None:
    require_file(file, "record", RECORD_SUFFIX)
    if episode is not None:
        fail(f"'{file}' is one record; it has no episodes by id, leave {episode} out")
    if env is None:
        fail(
            f"'{file}' is a file: a dataset is a folder, and a record of an environment needs "
            "--env with its configuration"
        )
    try:
        record = robocell.envs.EnvRecord.load(str(file))
    except robocell.Error as error:
        fail(str(error), ExitCode.OUTPUT)
    try:
        config = load_cell(env)
        config.sim.realtime = False
        environment = robocell.Env(config)
        report = environment.replay(record, tolerance=tolerance)
    except robocell.Error as error:
        fail(f"{file} cannot be replayed: {error}")
    environment.close()
    if report.same:
        print(f"{file}: {counted(report.steps, 'step')}, all as recorded")
        return
    print(f"{file}: {report.difference}")
    raise typer.Exit(ExitCode.INCOMPLETE)


def _end(count: int, differing: int, unplayed: int, unread: int) -> None:
    """Counts what is not as recorded, and ends with the code of the worst."""
    told = (
        (differing, "differ" if count > 1 else "differs", ExitCode.INCOMPLETE),
        (unplayed, "cannot be replayed", ExitCode.USAGE),
        (unread, "cannot be read", ExitCode.OUTPUT),
    )
    for number, what, _ in told:
        if number:
            print(f"{number} of {counted(count, 'episode')} {what}")
    codes = [code for number, _, code in told if number]
    if codes:
        raise typer.Exit(codes[-1])
