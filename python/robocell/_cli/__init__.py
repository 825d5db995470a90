"""The command line `robocell`. One file per command; `common` holds shared code."""

from __future__ import annotations

import importlib
import keyword
import sys
from collections.abc import Sequence
from typing import Annotated

import typer

from robocell import Error, __version__
from robocell._cli.common import ExitCode, print_error
from robocell._generation.streams import forgive_readers

# Each is a function in a module of its name.
COMMANDS = (
    "generate",
    "augment",
    "report",
    "verify",
    "replay",
    "merge",
    "split",
    "filter",
    "pack",
    "unpack",
    "export",
    "import",
    "evaluate",
    "benchmark",
    "serve-policy",
    "init",
    "convert",
    "make-houses",
    "check",
    "gripper-range",
    "ik-test",
    "reach",
    "view",
    "teleop",
    "add-object",
    "fetch",
    "identify",
    "doctor",
)


def _say_version(wanted: bool) -> None:
    if wanted:
        print(f"robocell {__version__}")
        raise typer.Exit


def options(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=_say_version,
            is_eager=True,
            help="Print the version. `robocell doctor` prints those of all parts.",
        ),
    ] = False,
) -> None:
    """Robot cells in MuJoCo: check robots, generate, verify and replay datasets."""


def load(arguments: Sequence[str]) -> typer.Typer:
    """Returns the command line for these arguments.

    It loads only the command that they begin with; all commands for the help and for an unknown
    name.
    """
    app = typer.Typer(
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
    )
    app.callback()(options)
    wanted = [name for name in COMMANDS if name in arguments[:1]] or COMMANDS
    for name in wanted:
        module = name.replace("-", "_") + ("_" if keyword.iskeyword(name) else "")
        app.command(name)(getattr(importlib.import_module(f"robocell._cli.{module}"), module))
    return app


def main(app: typer.Typer | None = None) -> None:
    """Runs a command. What the user can mend is reported without a traceback; see `ExitCode`.

    Args:
        app: What `load` returned; it is loaded here unless given.
    """
    forgive_readers()
    try:
        try:
            (app or load(sys.argv[1:]))(prog_name="robocell")
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()  # here a full disk is still reported
    except OSError as error:
        print_error(_text_of(error))
        sys.exit(ExitCode.OUTPUT)
    except Error as error:
        print_error(_text_of(error))
        sys.exit(ExitCode.USAGE)
    except KeyboardInterrupt:
        sys.exit(ExitCode.INTERRUPTED)
    except (SystemExit, GeneratorExit):
        raise
    except BaseException as error:
        from robocell._raised import is_of_own_code

        if not is_of_own_code(error):
            raise  # a defect of robocell
        print_error(_text_of(error))
        sys.exit(ExitCode.USAGE)


def _text_of(error: BaseException) -> str:
    from robocell._raised import text_with_place  # not needed by most commands

    return text_with_place(error)
