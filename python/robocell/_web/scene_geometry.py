"""What a page draws of a scene: shapes once, poses of bodies in every state.

`geometry_of` packs the model's geoms, meshes, height fields and textures, with its joints, cameras
and frames; `body_poses` are the numbers of a state. Geoms are fixed to bodies, so a state is the
pose of each body: position and quaternion xyzw; and the points of what is no geom (soft_parts.py).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell import _core
from robocell._notebook import has_arm, orbit_of
from robocell._web.packed import Packed
from robocell._web.soft_parts import SoftParts

LARGEST_TEXTURE = 1024  # pixels of a side; larger ones are thinned out
HIDDEN_GROUP = 3  # from this group on, geoms are for collisions
TYPES = {
    0: "plane",
    1: "hfield",
    2: "sphere",
    3: "capsule",
    4: "ellipsoid",
    5: "cylinder",
    6: "box",
    7: "mesh",
}
HINGE, SLIDE = 3, 2
TEXTURE_2D, RGB_ROLE = 0, 1
DEFAULT_RGBA = np.array([0.5, 0.5, 0.5, 1], np.float32)  # then the material's colour counts


def body_poses(scene: _core.Scene) -> NDArray[np.float32]:
    """Returns the poses of all bodies (nbody, 7): position, quaternion xyzw."""
    data = scene.data
    poses = np.empty((len(data.xpos), 7), np.float32)
    poses[:, :3] = data.xpos
    poses[:, 3:] = np.roll(data.xquat, -1, axis=1)
    return poses


def geometry_of(scene: _core.Scene, soft: SoftParts | None = None) -> bytes:
    """Returns everything that a page draws, as it is now.

    Args:
        scene: The scene.
        soft: Its soft parts; by default all of them.
    """
    model: Any = scene.model
    soft = soft or SoftParts(model)
    packed = Packed()
    lookat, distance = orbit_of(scene)
    geoms = [_geom(model, i) for i in range(model.ngeom) if int(model.geom_type[i]) in TYPES]
    meshes = sorted({geom["mesh"] for geom in geoms if geom["type"] == "mesh"})
    fields = sorted({geom["mesh"] for geom in geoms if geom["type"] == "hfield"})
    textures = sorted({geom["texture"] for geom in geoms if geom["texture"] >= 0})
    header = {
        "generation": scene.generation,
        "name": scene.name,
        "bodies": scene.body_names(),
        "geoms": geoms,
        "meshes": {i: _mesh(model, i, packed) for i in meshes},
        "hfields": {i: _height_field(model, i, packed) for i in fields},
        "textures": {i: _texture(model, i, packed) for i in textures},
        "joints": joints_of(scene),
        "grippers": [robot.name for robot in scene.robots if robot.has_gripper],
        "cameras": scene.camera_names(),
        "frames": frames_of(scene),
        "lookat": list(map(float, lookat)),
        "distance": float(distance),
        "extent": float(model.stat.extent),
        "poses": packed.add(body_poses(scene)),
        "soft": soft.header(packed),
        "points": packed.add(soft.points(scene.data)),
    }
    return packed.block(header)


def joints_of(scene: _core.Scene) -> list[dict[str, Any]]:
    """Returns the hinges and slides with their limits, in the model's order."""
    model: Any = scene.model
    found = []
    for i in range(model.njnt):
        if int(model.jnt_type[i]) not in (HINGE, SLIDE):
            continue
        slide = int(model.jnt_type[i]) == SLIDE
        lower, upper = (-1.0, 1.0) if slide else (-np.pi, np.pi)
        if model.jnt_limited[i]:
            lower, upper = map(float, model.jnt_range[i])
        unit = "m" if slide else "rad"
        found.append({"name": _name(model.joint(i).name, "joint", i), "lower": lower})
        found[-1] |= {"upper": upper, "unit": unit, "qpos": int(model.jnt_qposadr[i])}
    return found


def frames_of(scene: _core.Scene) -> list[dict[str, Any]]:
    """Returns the frames that a page can draw: TCPs, sites and cameras, fixed to bodies."""
    model: Any = scene.model
    found = [
        _frame(f"{robot.name} TCP", "robot", model, model.site(robot.tcp_site), model.site_quat)
        for robot in scene.robots
        if has_arm(robot) and robot.has_tcp_frame
    ]
    for i in range(model.nsite):
        if name := model.site(i).name:
            found.append(_frame(name, "site", model, model.site(i), model.site_quat))
    for i in range(model.ncam):
        if name := model.camera(i).name:
            found.append(_frame(name, "camera", model, model.camera(i), model.cam_quat))
    return found


def _frame(text: str, kind: str, model: Any, element: Any, quaternions: Any) -> dict[str, Any]:
    return {
        "name": text,
        "kind": kind,
        "body": int(element.bodyid[0]),
        "pos": _numbers(element.pos),
        "quat": _numbers(np.roll(quaternions[element.id], -1)),
    }


def _name(name: str, kind: str, number: int) -> str:
    return name or f"{kind}#{number}"


def _numbers(values: Any) -> list[float]:
    return [float(each) for each in values]


def _geom(model: Any, i: int) -> dict[str, Any]:
    kind = TYPES[int(model.geom_type[i])]
    material = int(model.geom_matid[i])
    rgba = model.geom_rgba[i]
    texture, repeat, uniform = -1, [1.0, 1.0], False
    if material >= 0:
        if np.array_equal(rgba, DEFAULT_RGBA):
            rgba = model.mat_rgba[material]
        texture = int(model.mat_texid[material][RGB_ROLE])
        repeat = _numbers(model.mat_texrepeat[material])
        uniform = bool(model.mat_texuniform[material])
    if texture >= 0 and int(model.tex_type[texture]) != TEXTURE_2D:
        rgba = np.append(_mean_colour(model, texture) * rgba[:3], rgba[3])
        texture = -1
    return {
        "body": int(model.geom_bodyid[i]),
        "type": kind,
        "size": _numbers(model.geom_size[i]),
        "pos": _numbers(model.geom_pos[i]),
        "quat": _numbers(np.roll(model.geom_quat[i], -1)),
        "rgba": _numbers(rgba),
        "mesh": int(model.geom_dataid[i]),
        "texture": texture,
        "repeat": repeat,
        "uniform": uniform,
        "hidden": int(model.geom_group[i]) >= HIDDEN_GROUP,
    }


def _mesh(model: Any, i: int, packed: Packed) -> dict[str, Any]:
    """Returns a mesh with one vertex for each different corner of its faces."""
    first, count = int(model.mesh_vertadr[i]), int(model.mesh_vertnum[i])
    faces = slice(model.mesh_faceadr[i], model.mesh_faceadr[i] + model.mesh_facenum[i])
    corner = model.mesh_face[faces].reshape(-1).astype(np.int64)
    normal = model.mesh_facenormal[faces].reshape(-1).astype(np.int64)
    vertices = model.mesh_vert[first : first + count]
    at, n_normals = int(model.mesh_normaladr[i]), max(int(model.mesh_normalnum[i]), 1)
    normals = model.mesh_normal[at : at + n_normals]
    at, n_uvs = int(model.mesh_texcoordadr[i]), int(model.mesh_texcoordnum[i])
    key = corner * n_normals + normal
    uv = None
    if at >= 0 and n_uvs:
        uv = model.mesh_facetexcoord[faces].reshape(-1).astype(np.int64)
        key = key * n_uvs + uv
    _, chosen, faces_of = np.unique(key, return_index=True, return_inverse=True)
    found = {
        "vertices": packed.add(vertices[corner[chosen]]),
        "normals": packed.add(normals[normal[chosen]]),
        "faces": packed.add(faces_of.reshape(-1), "u4"),
    }
    if uv is not None:
        found["uvs"] = packed.add(model.mesh_texcoord[at : at + n_uvs][uv[chosen]])
    return found


def _height_field(model: Any, i: int, packed: Packed) -> dict[str, Any]:
    rows, columns = int(model.hfield_nrow[i]), int(model.hfield_ncol[i])
    at = int(model.hfield_adr[i])
    heights = model.hfield_data[at : at + rows * columns].reshape(rows, columns)
    x, y, top, _ = model.hfield_size[i]
    grid = np.stack(
        [
            *np.meshgrid(np.linspace(-x, x, columns), np.linspace(-y, y, rows)),
            top * heights,
        ],
        axis=-1,
    )
    corner = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = corner[:-1, :-1], corner[:-1, 1:], corner[1:, :-1], corner[1:, 1:]
    faces = np.stack([np.stack([a, b, d], -1), np.stack([a, d, c], -1)], -2)
    return {
        "vertices": packed.add(grid.reshape(-1, 3)),
        "faces": packed.add(faces.reshape(-1), "u4"),
    }


def _pixels(model: Any, i: int) -> NDArray[np.uint8]:
    height, width = int(model.tex_height[i]), int(model.tex_width[i])
    channels, at = int(model.tex_nchannel[i]), int(model.tex_adr[i])
    pixels = model.tex_data[at : at + height * width * channels]
    return np.asarray(pixels, np.uint8).reshape(height, width, channels)


def _mean_colour(model: Any, i: int) -> NDArray[np.float64]:
    pixels = _pixels(model, i)
    colour = pixels.reshape(-1, pixels.shape[-1]).mean(axis=0) / 255
    return np.resize(colour, 3) if len(colour) < 3 else np.asarray(colour[:3])


def _texture(model: Any, i: int, packed: Packed) -> dict[str, Any]:
    pixels = _pixels(model, i)
    step = -(-max(pixels.shape[:2]) // LARGEST_TEXTURE)
    pixels = pixels[::step, ::step]
    height, width, channels = pixels.shape
    rgba = np.full((height, width, 4), 255, np.uint8)
    rgba[:, :, :3] = pixels[:, :, :3] if channels >= 3 else pixels[:, :, :1]
    if channels == 4:
        rgba[:, :, 3] = pixels[:, :, 3]
    return {"pixels": packed.add(rgba, "u1"), "width": width, "height": height}
