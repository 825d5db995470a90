"""What tests of OpenGL need."""

from __future__ import annotations

import pytest

import robocell as rc


def require_gl() -> str:
    """The description of this machine's OpenGL; the test is skipped where there is none."""
    try:
        return rc.diagnose.describe_gl()
    except rc.Error as error:
        pytest.skip(str(error))
