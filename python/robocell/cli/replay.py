"""`robocell replay`: do the recorded controls, or actions, give the recorded episode?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

import robocell
from robocell import _core, data
from robocell._cells import load_cell
from robocell._own_code import RAISED
from robocell.cli.common import ExitCode, fail, print_error, print_warning, require_folder
from robocell.dataset_run import manifest_of_dataset, run_of_dataset
from robocell.generate.run_source import import_named, is_of_own_code, text_with_place
from robocell.generate.totals import counted


def replay(
    dataset: Annotated[Path, typer.Argument(metavar="DATASET", help="Folder of the dataset.")],
    episode: Annotated[
        str | None, typer.Argument(metavar="EPISODE", help="Id of one episode. Default: all.")
    ] = None,
    _check: Annotated[
        bool, typer.Option("--check", hidden=True, help="What it does anyway.")
    ] = True,
    tolerance: Annotated[
        float, typer.Option(min=0, help="Differences up to this count as none: m, rad, m/s, s.")
    ] = 1e-9,
    actions: Annotated[
        bool,
        typer.Option(
            "--actions",
            help="Give an environment its recorded actions again, instead of the controls.",
        ),
    ] = False,
    env: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Like --actions, in the environment of another configuration or ready-made cell.",
        ),
    ] = None,
    imports: Annotated[
        list[str] | None,
        typer.Option(
            "--import",
            metavar="MODULE",
            help="A module or library (libstack.so) that registers tasks or features. "
            "Its code must be the code that made the episodes.",
        ),
    ] = None,
) -> None:
    """Simulate episodes again with their recorded controls, and compare.

    With --actions or --env the environment gets the actions again, and its
    observations and rewards are compared. With --import the code of the task
    and its features must be that of the dataset. The first step that differs
    is printed. An episode that cannot be replayed does not stop the others.

    Exit codes:
    0  all the same
    1  some differ
    2  wrong command, or an episode that cannot be replayed
    3  a file cannot be read
    """
    require_folder(dataset, "dataset")
    for module in imports or ():
        import_named(module, Path.cwd())
    _core.require_dataset(dataset)
    episodes = robocell.Dataset(dataset)
    if episode is not None and episode not in episodes:
        episodes[episode]  # says which there are
    ids = [episode] if episode is not None else episodes.ids
    if not ids:
        fail(f"'{dataset}' has no episodes")
    if imports:
        _require_same_code(episodes)
    environment = _environment(env) if env is not None else None
    differing, unread, unplayed = 0, 0, 0
    for name in ids:
        try:
            result = _result(episodes[name], tolerance, actions, environment)
        except robocell.IoError as error:
            print_error(str(error))
            unread += 1
        except RAISED as error:
            if not isinstance(error, robocell.Error) and not is_of_own_code(error):
                raise
            print_error(f"{name} cannot be replayed: {text_with_place(error)}")
            unplayed += 1
        else:
            print(result, flush=True)
            differing += not result.ok
    _end(len(ids), differing=differing, unplayed=unplayed, unread=unread)


def _require_same_code(dataset: robocell.Dataset) -> None:
    """Ends the command when modules that were imported are not those of a generated dataset.

    Episodes of environments look at their code themselves. Without a dataset.json nothing is
    compared.
    """
    metadata: Any = dataset[0].metadata
    if "identity" not in metadata:
        return
    manifest = manifest_of_dataset(dataset.folder)
    if manifest is None:
        print_warning(
            f"'{dataset.folder}' has no dataset.json: the code that was imported is not compared"
        )
        return
    try:
        run_of_dataset(dataset.folder)
    except robocell.SpecError as error:
        fail(f"{error}. Without --import only the recorded controls are simulated")
    if any(name.startswith("code/") for name in manifest.get("files", ())):
        print("code: unchanged since the dataset was made")


def _environment(name: str) -> robocell.Env:
    try:
        config = load_cell(name)
        config.sim.realtime = False
        config.cameras.streams.clear()
        return robocell.Env(config)
    except RAISED as error:
        fail(text_with_place(error))


def _result(
    episode: robocell.data.Episode, tolerance: float, actions: bool, env: robocell.Env | None
) -> robocell.data.ReplayResult:
    if env is not None:
        return data.replay_actions(env, episode, tolerance=tolerance)
    if not actions:
        return robocell.data.verify_replay(episode, tolerance)
    own = data.env_of_episode(episode)
    try:
        return data.replay_actions(own, episode, tolerance=tolerance)
    finally:
        own.close()


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
