"""A plugin for pytest: `robocell._core` is the extension that the environment names.

    ROBOCELL_CORE=build/tsan/python/_core.so PYTHONPATH=tests/sanitizers pytest -p instrumented

scripts/tsan_python runs it so, and has a word about why.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from typing import Any

CORE = "robocell._core"


class Instrumented(MetaPathFinder):
    """Finds the one module elsewhere."""

    def find_spec(self, fullname: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        """Where the module is; None for others."""
        if fullname != CORE:
            return None
        return importlib.util.spec_from_file_location(CORE, os.environ["ROBOCELL_CORE"])


sys.meta_path.insert(0, Instrumented())


def pytest_configure() -> None:
    """Says which extension is tested; an error when it is another one than that."""
    import robocell._core

    assert robocell._core.__file__ == os.environ["ROBOCELL_CORE"], robocell._core.__file__
    print("extension:", robocell._core.__file__)
