"""Features: the named values that a cell observes, records and commands, and features of your own.

    @register_feature("tcp_height", units="m", frame="world")
    def tcp_height(scene):
        return scene.robot("rc7").tcp_in_world.translation[2]

`features: [tcp_height]` in a run records it as the column `features/tcp_height`; policies and
environments of the dataset see it under that name.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

from robocell._arguments import show, with_hints
from robocell._core import (
    ArgumentError,
    CellFeatures,
    Feature,
    Scene,
    _register_feature,
    feature_names,
)
from robocell._own_code import calling_module, code_of
from robocell._quantities import require_frame, require_units
from robocell._registering import note_registered, require_name, require_takes

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["CellFeatures", "Feature", "feature_names", "register_feature"]

FeatureFunction = TypeVar("FeatureFunction", bound=Callable[[Scene], Any])


@with_hints
def register_feature(
    name: str,
    *,
    shape: int | Sequence[int] = (),
    units: str = "",
    frame: str = "",
    names: str | Sequence[str] = (),
    privileged: bool = False,
    lower: ArrayLike = (),
    upper: ArrayLike = (),
    description: str = "",
) -> Callable[[FeatureFunction], FeatureFunction]:
    """Registers a function of a scene as a feature, for cells that list it in `features`.

    Such cells record it as the column `features/<name>`, and policies and environments observe it.

    Args:
        name: Name for `features: [...]` of a run; one part of a path.
        shape: Shape of the values, () for a single number.
        units: Unit, such as "m/s", of SI symbols; "m, 1" if components differ, "1" without a unit.
        frame: Frame that the values are expressed in: "world", "base of rc7", "TCP of rc7",
            "shared base frame", or "body 'cup'" (or site, geom, camera, object).
        names: Names of the values along the last axis.
        privileged: Whether only simulation knows the values, unlike a sensor.
        lower: Smallest value of each number, row-major, or the number itself if there is one;
            requires `upper`.
        upper: Largest value of each number.
        description: One sentence, if the name is not enough.

    `function(scene)` is called for each recorded row and returns finite numbers of that shape.
    Registering a name again replaces it; a name registered in C++ raises ArgumentError.

    Examples:
        >>> @rc.features.register_feature("cube_height", shape=(1,), units="m", frame="world")
        ... def cube_height(scene):
        ...     return [scene.body_pose("cube").translation[2]]
        >>> "cube_height" in rc.features.feature_names()
        True
    """
    registering = calling_module()
    require_name("register_feature", name, "name")
    call = f"register_feature({name!r})"
    require_units(call, units)
    require_frame(call, frame)
    sizes = _integers(call, shape)
    lowest, highest = _numbers(call, "lower", lower), _numbers(call, "upper", upper)
    labels = [names] if isinstance(names, str) else list(names)

    def register(function: FeatureFunction) -> FeatureFunction:
        if not callable(function):
            raise TypeError(f"{call}: expected a function (scene) -> numbers, got {function!r}")
        require_takes(call, function, ["scene"])
        _register_feature(
            name,
            function,
            sizes,
            units,
            frame,
            labels,
            description,
            "privileged" if privileged else "observation",
            lowest,
            highest,
            code_of(function, registering=registering),
        )
        note_registered("feature", name, registering)
        return function

    return register


def _integers(call: str, shape: int | Sequence[int]) -> list[int]:
    """Returns the shape as a list; a lone number is the length of a row."""
    import numpy as np

    try:
        return [operator.index(size) for size in np.atleast_1d(np.asarray(shape, dtype=object))]
    except TypeError:
        raise ArgumentError(
            f"{call}: `shape` must be whole numbers such as (3,), or () for a single number, got "
            f"{show(shape)}"
        ) from None


def _numbers(call: str, argument: str, values: ArrayLike) -> list[float]:
    """Returns the numbers of an argument, row-major; a lone number is a list of one."""
    import numpy as np

    try:
        if values is None:  # NumPy makes it NaN
            raise TypeError
        return [float(value) for value in np.asarray(values, dtype=np.float64).ravel()]
    except (TypeError, ValueError):
        raise ArgumentError(
            f"{call}: `{argument}` must be numbers such as [0, 0.5], one for each number of the "
            f"feature, got {show(values)}"
        ) from None
