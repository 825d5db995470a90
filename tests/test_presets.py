"""Every CMake preset configures: a source that moved is found before somebody fuzzes it."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PRESETS = [
    preset["name"]
    for preset in json.loads((ROOT / "CMakePresets.json").read_text())["configurePresets"]
    if not preset.get("hidden")
]


# The commands of `make check` configure the others too.
@pytest.mark.parametrize(
    "preset",
    [pytest.param(name, marks=pytest.mark.proof if name != "debug" else ()) for name in PRESETS],
)
def test_preset_configures(preset: str, tmp_path: Path) -> None:
    if preset == "fuzz" and shutil.which("clang++") is None:
        pytest.skip("the fuzzers need clang++, which is not installed")
    build = tmp_path / "link"  # as on machines whose large folders lie elsewhere
    (tmp_path / "deep" / "real").mkdir(parents=True)
    build.symlink_to(tmp_path / "deep" / "real")
    configured = subprocess.run(
        ["cmake", "--preset", preset, "-B", build, f"-DPython_EXECUTABLE={sys.executable}"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert configured.returncode == 0, configured.stderr
    units = list(build.glob("Unity/*/*.cxx"))
    assert units
    for unit in units:
        for source in re.findall(r'#include "(.*)"', unit.read_text()):
            assert (unit.parent / source).exists() or (ROOT / "src" / source).exists(), source
