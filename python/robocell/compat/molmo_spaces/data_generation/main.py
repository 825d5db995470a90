"""Generates the data of a registered experiment.

    python -m robocell.compat.molmo_spaces.data_generation.main MODULE:NAME

It writes a run file beside the dataset and makes its episodes as `robocell generate` does. Repeat
the command to continue after an interruption.
"""

from __future__ import annotations

import argparse
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path

import robocell as rc
from robocell.compat.molmo_spaces._command import import_named, run_main
from robocell.compat.molmo_spaces.data_generation._run import write_run
from robocell.compat.molmo_spaces.data_generation.config_registry import (
    get_config_class,
    list_available_configs,
)

__all__ = ["main", "prepare"]


def prepare(experiment: str, folder: Path | None = None) -> Path:
    """Writes the run file of "module:name", or of a registered name, and returns its path.

    Warnings are printed to standard error. Raises NotFoundError for an unknown module or name.
    """
    module, colon, name = experiment.rpartition(":")
    if colon:
        import_named(module)
    elif not list_available_configs():
        raise rc.NotFoundError(
            f"no experiment '{experiment}': nothing is registered. Name its module too, as in "
            f"my_datagen:{experiment}"
        )
    kind = get_config_class(name)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        path = write_run(name, kind(), folder)  # type: ignore[call-arg]
    for warning in caught:
        if issubclass(warning.category, UserWarning):
            print(f"warning: {warning.message}", file=sys.stderr)
    return path


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command. Options after the experiment are those of `robocell generate`."""
    parser = argparse.ArgumentParser(
        prog="data_generation.main", description="Generate the data of a registered experiment."
    )
    parser.add_argument("experiment", metavar="MODULE:NAME", help="xarm7_datagen:XArm7Pick...")
    given, rest = parser.parse_known_args(arguments)
    path = prepare(given.experiment)
    from robocell.__main__ import run

    sys.argv = ["robocell", "generate", *rest, "--", str(path)]
    run()
    return 0


if __name__ == "__main__":
    run_main(main)
