"""Metadata of episodes: JSON that every reader can read."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from robocell._core import ArgumentError


def metadata_text(metadata: Mapping[str, Any] | None, what: str = "metadata") -> str:
    """Returns metadata as a JSON object.

    Raises:
        ArgumentError: A value is none of JSON, or no other reader could read it.
    """
    try:
        text = json.dumps(dict(metadata or {}), allow_nan=False)
        _require_storable(json.loads(text))
    except (TypeError, ValueError) as error:
        raise ArgumentError(
            f"{what} cannot be kept with episodes, as JSON: {error}; it takes texts, finite "
            "numbers, booleans, None, and lists and dictionaries of those"
        ) from error
    return text


def _require_storable(value: Any) -> None:
    """Raises ValueError for what Python writes as JSON and other readers change or reject."""
    if isinstance(value, dict):
        for key, inner in value.items():
            _require_storable(key)
            _require_storable(inner)
    elif isinstance(value, list):
        for inner in value:
            _require_storable(inner)
    elif isinstance(value, str):
        try:
            value.encode()
        except UnicodeEncodeError:
            raise ValueError(f"the text {value!r} is not valid Unicode") from None
    elif isinstance(value, int) and not -(2**63) <= value < 2**64:
        raise ValueError(f"the number {value} does not fit in 64 bits")
