"""Convex hulls, as MuJoCo computes them for collisions."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from robocell._adding.errors import AddObjectError

Points = NDArray[np.float64]  # (n, 3) metres
Faces = NDArray[np.int64]  # (m, 3)
Hull = tuple[Points, Faces]

MOST_VERTICES = 64


def hull_of(points: Points, place: str, *, most: int = MOST_VERTICES) -> Hull:
    """Returns the convex hull of points, with faces that wind counter-clockwise.

    Args:
        points: The points.
        place: Names them in messages.
        most: Vertices of the hull; -1 for as many as it has.
    """
    spec = mujoco.MjSpec()
    spec.add_mesh(
        name="hull",
        uservert=np.unique(np.round(points, 7), axis=0).ravel(),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
        maxhullvert=most,
    )
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="hull")
    try:
        model = spec.compile()
    except (ValueError, mujoco.FatalError) as error:
        reason = str(error).splitlines()[0]
        raise AddObjectError(f"{place}: its points have no convex hull: {reason[:160]}") from None
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, model.mesh_quat[0])
    vertices = model.mesh_vert @ turn.reshape(3, 3).T + model.mesh_pos[0]
    graph = model.mesh_graph[model.mesh_graphadr[0] :]
    used, count = graph[0], graph[1]
    numbers = graph[2 + used : 2 + 2 * used]  # of the hull's vertices
    faces = graph[2 + 3 * used + 3 * count :][: 3 * count].reshape(-1, 3)
    position = np.zeros(len(vertices), np.int64)
    position[numbers] = np.arange(used)
    hull = vertices[numbers].astype(float), position[faces]
    return hull if signed_volume(*hull) > 0 else (hull[0], hull[1][:, ::-1])


def volume_of(hull: Hull) -> float:
    """Returns the volume of a hull, m^3."""
    return abs(signed_volume(*hull))


def signed_volume(vertices: Points, faces: Faces) -> float:
    """Returns the volume within closed faces, m^3; negative if they wind clockwise."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6)
