"""The error of files that cannot become objects."""

from __future__ import annotations

from robocell import SpecError


class AddObjectError(SpecError):
    """A file that cannot become an object, and what to do about it."""
