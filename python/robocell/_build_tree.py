"""Finds the compiled part of robocell when the package runs from a checkout.

In a wheel the extension `robocell._core` is in this folder. The build of a checkout writes the
extension and its stubs to ``python/robocell`` in its build folder, never among the sources. The
package looks there first: in ``build/release``, or in the build folder that the variable
``ROBOCELL_BUILD`` names (``ROBOCELL_BUILD=build/tsan``, relative to the checkout).
"""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path

VARIABLE = "ROBOCELL_BUILD"


def checkout() -> Path | None:
    """Returns the checkout that this package belongs to; None when it is installed."""
    root = Path(__file__).resolve().parents[2]
    is_checkout = (root / "CMakeLists.txt").is_file() and (root / "python" / "bindings").is_dir()
    return root if is_checkout else None


def build_folder() -> Path | None:
    """Returns the build folder of library and extension; None for an installed package."""
    root = checkout()
    return root / (os.environ.get(VARIABLE) or "build/release") if root else None


def join() -> None:
    """Adds the build folder's part of the package to the package.

    Raises:
        ImportError: The build folder has no extension module.
    """
    package = sys.modules["robocell"]
    folder = build_folder()
    if folder:
        package.__path__.insert(0, str(folder / "python" / "robocell"))
    if importlib.util.find_spec("robocell._core"):
        return
    if folder:
        raise ImportError(
            f"robocell's extension _core is not in {folder}/python/robocell. Build it with `make`"
            f", or set {VARIABLE} to another build folder."
        )
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    raise ImportError(
        f"robocell's extension _core for Python {version} is not in {Path(__file__).parent}. "
        "Install robocell again with this Python: pip install --force-reinstall robocell"
    )


join()
