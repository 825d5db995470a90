"""A policy learns in the vector environment, as it is: examples/learning/clone.py."""

from __future__ import annotations

import importlib.util
from pathlib import Path

CLONE = Path(__file__).parents[2] / "examples" / "learning" / "clone.py"


def test_a_cloned_policy_does_what_it_was_shown():
    spec = importlib.util.spec_from_file_location("clone", CLONE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    reward = module.compare()
    assert 0 < reward["chance"] < 0.25 * reward["demonstrations"]
    assert reward["clone"] > 0.9 * reward["demonstrations"]
