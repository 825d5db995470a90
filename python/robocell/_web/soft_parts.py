"""What a page draws of a scene that is no geom: tendons, flexes and skins.

Their shapes change with the state. A part is a surface, whose triangles stay while its vertices
move, or a number of segments, some of which may have no length. `points` are the vertices of all
parts, one after the other, in the world.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell._web.packed import Packed

HIDDEN_GROUP = 3  # from this group on, nothing is drawn
PULLEY = -2  # in `wrap_obj`
DEFAULT_RGBA = np.array([0.5, 0.5, 0.5, 1], np.float32)  # then the material's colour counts
LINES, SURFACE, SOLID = 1, 2, 3  # of a flex


class SoftParts:
    """The parts of a model.

    Args:
        model: The engine's model; None for no parts.

    Attributes:
        count: Number of points.
    """

    def __init__(self, model: Any = None) -> None:
        self._parts: list[dict[str, Any]] = []
        self._faces: list[NDArray[np.uint32] | None] = []
        self._points: list[Callable[[Any], NDArray[np.float64]]] = []
        self.count = 0
        if model is None:
            return
        for i in range(model.ntendon):
            self._add_tendon(model, i)
        for i in range(model.nflex):
            self._add_flex(model, i)
        for i in range(model.nskin):
            self._add_skin(model, i)

    def header(self, packed: Packed) -> list[dict[str, Any]]:
        """Returns what the geometry says about the parts."""
        return [
            part | ({} if faces is None else {"faces": packed.add(faces, "u4")})
            for part, faces in zip(self._parts, self._faces, strict=True)
        ]

    def points(self, data: Any) -> NDArray[np.float32]:
        """Returns the points in a state (count, 3); the engine has computed its positions."""
        if not self._points:
            return np.zeros((0, 3), np.float32)
        return np.concatenate([each(data) for each in self._points]).astype(np.float32)

    def _add(
        self,
        kind: str,
        rgba: NDArray[np.float32],
        count: int,
        points: Callable[[Any], NDArray[np.float64]],
        faces: NDArray[np.uint32] | None = None,
        radius: float = 0.0,
    ) -> None:
        part = {"kind": kind, "first": self.count, "count": count, "radius": radius}
        self._parts.append(part | {"rgba": [float(value) for value in rgba]})
        self._faces.append(faces)
        self._points.append(points)
        self.count += count

    def _add_tendon(self, model: Any, i: int) -> None:
        first, number = int(model.tendon_adr[i]), int(model.tendon_num[i])
        if model.wrap_type[first] == 1 or model.tendon_group[i] >= HIDDEN_GROUP:
            return  # a tendon of joints has no place

        def points(data: Any) -> NDArray[np.float64]:
            at, used = int(data.ten_wrapadr[i]), int(data.ten_wrapnum[i])
            path = data.wrap_xpos.reshape(-1, 3)[at : at + used]
            objects = data.wrap_obj.reshape(-1)[at : at + used]
            ends = np.zeros((2 * number - 1, 2, 3))  # a geom adds a point to its own
            ends[:] = path[0] if used else 0.0
            through = (objects[:-1] != PULLEY) & (objects[1:] != PULLEY)
            segments = np.stack([path[:-1], path[1:]], axis=1)[through]
            ends[: len(segments)] = segments
            return ends.reshape(-1, 3)

        rgba = _rgba(model, model.tendon_rgba[i], int(model.tendon_matid[i]))
        count, radius = 2 * (2 * number - 1), float(model.tendon_width[i])
        self._add("segments", rgba, count, points, radius=radius)

    def _add_flex(self, model: Any, i: int) -> None:
        if model.flex_group[i] >= HIDDEN_GROUP:
            return
        dim = int(model.flex_dim[i])
        first, number = int(model.flex_vertadr[i]), int(model.flex_vertnum[i])
        vertices = slice(first, first + number)
        rgba = _rgba(model, model.flex_rgba[i], int(model.flex_matid[i]))
        at, count = int(model.flex_elemdataadr[i]), int(model.flex_elemnum[i])
        if dim == LINES:
            ends = model.flex_elem[at : at + 2 * count].copy()
            radius = float(max(model.flex_radius[i], 1e-3))
            self._add(
                "segments",
                rgba,
                2 * count,
                lambda data: data.flexvert_xpos[vertices][ends],
                radius=radius,
            )
            return
        if dim == SOLID:
            at, count = int(model.flex_shelldataadr[i]), int(model.flex_shellnum[i])
            faces = model.flex_shell[at : at + 3 * count]
        else:
            faces = model.flex_elem[at : at + 3 * count]
        self._add(
            "surface",
            rgba,
            number,
            lambda data: data.flexvert_xpos[vertices],
            np.asarray(faces, np.uint32),
        )

    def _add_skin(self, model: Any, i: int) -> None:
        if model.skin_group[i] >= HIDDEN_GROUP:
            return
        at, number = int(model.skin_vertadr[i]), int(model.skin_vertnum[i])
        vertices = np.asarray(model.skin_vert[at : at + number], float)
        bones: list[tuple[int, NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]] = []
        start = int(model.skin_boneadr[i])
        for bone in range(start, start + int(model.skin_bonenum[i])):
            first, count = int(model.skin_bonevertadr[bone]), int(model.skin_bonevertnum[bone])
            moved = np.array(model.skin_bonevertid[first : first + count], np.int64)
            weights = np.array(model.skin_bonevertweight[first : first + count], float)
            # The vertices in the axes of the bone.
            rest = vertices[moved] - model.skin_bonebindpos[bone]
            own = rest @ _matrix(model.skin_bonebindquat[bone])
            bones.append((int(model.skin_bonebodyid[bone]), moved, weights[:, None], own))

        def points(data: Any) -> NDArray[np.float64]:
            found = np.zeros((number, 3))
            for body, moved, weights, own in bones:
                placed = own @ data.xmat[body].reshape(3, 3).T + data.xpos[body]
                np.add.at(found, moved, weights * placed)
            return found

        at, count = int(model.skin_faceadr[i]), int(model.skin_facenum[i])
        faces = np.asarray(model.skin_face[at : at + count], np.uint32).reshape(-1)
        rgba = _rgba(model, model.skin_rgba[i], int(model.skin_matid[i]))
        self._add("surface", rgba, number, points, faces)


def _rgba(model: Any, rgba: NDArray[np.float32], material: int) -> NDArray[np.float32]:
    """Returns the colour of a part: its own, else that of its material."""
    if material >= 0 and np.array_equal(rgba, DEFAULT_RGBA):
        return np.asarray(model.mat_rgba[material])
    return np.asarray(rgba)


def _matrix(quaternion: Any) -> NDArray[np.float64]:
    """Returns the matrix of a quaternion (w, x, y, z)."""
    w, x, y, z = (float(value) for value in quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
