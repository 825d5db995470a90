"""Takes a user's MJCF model, with the files that it names, into the catalogue."""

from __future__ import annotations

import shutil
import xml.etree.ElementTree as ET
from pathlib import Path, PurePosixPath

import mujoco

from robocell._adding.meshes import AddObjectError

NAMED_BY = {"mesh": "meshdir", "texture": "texturedir", "hfield": ""}


def copy_model(path: Path, folder: Path, name: str) -> None:
    """Copies a model as NAME.xml, and its files under the names that it has for them.

    Raises:
        AddObjectError: The model is no single object, or names files outside its folder.
    """
    spec = _compiled(path)
    roots = [body for body in spec.bodies if body.parent == spec.worldbody]
    if len(roots) != 1:
        raise AddObjectError(
            f"{path}: has {len(roots)} bodies in its worldbody, and an object has one: put the "
            "others into it, or into files of their own"
        )
    shutil.copyfile(path, folder / f"{name}.xml")
    for file in _files_of(path):
        source = path.parent / file
        target = folder / file
        if target.exists():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            shutil.copyfile(source, target)
        except OSError as error:
            raise AddObjectError(f"{path}: '{file}' cannot be read: {error.strerror}") from None


def _compiled(path: Path) -> mujoco.MjSpec:
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        spec.compile()
    except (ValueError, mujoco.FatalError, FileNotFoundError) as error:
        raise AddObjectError(
            f"{path}: MuJoCo cannot load it: {' '.join(str(error).split())}"
        ) from None
    return spec


def _files_of(path: Path) -> list[str]:
    """The files that a model and its includes name, relative to its folder."""
    found: list[str] = []
    waiting, seen = [path], {path.resolve()}
    folders = {"meshdir": "", "texturedir": ""}
    documents = []
    while waiting:
        document = waiting.pop(0)
        root = ET.parse(document).getroot()
        documents.append(root)
        for compiler in root.iter("compiler"):
            asset = compiler.get("assetdir", "")
            for key in folders:
                folders[key] = compiler.get(key, asset) or folders[key]
        for include in root.iter("include"):
            file = _inside(path, include.get("file", ""))
            found.append(file)
            if (path.parent / file).resolve() not in seen:
                seen.add((path.parent / file).resolve())
                waiting.append(path.parent / file)
    for root in documents:
        for tag, key in NAMED_BY.items():
            for element in root.iter(tag):
                for attribute, value in element.attrib.items():
                    if attribute.startswith("file") and value:
                        found.append(_inside(path, str(PurePosixPath(folders.get(key, ""), value))))
    return list(dict.fromkeys(found))


def _inside(path: Path, file: str) -> str:
    if not file or PurePosixPath(file).is_absolute() or ".." in PurePosixPath(file).parts:
        raise AddObjectError(
            f"{path}: names the file '{file}', which is not in its folder. Copy the model and its "
            "files into one folder, and name them from there"
        )
    return file
