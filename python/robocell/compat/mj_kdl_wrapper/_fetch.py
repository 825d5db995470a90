"""``mj-kdl-fetch-menagerie``: the robots and assets of the examples, and where they are."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from robocell import Error
from robocell._cli.common import ExitCode, print_error
from robocell.compat.mj_kdl_wrapper import menagerie


def fetch(
    dest: Annotated[
        Path | None, typer.Option(help="Also fill this folder with assets/ and menagerie/.")
    ] = None,
) -> None:
    """Fetch the robots of the examples into the cache, and print where models and assets are."""
    for name, path in menagerie.fetch(dest).items():
        print(f"{name}: {path}")


def main() -> None:
    """The console script."""
    try:
        typer.run(fetch)
    except OSError as error:
        print_error(str(error))
        sys.exit(ExitCode.OUTPUT)
    except Error as error:
        print_error(str(error))
        sys.exit(ExitCode.USAGE)


if __name__ == "__main__":
    main()
