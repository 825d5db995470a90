"""Building blocks and toys."""

from __future__ import annotations

import math

import numpy as np

from object_models.parts import (
    Body,
    Kind,
    Look,
    ball_geom,
    box_geom,
    ellipsoid_geom,
    hull_geom,
    rod_geom,
)
from object_models.shapes import (
    arc,
    ball,
    extrude,
    lathe,
    loft,
    outwards,
    plate,
    rod,
    rounded_box,
)

BLACK = "0.09 0.09 0.10 1"


def block_cube() -> Kind:
    """A cube of 40 mm."""
    half = (0.020, 0.020, 0.020)
    root = Body(
        "block_cube",
        0.045,
        [box_geom("block_cube_body", half)],
        [Look(rounded_box(half, 0.002), "0.82 0.22 0.20 1")],
    )
    return Kind(
        root,
        "A building block: a cube.",
        "blocks",
        "red",
        "wood",
        ["cube", "red cube"],
        ["top", "side"],
    )


def block_cuboid() -> Kind:
    """A cuboid of 80 x 40 x 20 mm."""
    half = (0.040, 0.020, 0.010)
    root = Body(
        "block_cuboid",
        0.045,
        [box_geom("block_cuboid_body", half)],
        [Look(rounded_box(half, 0.002), "0.20 0.45 0.78 1")],
    )
    return Kind(
        root,
        "A building block: a flat cuboid.",
        "blocks",
        "blue",
        "wood",
        ["cuboid", "brick"],
        ["top"],
    )


def block_prism() -> Kind:
    """A triangular prism, 56 mm wide, 28 mm high and 40 mm deep: a roof."""
    outline = [(-0.028, -0.014), (0.028, -0.014), (0.0, 0.014)]
    prism = extrude(outline, 0.040).turned("x", 90)
    root = Body(
        "block_prism",
        0.022,
        [hull_geom("block_prism_body", prism)],
        [Look(plate(outline, 0.040, 0.0015).turned("x", 90), "0.24 0.62 0.34 1")],
    )
    return Kind(
        root,
        "A building block: a triangular prism.",
        "blocks",
        "green",
        "wood",
        ["prism", "triangle", "roof"],
        ["top"],
    )


def block_arch() -> Kind:
    """An arch, 80 mm wide, 40 mm high and 40 mm deep."""
    w, h, r = 0.040, 0.020, 0.022
    outline = [
        (-w, -h),
        (-r, -h),
        *arc(0, -h, r, 180, 0, 15)[1:-1],
        (r, -h),
        (w, -h),
        (w, h),
        (-w, h),
    ]
    look = plate(outline, 0.040, 0.0012).turned("x", 90)
    geoms = [
        box_geom("block_arch_left", ((w - r) / 2, 0.020, h), (-(w + r) / 2, 0, 0)),
        box_geom("block_arch_right", ((w - r) / 2, 0.020, h), ((w + r) / 2, 0, 0)),
        box_geom("block_arch_top", (r, 0.020, (2 * h - r) / 2), (0, 0, h - (2 * h - r) / 2)),
    ]
    for sign, side in ((-1, "left"), (1, "right")):
        points = [
            (sign * r, 0.002),
            (sign * r, -0.010),
            (sign * r * math.cos(math.pi / 6), 0.002 - r / 2 + 0.0007),
            (sign * r / 2, 0.002),
        ]
        flat = points if sign < 0 else points[::-1]
        wedge = extrude(flat, 0.040).turned("x", 90)
        geoms.append(hull_geom(f"block_arch_corner_{side}", outwards(wedge)))
    root = Body("block_arch", 0.055, geoms, [Look(look, "0.94 0.72 0.18 1")])
    return Kind(
        root, "A building block: an arch.", "blocks", "yellow", "wood", ["arch", "bridge"], ["top"]
    )


def block_cylinder() -> Kind:
    """A column, 36 mm wide and 60 mm high."""
    root = Body(
        "block_cylinder",
        0.043,
        [rod_geom("block_cylinder_body", 0.018, 0.060)],
        [Look(rod(0.018, 0.060, 0.0015, 40), "0.55 0.32 0.66 1")],
    )
    return Kind(
        root,
        "A building block: a column.",
        "blocks",
        "purple",
        "wood",
        ["column", "pillar"],
        ["top", "side"],
    )


def toy_car() -> Kind:
    """A toy car of 100 mm that points to +x; its wheels do not turn."""
    side = [
        (-0.050, -0.012),
        (0.046, -0.012),
        (0.050, -0.006),
        (0.049, 0.002),
        (0.028, 0.006),
        (0.014, 0.022),
        (-0.024, 0.022),
        (-0.040, 0.007),
        (-0.050, 0.004),
    ]
    body = plate(side, 0.044, 0.003).turned("x", 90)
    window = [(0.026, 0.0065), (0.0135, 0.0195), (-0.0225, 0.0195), (-0.036, 0.0075)]
    glass = plate(window, 0.0448).turned("x", 90)
    roof = rounded_box((0.017, 0.0165, 0.0015), 0.001).at(-0.005, 0, 0.0215)
    wheels, geoms = (
        [],
        [
            hull_geom(
                "toy_car_body",
                extrude(
                    [
                        (-0.050, -0.012),
                        (0.046, -0.012),
                        (0.050, -0.006),
                        (0.049, 0.002),
                        (0.028, 0.006),
                        (-0.040, 0.007),
                        (-0.050, 0.004),
                    ],
                    0.044,
                ).turned("x", 90),
            ),
            hull_geom(
                "toy_car_cabin",
                extrude(
                    [(-0.040, 0.006), (0.028, 0.006), (0.014, 0.023), (-0.024, 0.023)], 0.044
                ).turned("x", 90),
            ),
        ],
    )
    for x in (-0.030, 0.029):
        for y in (-0.0225, 0.0225):
            wheels.append(
                Look(
                    rod(0.0120, 0.010, 0.002, 24).turned("x", 90).at(x, y, -0.0120), BLACK, 0.2, 0.2
                )
            )
            wheels.append(
                Look(
                    rod(0.0065, 0.0106, 0.001, 16).turned("x", 90).at(x, y, -0.0120),
                    "0.80 0.81 0.83 1",
                    0.8,
                    0.8,
                )
            )
            side_name = f"{'rear' if x < 0 else 'front'}_{'right' if y < 0 else 'left'}"
            geoms.append(
                box_geom(f"toy_car_wheel_{side_name}", (0.0085, 0.005, 0.012), (x, y, -0.012))
            )
    lamps = [
        Look(
            ball(0.0042, 12, 6).stretched(0.5, 1, 1).at(0.0485, y, -0.003),
            "0.98 0.95 0.75 1",
            0.8,
            0.8,
        )
        for y in (-0.014, 0.014)
    ]
    lamps += [
        Look(
            ball(0.0036, 12, 6).stretched(0.5, 1, 1).at(-0.0495, y, -0.002),
            "0.85 0.15 0.12 1",
            0.8,
            0.8,
        )
        for y in (-0.015, 0.015)
    ]
    looks = [
        Look(body, "0.86 0.24 0.18 1", 0.7, 0.7),
        Look(glass, "0.20 0.26 0.32 1", 0.9, 0.9),
        Look(roof, "0.86 0.24 0.18 1", 0.7, 0.7),
        *wheels,
        *lamps,
    ]
    return Kind(
        Body("toy_car", 0.12, geoms, looks),
        "A toy car whose wheels do not turn.",
        "toys",
        "red",
        "plastic",
        ["car", "toy"],
        ["top"],
    )


def rubber_duck() -> Kind:
    """A rubber duck, 80 mm long, that looks to +x."""
    yellow = "0.97 0.80 0.16 1"
    turn = 2 * np.pi * np.arange(24) / 24
    rings = []
    for x, rx, rz, z in (
        (-0.042, 0.004, 0.003, 0.004),
        (-0.037, 0.012, 0.008, 0.000),
        (-0.028, 0.022, 0.016, -0.009),
        (-0.015, 0.0285, 0.021, -0.014),
        (0.000, 0.030, 0.0225, -0.0155),
        (0.014, 0.0275, 0.0215, -0.0145),
        (0.026, 0.020, 0.0165, -0.0125),
        (0.034, 0.010, 0.009, -0.011),
        (0.037, 0.003, 0.003, -0.011),
    ):
        rings.append(np.column_stack([0 * turn + x, rx * np.cos(turn), z + rz * np.sin(turn)]))
    head = ball(0.0195, 24, 12).at(0.018, 0, 0.021)
    beak = loft(
        [
            np.column_stack([0 * turn + x, ry * np.cos(turn), 0.018 + z + rz * np.sin(turn)])
            for x, ry, rz, z in (
                (0.033, 0.009, 0.006, 0.000),
                (0.040, 0.0095, 0.0045, 0.000),
                (0.046, 0.0075, 0.0022, 0.0015),
                (0.048, 0.004, 0.001, 0.002),
            )
        ]
    )
    eyes = [
        Look(ball(0.0030, 12, 6).at(0.0325, s * 0.0095, 0.028), BLACK, 0.9, 0.9) for s in (-1, 1)
    ]
    wings = [
        Look(
            ball(1.0, 18, 8)
            .stretched(0.017, 0.005, 0.010)
            .turned("y", 12)
            .at(-0.006, s * 0.0275, -0.010),
            "0.95 0.74 0.10 1",
        )
        for s in (-1, 1)
    ]
    foot = lathe([(0, -0.038), (0.019, -0.038), (0.022, -0.034), (0, -0.030)], 28).stretched(
        1.25, 1, 1
    )
    geoms = [
        ellipsoid_geom("rubber_duck_body", (0.037, 0.0305, 0.0225), (-0.002, 0, -0.0150)),
        ball_geom("rubber_duck_head", 0.0195, (0.018, 0, 0.021)),
        ellipsoid_geom("rubber_duck_tail", (0.010, 0.010, 0.006), (-0.033, 0, 0.000)),
        box_geom("rubber_duck_beak", (0.0075, 0.0075, 0.003), (0.0405, 0, 0.0185)),
        rod_geom("rubber_duck_foot", 0.019, 0.006, (0, 0, -0.035)),
    ]
    looks = [
        Look(loft(rings) + head + foot, yellow, 0.5, 0.5),
        Look(beak, "0.93 0.45 0.10 1"),
        *wings,
        *eyes,
    ]
    return Kind(
        Body("rubber_duck", 0.07, geoms, looks),
        "A rubber duck.",
        "toys",
        "yellow",
        "rubber",
        ["duck", "bath duck"],
        ["top"],
    )


def die() -> Kind:
    """A die of 36 mm."""
    a = 0.018
    pips = {"x": (3, 4), "y": (2, 5), "z": (6, 1)}  # at the negative and at the positive face
    spots = {
        1: [(0, 0)],
        2: [(-1, -1), (1, 1)],
        3: [(-1, -1), (0, 0), (1, 1)],
        4: [(-1, -1), (-1, 1), (1, -1), (1, 1)],
        5: [(-1, -1), (-1, 1), (1, -1), (1, 1), (0, 0)],
        6: [(-1, -1), (-1, 0), (-1, 1), (1, -1), (1, 0), (1, 1)],
    }
    looks = [Look(rounded_box((a, a, a), 0.003, 3), "0.95 0.94 0.91 1", 0.5, 0.6)]
    for i, axis in enumerate("xyz"):
        for sign, count in zip((-1, 1), pips[axis], strict=True):
            for u, v in spots[count]:
                pip = rod(0.0026, 0.0003, segments=14)
                pip = (
                    pip.turned("y", 90)
                    if axis == "x"
                    else pip.turned("x", 90)
                    if axis == "y"
                    else pip
                )
                at = np.zeros(3)
                at[i], at[(i + 1) % 3], at[(i + 2) % 3] = sign * a, u * 0.0085, v * 0.0085
                looks.append(Look(pip.at(*at), BLACK))
    root = Body("die", 0.06, [box_geom("die_body", (a, a, a))], looks)
    return Kind(root, "A die.", "toys", "white", "plastic", ["dice"], ["top", "side"])


def ring_tower() -> Kind:
    """A stacking toy, 68 mm wide and 96 mm high: rings of falling size on a base."""
    colours = ("0.84 0.24 0.20 1", "0.94 0.62 0.16 1", "0.30 0.64 0.34 1", "0.22 0.46 0.80 1")
    z, looks = -0.048, [Look(rod(0.034, 0.010, 0.003, 40).at(0, 0, -0.043), "0.80 0.64 0.44 1")]
    geoms = [rod_geom("ring_tower_base", 0.034, 0.010, (0, 0, -0.043))]
    z += 0.010
    for i, colour in enumerate(colours):
        r, t = 0.031 - 0.0045 * i, 0.008
        ring = lathe(
            [
                (0.006, z),
                *[
                    (r - t + t * math.cos(a), z + t + t * math.sin(a))
                    for a in np.linspace(-math.pi / 2, math.pi / 2, 9)
                ],
                (0.006, z + 2 * t),
            ],
            36,
        )
        looks.append(Look(ring, colour, 0.6, 0.6))
        geoms.append(rod_geom(f"ring_tower_ring_{i}", r - 0.001, 2 * t, (0, 0, z + t)))
        z += 2 * t
    looks.append(Look(ball(0.0130, 24, 12).at(0, 0, 0.035), "0.55 0.32 0.66 1", 0.6, 0.6))
    geoms.append(ball_geom("ring_tower_knob", 0.0130, (0, 0, 0.035)))
    return Kind(
        Body("ring_tower", 0.19, geoms, looks),
        "A stacking toy of rings on a base.",
        "toys",
        "red",
        "wood",
        ["stacking rings", "toy tower"],
        ["top"],
    )


KINDS = (
    block_cube,
    block_cuboid,
    block_prism,
    block_arch,
    block_cylinder,
    toy_car,
    rubber_duck,
    die,
    ring_tower,
)
