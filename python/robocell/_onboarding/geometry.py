"""Points on the surfaces of a model's geoms, for distances with their positions."""

from __future__ import annotations

import itertools
from typing import Any

import mujoco
import numpy as np

from robocell._onboarding.source_model import SourceModel, Vector

MOST_POINTS = 800
AS_NEAR = 1e-3  # m: points that are nearest together with others
PER_AXIS = 5  # points along each side of a geom's box


def surface_points(source: SourceModel, data: Any, geoms: list[int]) -> Vector:
    """(n, 3) points on geoms in the world, n at most `MOST_POINTS`.

    Of meshes these are vertices, of other geoms points on the box around them.
    """
    found = [np.zeros((0, 3))]
    for geom in geoms:
        if source.model.geom_rbound[geom] <= 0:
            continue  # a plane
        rotation = data.geom_xmat[geom].reshape(3, 3)
        found.append(_own_points(source, geom) @ rotation.T + data.geom_xpos[geom])
    points = np.concatenate(found)
    return points[:: max(1, -(-len(points) // MOST_POINTS))]


def nearest_points(first: Vector, second: Vector) -> tuple[float, Vector, Vector]:
    """Returns the least distance of two clouds of points, and the middle of each where they meet.

    Parallel edges and faces are as near everywhere: their middle counts, not one of their ends.
    """
    gaps = np.linalg.norm(first[:, None, :] - second[None, :, :], axis=2)
    least = float(gaps.min())
    near = gaps <= least + AS_NEAR
    return least, first[near.any(axis=1)].mean(axis=0), second[near.any(axis=0)].mean(axis=0)


def _own_points(source: SourceModel, geom: int) -> Vector:
    m = source.model
    mesh = int(m.geom_dataid[geom])
    if int(m.geom_type[geom]) == int(mujoco.mjtGeom.mjGEOM_MESH) and mesh >= 0:
        begin = int(m.mesh_vertadr[mesh])
        return np.array(m.mesh_vert[begin : begin + int(m.mesh_vertnum[mesh])], dtype=float)
    centre, half = m.geom_aabb[geom][:3], m.geom_aabb[geom][3:]
    steps = np.linspace(-1, 1, PER_AXIS)
    grid = np.array([p for p in itertools.product(steps, repeat=3) if max(map(abs, p)) == 1])
    return centre + grid * half
