"""`robocell fetch`: robots of the MuJoCo Menagerie, downloaded and pinned."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from robocell import IoError
from robocell import _fetching as fetching
from robocell._cli.common import ExitCode, fail, print_warning, print_wide

MEGABYTE = 1_000_000


def fetch(
    robots: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[ROBOT]...",
            help="Names in the Menagerie (default: the examples'), or parts of names with --list.",
        ),
    ] = None,
    listing: Annotated[
        bool, typer.Option("--list", help="List all robots, and which are on this machine.")
    ] = False,
    dest: Annotated[
        Path | None,
        typer.Option(help="Also copy the robots into this folder, for use as MENAGERIE_ROOT."),
    ] = None,
    update: Annotated[
        bool, typer.Option("--update", help="Update to the newest version of the package.")
    ] = False,
) -> None:
    """Fetch robots of the MuJoCo Menagerie, for `menagerie:` names.

    The package mujoco-menagerie downloads them into its cache. robocell
    records the version and a hash of every file, and keeps this version
    until --update. Exit code 3 if a download fails.
    """
    if listing:
        print_wide(_table(robots or []))
        return
    try:
        for robot in robots or fetching.EXAMPLE_ROBOTS:
            _fetch(robot, dest, update)
    except IoError as error:
        fail(str(error), ExitCode.OUTPUT)
    if dest:
        print(f"use them with MENAGERIE_ROOT={dest.resolve()}")
    elif root := os.environ.get("MENAGERIE_ROOT"):
        print_warning(f"MENAGERIE_ROOT is {root}: models there take precedence over the cache")


def _fetch(robot: str, dest: Path | None, update: bool) -> None:
    fetched = fetching.fetch(robot, update=update, progress=fetching.printed_progress())
    folder = fetching.copy_to(fetched, dest, update=update) if dest else fetched.folder
    note = "; the package has another version: use --update to get it" if fetched.newer else ""
    print(f"{robot}: {folder} (Menagerie {fetched.pin.commit[:12]}){note}", flush=True)


def _table(words: list[str]) -> Table:
    record = fetching.read_record(fetching.record_path())
    table = Table("robot", "kind", "license", "MB", "here", box=None)
    found = fetching.robots_like(words)
    if not found:
        wanted = " or ".join(f"'{word}'" for word in words)
        fail(f"no robot has {wanted} in its name. `robocell fetch --list` lists all robots.")
    for robot in found:
        pin = record.get(robot.name)
        here = "yes" if fetching.is_here(robot.name, robot.oid) else ""
        if pin and fetching.is_here(robot.name, pin.tree):
            here = f"pinned to {pin.commit[:12]}"
        size = f"{(robot.download_size or 0) / MEGABYTE:.1f}"
        table.add_row(robot.name, robot.category, robot.license, size, here)
    return table
