"""Packages that parts of robocell need and `pip install robocell` does not install.

Each belongs to an extra of pyproject.toml; an error about a missing one names the command.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

# extra -> module -> package
EXTRAS = {
    "envs": {"gymnasium": "gymnasium"},
    "plots": {"matplotlib": "matplotlib", "plotly": "plotly"},
    "sb3": {"gymnasium": "gymnasium", "stable_baselines3": "stable-baselines3"},
    "torch": {"torch": "torch"},
}


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
            f"{user} needs the package {package}, which is not installed: "
            f"pip install 'robocell[{extra}]'"
        )
        if otherwise:
            message += f". {otherwise}"
        raise ModuleNotFoundError(message, name=error.name) from None
