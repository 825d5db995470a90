"""Write the type stubs of robocell._core: ``make_stubs.py FOLDER_OF_THE_EXTENSION OUT``.

Called by the build. The package around the extension is not imported, so that stubs can be made
whatever state its Python sources are in.
"""

from __future__ import annotations

import importlib
import re
import shutil
import sys
import types
from pathlib import Path

from nanobind import stubgen

MODULE = "robocell._core"
PATTERNS = Path(__file__).resolve().parents[1] / "python" / "bindings" / "stubs.pat"


def import_alone(extension_folder: Path) -> types.ModuleType:
    """Import the extension without the package around it."""
    package = types.ModuleType("robocell")
    package.__path__ = [str(extension_folder)]
    sys.modules["robocell"] = package
    return importlib.import_module(MODULE)


def claim_classes(module: types.ModuleType) -> None:
    """Make classes that call themselves ``robocell.X`` the extension's own, for its stub only."""
    for value in vars(module).values():
        if isinstance(value, type) and value.__module__ == "robocell":
            value.__module__ = module.__name__


def without_false_imports(text: str) -> str:
    """Drop ``import X`` for classes X of the stub itself: stubgen takes X in X.Y for a module."""
    classes = set(re.findall(r"^class (\w+)", text, re.MULTILINE))
    return re.sub(
        r"^import (\w+)\n",
        lambda match: "" if match[1] in classes else match[0],
        text,
        flags=re.MULTILINE,
    )


def make_stubs(extension_folder: Path, out: Path) -> None:
    """Write ``_core.pyi``, or ``_core/*.pyi`` when it has submodules, into the folder out."""
    module = import_alone(extension_folder)
    claim_classes(module)
    (out / "_core.pyi").unlink(missing_ok=True)
    shutil.rmtree(out / "_core", ignore_errors=True)
    options = ["--quiet", "--recursive", "--include-private", "--pattern-file", str(PATTERNS)]
    stubgen.main([*options, "--module", MODULE, "--output-dir", str(out)])
    top = out / "_core.pyi" if (out / "_core.pyi").exists() else out / "_core" / "__init__.pyi"
    for stub in {top, *(out / "_core").glob("*.pyi")}:
        stub.write_text(without_false_imports(stub.read_text()))
    for name in ("__version__", "__mujoco_version__"):  # stubgen leaves them out
        if hasattr(module, name):
            top.write_text(top.read_text() + f"\n{name}: str\n")


if __name__ == "__main__":
    make_stubs(Path(sys.argv[1]), Path(sys.argv[2]))
