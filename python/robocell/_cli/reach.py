"""`robocell reach`: where a robot's TCP can be, and how freely it turns there."""

from __future__ import annotations

import os
import re
import time
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from robocell._cli.common import ExitCode, fail, print_warning
from robocell._cli.robot_scene import load_robot

if TYPE_CHECKING:
    from robocell import Robot

SUFFIXES = (".npz", ".png", ".html")
FULL_POSE = 6  # joints that it takes
PLANE = re.compile(r"\s*([xyz])\s*=\s*([-+0-9.eE]+)\s*")


class Axis(StrEnum):
    """An axis of the TCP frame."""

    X = "x"
    Y = "y"
    Z = "z"

    @property
    def vector(self) -> tuple[float, float, float]:
        """Returns the axis as a unit vector."""
        x, y, z = (float(self == axis) for axis in Axis)
        return x, y, z


def reach(
    robot_file: Annotated[Path, typer.Argument(metavar="ROBOT.yaml", help="The robot file.")],
    plane: Annotated[
        str | None,
        typer.Option(metavar="AXIS=METRES", help="Map one layer of cells: z=0.4."),
    ] = None,
    volume: Annotated[
        bool, typer.Option("--volume", help="Map the whole space around the robot.")
    ] = False,
    cell: Annotated[float, typer.Option(min=1e-3, help="Edge of a cell, m.")] = 0.05,
    rotations: Annotated[int, typer.Option(min=1, help="Rotations tried in each cell.")] = 64,
    axis: Annotated[
        Axis | None,
        typer.Option(help="Only this axis of the TCP matters: for arms of 5 joints."),
    ] = None,
    position_only: Annotated[
        bool,
        typer.Option("--position-only", help="Any rotation counts: for arms of 3 or 4 joints."),
    ] = False,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="NAME", help="Write NAME.npz, NAME.png and NAME.html."
        ),
    ] = None,
) -> None:
    """Map the reach of a robot in its base frame, and write three files.

    At the centre of each cell the command tries evenly spread rotations of
    the TCP. The map holds the share that inverse kinematics solves within the
    limits, and the mean manipulability of the solutions. Collisions do not
    count. NAME.npz has the numbers, NAME.png a picture, NAME.html a page.
    """
    layer = _layer(plane, volume)
    if axis and position_only:
        fail("--axis and --position-only exclude each other: take one")
    # With numpy and pyplot, which take longer to load than all that the other commands need.
    from robocell._cli.reach_map import corners, draw, load_plots, save, write_page

    try:
        load_plots()
    except ModuleNotFoundError as error:
        fail(str(error))

    robot = load_robot(robot_file).robot
    joints = len(robot.kinematics.joint_names)
    if joints < FULL_POSE and not (axis or position_only):
        print_warning(
            f"with {joints} joints {robot.name} reaches hardly any full rotation, so "
            "the map says little of where it gets to: add --axis z (where the TCP's z axis points; "
            "or x, y) or --position-only"
        )
    name = output or Path(f"{robot.name}_reach")
    if name.suffix in SUFFIXES:
        name = name.with_suffix("")
    if not name.parent.is_dir():
        fail(f"cannot write '{name}.npz': there is no folder '{name.parent}'", ExitCode.OUTPUT)
    lower, upper = corners(robot, layer)
    begin = time.perf_counter()
    found = robot.kinematics.reach_map(
        lower,
        upper,
        cell=cell,
        rotations=rotations,
        threads=len(os.sched_getaffinity(0)),
        position_only=position_only,
        axis=axis and axis.vector,
    )
    seconds = time.perf_counter() - begin
    numbers, picture, page = (name.with_name(name.name + suffix) for suffix in SUFFIXES)
    save(numbers, found)
    draw(picture, robot.name, found)
    write_page(page, robot.name, found)
    poses = found.fraction.size * found.rotations
    reached = float((found.fraction > 0).mean())
    print(
        f"{robot.name}: {found.fraction.size} cells of {cell:g} m, {poses} poses in {seconds:.1f} s"
    )
    print(
        f"reached: {100 * reached:.1f} % of the cells, "
        f"{100 * float(found.fraction.mean()):.1f} % of the poses"
    )
    if not reached:
        _say_where_it_reaches(robot, layer, position_only=position_only)
    print(f"written: {numbers}, {picture}, {page}")


def _say_where_it_reaches(
    robot: Robot, layer: tuple[int, float] | None, *, position_only: bool
) -> None:
    lower, upper = robot.kinematics.reach_box()
    if not position_only and (layer is None or lower[layer[0]] <= layer[1] <= upper[layer[0]]):
        print_warning(
            "none of the rotations that were tried is reached there: --position-only maps "
            "where the TCP gets, however it is turned"
        )
        return
    box = ", ".join(
        f"{axis} from {low:.2f} to {high:.2f} m"
        for axis, low, high in zip("xyz", lower, upper, strict=True)
    )
    where = f"with {'xyz'[layer[0]]} = {layer[1]:g} m" if layer else "there"
    print_warning(f"nothing {where} is reached; {robot.name}'s TCP is never beyond {box}")


def _layer(plane: str | None, volume: bool) -> tuple[int, float] | None:
    """Returns the axis and the position of a plane; None for the volume."""
    if (plane is None) == (not volume):
        fail("give one of --plane AXIS=METRES (as --plane z=0.4) and --volume")
    if plane is None:
        return None
    match = PLANE.fullmatch(plane)
    try:
        return "xyz".index(match[1]), float(match[2])  # type: ignore[index]
    except (TypeError, ValueError):
        fail(f"--plane '{plane}' is not a plane: write x, y or z, = and metres, as --plane z=0.4")
