"""Features: what a cell observes, records and commands, by name, and your own.

    @register_feature("tcp_height", unit="m", frame="world")
    def tcp_height(scene):
        return scene.robot("rc7").tcp_in_world.translation[2]

`features: [tcp_height]` in a run records it as the column `features/tcp_height`; policies and
environments of the dataset see it under that name.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from robocell._core import (
    ArgumentError,
    CellFeatures,
    Feature,
    Scene,
    _register_feature,
    feature_names,
)
from robocell.tasks import code_of

__all__ = ["CellFeatures", "Feature", "feature_names", "register_feature"]

FeatureFunction = TypeVar("FeatureFunction", bound=Callable[[Scene], Any])


def register_feature(
    name: str,
    *,
    shape: Sequence[int] = (),
    unit: str = "",
    frame: str = "",
    names: Sequence[str] = (),
    privileged: bool = False,
    lower: Sequence[float] = (),
    upper: Sequence[float] = (),
    description: str = "",
) -> Callable[[FeatureFunction], FeatureFunction]:
    """Makes a function of a scene known as a feature, for cells whose `features` name it.

    Such cells record it as the column `features/<name>`, and policies and environments see it.

    Args:
        name: What `features: [...]` of a run says; one part of a path.
        shape: Of its numbers, () for a single one.
        unit: "m/s", "1".
        frame: What it is expressed in: "world".
        names: Of the numbers along the last axis.
        privileged: Whether only simulation knows it, unlike a sensor.
        lower: Smallest of each number, row-major; none without `upper`.
        upper: Largest of each number.
        description: One sentence, where the name does not say it.

    The function is called as `function(scene)` for each recorded row and returns finite numbers of
    that shape. Registering a name again replaces it (ArgumentError for one of C++).
    """
    if not isinstance(name, str) or not name:
        raise ArgumentError("register_feature: `name` must be a name that is not empty")

    def register(function: FeatureFunction) -> FeatureFunction:
        if not callable(function):
            raise TypeError(
                f"register_feature({name!r}): expected a function (scene) -> numbers, "
                f"got {function!r}"
            )
        _register_feature(
            name,
            function,
            list(shape),
            unit,
            frame,
            list(names),
            description,
            "privileged" if privileged else "observation",
            list(lower),
            list(upper),
            code_of(function),
        )
        return function

    return register
