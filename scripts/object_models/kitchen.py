"""Vessels and containers of the kitchen."""

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
    box_geom,
    capsule_geom,
    hull_geom,
    ring_geoms,
    rod_geom,
)
from object_models.shapes import (
    Mesh,
    arc,
    box,
    extrude,
    lathe,
    rod,
    rounded_outline,
    sweep,
)

STEEL = "0.74 0.76 0.78 1"
BLACK = "0.10 0.10 0.11 1"
CREAM = "0.93 0.90 0.82 1"
SHINY: dict[str, Any] = {"specular": 0.9, "shininess": 0.85}


def bowl() -> Kind:
    """A bowl, 140 mm wide and 56 mm high."""
    r, h, foot, wall = 0.070, 0.028, 0.030, 0.004
    outer = [
        (foot + (r - foot) * math.sin(t), -h + 0.004 + (2 * h - 0.006) * (1 - math.cos(t)))
        for t in np.linspace(0, math.pi / 2, 10)
    ]
    inner = [
        (max(x - wall, 0.001), z + (wall if i < 3 else wall * (9 - i) / 9))
        for i, (x, z) in enumerate(outer)
    ]
    profile = [
        (0, -h),
        (foot, -h),
        *outer,
        (r - wall / 2, h - 0.0005),
        *inner[::-1],
        (0, -h + 2 * wall),
    ]
    knots = [outer[i] for i in (0, 3, 6, 9)]
    geoms = [rod_geom("bowl_bottom", foot, 0.008, (0, 0, -h + 0.004))]
    for i, (low, high) in enumerate(itertools.pairwise(knots)):
        name = "bowl_rim" if i == 2 else f"bowl_wall_{i}"
        geoms += ring_geoms(name, low, (high[0], h if i == 2 else high[1]), wall, 16)
    root = Body("bowl", 0.26, geoms, [Look(lathe(profile, 40), "0.33 0.55 0.62 1", 0.6, 0.6)])
    return Kind(root, "A bowl.", "kitchen", "blue", "ceramic", ["dish"], ["rim"])


def dinner_plate() -> Kind:
    """A dinner plate, 200 mm wide and 22 mm high."""
    r, h, well = 0.10, 0.011, 0.062
    profile = [
        (0, -h),
        (well - 0.010, -h),
        (well, -h + 0.004),
        (r - 0.002, h - 0.003),
        *arc(r - 0.002, h - 0.0015, 0.0015, -60, 120, 5),
        (well + 0.002, -h + 0.009),
        (well - 0.010, -h + 0.005),
        (0, -h + 0.005),
    ]
    geoms = [rod_geom("plate_bottom", well, 0.005, (0, 0, -h + 0.0025))]
    geoms += ring_geoms("plate_rim", (well, -h + 0.004), (r, h - 0.001), 0.005, 20)
    band = [(0.080, 0.0015), (0.083, 0.0015), (0.083, 0.0045), (0.080, 0.0030)]
    looks = [
        Look(lathe(profile, 56), "0.94 0.93 0.90 1", 0.6, 0.7),
        Look(lathe(band, 56), "0.25 0.40 0.65 1", 0.6, 0.7),
    ]
    root = Body("plate", 0.42, geoms, looks)
    return Kind(
        root, "A dinner plate.", "kitchen", "white", "ceramic", ["dinner plate", "dish"], ["rim"]
    )


def _tumbler(
    name: str,
    low: float,
    high: float,
    height: float,
    wall: float,
    mass: float,
    rgba: str,
    *,
    base: float = 0.006,
    specular: float = 0.5,
) -> Body:
    """A round vessel without a handle."""
    h = height / 2
    profile = [
        (0, -h),
        *arc(low - 0.004, -h + 0.004, 0.004, -90, -10, 4),
        *arc(high - wall / 2, h - wall / 2, wall / 2, 0, 180, 5),
        (low - wall, -h + base + 0.002),
        (low - wall - 0.003, -h + base),
        (0, -h + base),
    ]
    geoms = [
        rod_geom(f"{name}_bottom", low - 0.001, base, (0, 0, -h + base / 2)),
        *ring_geoms(f"{name}_wall", (low, -h), (high, h), wall, 12),
    ]
    return Body(name, mass, geoms, [Look(lathe(profile, 40), rgba, specular, 0.7)])


def cup() -> Kind:
    """A cup without a handle."""
    body = _tumbler("cup", 0.025, 0.031, 0.078, 0.0035, 0.13, "0.86 0.42 0.30 1")
    stripe = lathe([(0.0286, 0.012), (0.0294, 0.012), (0.0301, 0.021), (0.0293, 0.021)], 40)
    body.looks.append(Look(stripe, CREAM, 0.5, 0.7))
    return Kind(
        body,
        "A cup without a handle.",
        "kitchen",
        "red",
        "ceramic",
        ["beaker", "tumbler"],
        ["top", "side"],
    )


def glass() -> Kind:
    """A drinking glass."""
    body = _tumbler(
        "glass", 0.026, 0.031, 0.115, 0.003, 0.16, "0.70 0.85 0.92 0.45", base=0.010, specular=0.9
    )
    return Kind(
        body,
        "A drinking glass.",
        "kitchen",
        "clear",
        "glass",
        ["drinking glass", "water glass"],
        ["top", "side"],
    )


def _pan_vessel(
    name: str, low: float, high: float, height: float, wall: float
) -> tuple[list[Geom], Mesh]:
    h = height / 2
    profile = [
        (0, -h),
        *arc(low - 0.006, -h + 0.006, 0.006, -90, -10, 4),
        *arc(high - wall / 2, h - wall / 2, wall / 2, 0, 180, 5),
        (low - wall, -h + 0.008),
        (low - wall - 0.005, -h + 0.005),
        (0, -h + 0.005),
    ]
    geoms = [rod_geom(f"{name}_bottom", low - 0.001, 0.006, (0, 0, -h + 0.003))]
    geoms += ring_geoms(f"{name}_wall", (low, -h), (high, h), wall, 16)
    return geoms, lathe(profile, 44)


def pan() -> Kind:
    """A frying pan of 170 mm with a handle of 130 mm in +x."""
    geoms, mesh = _pan_vessel("pan", 0.072, 0.085, 0.040, 0.004)
    path = [
        (0.078, 0, 0.008),
        (0.10, 0, 0.016),
        (0.13, 0, 0.021),
        (0.17, 0, 0.023),
        (0.205, 0, 0.022),
        (0.212, 0, 0.0215),
    ]
    radii = [
        (0.005, 0.008),
        (0.006, 0.009),
        (0.009, 0.012),
        (0.010, 0.013),
        (0.009, 0.012),
        (0.004, 0.007),
    ]
    grip = [
        capsule_geom("pan_neck", (0.083, 0, 0.009), (0.105, 0, 0.017), 0.0055),
        capsule_geom("pan_handle", (0.118, 0, 0.0205), (0.202, 0, 0.0225), 0.0105),
    ]
    for geom in grip:
        geom.weight = 0.35
    low = rounded_outline(0.060, 0.060, 0.0599, 10)
    looks = [
        Look(mesh, "0.20 0.21 0.23 1", 0.5, 0.5),
        Look(extrude(low, 0.0006).at(0, 0, -0.0149), "0.30 0.30 0.31 1"),
        Look(sweep(path, radii, (0, 1, 0), 16), "0.52 0.20 0.14 1", 0.4, 0.5),
    ]
    root = Body("pan", 0.55, [*geoms, *grip], looks)
    return Kind(
        root,
        "A frying pan with a handle in +x.",
        "kitchen",
        "black",
        "metal",
        ["frying pan", "skillet"],
        ["handle"],
    )


def _loop(
    center: float, z: float, half: float, out: float, radius: float, sign: int
) -> tuple[list[Geom], Mesh]:
    """A handle on the wall of a pot, on one side in y."""
    y0 = sign * center
    points = [
        (-half, y0, z),
        (-half, y0 + sign * out * 0.7, z + 0.002),
        (-half * 0.6, y0 + sign * out, z + 0.003),
        (half * 0.6, y0 + sign * out, z + 0.003),
        (half, y0 + sign * out * 0.7, z + 0.002),
        (half, y0, z),
    ]
    side = "left" if sign > 0 else "right"
    geoms = [
        capsule_geom(f"pot_handle_{side}_{i}", a, b, radius)
        for i, (a, b) in enumerate(itertools.pairwise(points))
    ]
    return geoms, sweep(points, [(radius, radius)] * len(points), (0, 0, 1), 10)


def pot() -> Kind:
    """A pot, 150 mm wide and 90 mm high, with two handles."""
    geoms, mesh = _pan_vessel("pot", 0.073, 0.075, 0.090, 0.004)
    looks = [Look(mesh, STEEL, **SHINY)]
    for sign in (1, -1):
        more, look = _loop(0.073, 0.022, 0.028, 0.026, 0.0055, sign)
        geoms += more
        looks.append(Look(look, BLACK, 0.4, 0.5))
    root = Body("pot", 0.70, geoms, looks)
    return Kind(
        root,
        "A pot with two handles.",
        "kitchen",
        "silver",
        "metal",
        ["cooking pot", "saucepan"],
        ["handle"],
    )


def pot_lid() -> Kind:
    """The lid of the pot, with a knob."""
    profile = [
        (0, -0.001),
        (0.066, -0.006),
        (0.067, -0.010),
        (0.070, -0.010),
        (0.0705, -0.0035),
        (0.076, -0.003),
        (0.076, 0),
        (0.070, 0.002),
        (0.045, 0.009),
        (0.020, 0.0125),
        (0, 0.013),
    ]
    dome = lathe(
        [
            (0, 0.012),
            (0.008, 0.012),
            (0.008, 0.018),
            *arc(0.011, 0.026, 0.008, -90, 90, 7),
            (0, 0.034),
        ],
        32,
    )
    geoms = [
        rod_geom("pot_lid_seat", 0.070, 0.010, (0, 0, -0.005)),
        rod_geom("pot_lid_edge", 0.076, 0.003, (0, 0, -0.0015)),
        rod_geom("pot_lid_dome", 0.045, 0.009, (0, 0, 0.0045)),
        rod_geom("pot_lid_neck", 0.008, 0.010, (0, 0, 0.013)),
        rod_geom("pot_lid_knob", 0.018, 0.016, (0, 0, 0.026)),
    ]
    root = Body(
        "pot_lid",
        0.28,
        geoms,
        [Look(lathe(profile, 48), STEEL, **SHINY), Look(dome, BLACK, 0.4, 0.5)],
    )
    return Kind(
        root,
        "The lid of the pot, with a knob.",
        "kitchen",
        "silver",
        "metal",
        ["lid", "cover"],
        ["top"],
    )


def jar() -> Kind:
    """A jam jar with a screw lid."""
    r, h = 0.031, 0.044
    glass_ = lathe(
        [
            (0, -h),
            *arc(r - 0.005, -h + 0.005, 0.005, -90, 0, 4),
            *arc(r - 0.006, 0.018, 0.006, 0, 80, 5),
            (0.027, 0.026),
            (0, 0.026),
        ],
        40,
    )
    lid = lathe(
        [
            (0, 0.026),
            (0.029, 0.026),
            (0.0295, 0.027),
            *arc(0.0295, h - 0.0015, 0.0015, 0, 90, 3),
            (0, h),
        ],
        40,
    )
    label = lathe([(r, -0.026), (r + 0.0005, -0.026), (r + 0.0005, 0.008), (r, 0.008)], 40)
    geoms = [
        rod_geom("jar_body", r, 0.068, (0, 0, -h + 0.034)),
        rod_geom("jar_lid", 0.0295, h - 0.024, (0, 0, (h + 0.024) / 2)),
    ]
    geoms[1].weight = 0.5
    looks = [
        Look(glass_, "0.58 0.12 0.16 1", 0.9, 0.9),
        Look(lid, "0.85 0.70 0.28 1", **SHINY),
        Look(label, CREAM),
    ]
    return Kind(
        Body("jar", 0.28, geoms, looks),
        "A jam jar.",
        "kitchen",
        "red",
        "glass",
        ["jam jar"],
        ["top", "side"],
    )


def can() -> Kind:
    """A tin can."""
    r, h = 0.0315, 0.052
    body = [
        (0, -h + 0.002),
        (r - 0.003, -h + 0.002),
        (r - 0.002, -h),
        (r, -h),
        (r, -h + 0.003),
        (r - 0.0007, -h + 0.004),
    ]
    body += [
        (r - 0.0007, h - 0.004),
        (r, h - 0.003),
        (r, h),
        (r - 0.002, h),
        (r - 0.003, h - 0.002),
        (0, h - 0.002),
    ]
    label = lathe(
        [(r - 0.0007, -h + 0.010), (r, -h + 0.010), (r, h - 0.010), (r - 0.0007, h - 0.010)], 48
    )
    band = lathe([(r, -0.012), (r + 0.0003, -0.012), (r + 0.0003, 0.012), (r, 0.012)], 48)
    looks = [Look(lathe(body), STEEL, **SHINY), Look(label, "0.78 0.20 0.16 1"), Look(band, CREAM)]
    root = Body("can", 0.30, [rod_geom("can_body", r, 2 * h)], looks)
    return Kind(
        root,
        "A tin can.",
        "kitchen",
        "red",
        "metal",
        ["tin can", "tin", "soup can"],
        ["top", "side"],
    )


def milk_carton() -> Kind:
    """A gable-top carton."""
    a, h, gable, fin = 0.031, 0.075, 0.030, 0.012
    body = box((0, 0, -0.0), (a, a, h))
    roof = Mesh(
        np.array(
            [(-a, -a, h), (a, -a, h), (a, a, h), (-a, a, h), (-a, 0, h + gable), (a, 0, h + gable)]
        ),
        [[0, 1, 5, 4], [2, 3, 4, 5], [1, 2, 5], [3, 0, 4], [3, 2, 1, 0]],
    )
    ridge = box((0, 0, h + gable + fin / 2 - 0.001), (a, 0.0015, fin / 2 + 0.001))
    blue = "0.20 0.42 0.74 1"
    wave = [box((0, 0, -h + 0.030), (a + 0.0003, a + 0.0003, 0.022))]
    cap = rod(0.011, 0.010, 0.002).turned("x", 45).at(0, -a / 2 - 0.004, h + gable / 2 + 0.004)
    geoms = [
        box_geom("milk_carton_body", (a, a, h)),
        hull_geom("milk_carton_roof", roof),
        box_geom("milk_carton_fin", (a, 0.0015, fin / 2), (0, 0, h + gable + fin / 2)),
    ]
    looks = [
        Look(body + roof + ridge, "0.95 0.95 0.93 1"),
        Look(wave[0], blue),
        Look(box((a, 0, 0.022), (0.0004, 0.020, 0.014)), blue),
        Look(box((-a, 0, 0.022), (0.0004, 0.020, 0.014)), blue),
        Look(cap, blue),
    ]
    return Kind(
        Body("milk_carton", 0.45, geoms, looks),
        "A milk carton with a gable.",
        "kitchen",
        "white",
        "cardboard",
        ["milk", "carton"],
        ["side"],
    )


def salt_shaker() -> Kind:
    """A salt shaker, 42 mm wide and 92 mm high."""
    body = lathe(
        [
            (0, -0.046),
            *arc(0.018, -0.043, 0.003, -90, 0, 3),
            (0.019, 0.0),
            (0.0165, 0.018),
            (0, 0.018),
        ],
        36,
    )
    cap = lathe(
        [
            (0, 0.018),
            (0.017, 0.018),
            (0.0175, 0.030),
            *arc(0.0035, 0.032, 0.014, 0, 90, 6),
            (0, 0.046),
        ],
        36,
    )
    holes = [
        rod(0.0013, 0.001, segments=10).at(0.006 * math.cos(t), 0.006 * math.sin(t), 0.0457)
        for t in np.radians([0, 60, 120, 180, 240, 300])
    ]
    geoms = [
        rod_geom("salt_shaker_body", 0.020, 0.050, (0, 0, -0.021)),
        rod_geom("salt_shaker_neck", 0.0175, 0.032, (0, 0, 0.020)),
        rod_geom("salt_shaker_cap", 0.010, 0.010, (0, 0, 0.041)),
    ]
    looks = [Look(body, "0.93 0.94 0.95 1", 0.9, 0.9), Look(cap, STEEL, **SHINY)]
    looks += [Look(hole, BLACK) for hole in holes]
    return Kind(
        Body("salt_shaker", 0.14, geoms, looks),
        "A salt shaker.",
        "kitchen",
        "white",
        "glass",
        ["salt", "shaker"],
        ["top", "side"],
    )


KINDS = (bowl, dinner_plate, cup, glass, pan, pot, pot_lid, jar, can, milk_carton, salt_shaker)
