"""Reads OBJ, STL and GLB files into one mesh for each colour.

Every fault of a file is an `AddObjectError` that names the file and the next step.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from robocell._adding.errors import AddObjectError
from robocell._adding.hulls import Faces, Points, hull_of, signed_volume, volume_of
from robocell._adding.winding import faces_to_turn

MESH_SUFFIXES = (".obj", ".stl", ".glb")
LARGEST_FILE = 200_000_000  # bytes
MOST_TRIANGLES = 500_000
LARGEST_M = 10.0  # kLargestObject of scenes/catalogue.h
SMALLEST_M = 1e-3
GREY = (0.7, 0.7, 0.7, 1.0)


@dataclass
class Coloured:
    """Triangles of one colour."""

    vertices: Points  # (n, 3) metres
    faces: Faces  # (m, 3)
    rgba: tuple[float, float, float, float]


@dataclass
class Shape:
    """What a file shows."""

    parts: list[Coloured]
    is_watertight: bool  # closed, with faces that can be turned outwards
    volume: float  # m^3; of the convex hull unless watertight
    lost: list[str]  # what the file has and the object will not

    def points(self) -> Points:
        """All vertices."""
        return np.vstack([part.vertices for part in self.parts])


def read_shape(path: Path, *, scale: float = 1.0, up: str = "") -> Shape:
    """Reads a mesh file.

    Args:
        path: OBJ, STL or GLB.
        scale: Factor from the file's units to metres.
        up: Axis of the file that points up, "y" or "z". Default: "y" for GLB, as its standard says,
            else "z".

    Returns:
        The shape, with z up and its origin in the middle of its bounding box.
    """
    import trimesh

    scene, lost = _load(path)
    _require_few_triangles(path, scene)
    parts: list[Coloured] = []
    whole = []
    for mesh in cast("list[Any]", scene.dump()):
        if len(getattr(mesh, "faces", ())) == 0:
            continue  # points or lines
        rgba, has_texture = _colour_of(mesh)
        if has_texture:
            lost.append("textures: each part gets their main colour")
        whole.append(mesh)
        parts.append(
            Coloured(np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int64), rgba)
        )
    if not parts:
        raise AddObjectError(f"{path}: has no triangles. Export it as a mesh with faces")
    _place(path, parts, scale, up or ("y" if path.suffix.lower() == ".glb" else "z"))
    joined: Any = trimesh.util.concatenate(whole) if len(whole) > 1 else whole[0]
    mesh = trimesh.Trimesh(_all_points(parts), joined.faces, process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    vertices, faces = np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int64)
    turn = faces_to_turn(vertices, faces) if mesh.is_watertight else None
    volume = 0.0
    if turn is not None:
        _turn(parts, turn)
        volume = signed_volume(vertices, np.where(turn[:, None], faces[:, ::-1], faces))
    is_watertight = volume > 0
    if not is_watertight:
        volume = volume_of(hull_of(vertices, str(path), most=-1))
    return Shape(parts, is_watertight, volume, sorted(set(lost)))


def _require_few_triangles(path: Path, scene: Any) -> None:
    """Counts the triangles of each copy of a mesh before the copies are made."""
    triangles = sum(
        len(getattr(scene.geometry[scene.graph[node][1]], "faces", ()))
        for node in scene.graph.nodes_geometry
    )
    if triangles > MOST_TRIANGLES:
        raise AddObjectError(
            f"{path}: has {triangles:,} triangles, and at most {MOST_TRIANGLES:,} are drawn fast "
            "enough. Simplify it in the program that made it (in Blender: Decimate)"
        )


def _turn(parts: list[Coloured], turn: Any) -> None:
    first = 0
    for part in parts:
        of_part = turn[first : first + len(part.faces), None]
        part.faces = np.where(of_part, part.faces[:, ::-1], part.faces)
        first += len(part.faces)


def _load(path: Path) -> tuple[Any, list[str]]:
    import trimesh

    if path.suffix.lower() not in MESH_SUFFIXES:
        raise AddObjectError(
            f"{path}: '{path.suffix}' is no format of objects. Give MJCF (.xml), "
            f"{', '.join(MESH_SUFFIXES)}; others are converted by Blender or trimesh"
        )
    try:
        size = path.stat().st_size
    except OSError as error:
        raise AddObjectError(f"{path}: cannot be read: {error.strerror}") from None
    if size == 0:
        raise AddObjectError(f"{path}: is empty")
    if size > LARGEST_FILE:
        raise AddObjectError(f"{path}: has {size / 1e6:.0f} MB, at most {LARGEST_FILE / 1e6:.0f}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            scene = trimesh.load_scene(path)
    except (MemoryError, RecursionError) as error:
        raise AddObjectError(f"{path}: cannot be read: {type(error).__name__}") from None
    except Exception as error:  # the readers raise whatever a broken file leads to
        text = " ".join(str(error).split()) or type(error).__name__
        kind = path.suffix[1:].upper()
        raise AddObjectError(
            f"{path}: is no {kind} file that can be read: {text[:200]}. Export it again"
        ) from None
    return scene, []


def _colour_of(mesh: Any) -> tuple[tuple[float, float, float, float], bool]:
    """The main colour of a mesh, and whether it has a texture."""
    visual = mesh.visual
    material = getattr(visual, "material", None)
    texture = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    try:
        rgba = np.asarray(visual.main_color if material is None else material.main_color, float)
    except Exception:  # a material without a colour
        return GREY, texture is not None
    if rgba.shape != (4,) or not np.all(np.isfinite(rgba)):
        return GREY, texture is not None
    r, g, b, a = np.clip(rgba / 255, 0, 1)
    return (float(r), float(g), float(b), float(a) or 1.0), texture is not None


def _place(path: Path, parts: list[Coloured], scale: float, up: str) -> None:
    """Scales, turns and centres the parts; rejects sizes that no object has."""
    for part in parts:
        if not np.all(np.isfinite(part.vertices)):
            raise AddObjectError(f"{path}: has a vertex that is not a finite number")
        if part.faces.min() < 0 or part.faces.max() >= len(part.vertices):
            raise AddObjectError(f"{path}: has a face of a vertex that there is not")
        part.vertices = part.vertices * scale
        if up == "y":
            part.vertices = part.vertices[:, [0, 2, 1]] * np.array([1.0, -1.0, 1.0])
    points = _all_points(parts)
    low, high = points.min(0), points.max(0)
    size = high - low
    largest = float(size.max())
    if not np.isfinite(largest) or largest > LARGEST_M:
        raise AddObjectError(
            f"{path}: is {largest:.3g} m large, and lengths are in metres. Is it in millimetres? "
            f"Then give --scale 0.001 (it would be {largest / 1000:.3g} m)"
        )
    if largest < SMALLEST_M:
        raise AddObjectError(
            f"{path}: is {largest:.3g} m large. Give --scale: 1000 if it is in kilometres, or the "
            "factor from its units to metres"
        )
    if float(np.sort(size)[1]) < 1e-6 * largest or float(size.min()) < 1e-5:
        raise AddObjectError(
            f"{path}: is flat ({' x '.join(f'{v:.3g}' for v in size)} m). An object needs a volume"
        )
    for part in parts:
        part.vertices = part.vertices - (low + high) / 2


def _all_points(parts: list[Coloured]) -> Points:
    return np.vstack([part.vertices for part in parts])
