"""Meshes of the catalogue: turned, extruded, lofted and rounded shapes.

Lengths are metres. All shapes are closed, and their faces wind counter-clockwise seen from outside.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

SEGMENTS = 48  # of a full turn


@dataclass
class Mesh:
    """Triangles or polygons over vertices (n, 3) in metres; faces wind counter-clockwise."""

    vertices: np.ndarray
    faces: list[list[int]]

    def __add__(self, other: Mesh) -> Mesh:
        shift = len(self.vertices)
        moved = [[i + shift for i in face] for face in other.faces]
        return Mesh(np.vstack([self.vertices, other.vertices]), self.faces + moved)

    def triangles(self) -> list[tuple[int, int, int]]:
        """The faces as fans of triangles."""
        return [(f[0], f[i], f[i + 1]) for f in self.faces for i in range(1, len(f) - 1)]

    def to_obj(self, decimals: int = 6) -> str:
        """Wavefront OBJ text."""
        lines = [f"v {x:.6g} {y:.6g} {z:.6g}" for x, y, z in self.vertices.round(decimals) + 0.0]
        lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in self.triangles()]
        return "\n".join(lines) + "\n"

    def volume(self) -> float:
        """The enclosed volume, m^3; negative if the faces wind clockwise."""
        v = self.vertices
        return sum(float(np.dot(v[a], np.cross(v[b], v[c]))) for a, b, c in self.triangles()) / 6

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner."""
        return self.vertices.min(0), self.vertices.max(0)

    def at(self, x: float = 0, y: float = 0, z: float = 0) -> Mesh:
        """This mesh, moved."""
        return Mesh(self.vertices + np.array([x, y, z]), self.faces)

    def stretched(self, x: float, y: float, z: float) -> Mesh:
        """This mesh, scaled along its axes; a negative factor mirrors it."""
        flipped = [face[::-1] for face in self.faces] if x * y * z < 0 else self.faces
        return Mesh(self.vertices * np.array([x, y, z]), flipped)

    def turned(self, axis: str, degrees: float) -> Mesh:
        """This mesh, turned about an axis through the origin."""
        return Mesh(self.vertices @ rotation(axis, math.radians(degrees)).T, self.faces)


def rotation(axis: str, angle: float) -> np.ndarray:
    """The matrix of a rotation about x, y or z."""
    i = "xyz".index(axis)
    j, k = (i + 1) % 3, (i + 2) % 3
    matrix = np.eye(3)
    matrix[j, j] = matrix[k, k] = math.cos(angle)
    matrix[k, j], matrix[j, k] = math.sin(angle), -math.sin(angle)
    return matrix


def outwards(mesh: Mesh) -> Mesh:
    """The mesh with faces that wind counter-clockwise; it must be closed."""
    return mesh if mesh.volume() > 0 else Mesh(mesh.vertices, [face[::-1] for face in mesh.faces])


def lathe(profile: Sequence[tuple[float, float]], segments: int = SEGMENTS) -> Mesh:
    """Turns a closed chain of (radius, z), counter-clockwise in the r-z plane, about z.

    A point with radius 0 becomes one vertex, so a profile may start and end on the axis.
    """
    rings: list[tuple[int, int]] = []
    vertices: list[tuple[float, float, float]] = []
    for radius, z in profile:
        count = 1 if radius == 0 else segments
        rings.append((len(vertices), count))
        for k in range(count):
            angle = 2 * math.pi * k / segments
            vertices.append((radius * math.cos(angle), radius * math.sin(angle), z))
    faces = []
    for (a, na), (b, nb) in zip(rings, rings[1:] + rings[:1], strict=True):
        for k in range(segments):
            n = (k + 1) % segments
            quad = [a + k % na, a + n % na, b + n % nb, b + k % nb]
            face = list(dict.fromkeys(quad))
            if len(face) > 2:
                faces.append(face)
    return Mesh(np.array(vertices), faces)


def arc(
    cx: float, cz: float, radius: float, start: float, end: float, steps: int = 6
) -> list[tuple[float, float]]:
    """Points of an arc in the r-z plane; angles in degrees from the r axis."""
    angles = np.radians(np.linspace(start, end, steps))
    return [(cx + radius * math.cos(a), cz + radius * math.sin(a)) for a in angles]


def between(rings: list[tuple[np.ndarray, float]], turn: np.ndarray) -> Mesh:
    """A closed chain of (radius at each angle, z), like lathe but not round."""
    n, vertices, faces = len(turn), [], []
    for radius, z in rings:
        vertices += list(
            zip(radius * np.cos(turn), radius * np.sin(turn), 0 * turn + z, strict=True)
        )
    for i in range(len(rings)):
        a, b = i * n, (i + 1) % len(rings) * n
        faces += [[a + k, a + (k + 1) % n, b + (k + 1) % n, b + k] for k in range(n)]
    return Mesh(np.array(vertices), faces)


def extrude(outline: Sequence[tuple[float, float]], height: float) -> Mesh:
    """A convex outline in x-y, counter-clockwise, extruded from -height/2 to height/2."""
    n = len(outline)
    vertices = [(x, y, z) for z in (-height / 2, height / 2) for x, y in outline]
    sides = [[k, (k + 1) % n, n + (k + 1) % n, n + k] for k in range(n)]
    return Mesh(np.array(vertices), [list(range(n))[::-1], list(range(n, 2 * n)), *sides])


def box(center: tuple[float, float, float], half: tuple[float, float, float]) -> Mesh:
    """An axis-aligned box."""
    x, y, z = half
    mesh = extrude([(-x, -y), (x, -y), (x, y), (-x, y)], 2 * z)
    return Mesh(mesh.vertices + np.array(center), mesh.faces)


def rounded_box(half: tuple[float, float, float], radius: float, steps: int = 2) -> Mesh:
    """A box about the origin whose edges are rounded.

    Args:
        half: Half sizes.
        radius: Of the edges; at most the smallest half size.
        steps: Facets of a quarter turn.
    """
    inner = np.array(half) - min(radius, *half)
    radius = min(radius, *half)
    ticks = np.tan(np.linspace(0, math.pi / 4, steps + 1))[1:]
    line = np.concatenate([-ticks[::-1], [0.0], ticks])
    n = len(line)
    vertices: list[np.ndarray] = []
    number: dict[tuple[int, int, int], int] = {}
    faces: list[list[int]] = []

    def vertex(direction: np.ndarray, corner: np.ndarray) -> int:
        point = corner * inner + radius * direction / np.linalg.norm(direction)
        key = tuple(round(v * 1e7) for v in point)
        if key not in number:
            number[key] = len(vertices)
            vertices.append(point)
        return number[key]

    # A sphere of six square grids, cut along the planes of symmetry and pulled apart.
    for axis in range(3):
        for sign in (-1.0, 1.0):
            j, k = (axis + 1) % 3, (axis + 2) % 3
            coords = [(v, side) for v in line for side in ((-1, 1) if v == 0 else (np.sign(v),))]
            grid = []
            for v, sv in coords:
                row = []
                for w, sw in coords:
                    direction, corner = np.zeros(3), np.zeros(3)
                    direction[axis], direction[j], direction[k] = sign, v, w
                    corner[axis], corner[j], corner[k] = sign, sv, sw
                    row.append(vertex(direction, corner))
                grid.append(row)
            for a in range(n):
                for b in range(n):
                    face = [grid[a][b], grid[a + 1][b], grid[a + 1][b + 1], grid[a][b + 1]]
                    face = list(dict.fromkeys(face if sign > 0 else face[::-1]))
                    if len(face) > 2:
                        faces.append(face)
    return Mesh(np.array(vertices), faces)


def rounded_outline(
    half_x: float, half_y: float, radius: float, steps: int = 4
) -> list[tuple[float, float]]:
    """A rectangle with round corners in the plane, counter-clockwise."""
    points: list[tuple[float, float]] = []
    for sx, sy, start in ((1, 1, 0), (-1, 1, 90), (-1, -1, 180), (1, -1, 270)):
        cx, cy = sx * (half_x - radius), sy * (half_y - radius)
        points += arc(cx, cy, radius, start, start + 90, steps + 1)
    return list(dict.fromkeys(points))


def plate(outline: Sequence[tuple[float, float]], height: float, bevel: float = 0.0) -> Mesh:
    """Any simple outline, counter-clockwise, extruded about z = 0; its edges may be bevelled."""
    flat = np.array(outline)
    n = len(flat)
    before, after = np.roll(flat, 1, 0), np.roll(flat, -1, 0)
    d1, d2 = flat - before, after - flat
    d1 /= np.linalg.norm(d1, axis=1)[:, None]
    d2 /= np.linalg.norm(d2, axis=1)[:, None]
    normals = np.stack([d1[:, 1] + d2[:, 1], -d1[:, 0] - d2[:, 0]], 1)
    normals /= np.maximum(np.sum(normals**2, 1), 0.5)[:, None] / 2
    small = flat - bevel * normals
    h = height / 2
    layers = [(flat, -h), (flat, h)]
    if bevel > 0:
        layers = [(small, -h), (flat, -h + bevel), (flat, h - bevel), (small, h)]
    vertices = np.vstack([np.column_stack([xy, np.full(n, z)]) for xy, z in layers])
    faces = []
    for i in range(len(layers) - 1):
        a, b = i * n, (i + 1) * n
        faces += [[a + k, a + (k + 1) % n, b + (k + 1) % n, b + k] for k in range(n)]
    last = (len(layers) - 1) * n
    for a, b, c in _ears(layers[0][0]):
        faces += [[c, b, a], [last + a, last + b, last + c]]
    return Mesh(vertices, faces)


def _ears(outline: np.ndarray) -> list[tuple[int, int, int]]:
    """Triangles of a simple polygon, by cutting ears."""

    def cross(a: int, b: int, c: int) -> float:
        p, q = outline[b] - outline[a], outline[c] - outline[a]
        return float(p[0] * q[1] - p[1] * q[0])

    rest, triangles = list(range(len(outline))), []
    while len(rest) > 3:
        best = None
        for i in range(len(rest)):
            a, b, c = rest[i - 1], rest[i], rest[(i + 1) % len(rest)]
            if cross(a, b, c) <= 1e-14:
                continue
            inside = any(
                cross(a, b, p) >= 0 and cross(b, c, p) >= 0 and cross(c, a, p) >= 0
                for p in rest
                if p not in (a, b, c)
            )
            # The shortest cut makes the best triangles.
            length = float(np.linalg.norm(outline[a] - outline[c]))
            if not inside and (best is None or length < best[0]):
                best = (length, i)
        i = best[1] if best else 0
        triangles.append((rest[i - 1], rest[i], rest[(i + 1) % len(rest)]))
        del rest[i]
    return [*triangles, (rest[0], rest[1], rest[2])]


def loft(rings: Sequence[np.ndarray]) -> Mesh:
    """A skin over rings (n, 3) with equally many points, closed by flat ends."""
    n = len(rings[0])
    faces = []
    for i in range(len(rings) - 1):
        a, b = i * n, (i + 1) * n
        faces += [[a + k, a + (k + 1) % n, b + (k + 1) % n, b + k] for k in range(n)]
    last = (len(rings) - 1) * n
    faces += [list(range(n))[::-1], list(range(last, last + n))]
    return outwards(Mesh(np.vstack(rings), faces))


def sweep(
    path: Sequence[Sequence[float]] | Sequence[np.ndarray],
    radii: Sequence[tuple[float, float]],
    side: Sequence[float] = (0, 1, 0),
    segments: int = 16,
) -> Mesh:
    """Ellipses along a path, the skin of which is a handle, a stalk or a banana.

    Args:
        path: Points (n, 3).
        radii: At each point, across the path and along `side`.
        side: A direction that the path never has.
        segments: Of an ellipse.
    """
    points = np.array(path, float)
    tangents = np.gradient(points, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    angles = 2 * np.pi * np.arange(segments) / segments
    rings = []
    for point, tangent, (across, along) in zip(points, tangents, radii, strict=True):
        y = np.array(side, float) - np.dot(side, tangent) * tangent
        y /= np.linalg.norm(y)
        x = np.cross(y, tangent)
        rings.append(
            point + across * np.outer(np.cos(angles), x) + along * np.outer(np.sin(angles), y)
        )
    return loft(rings)


def ball(radius: float, segments: int = 24, rings: int = 12) -> Mesh:
    """A sphere about the origin."""
    profile = [(radius * math.cos(a), radius * math.sin(a)) for a in _half_turn(rings)]
    return lathe([(0, -radius), *profile, (0, radius)], segments)


def _half_turn(rings: int) -> np.ndarray:
    return np.linspace(-math.pi / 2, math.pi / 2, rings + 1)[1:-1]


def rod(radius: float, height: float, bevel: float = 0.0, segments: int = 32) -> Mesh:
    """An upright cylinder about the origin with bevelled edges."""
    h = height / 2
    if bevel == 0:
        return lathe([(0, -h), (radius, -h), (radius, h), (0, h)], segments)
    low = arc(radius - bevel, -h + bevel, bevel, -90, 0, 3)
    high = arc(radius - bevel, h - bevel, bevel, 0, 90, 3)
    return lathe([(0, -h), *low, *high, (0, h)], segments)


def tube(path: np.ndarray, radius: float, segments: int = 12) -> Mesh:
    """A round tube along a planar path (n, 3) in the x-z plane, with flat ends."""
    tangents = np.gradient(path, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    side = np.array([0.0, 1.0, 0.0])
    vertices, faces = [], []
    for point, tangent in zip(path, tangents, strict=True):
        normal = np.cross(side, tangent)
        for k in range(segments):
            angle = 2 * math.pi * k / segments
            vertices.append(point + radius * (math.cos(angle) * normal + math.sin(angle) * side))
    for i in range(len(path) - 1):
        for k in range(segments):
            a, b = i * segments + k, i * segments + (k + 1) % segments
            faces.append([a, a + segments, b + segments, b])
    last = (len(path) - 1) * segments
    faces += [list(range(segments)), list(range(last, last + segments))[::-1]]
    # The rings turn clockwise about the path, hence the reversal.
    return Mesh(np.array(vertices), [face[::-1] for face in faces])
