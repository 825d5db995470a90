"""Splits a shape into convex parts for collisions, with CoACD.

CoACD is native code that broken meshes can end: it runs in a process of its own, with a time limit.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from robocell._adding.errors import AddObjectError
from robocell._adding.hulls import Faces, Hull, hull_of, volume_of
from robocell._adding.meshes import Shape

CONVEX_SHARE = 0.97  # volume of a shape in that of its hull, from which one hull is enough
MOST_PARTS = 32
CONCAVITY = 0.05  # CoACD's threshold
LIMIT_S = 600


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


def _joined_faces(shape: Shape) -> Faces:
    faces, shift = [], 0
    for part in shape.parts:
        faces.append(part.faces + shift)
        shift += len(part.vertices)
    return np.vstack(faces)
