"""The code in docs/ is code: Python runs, C++ compiles against the library as it is."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from commands import warnings_of
from test_packaging import ROOT, run

from menagerie import require_menagerie

PAGES = sorted((ROOT / "docs").glob("*.md"))


def blocks(page: Path, language: str) -> list[str]:
    found = re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)
    return [str(block) for block in found]


def make_demo(folder: Path) -> None:
    """What `make demo` leaves, but small."""
    small = ["--episodes=2", "--set", "cameras.resolution=[64, 48]"]
    command = [sys.executable, "-m", "robocell", "generate", "examples/demo.yaml", *small]
    subprocess.run(command, cwd=folder, capture_output=True, check=True)


@pytest.mark.parametrize("page", [p for p in PAGES if blocks(p, "python")], ids=lambda p: p.stem)
def test_the_python_of_a_page_runs_from_top_to_bottom(page: Path, tmp_path: Path):
    code = "\n".join(blocks(page, "python"))
    if "fr3_2f85" in code:
        require_menagerie("franka_fr3", "robotiq_2f85")
    for folder in ("examples", "models"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    if "experiment_output/demo" in code:
        make_demo(tmp_path)
    script = tmp_path / "page.py"
    script.write_text(code)
    done = subprocess.run(
        [sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert warnings_of(done.stderr) == ""


def test_the_list_of_all_fields_is_as_the_specs_have_them():
    run(sys.executable, ROOT / "docs" / "make_spec_fields.py", "--check")
