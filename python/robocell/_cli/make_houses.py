"""`robocell make-houses`: generated houses."""

from __future__ import annotations

import os
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Annotated

import typer

from robocell import Error
from robocell._cli.common import ExitCode, counting, fail, print_error
from robocell._suggestions import counted
from robocell.scenes import (
    HouseOptions,
    HouseSummary,
    has_house,
    make_house,
    prepare_house_folder,
)

MOST_HOUSES = 1_000_000
SHOWN_FAILURES = 8


def make_houses(
    out: Annotated[Path, typer.Argument(metavar="OUT", help="The folder of the houses.")],
    count: Annotated[int, typer.Option("-n", "--count", help="How many houses.")] = 20,
    seed: Annotated[int, typer.Option(help="Seed of all houses.")] = 0,
    first: Annotated[int, typer.Option(help="Number of the first house.")] = 0,
    rooms: Annotated[
        tuple[int, int], typer.Option(help="Smallest and largest number of rooms.")
    ] = (3, 6),
    objects: Annotated[int, typer.Option(help="Most objects in a house.")] = 40,
    workers: Annotated[
        int | None, typer.Option(help="Threads. Default: the number of processors.")
    ] = None,
) -> None:
    """Generate houses with rooms, furniture and objects.

    House i of a seed is always the same. Each house has a model with and without a ceiling, a map
    of its free floor and metadata of its objects; houses that the folder has already are kept. Use
    them with `scenes: {source: houses, root: OUT}`.
    """
    if not 1 <= count <= MOST_HOUSES:
        fail(f"--count is {count}; give 1 to {MOST_HOUSES}")
    if first < 0:
        fail(f"--first is {first}; houses count from 0")
    if seed < 0:
        fail(f"--seed is {seed}; give a number from 0 on")
    if workers is not None and workers < 1:
        fail(f"--workers is {workers}; give a number from 1 on")
    options = HouseOptions(seed=seed, rooms=rooms, most_objects=objects)
    prepare_house_folder(out, options)
    wanted = range(first, first + count)
    missing = [index for index in wanted if not has_house(out, options, index)]
    start = time.monotonic()

    made: list[HouseSummary] = []
    failed: dict[int, Error] = {}

    def make(index: int) -> None:
        try:
            made.append(make_house(out, options, index))
        except Error as error:
            failed[index] = error

    pool = ThreadPoolExecutor(workers or len(os.sched_getaffinity(0)))
    with pool, counting("houses") as count_to:
        try:
            for done, _ in enumerate(pool.map(make, missing), 1):
                count_to(done, len(missing))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    seconds = time.monotonic() - start
    totals = {
        name: sum(getattr(house, name) for house in made)
        for name in ("rooms", "pieces", "joints", "objects", "removed")
    }
    print(f"houses:    {len(made)} made, {count - len(missing)} there already")
    if made:
        print(f"rooms:     {totals['rooms']}")
        print(f"furniture: {totals['pieces']} pieces, {totals['joints']} doors and drawers")
        print(f"objects:   {totals['objects']} ({totals['removed']} left out, not at rest)")
        print(f"time:      {seconds:.1f} s ({len(made) / seconds:.1f} houses/s)")
    if failed:
        some = ", ".join(f"{index} ({failed[index]})" for index in sorted(failed)[:SHOWN_FAILURES])
        more = f" and {len(failed) - SHOWN_FAILURES} more" if len(failed) > SHOWN_FAILURES else ""
        print_error(f"{counted(len(failed), 'house')} could not be made: {some}{more}")
        raise typer.Exit(ExitCode.INCOMPLETE)
    print(f"Use them with: scenes: {{source: houses, root: {out}}}")
