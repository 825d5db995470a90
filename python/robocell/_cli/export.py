"""`robocell export`: writes a dataset in the format of a training stack."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

import robocell
from robocell import _core
from robocell._cli.common import (
    ExitCode,
    counting,
    fail,
    print_warning,
    require_folder,
    require_mapping,
)
from robocell._suggestions import counted
from robocell.export import FORMATS, Exported, export_dataset
from robocell.export._formats import require_format


def export(
    dataset: Annotated[Path, typer.Argument(metavar="DATASET", help="Folder of the dataset.")],
    out: Annotated[Path, typer.Argument(metavar="OUT", help="Folder to make.")],
    format: Annotated[
        str, typer.Option(metavar="NAME", help=f"One of: {', '.join(FORMATS)}.")
    ] = "lerobot-v3",
    actions: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="joints, joints_relative, tcp_pose, tcp_displacement, or columns of the episodes "
            "separated by commas. Default: joints, or those of --mapping.",
        ),
    ] = None,
    preset: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Names, image size and numbers as in another dataset: droid, libero, aloha, or a "
            "YAML file. For LeRobot formats.",
        ),
    ] = None,
    mapping: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="YAML file: the columns of each feature. docs/export.md has it."
        ),
    ] = None,
    cameras: Annotated[
        str | None,
        typer.Option(metavar="NAMES", help="Separated by commas; '' for none. Default: all."),
    ] = None,
    episodes: Annotated[
        str | None,
        typer.Option(metavar="WHICH", help="Ids or ranges separated by commas: 0:100,s0003_e0001."),
    ] = None,
    successes_only: Annotated[
        bool, typer.Option("--successes-only", help="Leave out the episodes that failed.")
    ] = False,
    keyframe_interval: Annotated[
        int | None,
        typer.Option(
            min=1,
            metavar="N",
            help="Encode videos again whose key frames are more than N frames apart. "
            "Default: copy them.",
        ),
    ] = None,
    pack: Annotated[
        bool,
        typer.Option(
            "--pack",
            help="Write a file for each episode first, and large files of them: a killed export "
            "loses one episode. For lerobot-v3.",
        ),
    ] = False,
    action_horizon: Annotated[
        int | None,
        typer.Option(
            min=1,
            metavar="N",
            help="Actions of a chunk in GR00T's configuration, for meta/relative_stats.json of "
            "lerobot-v2.1. Default: 16.",
        ),
    ] = None,
    depth: Annotated[
        bool,
        typer.Option("--depth", help="Export depth too. For robomimic, zarr, mcap, rerun."),
    ] = False,
    rate: Annotated[
        str | None,
        typer.Option(
            "--rate",
            "--fps",
            metavar="HZ",
            help="Rows per second: 15, 12.5 or 100/7. Rows show the nearest recorded row before, "
            "and videos are encoded again. Default: the rate of the episodes.",
        ),
    ] = None,
) -> None:
    """Write a dataset in the format of a training stack.

    OUT is complete or absent. After a kill, the same command continues.

    Exit codes:
    0  exported
    2  wrong command, mapping or selection; nothing to export
    3  a file cannot be read or written
    """
    require_format(format)
    require_folder(dataset, "dataset")
    _core.require_dataset(dataset)
    require_mapping(mapping)
    try:
        with counting() as count:
            result = export_dataset(
                robocell.Dataset(dataset),
                out,
                format,
                actions=actions,
                preset=preset,
                mapping=mapping,
                cameras=None if cameras is None else _list(cameras),
                episodes=None if episodes is None else _list(episodes),
                successes_only=successes_only,
                keyframe_interval=keyframe_interval,
                pack=pack,
                action_horizon=action_horizon,
                rate=rate,
                depth=depth,
                command=shlex.join(["robocell", *sys.argv[1:]]),
                on_episodes=count,
            )
    except robocell.IoError as error:
        fail(str(error), ExitCode.OUTPUT)
    except ModuleNotFoundError as error:
        fail(str(error))
    _print(result, format)


def _list(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _print(result: Exported, format: str) -> None:
    form = FORMATS[format]
    rate = f"at {result.fps} fps" if form.is_lerobot else f"at {result.rate:.6g} Hz"
    rate = rate if result.is_even else "at uneven times"
    print(
        f"{form.title}: {counted(result.episodes, 'episode')}, "
        f"{counted(result.frames, 'frame')} {rate}, "
        f"{counted(result.cameras, 'camera')}: {result.folder}"
    )
    if result.resumed:
        print(f"{counted(result.resumed, 'episode')} already written by an interrupted export")
    for camera, reason in result.encoded.items():
        print(f"{camera} was encoded again: {reason}")
    if result.left_out:
        print(f"not exported: {', '.join(result.left_out)}")
    if form.is_lerobot and result.rate != result.fps:
        print_warning(
            f"the episodes have {result.rate:.4f} rows per second and {form.title} needs a "
            f"whole number: timestamps count {result.fps} per second. No row was added or "
            f"left out; --rate {result.fps} resamples"
        )
