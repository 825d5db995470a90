"""Libraries of assets and grasps of your own."""

from __future__ import annotations

import json
from pathlib import Path

import robocell as rc
from robocell._suggestions import did_you_mean

__all__ = [
    "register_user_asset_library",
    "register_user_grasp_library",
    "user_asset_libraries",
]

INDEX, GRASP_INDEX = "assets_index.json", "grasps_index.json"
_libraries: dict[str, Path] = {}


def register_user_asset_library(name: str, path: Path | str) -> None:
    """Makes the assets of a folder known under a name.

    Raises NotFoundError for a folder that there is not, ArgumentError for an index that cannot be
    read and for a name that another folder has.
    """
    folder = _folder("register_user_asset_library", name, path)
    if _libraries.get(name, folder) != folder:
        raise rc.ArgumentError(
            f"register_user_asset_library: '{name}' is '{_libraries[name]}' already; take another "
            "name"
        )
    index = folder / INDEX
    if index.is_file():
        try:
            json.loads(index.read_text())
        except ValueError as error:
            raise rc.ArgumentError(f"'{index}' is no JSON: {error}") from None
    _libraries[name] = folder


def register_user_grasp_library(name: str, path: Path | str, asset_library: str) -> None:
    """Makes the grasps in a folder known, which were made for the assets of a library.

    robocell reads grasps in its own format (docs/grasps.md) from it before it computes any. Raises
    NotFoundError for a folder or an asset library that there is not.
    """
    folder = _folder("register_user_grasp_library", name, path)
    if asset_library not in _libraries:
        known = ", ".join(_libraries) or "none; register_user_asset_library comes first"
        raise rc.NotFoundError(
            f"register_user_grasp_library: no asset library '{asset_library}'. There are: {known}."
            f"{did_you_mean(asset_library, _libraries)}"
        )
    rc.tasks.register_grasp_library(name, folder)


def user_asset_libraries() -> dict[str, Path]:
    """Returns the folders of the registered asset libraries by name."""
    return dict(_libraries)


def _folder(function: str, name: str, path: Path | str) -> Path:
    folder = Path(path).absolute()
    if not name:
        raise rc.ArgumentError(f"{function}: the name is empty")
    if not folder.is_dir():
        raise rc.NotFoundError(f"{function}('{name}'): there is no folder '{folder}'")
    return folder
