"""Puts a new object on a floor, lets it come to rest, and draws it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

import robocell as rc
from robocell._adding.errors import AddObjectError
from robocell._adding.meshes import LARGEST_M
from robocell.render import OrbitCamera, Renderer, write_png

LONGEST_S = 6.0  # until it rests
CHUNK_S = 1.0
TIMESTEP = 0.002
DEEPEST = 1e-3  # m
REST_SPEED = 0.05  # m/s and rad/s
SIZE_PX = (480, 360)


@dataclass
class Rest:
    """How an object comes to rest."""

    size: NDArray[np.float64]  # m, of its bounding box as it stands in its file
    mass: float  # kg
    tilt: float  # degrees between how it stands in its file and how it rests
    penetration: float  # m
    is_still: bool


def settle(model: Path, picture: Path | None, place: str) -> Rest:
    """Lets an object fall from just above a floor.

    Args:
        model: Its MJCF.
        picture: Where a picture of it is written, as it stands in its file; None for no picture.
        place: Names it in messages.

    Raises:
        AddObjectError: It cannot stand in a scene, has no shape that collides, or the simulation
            diverges.
    """
    try:
        scene = _scene(model)
    except rc.Error as error:
        reason = str(error).replace(f"{model.resolve().parent}/", "")
        raise AddObjectError(f"{place}: a scene cannot have it: {reason}") from None
    low, high, volume = _bounds(scene)
    size = high - low
    if size.max() > LARGEST_M:
        raise AddObjectError(
            f"{place}: is {size.max():.3g} m large, and lengths are in metres. Is it in "
            'millimetres? Then give its <mesh> scale="0.001 0.001 0.001"'
        )
    if volume == 0:
        raise AddObjectError(f"{place}: none of its geoms collides (contype, conaffinity)")
    body = scene.model.body(scene.compiled.object("object").root_body).id
    start = scene.data.joint(0).qpos.copy()
    start[2] -= low[2] - 1e-4
    scene.data.joint(0).qpos[:] = start
    scene.forward()
    if picture is not None:
        _draw(scene, picture, size)
    data = scene.data
    is_still = False
    while data.time < LONGEST_S and not is_still:
        result = scene.step_n(round(CHUNK_S / TIMESTEP))
        if not result.ok:
            raise AddObjectError(f"{place}: does not come to rest: {result.message}")
        is_still = bool(np.abs(data.qvel[:6]).max() < REST_SPEED)
    up = data.xmat[body].reshape(3, 3)[:, 2]
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, start[3:7])
    tilt = np.degrees(np.arccos(np.clip(up @ matrix.reshape(3, 3)[:, 2], -1, 1)))
    deepest = max((-float(contact.dist) for contact in data.contact), default=0.0)
    return Rest(
        size=size,
        mass=float(scene.model.body_subtreemass[body]),
        tilt=float(tilt),
        penetration=max(deepest, 0.0),
        is_still=is_still,
    )


def _scene(model: Path) -> rc.Scene:
    spec = rc.SceneSpec(name="object", timestep=TIMESTEP, add_floor=True, add_skybox=True)
    spec.objects.append(
        rc.SceneObject(name="object", mjcf_path=str(model.resolve()), pos=[0, 0, 0], fixed=False)
    )
    return rc.Scene.build(spec)


def _bounds(scene: rc.Scene) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Lowest and highest corner of what collides, and how many geoms do."""
    model, data = scene.model, scene.data
    low, high, count = np.full(3, np.inf), np.full(3, -np.inf), 0
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    for geom in range(model.ngeom):
        touches = model.geom_contype[geom] or model.geom_conaffinity[geom]
        if model.geom_bodyid[geom] == 0 or not touches:
            continue
        mesh = model.geom_dataid[geom]
        if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
            first = model.mesh_vertadr[mesh]
            local = model.mesh_vert[first : first + model.mesh_vertnum[mesh]]
        else:
            local = model.geom_aabb[geom, :3] + signs * model.geom_aabb[geom, 3:]
        points = local @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        low, high, count = (
            np.minimum(low, points.min(0)),
            np.maximum(high, points.max(0)),
            count + 1,
        )
    if count == 0:
        low = high = np.zeros(3)
    return low, high, count


def _draw(scene: rc.Scene, path: Path, size: NDArray[np.float64]) -> None:
    renderer = Renderer(scene, backend="soft", quality="high")
    extent = float(np.linalg.norm(size))
    view = OrbitCamera(
        lookat=np.array([0, 0, size[2] / 2]), distance=2.0 * extent, azimuth=125, elevation=-28
    )
    image = renderer.render(view, width=2 * SIZE_PX[0], height=2 * SIZE_PX[1])["rgb"]
    small = image.reshape(SIZE_PX[1], 2, SIZE_PX[0], 2, 3).mean((1, 3)).round().astype(np.uint8)
    write_png(path, np.ascontiguousarray(small))
