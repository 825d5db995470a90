"""Where tests find the MuJoCo Menagerie's robots: the rule of src/robocell/testing/menagerie.h.

Looked at in this order: the environment variable MENAGERIE_ROOT, ``../shared/menagerie`` beside the
repository, the cache of the package mujoco-menagerie. Nothing is downloaded here.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
SHARED_ROOT = REPOSITORY.parent / "shared" / "menagerie"
TEST_MODELS = (
    "ufactory_xarm7",
    "kinova_gen3",
    "robotiq_2f85",
    "franka_fr3",
    "franka_emika_panda",
)


class MissingModelError(LookupError):
    """A Menagerie model is on none of the places looked at."""


def adopt_shared_root() -> None:
    """Set MENAGERIE_ROOT to ``../shared/menagerie`` when it is unset and that folder exists.

    ``menagerie:`` names in specs and robot files then resolve to the same files in this process and
    in those it starts.
    """
    if not os.environ.get("MENAGERIE_ROOT") and SHARED_ROOT.is_dir():
        os.environ["MENAGERIE_ROOT"] = str(SHARED_ROOT)


def find_model(name: str) -> Path | None:
    """The folder of a model, or None."""
    from robocell import (
        NotFoundError,
        menagerie,
    )  # not at import: what fetches has no extension yet

    try:
        return Path(menagerie.folder(name))
    except NotFoundError:
        return None


def missing_text(names: tuple[str, ...]) -> str:
    """Returns the missing models and a remedy; empty when every model is there."""
    missing = [name for name in names if find_model(name) is None]
    if not missing:
        return ""
    root = os.environ.get("MENAGERIE_ROOT") or "not set"
    return (
        f"Menagerie models missing: {', '.join(missing)}. Looked: MENAGERIE_ROOT ({root}), "
        f"the cache of mujoco-menagerie. Fetch them: robocell fetch {' '.join(missing)}"
    )


class Menagerie:
    """What the fixture ``menagerie`` gives a test."""

    def path(self, model: str, file: str = "") -> Path:
        """Full path of a model's folder or of one file in it; MissingModelError when absent."""
        folder = find_model(model)
        if folder is None:
            raise MissingModelError(missing_text((model,)))
        return folder / file if file else folder


def skips_are_failures() -> bool:
    """Whether a skipped test counts as a failure (CI=true)."""
    return os.environ.get("CI") in ("true", "1")


def require_menagerie(*models: str) -> Menagerie:
    """The Menagerie when the models (none given: TEST_MODELS) are there; else skip the test."""
    text = missing_text(models or TEST_MODELS)
    if text:
        pytest.skip(text)
    return Menagerie()
