"""Splits a shape into convex parts for collisions, with CoACD.

CoACD is native code that broken meshes can end: it runs in a process of its own, with a time limit.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from robocell._adding.meshes import AddObjectError, Faces, Points, Shape

CONVEX_SHARE = 0.97  # volume of a shape in that of its hull, from which one hull is enough
MOST_PARTS = 32
CONCAVITY = 0.05  # CoACD's threshold
LIMIT_S = 600

Hull = tuple[Points, Faces]


def convex_parts(shape: Shape, place: str, *, split: bool = True) -> list[Hull]:
    """Returns convex hulls, (vertices, faces) each, that together cover the shape.

    Args:
        shape: The shape.
        place: Names it in messages.
        split: False for one hull around all of it.
    """
    points = shape.points()
    whole = hull_of(points, place)
    if not split or (shape.is_watertight and shape.volume > CONVEX_SHARE * volume_of(whole)):
        return [whole]
    with tempfile.TemporaryDirectory() as folder:
        given, made = Path(folder, "given.npz"), Path(folder, "made.npz")
        np.savez(given, vertices=points, faces=_joined_faces(shape))
        command = [sys.executable, "-P", "-c", CODE, str(given), str(made)]
        options = [str(CONCAVITY), str(MOST_PARTS)]
        try:
            done = subprocess.run(
                [*command, *options], capture_output=True, timeout=LIMIT_S, check=False
            )
        except subprocess.TimeoutExpired:
            raise AddObjectError(
                f"{place}: its convex parts were not found within {LIMIT_S} s. Simplify the mesh, "
                "or give --one-hull"
            ) from None
        if done.returncode != 0 or not made.is_file():
            reason = done.stderr.decode(errors="replace").strip().splitlines()
            raise AddObjectError(
                f"{place}: CoACD found no convex parts"
                f"{f' ({reason[-1][:120]})' if reason else ''}. Repair the mesh, or give --one-hull"
            )
        with np.load(made) as parts:
            count = len(parts.files) // 2
            hulls = [hull_of(parts[f"v{i}"], place) for i in range(count)]
    if not hulls:
        raise AddObjectError(f"{place}: CoACD found no convex parts. Give --one-hull")
    return hulls


# What the process of its own does.
CODE = """
import sys
import numpy as np
import coacd
coacd.set_log_level("error")
given = np.load(sys.argv[1])
mesh = coacd.Mesh(given["vertices"], given["faces"])
parts = coacd.run_coacd(
    mesh, threshold=float(sys.argv[3]), max_convex_hull=int(sys.argv[4]), mcts_iterations=60, seed=0
)
arrays = {}
for i, (vertices, faces) in enumerate(parts):
    arrays[f"v{i}"], arrays[f"f{i}"] = vertices, faces
np.savez(sys.argv[2], **arrays)
"""


def hull_of(points: Points, place: str) -> Hull:
    """Returns the convex hull of points, with faces that wind counter-clockwise.

    MuJoCo computes it, as it does for collisions.
    """
    import mujoco

    spec = mujoco.MjSpec()
    spec.add_mesh(
        name="hull",
        uservert=np.unique(np.round(points, 7), axis=0).ravel(),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
        maxhullvert=64,
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
    position = {int(number): i for i, number in enumerate(numbers)}
    triangles = np.array([[position[int(v)] for v in face] for face in faces], np.int64)
    hull = vertices[numbers].astype(float), triangles
    return hull if _signed_volume(*hull) > 0 else (hull[0], triangles[:, ::-1])


def volume_of(hull: Hull) -> float:
    """Returns the volume of a hull, m^3."""
    return abs(_signed_volume(*hull))


def _signed_volume(vertices: Points, faces: Faces) -> float:
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6)


def _joined_faces(shape: Shape) -> Faces:
    faces, shift = [], 0
    for part in shape.parts:
        faces.append(part.faces + shift)
        shift += len(part.vertices)
    return np.vstack(faces)
