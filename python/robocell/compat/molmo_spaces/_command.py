"""What the package's commands share: modules by name, and errors without a traceback."""

from __future__ import annotations

import importlib
import inspect
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

import robocell as rc
from robocell._cli.common import ExitCode
from robocell._suggestions import did_you_mean, shortened

ORIGINAL, OURS = "molmo_spaces", "robocell.compat.molmo_spaces"


def import_named(name: str) -> ModuleType:
    """Imports a module, also one of the working folder, or of the original's name.

    Raises NotFoundError for a module that there is not; other errors pass.
    """
    if name == ORIGINAL or name.startswith(f"{ORIGINAL}."):
        name = OURS + name.removeprefix(ORIGINAL)
    if str(Path.cwd()) not in sys.path:
        sys.path.insert(0, str(Path.cwd()))
    try:
        return importlib.import_module(name.removesuffix(".py"))
    except ModuleNotFoundError as error:
        missing = error.name or ""
        if missing != name and not name.startswith(f"{missing}."):
            raise _without(name, missing) from error
        files = sorted(path.stem for path in Path.cwd().glob("*.py"))
        raise rc.NotFoundError(
            f"no module '{name}' in '{Path.cwd()}'. Modules there: {shortened(files) or 'none'}."
            f"{did_you_mean(name, files)}"
        ) from error


def _without(name: str, missing: str) -> rc.NotFoundError:
    """Returns the error for a module that imports one that there is not."""
    if missing.partition(".")[0] == ORIGINAL:
        return rc.NotFoundError(
            f"module '{name}' imports '{ORIGINAL}', which is not installed. With robocell the "
            f"package is called '{OURS}': write this name in its imports"
        )
    if missing.startswith(f"{OURS}."):
        return rc.NotFoundError(
            f"module '{name}' imports '{missing}', which robocell does not have: "
            "docs/compat_molmo_spaces.md lists the modules"
        )
    return rc.NotFoundError(f"module '{name}' imports '{missing}', which is not installed")


def config_class(module: str, name: str) -> type:
    """Returns a configuration's class of a module. Raises NotFoundError with those it has."""
    from robocell.compat.molmo_spaces.configs.robot_configs import BaseRobotConfig

    loaded = import_named(module)
    found = getattr(loaded, name, None)
    known = [
        key
        for key, value in vars(loaded).items()
        if inspect.isclass(value)
        and issubclass(value, BaseRobotConfig)
        and value is not BaseRobotConfig
    ]
    if found is None:
        raise rc.NotFoundError(
            f"module '{module}' has no '{name}'. Its robot configurations: "
            f"{shortened(known) or 'none'}.{did_you_mean(name, known)}"
        )
    if not (inspect.isclass(found) and issubclass(found, BaseRobotConfig)):
        raise rc.ArgumentError(
            f"'{module}.{name}' is not a class of BaseRobotConfig. Those of the module: "
            f"{shortened(known) or 'none'}"
        )
    return found


def run_main(main: Callable[[], int]) -> NoReturn:
    """Ends the process with the exit code of `main`; robocell's errors are one line."""
    try:
        code = main()
    except (rc.Error, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        code = ExitCode.OUTPUT if isinstance(error, OSError) else ExitCode.USAGE
    except KeyboardInterrupt:
        code = ExitCode.INTERRUPTED
    sys.exit(code)


def require_instance(value: Any, kind: type, what: str) -> None:
    """Raises ArgumentError unless a value is of a kind."""
    if not isinstance(value, kind):
        raise rc.ArgumentError(f"{what}: expected a {kind.__name__}, got {type(value).__name__}")
