"""Experiments by name."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import TypeVar

import robocell as rc
from robocell.compat.molmo_spaces._elements import look_up
from robocell.compat.molmo_spaces.configs.abstract_exp_config import MlSpacesExpConfig
from robocell.compat.molmo_spaces.data_generation._sampler import register_parts

__all__ = ["get_config_class", "list_available_configs", "register_config"]

Kind = TypeVar("Kind", bound=type)
_registered: dict[str, type[MlSpacesExpConfig]] = {}


def register_config(name: str, strict: bool = True) -> Callable[[Kind], Kind]:
    """Decorator: registers an experiment's class under a name.

    Raises ArgumentError for a class that is no experiment, and, if `strict`, for a name that
    another class has.
    """

    def register(kind: Kind) -> Kind:
        if not (inspect.isclass(kind) and issubclass(kind, MlSpacesExpConfig)):
            raise rc.ArgumentError(
                f"register_config('{name}'): {kind!r} is not a subclass of MlSpacesExpConfig, such "
                "as PickBaseConfig"
            )
        before = _registered.get(name)
        if strict and before is not None and _origin(before) != _origin(kind):
            raise rc.ArgumentError(
                f"register_config: '{name}' is {_origin(before)} already; take another name for "
                f"{_origin(kind)}, or strict=False"
            )
        _registered[name] = kind
        register_parts(name, kind)
        return kind

    return register


def get_config_class(name: str) -> type[MlSpacesExpConfig]:
    """Returns a registered class. Raises NotFoundError that lists the names."""
    return look_up(_registered, name, "experiments that register_config registered")


def list_available_configs() -> list[str]:
    """Returns the names of all registered experiments."""
    return sorted(_registered)


def _origin(kind: type) -> str:
    return f"{kind.__module__}.{kind.__qualname__}"
