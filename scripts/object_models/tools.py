"""Hand tools and fasteners."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from object_models.parts import Body, Kind, Look, box_geom, capsule_geom, hull_geom, rod_geom
from object_models.shapes import (
    SEGMENTS,
    Mesh,
    between,
    extrude,
    lathe,
    loft,
    outwards,
    plate,
    rod,
    rounded_box,
    sweep,
)

STEEL = "0.66 0.68 0.70 1"
DARK = "0.16 0.17 0.18 1"
SHINY: dict[str, Any] = {"specular": 0.9, "shininess": 0.8}


def screwdriver() -> Kind:
    """A screwdriver of 200 mm, lying along x."""
    grip = [
        (-0.10, 0.009),
        (-0.097, 0.013),
        (-0.075, 0.015),
        (-0.045, 0.014),
        (-0.022, 0.011),
        (-0.012, 0.013),
        (-0.006, 0.012),
        (-0.004, 0.006),
    ]
    turn = 2 * np.pi * np.arange(24) / 24
    flutes = 1 - 0.07 * (np.cos(6 * turn) > 0.3)
    rings = []
    for x, r in grip:
        s = flutes if -0.09 < x < -0.02 else np.ones(24)
        rings.append(np.column_stack([np.full(24, x), r * s * np.cos(turn), r * s * np.sin(turn)]))
    handle = loft(rings)
    shaft = rod(0.0035, 0.09, segments=16).turned("y", 90).at(0.040, 0, 0)
    tip = Mesh(
        np.array(
            [
                (0.085, -0.0035, -0.0030),
                (0.085, 0.0035, -0.0030),
                (0.085, 0.0035, 0.0030),
                (0.085, -0.0035, 0.0030),
                (0.10, -0.0045, -0.0008),
                (0.10, 0.0045, -0.0008),
                (0.10, 0.0045, 0.0008),
                (0.10, -0.0045, 0.0008),
            ]
        ),
        [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
    )
    geoms = [
        rod_geom("screwdriver_handle", 0.0148, 0.090, (-0.055, 0, 0), (0, 90, 0)),
        capsule_geom("screwdriver_shaft", (-0.01, 0, 0), (0.0955, 0, 0), 0.0040),
    ]
    geoms[1].weight = 4
    looks = [
        Look(handle, "0.85 0.22 0.16 1", 0.5, 0.6),
        Look(shaft + outwards(tip), STEEL, **SHINY),
        Look(rod(0.0151, 0.006, 0.001, 24).turned("y", 90).at(-0.070, 0, 0), DARK),
    ]
    root = Body("screwdriver", 0.12, geoms, looks)
    return Kind(
        root,
        "A screwdriver.",
        "tools",
        "red",
        "plastic",
        ["flat screwdriver"],
        ["top"],
        condim=6,
        friction="0.8 0.02 0.002",
    )


def hammer() -> Kind:
    """A hammer of 274 mm that lies along x, with its head in +x."""
    path = [
        (-0.14, 0, 0),
        (-0.136, 0, 0),
        (-0.10, 0, 0),
        (-0.03, 0, 0),
        (0.05, 0, 0),
        (0.134, 0, 0),
    ]
    radii = [
        (0.010, 0.011),
        (0.0130, 0.014),
        (0.0125, 0.014),
        (0.0105, 0.012),
        (0.0085, 0.010),
        (0.0080, 0.010),
    ]
    handle = sweep(path, radii, (0, 1, 0), 18)
    face = rod(0.0135, 0.018, 0.002, 28).turned("x", 90).at(0.118, -0.049, 0)
    neck = rod(0.010, 0.030, segments=24).turned("x", 90).at(0.118, -0.028, 0)
    middle = rounded_box((0.015, 0.018, 0.013), 0.003).at(0.118, -0.002, 0)
    peen = Mesh(
        np.array(
            [
                (0.104, 0.014, -0.012),
                (0.132, 0.014, -0.012),
                (0.132, 0.014, 0.012),
                (0.104, 0.014, 0.012),
                (0.106, 0.058, -0.0015),
                (0.130, 0.058, -0.0015),
                (0.130, 0.058, 0.0015),
                (0.106, 0.058, 0.0015),
            ]
        ),
        [[0, 1, 2, 3], [7, 6, 5, 4], [4, 5, 1, 0], [5, 6, 2, 1], [6, 7, 3, 2], [7, 4, 0, 3]],
    )
    peen = outwards(peen)
    geoms = [
        box_geom("hammer_handle", (0.095, 0.0115, 0.0100), (0.004, 0, 0)),
        box_geom("hammer_handle_end", (0.0245, 0.0135, 0.0134), (-0.1155, 0, 0)),
        rod_geom("hammer_face", 0.0135, 0.018, (0.118, -0.049, 0), (90, 0, 0)),
        rod_geom("hammer_neck", 0.010, 0.030, (0.118, -0.028, 0), (90, 0, 0)),
        box_geom("hammer_head", (0.015, 0.018, 0.013), (0.118, -0.002, 0)),
        hull_geom("hammer_peen", peen),
    ]
    for geom in geoms[2:]:
        geom.weight = 9
    looks = [
        Look(handle, "0.70 0.50 0.30 1"),
        Look(
            sweep(path[:3], [(0.0103, 0.0113), (0.0135, 0.0145), (0.0129, 0.0144)], (0, 1, 0), 18),
            DARK,
        ),
        Look(face + neck + middle + peen, "0.36 0.38 0.41 1", **SHINY),
    ]
    return Kind(
        Body("hammer", 0.48, geoms, looks),
        "A hammer.",
        "tools",
        "black",
        "metal",
        ["claw hammer"],
        ["top"],
    )


def _ring(cx: float, outer: float, inner: float, height: float, opening: float = 0.0) -> Mesh:
    """A ring about (cx, 0) with an opening towards -x or +x, by its sign, in degrees."""
    start = abs(opening) / 2
    angles = np.radians(np.linspace(start, 360 - start, 28))
    if opening < 0:
        angles = angles + math.pi
    outline = [(cx + outer * math.cos(a), outer * math.sin(a)) for a in angles]
    outline += [(cx + inner * math.cos(a), inner * math.sin(a)) for a in angles[::-1]]
    return plate(outline, height, 0.0012)


def wrench() -> Kind:
    """A combination wrench of 190 mm: an open end in +x, a ring in -x."""
    t = 0.016
    shaft = plate([(-0.066, -0.008), (0.062, -0.0095), (0.062, 0.0095), (-0.066, 0.008)], t, 0.002)
    jaw = _ring(0.078, 0.0205, 0.0105, t, 75)
    turn = np.radians(np.arange(0, 360, 360 / SEGMENTS))
    outer, inner = 0 * turn + 0.0165, 0.0095 / np.cos((turn) % (math.pi / 3) - math.pi / 6) * 0.95
    eye = between([(outer, -t / 2), (outer, t / 2), (inner, t / 2), (inner, -t / 2)], turn).at(
        -0.0785
    )
    geoms = [box_geom("wrench_handle", (0.062, 0.0085, t / 2), (-0.002, 0, 0))]
    for k in range(8):
        a = 2 * math.pi * k / 8
        r = 0.013
        geoms.append(
            box_geom(
                f"wrench_ring_{k}",
                (0.0035, 0.0068, t / 2),
                (-0.0785 + r * math.cos(a), r * math.sin(a), 0),
                (0, 0, math.degrees(a)),
            )
        )
    for k, a in enumerate(np.radians([62, 103, 144, 180, 216, 257, 298])):
        r = 0.0155
        geoms.append(
            box_geom(
                f"wrench_jaw_{k}",
                (0.005, 0.0062, t / 2),
                (0.078 + r * math.cos(a), r * math.sin(a), 0),
                (0, 0, math.degrees(a)),
            )
        )
    root = Body("wrench", 0.16, geoms, [Look(shaft + jaw + eye, STEEL, **SHINY)])
    return Kind(root, "A combination wrench.", "tools", "silver", "metal", ["spanner"], ["top"])


def pliers() -> Kind:
    """Pliers of 170 mm, closed, their jaws in +x."""
    looks, geoms = [], []
    for sign, side in ((1, "left"), (-1, "right")):
        path = [
            (0.012, 0, 0),
            (-0.010, sign * 0.010, 0),
            (-0.045, sign * 0.0175, 0),
            (-0.080, sign * 0.0165, 0),
            (-0.102, sign * 0.0135, 0),
            (-0.106, sign * 0.0125, 0),
        ]
        radii = [
            (0.005, 0.006),
            (0.007, 0.0070),
            (0.0075, 0.0080),
            (0.0075, 0.0080),
            (0.0072, 0.0078),
            (0.003, 0.003),
        ]
        looks.append(Look(sweep(path, radii, (0, 0, 1), 14), "0.18 0.38 0.72 1", 0.4, 0.5))
        geoms.append(capsule_geom(f"pliers_handle_{side}_0", path[1], path[2], 0.0080))
        geoms.append(
            capsule_geom(f"pliers_handle_{side}_1", path[2], (-0.0985, sign * 0.0140, 0), 0.0080)
        )
        outline = [
            (0.006, 0.0006),
            (0.064, 0.0006),
            (0.064, 0.004),
            (0.045, 0.0085),
            (0.018, 0.0130),
            (0.006, 0.0120),
        ]
        points = outline if sign > 0 else [(x, -y) for x, y in outline[::-1]]
        looks.append(Look(plate(points, 0.014, 0.0012), STEEL, **SHINY))
    geoms.append(
        hull_geom(
            "pliers_jaw",
            extrude(
                [
                    (0.004, -0.0125),
                    (0.018, -0.013),
                    (0.045, -0.0085),
                    (0.064, -0.004),
                    (0.064, 0.004),
                    (0.045, 0.0085),
                    (0.018, 0.013),
                    (0.004, 0.0125),
                ],
                0.014,
            ),
        )
    )
    geoms.append(rod_geom("pliers_pivot", 0.0125, 0.0150, (0.006, 0, 0)))
    geoms[-1].weight = geoms[-2].weight = 3
    looks += [
        Look(rod(0.0125, 0.0150, 0.002, 28).at(0.006), STEEL, **SHINY),
        Look(rod(0.005, 0.0160, 0.001, 20).at(0.006), DARK),
    ]
    return Kind(
        Body("pliers", 0.21, geoms, looks),
        "Pliers.",
        "tools",
        "blue",
        "metal",
        ["tongs", "combination pliers"],
        ["top"],
    )


def tape_roll() -> Kind:
    """A roll of tape, 62 mm wide and 24 mm high, lying flat."""
    outer, inner, h = 0.031, 0.019, 0.012
    tape = lathe(
        [
            (inner + 0.003, -h),
            (outer - 0.0006, -h),
            (outer, -h + 0.0006),
            (outer, h - 0.0006),
            (outer - 0.0006, h),
            (inner + 0.003, h),
        ]
    )
    core = lathe([(inner, -h), (inner + 0.003, -h), (inner + 0.003, h), (inner, h)])
    lines = [
        lathe([(r, h), (r + 0.0004, h), (r + 0.0004, h + 0.0001), (r, h + 0.0001)])
        for r in (0.0248, 0.0272, 0.0294)
    ]
    end = rounded_box((0.0004, 0.004, h), 0.0003).at(outer, 0, 0)
    sides, geoms = 14, []
    wall = outer - inner
    half = outer * math.tan(math.pi / sides) * (outer - wall / 2) / outer
    for k in range(sides):
        a = 2 * math.pi * k / sides
        r = outer - wall / 2 - 0.0003
        geoms.append(
            box_geom(
                f"tape_roll_wall_{k}",
                (wall / 2, half, h),
                (r * math.cos(a), r * math.sin(a), 0),
                (0, 0, math.degrees(a)),
            )
        )
    looks = [
        Look(tape, "0.90 0.72 0.16 1"),
        Look(core, "0.70 0.58 0.42 1"),
        *[Look(line, "0.78 0.60 0.10 1") for line in lines],
        Look(end, "0.78 0.60 0.10 1"),
    ]
    return Kind(
        Body("tape_roll", 0.09, geoms, looks),
        "A roll of tape.",
        "tools",
        "yellow",
        "plastic",
        ["tape", "adhesive tape", "roll of tape"],
        ["top"],
    )


def bolt() -> Kind:
    """A hexagon bolt M16 x 60, standing on its head."""
    flat, r, head, total = 0.012, 0.008, 0.010, 0.060
    low = -total / 2
    corner = flat / math.cos(math.pi / 6)
    hexagon = [
        (corner * math.cos(a), corner * math.sin(a)) for a in np.radians(np.arange(0, 360, 60))
    ]
    top = plate(hexagon, head, 0.001).at(0, 0, low + head / 2)
    profile = [
        (0, low + head - 0.001),
        (r - 0.0006, low + head - 0.001),
        (r - 0.0006, low + head + 0.014),
    ]
    z = low + head + 0.014
    while z < total / 2 - 0.005:
        profile += [(r, z + 0.001), (r - 0.0012, z + 0.002)]
        z += 0.002
    profile += [(r - 0.0006, total / 2 - 0.002), (r - 0.002, total / 2), (0, total / 2)]
    geoms = [
        rod_geom("bolt_head", 0.0126, head, (0, 0, low + head / 2)),
        rod_geom("bolt_shank", r, total - head, (0, 0, head / 2)),
    ]
    root = Body(
        "bolt",
        0.13,
        geoms,
        [Look(top, "0.50 0.52 0.55 1", **SHINY), Look(lathe(profile, 24), STEEL, **SHINY)],
    )
    return Kind(
        root,
        "A hexagon bolt that stands on its head.",
        "tools",
        "grey",
        "metal",
        ["screw", "hexagon bolt"],
        ["top", "side"],
    )


KINDS = (screwdriver, hammer, wrench, pliers, tape_roll, bolt)
