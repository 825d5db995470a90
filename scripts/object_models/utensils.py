"""Cutlery, a spatula and a cutting board."""

from __future__ import annotations

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
    rod_geom,
)
from object_models.shapes import (
    Mesh,
    arc,
    box,
    loft,
    plate,
    sweep,
)

STEEL = "0.74 0.76 0.78 1"
OAK = "0.72 0.52 0.32 1"
BLACK = "0.10 0.10 0.11 1"
SHINY: dict[str, Any] = {"specular": 0.9, "shininess": 0.85}


GRIP = [
    (0.000, 0.0045, 0.0040),
    (0.012, 0.0075, 0.0064),
    (0.035, 0.0085, 0.0078),
    (0.070, 0.0082, 0.0075),
    (0.092, 0.0076, 0.0082),
    (0.100, 0.0040, 0.0050),
]


def _cutlery(name: str, look: Mesh, geoms: list[Geom], mass: float, synonyms: list[str]) -> Kind:
    """Cutlery that lies along x: a grip of 100 mm that hands can take, and a head in +x."""
    path = [(x - 0.100, 0, 0) for x, _, _ in GRIP]
    grip = sweep(path, [(a, b) for _, a, b in GRIP], (0, 1, 0), 16)
    grip_geom = box_geom(f"{name}_handle", (0.048, 0.0072, 0.0083), (-0.051, 0, 0))
    grip_geom.weight = 0.3
    neck = box_geom(f"{name}_neck", (0.022, 0.003, 0.002), (0.020, 0, 0))
    root = Body(
        name,
        mass,
        [grip_geom, neck, *geoms],
        [Look(look, STEEL, **SHINY), Look(grip, "0.22 0.32 0.44 1", 0.4, 0.5)],
    )
    return Kind(
        root, f"A {name} with a thick grip.", "kitchen", "silver", "metal", synonyms, ["top"]
    )


def spoon() -> Kind:
    """A spoon of 180 mm."""
    neck = sweep(
        [(-0.005, 0, 0), (0.02, 0, 0), (0.042, 0, -0.001)], [(0.002, 0.003)] * 3, (0, 1, 0), 10
    )
    rings = []
    angles = 2 * np.pi * np.arange(20) / 20
    for s, drop in ((1.0, 0.0), (0.9, -0.0035), (0.6, -0.0055), (0.25, -0.0062)):
        rings.append(
            np.column_stack(
                [0.060 + 0.022 * s * np.cos(angles), 0.016 * s * np.sin(angles), 0 * angles + drop]
            )
        )
    inner = [ring + np.array([0, 0, 0.0016]) for ring in rings[::-1]]
    inner[-1] = inner[-1] * [1, 0.93, 1] + [0, 0, -0.0010]
    head = loft([*rings[::-1], *inner[::-1]])
    geom = hull_geom("spoon_bowl", loft([rings[2][::2], rings[0][::2] + np.array([0, 0, 0.001])]))
    return _cutlery("spoon", neck + head, [geom], 0.06, ["tablespoon"])


def fork() -> Kind:
    """A fork of 180 mm."""
    neck = sweep(
        [(-0.005, 0, 0), (0.02, 0, 0), (0.044, 0, -0.001)], [(0.002, 0.003)] * 3, (0, 1, 0), 10
    )
    outline = [(0.036, -0.003), (0.048, -0.011), (0.080, -0.0115), (0.080, -0.0085)]
    for k in range(3):
        y = -0.0085 + k * 0.0066
        outline += [(0.056, y), (0.056, y + 0.0040), (0.080, y + 0.0040), (0.080, y + 0.0066)][0:4]
    outline = [*outline[:-1], (0.080, 0.0115), (0.048, 0.011), (0.036, 0.003)]
    head = plate(outline, 0.002, 0.0005).at(0, 0, -0.0012)
    geom = box_geom("fork_head", (0.017, 0.0112, 0.0011), (0.0625, 0, -0.0012))
    return _cutlery("fork", neck + head, [geom], 0.06, ["table fork"])


def knife() -> Kind:
    """A table knife of 200 mm."""
    outline = [
        (-0.004, -0.004),
        (0.010, -0.0085),
        (0.075, -0.0095),
        (0.094, -0.004),
        (0.098, 0.004),
        (0.090, 0.0075),
        (-0.004, 0.0065),
    ]
    blade = plate(outline, 0.0024, 0.0008)
    geom = box_geom("knife_blade", (0.048, 0.0085, 0.0012), (0.049, -0.0005, 0))
    return _cutlery("knife", blade, [geom], 0.08, ["table knife"])


def spatula() -> Kind:
    """A spatula of 280 mm with a round wooden handle."""
    path = [
        (-0.14, 0, 0),
        (-0.136, 0, 0),
        (-0.11, 0, 0),
        (-0.05, 0, 0),
        (-0.02, 0, 0),
        (-0.016, 0, 0),
    ]
    radii = [
        (0.005, 0.005),
        (0.0085, 0.0085),
        (0.0095, 0.0095),
        (0.0085, 0.0085),
        (0.0075, 0.0075),
        (0.005, 0.005),
    ]
    shaft = sweep(
        [(-0.02, 0, 0), (0.03, 0, -0.001), (0.055, 0, -0.005), (0.07, 0, -0.0075)],
        [(0.003, 0.003), (0.003, 0.003), (0.002, 0.004), (0.0012, 0.008)],
        (0, 1, 0),
        12,
    )
    head = plate(
        [
            (0.062, -0.012),
            (0.080, -0.030),
            (0.140, -0.034),
            (0.140, 0.034),
            (0.080, 0.030),
            (0.062, 0.012),
        ],
        0.002,
        0.0006,
    )
    slots = [box((0.112, y, -0.0078), (0.018, 0.0022, 0.0003)) for y in (-0.016, 0, 0.016)]
    geoms = [
        rod_geom("spatula_handle", 0.0092, 0.122, (-0.078, 0, 0), (0, 90, 0)),
        capsule_geom("spatula_shaft", (-0.01, 0, 0), (0.06, 0, -0.0055), 0.003),
        box_geom("spatula_blade", (0.036, 0.032, 0.001), (0.104, 0, -0.0085)),
    ]
    geoms[0].weight = 0.4
    looks = [
        Look(sweep(path, radii, (0, 1, 0), 18), OAK),
        Look(shaft + head.at(0, 0, -0.0085), "0.30 0.31 0.33 1", 0.5, 0.5),
        *[Look(slot.at(0, 0, 0.0004), BLACK) for slot in slots],
    ]
    return Kind(
        Body("spatula", 0.11, geoms, looks),
        "A spatula.",
        "kitchen",
        "brown",
        "wood",
        ["turner", "flipper"],
        ["top"],
    )


def cutting_board() -> Kind:
    """A cutting board of 240 x 150 mm with a handle of 80 mm."""
    t, x0, x1, yb, yh = 0.016, -0.15, 0.09, 0.075, 0.018
    outline: list[tuple[float, float]] = []
    outline += arc(x1 - 0.015, yb - 0.015, 0.015, 0, 90, 5)
    outline += arc(x0 + 0.015, yb - 0.015, 0.015, 90, 180, 5)
    outline += arc(x0 + 0.015, -yb + 0.015, 0.015, 180, 270, 5)
    outline += arc(x1 - 0.015, -yb + 0.015, 0.015, 270, 360, 5)
    grip = sweep(
        [(0.085, 0, 0), (0.1, 0, 0), (0.13, 0, 0), (0.16, 0, 0), (0.168, 0, 0)],
        [(t / 2, 0.020), (t / 2, yh), (t / 2, yh - 0.002), (t / 2, yh), (t / 4, yh - 0.008)],
        (0, 1, 0),
        20,
    )
    groove = [box((-0.03, y, t / 2), (0.100, 0.0015, 0.0002)) for y in (-0.060, 0.060)]
    groove += [box((x, 0, t / 2), (0.0015, 0.060, 0.0002)) for x in (-0.13, 0.07)]
    geoms = [
        box_geom("cutting_board_slab", ((x1 - x0) / 2, yb, t / 2), ((x1 + x0) / 2, 0, 0)),
        box_geom("cutting_board_handle", (0.039, yh - 0.001, t / 2), (x1 + 0.0385, 0, 0)),
    ]
    looks = [Look(plate(outline, t, 0.002), "0.80 0.62 0.40 1"), Look(grip, "0.80 0.62 0.40 1")]
    looks += [Look(line, "0.58 0.42 0.25 1") for line in groove]
    return Kind(
        Body("cutting_board", 0.42, geoms, looks),
        "A cutting board with a handle in +x.",
        "kitchen",
        "brown",
        "wood",
        ["chopping board", "board"],
        ["handle"],
    )


KINDS = (spoon, fork, knife, spatula, cutting_board)
