"""Cameras for a robot whose model has none: one on the hand and one that sees the whole robot."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from robocell._onboarding.guess import Confidence, Guess
from robocell._onboarding.source_model import SourceModel, Vector
from robocell._onboarding.tcp import rounded

BEHIND = 0.09  # of a wrist camera: behind the TCP, m
BESIDE = (0.07, 0.1, 0.14)  # and beside it, the nearest from which nothing hides the TCP
AHEAD = 0.03  # it looks at this beyond the TCP


@dataclass(frozen=True)
class Camera:
    """A camera of the robot file, or the name of one of the model."""

    name: str
    field: dict[str, object] | None = None

    def __str__(self) -> str:
        return self.name


def cameras_of_model(source: SourceModel, bodies: list[int]) -> list[str]:
    """Returns the cameras that move with the robot."""
    own = set(bodies)
    m = source.model
    return [str(m.cam(c).name) for c in range(m.ncam) if int(m.cam_bodyid[c]) in own]


def is_on(source: SourceModel, camera: str, body: int) -> bool:
    """Returns True if a body carries a camera of the model."""
    return source.is_below(int(source.model.cam_bodyid[source.model.cam(camera).id]), body)


def wrist_camera(
    source: SourceModel, body: int, tcp: Vector, approach: Vector, closing: Vector, name: str
) -> Guess[Camera]:
    """Returns a camera beside the fingers that looks at the TCP; all in the hand's frame."""
    side = np.cross(closing, approach)
    places = [
        tcp - BEHIND * approach + sign * offset * side for offset in BESIDE for sign in (1, -1)
    ]
    clear = [place for place in places if _sees(source, body, place, tcp)]
    place = (clear or places)[0]
    field = {
        "name": name,
        "attach_to": {"body": source.body_name(body)},
        "pos": rounded(place, 3),
        "look_at": rounded(tcp + AHEAD * approach, 3),
        "fovy": 60,
    }
    if clear:
        return Guess(Camera(name, field), "beside the hand, looking at the TCP", Confidence.HIGH)
    return Guess(
        Camera(name, field),
        "beside the hand, looking at the TCP, which a part of the hand hides",
        Confidence.LOW,
    )


def _sees(source: SourceModel, body: int, place: Vector, tcp: Vector) -> bool:
    """Returns True if no geom of the hand is between a position and (nearly) the TCP."""
    d = source.data
    rotation = d.xmat[body].reshape(3, 3)
    begin, end = (rotation @ point + d.xpos[body] for point in (place, tcp))
    way = end - begin
    length = float(np.linalg.norm(way))
    hit = np.array([-1], dtype=np.int32)
    distance = mujoco.mj_ray(source.model, d, begin, way / length, None, 1, -1, hit, None)
    return distance < 0 or distance > 0.7 * length


def exo_camera(source: SourceModel, body: int, reach: float, name: str) -> Guess[Camera]:
    """Returns a camera in front and to the side that sees the robot and its workspace."""
    reach = max(reach, 0.15)
    field = {
        "name": name,
        "attach_to": {"body": source.body_name(body)},
        "pos": rounded([1.35 * reach, 1.35 * reach, 1.05 * reach], 2),
        "look_at": rounded([0.35 * reach, 0, 0.25 * reach], 2),
        "fovy": 50,
    }
    return Guess(Camera(name, field), "sees the robot and what is before it", Confidence.HIGH)
