"""The dataset of an undisturbed run, which every disturbed one is held against."""

from __future__ import annotations

import pytest
from storm import Storm

from made_once import made_once


@pytest.fixture(scope="session")
def calm(tmp_path_factory: pytest.TempPathFactory) -> Storm:
    """Made by two workers. Nobody may change it."""
    return Storm(made_once(tmp_path_factory, "calm", lambda folder: Storm(folder).finish()))
