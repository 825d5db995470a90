"""Fruit."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np

from object_models.parts import (
    Body,
    Geom,
    Kind,
    Look,
    ball_geom,
    capsule_geom,
    ellipsoid_geom,
    rod_geom,
)
from object_models.shapes import Mesh, lathe, loft, sweep

# Fruit rolls a little and comes to rest.
ROLLING: dict[str, Any] = {"friction": "0.8 0.02 0.003", "condim": 6}
BROWN = "0.33 0.22 0.12 1"
GREEN = "0.30 0.50 0.20 1"


def _leaf(x: float, y: float, z: float, length: float) -> Mesh:
    """A leaf that starts at a point and points to +x."""
    rings = []
    angles = 2 * np.pi * np.arange(8) / 8
    for s in np.linspace(0.02, 1, 7):
        width = 0.32 * length * math.sin(math.pi * s**0.8) + 0.0004
        rings.append(
            np.column_stack(
                [
                    0 * angles + x + length * s,
                    y + width * np.cos(angles),
                    z + 0.25 * length * math.sin(2.2 * s) + 0.0006 * np.sin(angles),
                ]
            )
        )
    return loft(rings)


def _foot(name: str, radius: float, z: float) -> Geom:
    """A thin flat foot, on which a fruit stands."""
    return rod_geom(name, radius, 0.004, (0, 0, z + 0.002))


def apple() -> Kind:
    """An apple of 62 mm."""
    r, points = 0.030, []
    for t in np.linspace(-math.pi / 2, math.pi / 2, 17):
        c, s = math.cos(t), math.sin(t)
        radius = r * c**0.82 * (1 + 0.04 * s)
        z = 0.030 * s - (
            0.009 * math.exp(-((radius / 0.011) ** 2))
            if s > 0
            else -0.005 * math.exp(-((radius / 0.011) ** 2))
        )
        points.append((radius, z))
    profile = [(0, points[0][1]), *points[1:-1], (0, points[-1][1])]
    low = min(z for _, z in profile)
    stem = sweep(
        [(0, 0, 0.019), (0.001, 0, 0.027), (0.004, 0, 0.035)],
        [(0.0014, 0.0014), (0.0012, 0.0012), (0.0016, 0.0016)],
        (0, 1, 0),
        8,
    )
    geoms = [
        ellipsoid_geom("apple_body", (0.0306, 0.0306, 0.0282), (0, 0, 0.0003)),
        _foot("apple_foot", 0.016, low),
        rod_geom("apple_stem", 0.002, 0.016, (0.002, 0, 0.027)),
    ]
    geoms[2].weight = 0.1
    looks = [
        Look(lathe(profile, 36), "0.76 0.13 0.13 1", 0.5, 0.6),
        Look(stem, BROWN),
        Look(_leaf(0.002, 0, 0.028, 0.022), GREEN),
    ]
    return Kind(
        Body("apple", 0.13, geoms, looks),
        "An apple.",
        "fruit",
        "red",
        "organic",
        ["red apple"],
        ["top", "side"],
        **ROLLING,
    )


def orange() -> Kind:
    """An orange of 62 mm."""
    r = 0.031
    t = np.linspace(-math.pi / 2, math.pi / 2, 17)
    profile = [
        (0, -0.0315),
        *[(r * math.cos(a), 0.0315 * math.sin(a)) for a in t[1:-1]],
        (0, 0.0310),
    ]
    button = lathe([(0, 0.0300), (0.0035, 0.0305), (0.0030, 0.0325), (0, 0.0328)], 10)
    geoms = [ellipsoid_geom("orange_body", (r, r, 0.0316)), _foot("orange_foot", 0.012, -0.0316)]
    looks = [Look(lathe(profile, 36), "0.93 0.52 0.10 1", 0.35, 0.4), Look(button, GREEN)]
    return Kind(
        Body("orange", 0.17, geoms, looks),
        "An orange.",
        "fruit",
        "orange",
        "organic",
        ["mandarin"],
        ["top", "side"],
        **ROLLING,
    )


def lemon() -> Kind:
    """A lemon of 78 mm, lying along x."""
    r = 0.0265
    xs = [
        -0.039,
        -0.0375,
        -0.034,
        -0.028,
        -0.018,
        -0.006,
        0.006,
        0.018,
        0.028,
        0.034,
        0.0375,
        0.039,
    ]
    rs = [
        0.0012,
        0.004,
        0.0075,
        0.0155,
        0.0225,
        0.0262,
        0.0262,
        0.0225,
        0.0155,
        0.0075,
        0.004,
        0.0012,
    ]
    body = lathe([(0, xs[0]), *zip(rs, xs, strict=True), (0, xs[-1])], 32).turned("y", 90)
    geoms = [
        ellipsoid_geom("lemon_body", (0.034, r, r)),
        capsule_geom("lemon_tips", (-0.034, 0, 0), (0.034, 0, 0), 0.005),
        rod_geom("lemon_foot", 0.010, 0.004, (0, 0, -r + 0.002)),
    ]
    return Kind(
        Body("lemon", 0.10, geoms, [Look(body, "0.95 0.83 0.18 1", 0.35, 0.4)]),
        "A lemon.",
        "fruit",
        "yellow",
        "organic",
        ["citron"],
        ["top"],
        **ROLLING,
    )


def pear() -> Kind:
    """A pear, 60 mm wide and 92 mm high."""
    profile = [
        (0, -0.043),
        (0.010, -0.0455),
        (0.018, -0.0440),
        (0.0255, -0.037),
        (0.0295, -0.026),
        (0.0300, -0.015),
        (0.0275, -0.003),
        (0.0225, 0.010),
        (0.0180, 0.020),
        (0.0150, 0.028),
        (0.0120, 0.034),
        (0.0075, 0.0378),
        (0, 0.0375),
    ]
    stem = sweep(
        [(0, 0, 0.034), (0.0005, 0, 0.041), (0.004, 0, 0.0465)],
        [(0.0015, 0.0015), (0.0013, 0.0013), (0.0018, 0.0018)],
        (0, 1, 0),
        8,
    )
    geoms = [
        ellipsoid_geom("pear_body", (0.0300, 0.0300, 0.0285), (0, 0, -0.0165)),
        capsule_geom("pear_neck", (0, 0, 0.0), (0, 0, 0.024), 0.0140),
        _foot("pear_foot", 0.016, -0.0455),
        rod_geom("pear_stem", 0.002, 0.012, (0.001, 0, 0.0405)),
    ]
    geoms[3].weight = 0.1
    looks = [
        Look(lathe(profile, 36), "0.66 0.74 0.24 1", 0.4, 0.5),
        Look(stem, BROWN),
        Look(_leaf(0.001, 0, 0.039, 0.020), GREEN),
    ]
    return Kind(
        Body("pear", 0.17, geoms, looks),
        "A pear.",
        "fruit",
        "green",
        "organic",
        [],
        ["top", "side"],
        **ROLLING,
    )


def banana() -> Kind:
    """A banana of 170 mm, lying on its side."""
    bend, radius = 0.115, 0.0165
    angles = np.radians(np.linspace(-42, 42, 15))
    path = [(bend * math.sin(a), bend * (math.cos(a) - 1), 0) for a in angles]
    widths = [0.35, 0.60, 0.80, 0.92, 0.98, 1, 1, 1, 1, 0.98, 0.94, 0.86, 0.72, 0.50, 0.28]
    turn = 2 * np.pi * np.arange(15) / 15
    rings = []
    for (x, y, _), w, a in zip(path, widths, angles, strict=True):
        r = radius * w * (1 + 0.05 * np.cos(5 * turn + math.pi / 5))
        across = np.array([math.sin(a), math.cos(a), 0])
        rings.append(
            np.array([x, y, 0])
            + np.outer(r * np.cos(turn), across)
            + np.outer(r * np.sin(turn), [0, 0, 1])
        )
    stem = sweep(
        [
            path[0],
            (path[0][0] - 0.010, path[0][1] - 0.012, 0),
            (path[0][0] - 0.017, path[0][1] - 0.024, 0),
        ],
        [(0.0055, 0.0055), (0.0042, 0.0042), (0.0050, 0.0050)],
        (0, 0, 1),
        10,
    )
    end = path[-1]
    tip = sweep(
        [end, (end[0] + 0.004, end[1] - 0.0045, 0), (end[0] + 0.0055, end[1] - 0.0062, 0)],
        [(0.0046, 0.0046), (0.0040, 0.0040), (0.0025, 0.0025)],
        (0, 0, 1),
        10,
    )
    geoms = []
    knots = [
        (1, 0.0110),
        (3, 0.0150),
        (5, 0.0165),
        (7, 0.0167),
        (9, 0.0165),
        (11, 0.0150),
        (13, 0.0100),
    ]
    for i, ((a, ra), (b, rb)) in enumerate(itertools.pairwise(knots)):
        geoms.append(capsule_geom(f"banana_{i}", path[a], path[b], max(min(ra, rb), 0.010)))
    geoms.append(ball_geom("banana_middle", 0.0169, path[7]))
    geoms.append(
        capsule_geom("banana_stem", path[0], (path[0][0] - 0.0145, path[0][1] - 0.0205, 0), 0.0048)
    )
    geoms.append(capsule_geom("banana_tip", path[-2], (end[0] + 0.0025, end[1] - 0.003, 0), 0.0040))
    # It rests on flat sides, as the ridges of a banana do.
    geoms.append(rod_geom("banana_foot", 0.011, 0.0338, (path[5][0], path[5][1], 0)))
    geoms.append(rod_geom("banana_foot_2", 0.011, 0.0338, (path[9][0], path[9][1], 0)))
    looks = [
        Look(loft(rings), "0.94 0.80 0.20 1", 0.3, 0.4),
        Look(stem, "0.72 0.66 0.22 1"),
        Look(tip, BROWN),
    ]
    return Kind(
        Body("banana", 0.13, geoms, looks),
        "A banana that lies on its side.",
        "fruit",
        "yellow",
        "organic",
        [],
        ["top"],
        **ROLLING,
    )


KINDS = (apple, banana, orange, pear, lemon)
