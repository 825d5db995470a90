"""Runs Python code as if `pip install robocell` were all: what extras bring cannot be imported."""

from __future__ import annotations

import importlib.metadata
import os
import re
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]

# For a file that every Python process imports as it starts, so that workers are blocked too.
BLOCKER = """
import sys
from importlib.machinery import PathFinder

class Unblocked(PathFinder):
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        if name.partition(".")[0] not in {blocked!r}:
            return super().find_spec(name, path, target)

sys.meta_path[sys.meta_path.index(PathFinder)] = Unblocked
"""


def project() -> dict[str, Any]:
    """The table `project` of pyproject.toml."""
    content = tomllib.loads((ROOT / "pyproject.toml").read_text())
    table: dict[str, Any] = content["project"]
    return table


def normalized(requirement: str) -> str:
    """The package of a requirement, as pip compares names."""
    name = re.split(r"[^A-Za-z0-9._-]", requirement, maxsplit=1)[0]
    return re.sub(r"[-_.]+", "-", name).lower()


def with_what_they_need(packages: list[str]) -> set[str]:
    """The packages and all that these require, without their extras."""
    found: set[str] = set()
    waiting = [normalized(package) for package in packages]
    while waiting:
        package = waiting.pop()
        if package in found:
            continue
        found.add(package)
        try:
            wanted = importlib.metadata.requires(package) or []
        except importlib.metadata.PackageNotFoundError:
            continue
        waiting += [normalized(text) for text in wanted if "extra ==" not in text]
    return found


def blocked_modules() -> set[str]:
    """Top-level modules that are installed here and that no core dependency brings."""
    core = with_what_they_need(project()["dependencies"])
    modules = importlib.metadata.packages_distributions()
    return {
        module
        for module, owners in modules.items()
        if module != "robocell" and not core & {normalized(owner) for owner in owners}
    }


def run(code: str, *arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Runs code in a process of its own, without what the extras bring."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "sitecustomize.py").write_text(BLOCKER.format(blocked=blocked_modules()))
        path = os.pathsep.join([folder, str(ROOT / "python")])
        command = [sys.executable, "-c", code, *map(str, arguments)]
        return subprocess.run(
            command,
            cwd=cwd,
            env={**os.environ, "PYTHONPATH": path},
            capture_output=True,
            text=True,
            check=False,
        )
