"""Takes a user's MJCF model, with the files that it names, into the catalogue."""

from __future__ import annotations

import re
import shutil
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import mujoco

from robocell._adding.errors import AddObjectError

# Elements whose files are not in the folder of meshes.
FOLDERS = {"texture": "texturedir", "model": "", "include": "", "plugin": ""}
NOT_COPIED = (
    "Copy the model and its files into one folder, and name them from there: meshes, textures, "
    "height fields, skins, includes and attached models are copied with it"
)


def copy_model(path: Path, folder: Path, name: str) -> None:
    """Copies a model as NAME.xml, and its files under the names that it has for them.

    Raises:
        AddObjectError: The model is no single object that moves freely, or names files outside its
            folder.
    """
    spec = _compiled(path, path)
    _require_one_object(path, spec)
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
    _compiled(folder / f"{name}.xml", path)


def _require_one_object(path: Path, spec: mujoco.MjSpec) -> None:
    roots = [body for body in spec.bodies if body.parent == spec.worldbody]
    if len(roots) != 1:
        raise AddObjectError(
            f"{path}: has {len(roots)} bodies in its worldbody, and an object has one: put the "
            "others into it, or into files of their own"
        )
    joints = list(roots[0].joints)
    if any(joint.type != mujoco.mjtJoint.mjJNT_FREE for joint in joints):
        raise AddObjectError(
            f"{path}: its outermost body '{roots[0].name}' has the joint '{joints[0].name}', and "
            "an object moves freely: give that body a <freejoint/> and its joints to a body inside "
            "it"
        )


def _compiled(path: Path, given: Path) -> mujoco.MjSpec:
    """Compiles a model; messages are about the file that the user gave."""
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        spec.compile()
    except (ValueError, mujoco.FatalError, FileNotFoundError) as error:
        reason = " ".join(str(error).split())
        if path == given:
            raise AddObjectError(f"{given}: MuJoCo cannot load it: {reason}") from None
        raise AddObjectError(
            f"{given}: MuJoCo cannot load its copy: {reason.replace(str(path.parent) + '/', '')}. "
            f"{NOT_COPIED}"
        ) from None
    return spec


@dataclass
class _Document:
    """A file of a model; an attached model has folders of its own."""

    root: ET.Element
    base: PurePosixPath  # of its names, relative to the folder of the outermost model
    compiler: dict[str, str]  # shared with its includes


def _files_of(path: Path) -> list[str]:
    """The files that a model, its includes and the models that it attaches name.

    Relative to the model's folder.
    """
    found: list[str] = []
    for document in list(_documents(path, PurePosixPath(path.name), None, found, set())):
        for element in document.root.iter():
            folder = document.compiler.get(FOLDERS.get(element.tag, "meshdir"), "")
            for attribute, value in element.attrib.items():
                if not attribute.startswith("file") or not value or element.tag == "include":
                    continue
                if document.compiler.get("strippath") == "true":
                    value = PurePosixPath(value).name
                found.append(_inside(path, document.base / folder / value))
    return list(dict.fromkeys(found))


def _documents(
    path: Path, file: PurePosixPath, parent: _Document | None, found: list[str], seen: set[str]
) -> Iterator[_Document]:
    """Reads a file of a model, then those that it includes or attaches."""
    if str(file) in seen:
        return
    seen.add(str(file))
    root = _parsed(path, path.parent / file)
    if parent is None:
        document = _Document(root, file.parent, {})
    else:
        document = _Document(root, parent.base, parent.compiler)
    for compiler in root.iter("compiler"):
        given = dict(compiler.attrib)
        if asset := given.pop("assetdir", ""):
            given = {"meshdir": asset, "texturedir": asset, **given}
        document.compiler.update(given)
    for include in root.iter("include"):
        # MuJoCo looks beside the file that includes, then beside the model.
        names = [folder / include.get("file", "") for folder in (file.parent, document.base)]
        name = next((name for name in names if (path.parent / name).is_file()), names[0])
        found.append(_inside(path, name))
        yield from _documents(path, name, document, found, seen)
    for model in root.iter("model"):
        if attached := model.get("file"):
            name = PurePosixPath(_inside(path, document.base / attached))
            yield from _documents(path, name, None, found, seen)
    yield document


def _parsed(path: Path, file: Path) -> ET.Element:
    # MuJoCo's reader allows "--" in comments.
    text = re.sub(rb"<!--.*?-->", b"", file.read_bytes(), flags=re.DOTALL)
    try:
        return ET.fromstring(text)
    except ET.ParseError as error:
        raise AddObjectError(
            f"{path}: its files cannot be found, because {file} is no valid XML without its "
            f"comments: {error}. Correct it there"
        ) from None


def _inside(path: Path, file: PurePosixPath) -> str:
    if not file.name or file.is_absolute() or ".." in file.parts:
        raise AddObjectError(
            f"{path}: names the file '{file}', which is not in its folder. {NOT_COPIED}"
        )
    return str(file)
