"""Turns the faces of a closed mesh outwards.

Programs export meshes with faces that wind either way, and of several closed surfaces some inside
out. Volumes, CoACD and renderers need all of them to wind counter-clockwise, seen from outside.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robocell._adding.hulls import Faces, Points, signed_volume


def faces_to_turn(vertices: Points, faces: Faces) -> NDArray[np.bool_] | None:
    """Returns which faces wind the wrong way; None for a surface without an outside.

    The faces form closed surfaces: each edge belongs to two. A surface inside another that winds
    the other way is a cavity and stays.
    """
    pairs = _neighbours(faces)
    if pairs is None:
        return None
    spread = _Spread(*pairs)
    surfaces: list[NDArray[np.int64]] = []
    for first in range(len(faces)):
        if not spread.is_reached[first]:
            reached = spread.surface_of(first)
            if reached is None:
                return None
            surfaces.append(np.array(reached))
    turn = np.array(spread.turn)
    for members in surfaces:
        if np.count_nonzero(turn[members]) > len(members) / 2:
            turn[members] = ~turn[members]  # most of its faces keep their side
    outside = np.where(turn[:, None], faces[:, ::-1], faces)
    if signed_volume(vertices, outside) < 0:  # all of it is inside out, cavities too
        turn, outside = ~turn, outside[:, ::-1]
    lows = np.array([vertices[faces[members]].min((0, 1)) for members in surfaces])
    highs = np.array([vertices[faces[members]].max((0, 1)) for members in surfaces])
    for i, members in enumerate(surfaces):
        if signed_volume(vertices, outside[members]) >= 0:
            continue
        point = vertices[outside[members[0], 0]]
        around = np.all((lows <= point) & (point <= highs), axis=1)
        around[i] = False
        others = [outside[surfaces[other]] for other in np.flatnonzero(around)]
        if sum(_is_inside(point, vertices, other) for other in others) % 2 == 0:
            turn[members] = ~turn[members]
    return turn


# Of each edge of each face, (n, 3): the face beyond it, and whether both go along it the same way.
_Pairs = tuple[NDArray[np.int64], NDArray[np.bool_]]


def _neighbours(faces: Faces) -> _Pairs | None:
    edges = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    low, high = edges.min(1), edges.max(1)
    order = np.lexsort((high, low))
    one, two = order[0::2], order[1::2]
    if len(edges) % 2 or np.any(low[one] != low[two]) or np.any(high[one] != high[two]):
        return None  # an edge of one face or of three
    beyond = np.empty(len(edges), np.int64)
    beyond[one], beyond[two] = two // 3, one // 3
    same = np.empty(len(edges), bool)
    same[one] = same[two] = edges[one, 0] == edges[two, 0]
    return beyond.reshape(-1, 3), same.reshape(-1, 3)


class _Spread:
    """Goes from face to face. Lists, since numpy is slow with single numbers."""

    def __init__(self, beyond: NDArray[np.int64], same: NDArray[np.bool_]) -> None:
        self._beyond, self._same = beyond.tolist(), same.tolist()
        self.is_reached = [False] * len(beyond)
        self.turn = [False] * len(beyond)

    def surface_of(self, first: int) -> list[int] | None:
        """Notes which faces to turn; None if two ways to a face disagree."""
        self.is_reached[first] = True
        members = [first]
        for face in members:  # grows as it goes
            for other, must_differ in zip(self._beyond[face], self._same[face], strict=True):
                wanted = self.turn[face] != must_differ
                if not self.is_reached[other]:
                    self.is_reached[other], self.turn[other] = True, wanted
                    members.append(other)
                elif self.turn[other] != wanted:
                    return None
        return members


def _is_inside(point: Points, vertices: Points, faces: Faces) -> bool:
    """Returns true if a closed surface winds around a point: by the solid angle that it fills."""
    a, b, c = (vertices[faces[:, i]] - point for i in range(3))
    la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
    above = np.sum(a * np.cross(b, c), axis=1)
    below = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return abs(2 * np.arctan2(above, below).sum()) > 2 * np.pi
