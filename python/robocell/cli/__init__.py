"""The command line `robocell`. One file per command; what they share is in `common`."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from robocell import Error, __version__
from robocell.cli.check import check
from robocell.cli.common import ExitCode, print_error
from robocell.cli.doctor import doctor
from robocell.cli.fetch import fetch
from robocell.cli.generate import generate
from robocell.cli.gripper_range import gripper_range
from robocell.cli.ik_test import ik_test
from robocell.cli.reach import reach
from robocell.cli.replay import replay
from robocell.cli.report import report
from robocell.cli.verify import verify

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def _say_version(wanted: bool) -> None:
    if wanted:
        print(f"robocell {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=_say_version,
            is_eager=True,
            help="The version, and no more; `robocell doctor` has those of all parts.",
        ),
    ] = False,
) -> None:
    """Robot cells in MuJoCo: check robots, generate, verify and replay datasets."""


for command in (
    generate,
    report,
    verify,
    replay,
    check,
    gripper_range,
    ik_test,
    reach,
    fetch,
    doctor,
):
    app.command()(command)


def main() -> None:
    """Runs a command. What the user can mend is told without a traceback; see `ExitCode`."""
    try:
        app(prog_name="robocell")
    except OSError as error:
        print_error(str(error))
        sys.exit(ExitCode.OUTPUT)
    except Error as error:
        print_error(str(error))
        sys.exit(ExitCode.USAGE)
    except KeyboardInterrupt:
        sys.exit(ExitCode.INTERRUPTED)
