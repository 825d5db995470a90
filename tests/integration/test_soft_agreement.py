"""`soft` and `gl` show the same on every model of the Menagerie and of the catalogue."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

BUILD = Path(__file__).resolve().parents[2] / "build" / "release"


@pytest.mark.proof
def test_soft_agrees_with_gl_on_every_model():
    result = subprocess.run(
        [
            BUILD / "render_test",
            "--gtest_also_run_disabled_tests",
            "--gtest_filter=SoftAgreesLong.*",
        ],
        capture_output=True,
        text=True,
        cwd=BUILD,
        check=False,
    )
    assert result.returncode == 0, result.stdout[-4000:] + result.stderr[-4000:]
    assert "models agree" in result.stdout
