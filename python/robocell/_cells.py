"""Cells as they are given: as a file, or by the name of a ready-made one."""

from __future__ import annotations

import os
from typing import Any

from robocell import models
from robocell._core import EnvConfig, NotFoundError


def is_name(given: Any) -> bool:
    """Returns True for the name of a built-in cell, or a likely misspelling of one."""
    return isinstance(given, str) and not os.path.splitext(given)[1] and not os.path.exists(given)


def load_cell(given: str | os.PathLike[str]) -> EnvConfig:
    """Loads a configuration file, or the built-in cell of that name (``models.cells()``)."""
    if not is_name(given):
        return EnvConfig.load(given)
    try:
        file = models.cell_file(str(given))
    except NotFoundError as error:
        raise NotFoundError(f"{error} A file is given with its ending, '{given}.yaml'") from None
    return EnvConfig.load(file)
