"""Packages that parts of robocell need and `pip install robocell` does not install.

Each belongs to an extra of pyproject.toml; an error about a missing one names the command.
"""

from __future__ import annotations

import importlib.metadata
from collections.abc import Iterator
from contextlib import contextmanager

# extra -> module -> package
EXTRAS = {
    "envs": {"gymnasium": "gymnasium"},
    "plots": {"matplotlib": "matplotlib", "plotly": "plotly"},
    "sb3": {"gymnasium": "gymnasium", "stable_baselines3": "stable-baselines3"},
    "torch": {"torch": "torch"},
}

# module -> package, of those that robocell always comes with
REQUIRED = {
    "mujoco": "mujoco",
    "mujoco_menagerie": "mujoco-menagerie",
    "numpy": "numpy",
    "rich": "rich",
    "typer": "typer",
}


def needed_modules() -> set[str]:
    """Returns the names of all modules that robocell, or a part of it, imports."""
    return {*REQUIRED, *(module for modules in EXTRAS.values() for module in modules)}


def install_command(extra: str) -> str:
    """The command that installs an extra's packages.

    A checkout is not installed, so pip would look for robocell itself, which no index has.
    """
    try:
        importlib.metadata.distribution("robocell")
    except importlib.metadata.PackageNotFoundError:
        return f"pip install {' '.join(EXTRAS[extra].values())}"
    return f"pip install 'robocell[{extra}]'"


@contextmanager
def needed_by(user: str, extra: str, otherwise: str = "") -> Iterator[None]:
    """Around imports of an extra's packages: a missing one is an error with the pip command.

    Args:
        user: What needs them, such as "robocell.gym".
        extra: A key of `EXTRAS`.
        otherwise: What works without them, a sentence.

    Raises:
        ModuleNotFoundError: A package of the extra is not installed.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        package = EXTRAS[extra].get((error.name or "").partition(".")[0])
        if package is None:
            raise
        message = (
            f"{user} needs the package {package}, which is not installed: {install_command(extra)}"
        )
        if otherwise:
            message += f". {otherwise}"
        raise ModuleNotFoundError(message, name=error.name) from None
