"""The base of all configurations: pydantic models that refuse unknown fields by name."""

from __future__ import annotations

from typing import Any

import robocell as rc
from robocell._extras import needed_by
from robocell._suggestions import did_you_mean, shortened

with needed_by("robocell.compat.molmo_spaces", "molmo-spaces"):
    import pydantic

__all__ = ["Config"]


class Config(pydantic.BaseModel):
    """A configuration. Fields are checked when it is made and when they are set."""

    model_config = pydantic.ConfigDict(
        arbitrary_types_allowed=True, extra="forbid", validate_assignment=True
    )

    def __init__(self, **fields: Any) -> None:
        """Raises ArgumentError with the nearest name for a field that there is not."""
        known = type(self).model_fields
        for name in fields:
            if name not in known:
                raise rc.ArgumentError(
                    f"{type(self).__name__}: no field '{name}'.{did_you_mean(name, known)} Its "
                    f"fields: {shortened(list(known))}"
                )
        super().__init__(**fields)
