"""Every example runs as it stands, and its two languages print and draw the same."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from test_packaging import BUILD, ROOT

EXAMPLES = ROOT / "examples"
PYTHON = sorted(EXAMPLES.glob("[0-9]*.py"))


def run(*command: Path | str) -> str:
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stderr == ""
    return done.stdout


@pytest.mark.parametrize("path", PYTHON, ids=lambda p: p.stem)
def test_an_example_is_the_same_in_both_languages(path: Path, tmp_path: Path) -> None:
    program = BUILD / f"example_{path.stem}"
    if not program.exists():
        pytest.skip("build/release holds no examples; run make build")
    printed = run(sys.executable, path, tmp_path / "python")
    assert printed
    assert run(program, tmp_path / "cpp") == printed
    drawn, drawn_in_cpp = (
        {file.relative_to(folder): file.read_bytes() for file in folder.rglob("picture.png")}
        for folder in (tmp_path / "python", tmp_path / "cpp")
    )
    assert drawn, "every example draws what it is about"
    assert drawn == drawn_in_cpp


def test_every_example_is_there_in_both_languages_and_listed() -> None:
    names = [path.stem for path in PYTHON]
    assert names == sorted(p.stem for p in EXAMPLES.glob("[0-9]*.cc"))
    page = (EXAMPLES / "README.md").read_text()
    for name in names:
        assert f"({name}.py)" in page
        assert f"({name}.cc)" in page
        assert f"(../docs/example_{name[:2]}.png)" in page
