"""Where models and assets are: the variables ``MJ_KDL_*`` first, then robocell's own search.

``MJ_KDL_MODEL`` (the arm), ``MJ_KDL_GRIPPER``, ``MJ_KDL_TABLE``, ``MJ_KDL_BOTTLE`` and
``MJ_KDL_RECEIVER`` are files, ``MJ_KDL_MENAGERIE`` is a checkout of the Menagerie. What a variable
names must exist.
"""

from __future__ import annotations

import contextlib
import difflib
import os
import shutil
from pathlib import Path

from robocell import NotFoundError, fetching, menagerie, models
from robocell._core import override_file
from robocell.compat.mj_kdl_wrapper.calls import told

ARM, GRIPPER = "kinova_gen3", "robotiq_2f85"
# Asset -> built-in model, and the variable that puts a file in its place.
ASSETS = {
    "table.xml": ("table", "MJ_KDL_TABLE"),
    "mug.xml": ("mug", ""),
    "ft_sensor.xml": ("ft_sensor", ""),
    "bottle.xml": ("open_bottle", "MJ_KDL_BOTTLE"),
    "receiver.xml": ("receiver", "MJ_KDL_RECEIVER"),
    "cabinet/cabinet.xml": ("cabinet", ""),
}
GRIPPER_ASSET = "robotiq_2f85/2f85.xml"


@told
def model_path(name: str, *, env_var: str | None = None) -> str:
    """Main model file of a robot of the Menagerie; NotFoundError says what to do without it.

    Args:
        name: The robot, such as ``"kinova_gen3"``. A name that the Menagerie does not have is an
            error also where ``MJ_KDL_MODEL`` names the file.
        env_var: A variable of one's own that names the file, before all others.
    """
    if not isinstance(name, str):
        raise TypeError(f"model_path: expected a robot's name, such as '{ARM}'; got {name!r}")
    _require_robot(name)
    return (
        (env_var and _override(env_var))
        or _override("MJ_KDL_GRIPPER" if name == GRIPPER else "MJ_KDL_MODEL")
        or _below_root(name)
        or _from_the_menagerie(name)
    )


@told
def asset_path(rel: str, *, env_var: str | None = None) -> str:
    """An asset of the examples, such as ``"cabinet/cabinet.xml"``; NotFoundError lists them.

    Args:
        rel: Which one.
        env_var: A variable of one's own that names the file, before all others.
    """
    if rel == GRIPPER_ASSET:
        return model_path(GRIPPER, env_var=env_var)
    if rel not in ASSETS:
        raise NotFoundError(f"no asset '{rel}'. The assets: {', '.join([*ASSETS, GRIPPER_ASSET])}")
    model, variable = ASSETS[rel]
    return (
        (env_var and _override(env_var))
        or (variable and _override(variable))
        or models.resolve(model)
    )


@told
def fetch(dest: str | Path | None = None) -> dict[str, str]:
    """Fetches the examples' robots, unless they are here.

    Args:
        dest: A folder that gets ``assets/`` and ``menagerie/``, so that programs started in it
            find relative paths such as ``assets/robotiq_2f85/2f85.xml``.

    Returns:
        Name -> path of all models and assets.
    """
    folders = {robot: _folder(robot) for robot in (ARM, GRIPPER)}
    if dest is not None:
        return _fill(Path(dest), folders)
    paths = {robot: model_path(robot) for robot in folders}
    return paths | {asset: asset_path(asset) for asset in (*ASSETS, GRIPPER_ASSET)}


def _require_robot(name: str) -> None:
    robot = name.partition("/")[0]
    known = {ARM, GRIPPER, *menagerie.folders(), *_names_below_root()}
    if robot in known or override_file(name) is not None:
        return
    with contextlib.suppress(NotFoundError):  # without the package: those that are here
        known |= {each.name for each in fetching.known_robots()}
    if robot in known:
        return
    near = difflib.get_close_matches(robot, sorted(known), 1)
    raise NotFoundError(
        f"no robot '{robot}' in the Menagerie. "
        + (
            f"Did you mean '{near[0]}'?"
            if near
            else f"Here are {', '.join(sorted(known)[:12])} ..."
        )
        + " `robocell fetch --list` lists all robots; for a file of your own set RobotSpec.path"
    )


def _from_the_menagerie(name: str) -> str:
    try:
        return menagerie.model_path(name)
    except NotFoundError as missing:
        if name.partition("/")[0] not in (ARM, GRIPPER):
            raise
        message = f"{missing}\nmj-kdl-fetch-menagerie fetches it with all that the examples use"
        raise NotFoundError(message) from None


def _names_below_root() -> list[str]:
    root = os.environ.get("MJ_KDL_MENAGERIE")
    if not root or not Path(root).is_dir():
        return []
    return [folder.name for folder in Path(root).iterdir() if folder.is_dir()]


def _override(variable: str) -> str | None:
    value = os.environ.get(variable)
    if not value:
        return None
    if not Path(value).is_file():
        raise NotFoundError(f"{variable} is '{value}', which is no file: correct it or unset it")
    return str(Path(value).resolve())


def _below_root(robot: str) -> str | None:
    root = os.environ.get("MJ_KDL_MENAGERIE")
    if not root:
        return None
    folder = Path(root) / robot
    if not folder.is_dir():
        raise NotFoundError(
            f"MJ_KDL_MENAGERIE is '{root}', which holds no folder '{robot}': correct it, or unset "
            f"it and fetch the robot with mj-kdl-fetch-menagerie"
        )
    return str((folder / fetching.main_file(robot)).resolve())


def _folder(robot: str) -> Path:
    try:
        return Path(menagerie.folder(robot))
    except NotFoundError:
        return fetching.fetch(robot).folder


def _fill(dest: Path, folders: dict[str, Path]) -> dict[str, str]:
    paths = {}
    for robot, folder in folders.items():
        _copy(folder, dest / "menagerie" / robot)
        paths[robot] = str(dest / "menagerie" / robot / fetching.main_file(robot))
    _copy(folders[GRIPPER], dest / "assets" / GRIPPER)
    paths[GRIPPER_ASSET] = str(dest / "assets" / GRIPPER_ASSET)
    for asset, (model, _) in ASSETS.items():
        source, target = Path(models.resolve(model)), dest / "assets" / asset
        target.parent.mkdir(parents=True, exist_ok=True)
        for mesh in source.parent.glob("*.obj"):
            shutil.copyfile(mesh, target.parent / mesh.name)
        shutil.copyfile(source, target)
        paths[asset] = str(target)
    return paths


def _copy(folder: Path, target: Path) -> None:
    ignored = shutil.ignore_patterns(".complete")
    shutil.copytree(folder, target, ignore=ignored, dirs_exist_ok=True)
