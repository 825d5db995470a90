"""Features: the named values that a cell observes, records and commands, and features of your own.

    @register_feature("tcp_height", unit="m", frame="world")
    def tcp_height(scene):
        return scene.robot("rc7").tcp_in_world.translation[2]

`features: [tcp_height]` in a run records it as the column `features/tcp_height`; policies and
environments of the dataset see it under that name.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from robocell._arguments import with_hints
from robocell._core import (
    CellFeatures,
    Feature,
    Scene,
    _register_feature,
    feature_names,
)
from robocell._own_code import calling_module, code_of
from robocell._quantities import require_frame, require_unit
from robocell._registering import require_name, require_takes

__all__ = ["CellFeatures", "Feature", "feature_names", "register_feature"]

FeatureFunction = TypeVar("FeatureFunction", bound=Callable[[Scene], Any])


@with_hints
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
    """Registers a function of a scene as a feature, for cells that list it in `features`.

    Such cells record it as the column `features/<name>`, and policies and environments observe it.

    Args:
        name: Name for `features: [...]` of a run; one part of a path.
        shape: Shape of the values, () for a single number.
        unit: Unit, such as "m/s", of SI symbols; "m, 1" if components differ, "1" without a unit.
        frame: Frame that the values are expressed in: "world", "base of rc7", "TCP of rc7",
            "shared base frame", or "body 'cup'" (or site, geom, camera, object).
        names: Names of the values along the last axis.
        privileged: Whether only simulation knows the values, unlike a sensor.
        lower: Smallest value of each number, row-major; requires `upper`.
        upper: Largest value of each number.
        description: One sentence, if the name is not enough.

    `function(scene)` is called for each recorded row and returns finite numbers of that shape.
    Registering a name again replaces it; a name registered in C++ raises ArgumentError.

    Examples:
        >>> @rc.register_feature("cube_height", shape=(1,), unit="m", frame="world")
        ... def cube_height(scene):
        ...     return [scene.body_pose("cube").translation[2]]
        >>> "cube_height" in rc.features.feature_names()
        True
    """
    registering = calling_module()
    require_name("register_feature", name, "name")
    call = f"register_feature({name!r})"
    require_unit(call, unit)
    require_frame(call, frame)

    def register(function: FeatureFunction) -> FeatureFunction:
        if not callable(function):
            raise TypeError(f"{call}: expected a function (scene) -> numbers, got {function!r}")
        require_takes(call, function, ["scene"])
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
            code_of(function, registering=registering),
        )
        return function

    return register
