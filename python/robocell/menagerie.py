"""Finds the model files of robots of the MuJoCo Menagerie.

The search looks below the folder ``MENAGERIE_ROOT``, then in the cache of the package
``mujoco-menagerie``. `model_path` fetches a missing robot into the cache and records it, as
`robocell fetch` does.
"""

from __future__ import annotations

from robocell._core import (
    IoError,
    NotFoundError,
    menagerie_model_path,
    menagerie_robot_folder,
    menagerie_robot_folders,
    override_file,
)

__all__ = ["folder", "folders", "model_path"]


def folder(robot: str) -> str:
    """Returns the folder of a robot. Raises NotFoundError with the searched folders."""
    return menagerie_robot_folder(robot)


def folders() -> dict[str, str]:
    """Returns robot -> folder for all robots on this machine."""
    return menagerie_robot_folders()


def model_path(name: str) -> str:
    """Returns the path of a robot's main model file.

    Args:
        name: The robot, such as ``"kinova_gen3"``, or one of its files, such as
            ``"ufactory_xarm7/xarm7.xml"``.

    Returns:
        An absolute path. A robot that is not on this machine is downloaded.

    Raises:
        NotFoundError: The robot was not found and could not be downloaded, or the variable
            ``ROBOCELL_OVERRIDE_<NAME>`` does not name a file.
        ArgumentError: The robot has several models and the name selects none.
    """
    if (mine := override_file(name)) is not None:
        return mine
    try:
        return menagerie_model_path(name)
    except NotFoundError as missing:
        _download(name.partition("/")[0], missing)
    return menagerie_model_path(name)


def _download(robot: str, missing: NotFoundError) -> None:
    """Fetches a robot as `robocell fetch` does. Raises NotFoundError with the cause."""
    from robocell import _fetching as fetching

    try:
        fetching.fetch(robot)
    except (NotFoundError, IoError) as error:
        raise NotFoundError(f"{missing}\nDownloading it failed: {error}") from error
