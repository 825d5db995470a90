"""Searches models and assets: the variables ``MJ_KDL_*``, the guide's cache, robocell's search.

``MJ_KDL_MODEL`` (the arm), ``MJ_KDL_GRIPPER``, ``MJ_KDL_TABLE``, ``MJ_KDL_BOTTLE`` and
``MJ_KDL_RECEIVER`` are files, ``MJ_KDL_MENAGERIE`` is a checkout of the Menagerie. The file or
folder that a variable names must exist.

The cache is ``~/.cache/mj_kdl_wrapper`` with the folders ``menagerie`` and ``assets``
(``XDG_CACHE_HOME`` instead of ``~/.cache`` where it is set). `fetch` fills it.
"""

from __future__ import annotations

import contextlib
import difflib
import os
import shutil
from pathlib import Path

from robocell import NotFoundError, menagerie, models
from robocell import _fetching as fetching
from robocell._arguments import with_hints
from robocell._core import override_file

__all__ = [
    "ASSETS",
    "GRIPPER_ASSET",
    "asset_path",
    "cache_dir",
    "fetch",
    "model_path",
]

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


@with_hints
def model_path(name: str, *, env_var: str | None = None) -> str:
    """Returns the main model file of a robot. Raises NotFoundError with the next step.

    The variables come first, then the cache, then robocell's search. ``MENAGERIE_ROOT`` and
    ``ROBOCELL_OVERRIDE_<NAME>``, which robocell knows too, come before the cache.

    Args:
        name: The robot, such as ``"kinova_gen3"``. A name that the Menagerie does not have is an
            error also where ``MJ_KDL_MODEL`` names the file.
        env_var: Another variable that names the file, before all others.
    """
    if not isinstance(name, str):
        raise TypeError(f"model_path: expected a robot's name, such as '{ARM}'; got {name!r}")
    _require_robot(name)
    return (
        (env_var and _override(env_var))
        or _override("MJ_KDL_GRIPPER" if name == GRIPPER else "MJ_KDL_MODEL")
        or _below_root(name)
        or _in_cache(name)
        or _from_the_menagerie(name)
    )


@with_hints
def asset_path(rel: str, *, env_var: str | None = None) -> str:
    """Returns an asset, such as ``"cabinet/cabinet.xml"``. Raises NotFoundError with all names.

    Args:
        rel: Name of the asset.
        env_var: Another variable that names the file, before all others.
    """
    if rel == GRIPPER_ASSET:
        return (
            (env_var and _override(env_var))
            or _override("MJ_KDL_GRIPPER")
            or (None if os.environ.get("MJ_KDL_MENAGERIE") else _cached_asset(rel))
            or model_path(GRIPPER)
        )
    if rel not in ASSETS:
        raise NotFoundError(f"no asset '{rel}'. The assets: {', '.join([*ASSETS, GRIPPER_ASSET])}")
    model, variable = ASSETS[rel]
    return (
        (env_var and _override(env_var))
        or (variable and _override(variable))
        or _cached_asset(rel, model)
        or models.resolve(model)
    )


def cache_dir() -> Path:
    """Returns the guide's cache, which `fetch` fills; it need not exist."""
    root = os.environ.get("XDG_CACHE_HOME")
    return (Path(root) if root else Path.home() / ".cache") / "mj_kdl_wrapper"


@with_hints
def fetch(dest: str | Path | None = None) -> dict[str, str]:
    """Fetches the examples' robots, unless they are here, and fills the guide's cache.

    Files that the cache has already stay as they are.

    Args:
        dest: A folder that gets ``assets/`` and ``menagerie/`` too, so that programs started in it
            find relative paths such as ``assets/robotiq_2f85/2f85.xml``.

    Returns:
        Name -> path of all models and assets.
    """
    folders = {robot: _folder(robot) for robot in (ARM, GRIPPER)}
    _fill(cache_dir(), folders, keep=True)
    if dest is not None:
        return _fill(Path(dest), folders)
    paths = {robot: model_path(robot) for robot in folders}
    return paths | {asset: asset_path(asset) for asset in (*ASSETS, GRIPPER_ASSET)}


def _require_robot(name: str) -> None:
    robot = name.partition("/")[0]
    roots = (os.environ.get("MJ_KDL_MENAGERIE"), cache_dir() / "menagerie")
    known = {ARM, GRIPPER, *menagerie.folders(), *(name for r in roots for name in _names_below(r))}
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


def _names_below(root: str | Path | None) -> list[str]:
    if not root or not Path(root).is_dir():
        return []
    return [folder.name for folder in Path(root).iterdir() if folder.is_dir()]


def _override(variable: str) -> str | None:
    value = os.environ.get(variable)
    if not value:
        return None
    if not Path(value).is_file():
        raise NotFoundError(f"{variable} is '{value}', which is not a file: correct it or unset it")
    return str(Path(value).resolve())


def _below_root(name: str) -> str | None:
    root = os.environ.get("MJ_KDL_MENAGERIE")
    if not root:
        return None
    robot = name.partition("/")[0]
    folder = Path(root) / robot
    if not folder.is_dir():
        raise NotFoundError(
            f"MJ_KDL_MENAGERIE is '{root}', which holds no folder '{robot}': correct it, or unset "
            f"it and fetch the robot with mj-kdl-fetch-menagerie"
        )
    return _model_in(folder, name)


def _in_cache(name: str) -> str | None:
    robot = name.partition("/")[0]
    cached = cache_dir() / "menagerie" / robot
    own_root = os.environ.get("MENAGERIE_ROOT")
    chosen = override_file(name) is not None or (own_root and (Path(own_root) / robot).is_dir())
    return None if chosen or not _is_complete(cached) else _model_in(cached, name)


def _is_complete(folder: Path) -> bool:
    """Returns True if a robot's folder has its main file, which is copied last, or any model."""
    try:
        return (folder / fetching.main_file(folder.name)).is_file()
    except NotFoundError:
        return any(folder.glob("*.xml"))


def _model_in(folder: Path, name: str) -> str:
    """Returns a robot's model file by name. Raises NotFoundError with the models there."""
    robot, _, file = name.partition("/")
    models_here = sorted(path.name for path in folder.glob("*.xml"))
    if not file:
        try:
            file = fetching.main_file(robot)
        except NotFoundError:  # none of the Menagerie's, but perhaps one's own
            if not models_here:
                raise
            if len(models_here) == 1:
                file = models_here[0]
    if file and (folder / file).is_file():
        return str((folder / file).resolve())
    wrong = f"no file '{file}'" if file else "no main file: it is not one of the Menagerie's robots"
    example = difflib.get_close_matches(file, models_here, 1) or models_here or ["MODEL.xml"]
    raise NotFoundError(
        f"robot '{robot}' has {wrong}. The models in {folder}: {', '.join(models_here) or 'none'}. "
        f"Name one of them, such as model_path('{robot}/{example[0]}')"
    )


def _cached_asset(rel: str, model: str = "") -> str | None:
    if model and override_file(model) is not None:
        return None
    path = cache_dir() / "assets" / rel
    return str(path.resolve()) if path.is_file() else None


def _folder(robot: str) -> Path:
    try:
        return Path(menagerie.folder(robot))
    except NotFoundError:
        return fetching.fetch(robot).folder


def _fill(dest: Path, folders: dict[str, Path], *, keep: bool = False) -> dict[str, str]:
    """Copies robots and assets; with `keep`, only missing ones.

    An interrupted copy counts as missing: models are copied last, and each file appears complete.
    """
    paths = {}
    for robot, folder in folders.items():
        main = fetching.main_file(robot)
        _copy(folder, dest / "menagerie" / robot, main, keep)
        paths[robot] = str(dest / "menagerie" / robot / main)
    _copy(folders[GRIPPER], dest / "assets" / GRIPPER, fetching.main_file(GRIPPER), keep)
    paths[GRIPPER_ASSET] = str(dest / "assets" / GRIPPER_ASSET)
    for asset, (model, _) in ASSETS.items():
        source, target = Path(models.resolve(model)), dest / "assets" / asset
        if not (keep and target.exists()):
            for mesh in source.parent.glob("*.obj"):
                _put(mesh, target.parent / mesh.name)
            _put(source, target)
        paths[asset] = str(target)
    return paths


def _copy(folder: Path, target: Path, main: str, keep: bool) -> None:
    if keep and (target / main).is_file():
        return
    if not (folder / main).is_file():
        raise NotFoundError(
            f"robot '{folder.name}': {folder} has no '{main}'. Delete the folder and fetch the "
            f"robot again: robocell fetch {folder.name}"
        )
    files = [path for path in folder.rglob("*") if path.is_file() and path.name != ".complete"]
    for path in sorted(files, key=lambda path: path == folder / main):
        _put(path, target / path.relative_to(folder))


def _put(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(f".{target.name}.{os.getpid()}")
    try:
        shutil.copyfile(source, part)
        part.replace(target)
    finally:
        part.unlink(missing_ok=True)
