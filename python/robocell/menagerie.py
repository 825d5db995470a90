"""Robots of the MuJoCo Menagerie: where their model files are.

Looked for below the folder named by ``MENAGERIE_ROOT``, then in the cache of the package
``mujoco-menagerie``. What is missing is fetched there and recorded, as `robocell fetch` does.
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
    """Folder of a robot that is on this machine. NotFoundError says where it was looked for."""
    return menagerie_robot_folder(robot)


def folders() -> dict[str, str]:
    """Robot -> folder, of all robots that are on this machine."""
    return menagerie_robot_folders()


def model_path(name: str) -> str:
    """Path of a robot's main model file.

    Args:
        name: The robot, such as ``"kinova_gen3"``, or one of its files, such as
            ``"ufactory_xarm7/xarm7.xml"``.

    Returns:
        An absolute path. Downloads the robot when it is nowhere on this machine.

    Raises:
        NotFoundError: It is nowhere, and could not be downloaded; or what a variable
            ``ROBOCELL_OVERRIDE_<NAME>`` names is no file.
        ArgumentError: The robot has several models and none is named.
    """
    if (mine := override_file(name)) is not None:
        return mine
    try:
        return menagerie_model_path(name)
    except NotFoundError as missing:
        _download(name.partition("/")[0], missing)
    return menagerie_model_path(name)


def _download(robot: str, missing: NotFoundError) -> None:
    """Fetch a robot as `robocell fetch` does; else say that it is missing and why it stays so."""
    from robocell import fetching

    try:
        fetching.fetch(robot)
    except (NotFoundError, IoError) as error:
        raise NotFoundError(f"{missing}\nDownloading it failed: {error}") from error
