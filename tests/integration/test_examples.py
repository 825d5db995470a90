"""Every Python example runs as it stands (the C++ ones are run by ctest)."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("[0-9]*.py")), ids=lambda p: p.stem)
def test_example_runs(path: Path, tmp_path: Path) -> None:
    argument = tmp_path / ("picture.png" if path.stem.startswith("01") else "dataset")
    done = subprocess.run(
        [sys.executable, str(path), str(argument)], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert argument.exists()


def test_every_example_is_there_in_both_languages() -> None:
    python = {p.stem for p in EXAMPLES.glob("[0-9]*.py")}
    cpp = {p.stem for p in EXAMPLES.glob("[0-9]*.cc")}
    assert python == cpp
    assert python
