"""Pickles the core's classes by every protocol, 0 and 1 too.

Python's own way for classes of an extension knows protocols from 2 on only.
"""

from __future__ import annotations

import copyreg
from typing import Any

from robocell import _core


def _reduced(value: Any) -> tuple[Any, ...]:
    return copyreg.__newobj__, (type(value),), value.__getstate__()  # type: ignore[attr-defined]


for _kind in vars(_core).values():
    if (
        isinstance(_kind, type)
        and "__setstate__" in vars(_kind)
        and "__reduce__" not in vars(_kind)
    ):
        _kind.__reduce__ = _reduced  # type: ignore[method-assign, assignment]
