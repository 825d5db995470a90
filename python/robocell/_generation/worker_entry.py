"""The entry of worker processes: their command, and the `main` of modules that are workers."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from typing import NoReturn

from robocell._core import StopFlag
from robocell._ending import end_in_time
from robocell._generation.own_process import own_process
from robocell._generation.run_source import RunSource
from robocell._generation.worker import MakeEpisode, serve


def worker_command(module: str, source: RunSource, options: Sequence[str]) -> list[str]:
    """Returns the command that starts a module as a worker for a run, with options of its own."""
    return [*own_process(module), *source.options(), *options, "--", source.run]


def run_worker(
    parser: argparse.ArgumentParser,
    open_maker: Callable[[argparse.Namespace, StopFlag], MakeEpisode],
) -> NoReturn:
    """Works until the supervisor has no more items, and ends the process.

    Args:
        parser: Knows the module's own options.
        open_maker: Loads the run and returns the function that makes episodes.
    """
    RunSource.add_options(parser)
    arguments = parser.parse_args()
    stop = StopFlag()
    code = serve(lambda: open_maker(arguments, stop), stop)
    end_in_time(code)
    sys.exit(code)
