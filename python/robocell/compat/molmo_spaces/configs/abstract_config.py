"""The base of all configurations: pydantic models that refuse unknown fields by name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import robocell as rc
from robocell._extras import needed_by
from robocell._suggestions import did_you_mean, shortened

with needed_by("robocell.compat.molmo_spaces", "molmo-spaces"):
    import pydantic

__all__ = ["Config", "set_without_effect"]

MOST_SHOWN = 5  # wrong fields in a message


class Config(pydantic.BaseModel):
    """A configuration. Fields are checked when it is made and when they are set."""

    model_config = pydantic.ConfigDict(
        arbitrary_types_allowed=True, extra="forbid", validate_assignment=True
    )

    def __init__(self, **fields: Any) -> None:
        """Raises ArgumentError for values of another type, and for a field that there is not."""
        known = type(self).model_fields
        for name in fields:
            if name not in known:
                raise rc.ArgumentError(
                    f"{type(self).__name__}: no field '{name}'.{did_you_mean(name, known)} Its "
                    f"fields: {shortened(list(known))}"
                )
        with _as_argument_errors(type(self).__name__):
            super().__init__(**fields)

    def __setattr__(self, name: str, value: Any) -> None:
        """Raises ArgumentError for a value of another type."""
        with _as_argument_errors(type(self).__name__):
            super().__setattr__(name, value)


@contextmanager
def _as_argument_errors(kind: str) -> Iterator[None]:
    """Raises ArgumentError with the fields for what pydantic finds wrong."""
    try:
        yield
    except pydantic.ValidationError as error:
        wrong = "; ".join(
            f"{'.'.join(str(part) for part in each['loc'])}: {each['msg']}"
            f" (it is {each['input']!r:.60})"
            for each in error.errors()[:MOST_SHOWN]
        )
        raise rc.ArgumentError(f"{kind}: {wrong}") from error


def set_without_effect(config: Config, base: type[Config], names: Sequence[str]) -> list[str]:
    """Returns the fields, of those without an effect in robocell, that differ from the default.

    Args:
        config: The configuration, of `base` or of a user's class of it.
        base: The class that has the defaults.
        names: The fields without an effect.
    """
    fields = base.model_fields
    return [
        name
        for name in names
        if name in fields
        and getattr(config, name) != fields[name].get_default(call_default_factory=True)
    ]
