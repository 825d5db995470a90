"""Equipment with joints: what is opened, closed, pressed and turned.

Each stands on its origin and looks to +x. Doors, drawers and lids stay where they are left: dry
friction holds them. Moving parts keep two millimetres and more from the frame, because the engine
lets a part collide with a parent that is fixed to the world. Handles are geoms named `..._handle`,
with a site of that name where a hand takes them.
"""

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
    Vec,
    box_geom,
    capsule_geom,
    numbers,
    rod_geom,
)
from object_models.shapes import Mesh, box, plate, rod, rounded_box, rounded_outline, sweep

WHITE = "0.90 0.90 0.88 1"
STEEL = "0.70 0.72 0.74 1"
DARK = "0.16 0.17 0.19 1"
BLACK = "0.07 0.07 0.08 1"
OAK = "0.74 0.56 0.36 1"
WALNUT = "0.45 0.30 0.19 1"
BLUE = "0.28 0.42 0.55 1"
# With the engine's defaults a small lid creeps shut under its own weight.
STIFF = 'solimpfriction="0.9999 0.9999 0.001"'
HANDLE_CONTACT = 'friction="1 0.02 0.001"'


def hinge(name: str, axis: Vec, limits: tuple[float, float], friction: float) -> str:
    """MJCF of a hinge that stays where it is left; N m."""
    return (
        f'<joint name="{name}" type="hinge" axis="{numbers(axis)}" range="{numbers(limits)}" '
        f'damping="{friction / 2:.3g}" frictionloss="{friction:.3g}" armature="0.001" {STIFF}/>'
    )


def slide(name: str, axis: Vec, limits: tuple[float, float], friction: float) -> str:
    """MJCF of a slide that stays where it is left; N."""
    return (
        f'<joint name="{name}" type="slide" axis="{numbers(axis)}" range="{numbers(limits)}" '
        f'damping="{3 * friction:.3g}" frictionloss="{friction:.3g}"/>'
    )


def spring(name: str, axis: Vec, travel: float, force: float) -> str:
    """MJCF of a button: it moves along `axis`, and a spring pushes it back with `force` N."""
    stiffness = force / (2 * travel)
    return (
        f'<joint name="{name}" type="slide" axis="{numbers(axis)}" range="0 {travel:.4g}" '
        f'stiffness="{stiffness:.4g}" springref="{-travel:.4g}" damping="2" armature="0.02" '
        'solreflimit="0.004 1"/>'
    )


def block(half: Vec, pos: Vec = (0, 0, 0), radius: float = 0.003) -> Mesh:
    """A rounded box at a place."""
    return rounded_box(half, radius).at(*pos)


def bar_handle(
    name: str, center: Vec, along: str, length: float, stand: float, radius: float = 0.006
) -> tuple[list[Geom], Mesh]:
    """A bar before a face that looks to +x: `center` is on the face, `stand` the bar's distance."""
    x, y, z = center
    e = np.array([0, 1, 0] if along == "y" else [0, 0, 1]) * length / 2
    low = np.array([x + stand, y, z]) - e
    high = np.array([x + stand, y, z]) + e
    foot_low, foot_high = low - [stand, 0, 0], high - [stand, 0, 0]
    geoms = [
        capsule_geom(name, low, high, radius),
        capsule_geom(f"{name}_low", foot_low, low, radius),
        capsule_geom(f"{name}_high", foot_high, high, radius),
    ]
    for geom in geoms:
        geom.contact, geom.weight = HANDLE_CONTACT, 4.0
    r, x_axis = min(2.5 * radius, stand / 2), np.array([1.0, 0, 0])
    unit = e / np.linalg.norm(e)
    path = [foot_low]
    for sign, corner, turn in ((-1, low, np.linspace(0, 90, 5)), (1, high, np.linspace(90, 0, 5))):
        center = corner - r * (sign * unit + x_axis)
        for a in np.radians(turn):
            path.append(center + r * (sign * math.cos(a) * unit + math.sin(a) * x_axis))
    path.append(foot_high)
    side = (0.0, 0.0, 1.0) if along == "y" else (0.0, 1.0, 0.0)
    return geoms, sweep(path, [(radius, radius)] * len(path), side, 12)


def drawer_unit() -> Kind:
    """Three drawers in a case of 0.30 x 0.32 x 0.36 m."""
    dx, dy, h, t = 0.14, 0.16, 0.36, 0.006
    case = [
        box_geom("bottom", (dx, dy, t), (0, 0, t)),
        box_geom("top", (dx, dy, t), (0, 0, h - t)),
        box_geom("left", (dx, t, h / 2 - 2 * t), (0, dy - t, h / 2)),
        box_geom("right", (dx, t, h / 2 - 2 * t), (0, -dy + t, h / 2)),
        box_geom("back", (t, dy - 2 * t, h / 2 - 2 * t), (-dx + t, 0, h / 2)),
    ]
    looks = [
        Look(block((dx, dy, t), (0, 0, t), 0.002), OAK),
        Look(block((dx, dy, t), (0, 0, h - t), 0.002), OAK),
        Look(box((0, dy - t, h / 2), (dx, t, h / 2 - 2 * t)), OAK),
        Look(box((0, -dy + t, h / 2), (dx, t, h / 2 - 2 * t)), OAK),
        Look(box((-dx + t, 0, h / 2), (t, dy - 2 * t, h / 2 - 2 * t)), OAK),
    ]
    drawers = []
    space = (h - 4 * t) / 3
    for i in range(3):
        name = f"drawer_{i + 1}"
        z = h - 2 * t - (i + 0.5) * space
        front, half_y = space / 2 - 0.002, dy - 2 * t - 0.003
        depth, wall = dx - t - 0.008, 0.003  # half length of the tray
        side = front - 0.008
        geoms = [
            box_geom(f"{name}_front", (t, dy - 0.001, front), (t + 0.003, 0, 0)),
            box_geom(f"{name}_bottom", (depth, half_y, wall), (-depth, 0, -front + 0.004)),
            box_geom(f"{name}_left", (depth, wall, side), (-depth, half_y - wall, 0)),
            box_geom(f"{name}_right", (depth, wall, side), (-depth, -half_y + wall, 0)),
            box_geom(f"{name}_back", (wall, half_y, side), (-2 * depth + wall, 0, 0)),
        ]
        tray = [
            box_mesh(geom_half, pos)
            for geom_half, pos in (
                ((depth, half_y, wall), (-depth, 0, -front + 0.004)),
                ((depth, wall, side), (-depth, half_y - wall, 0)),
                ((depth, wall, side), (-depth, -half_y + wall, 0)),
                ((wall, half_y, side), (-2 * depth + wall, 0, 0)),
            )
        ]
        bar, bar_look = bar_handle(f"{name}_handle", (2 * t + 0.003, 0, 0), "y", 0.11, 0.032)
        drawers.append(
            Body(
                name,
                0.55,
                [*geoms, *bar],
                [
                    Look(block((t, dy - 0.001, front), (t + 0.003, 0, 0), 0.003), BLUE),
                    *[Look(mesh, "0.84 0.72 0.54 1") for mesh in tray],
                    Look(bar_look, STEEL, 0.7, 0.7),
                ],
                (dx, 0, z),
                slide(f"{name}_slide", (1, 0, 0), (0, 0.17), 1.0),
                {
                    f"{name}_handle": (2 * t + 0.035, 0, 0),
                    f"{name}_inside": (-depth, 0, -front + 0.007),
                },
            )
        )
    root = Body(
        "drawer_unit", 3.5, case, looks, sites={"drawer_unit_top": (0, 0, h)}, bodies=drawers
    )
    return Kind(
        root,
        "Three drawers, the first at the top.",
        "furniture",
        "blue",
        "wood",
        ["drawers", "chest of drawers"],
        is_free=False,
    )


def box_mesh(half: Vec, pos: Vec) -> Mesh:
    """A sharp box."""
    return box(pos, half)


def microwave() -> Kind:
    """An oven of 0.36 x 0.46 x 0.28 m with a door, a start button and a dial."""
    dx, dy, h, t, panel = 0.17, 0.23, 0.28, 0.008, 0.055
    geoms = [
        box_geom("bottom", (dx, dy, t), (0, 0, t + 0.006)),
        box_geom("top", (dx, dy, t), (0, 0, h - t)),
        box_geom("wall_right", (dx, t, h / 2 - 0.02), (0, -dy + t, h / 2)),
        box_geom("back", (t, dy, h / 2 - 0.02), (-dx + t, 0, h / 2)),
        box_geom("panel", (dx, panel, h / 2 - 0.02), (0, dy - panel, h / 2)),
        *[
            rod_geom(f"foot_{i}", 0.012, 0.008, (sx * (dx - 0.03), sy * (dy - 0.03), 0.004))
            for i, (sx, sy) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1)))
        ],
        rod_geom("plate", 0.12, 0.006, (0, -panel + t, 0.031)),
    ]
    geoms[4].weight = 0.25
    looks = [
        Look(block((dx, dy, t), (0, 0, t + 0.006), 0.005), WHITE),
        Look(block((dx, dy, t), (0, 0, h - t), 0.005), WHITE),
        Look(block((dx, t, h / 2 - 0.012), (0, -dy + t, h / 2 + 0.003), 0.005), WHITE),
        Look(
            block((dx, panel - 0.001, h / 2 - 0.012), (0, dy - panel, h / 2 + 0.003), 0.005), WHITE
        ),
        Look(box((-dx + t, 0, h / 2), (t, dy - 0.01, h / 2 - 0.014)), WHITE),
        *[
            Look(rod(0.012, 0.008).at(sx * (dx - 0.03), sy * (dy - 0.03), 0.004), DARK)
            for sx, sy in ((1, 1), (1, -1), (-1, 1), (-1, -1))
        ],
        Look(block((0.0015, 0.040, 0.020), (dx, dy - panel, h - 0.05), 0.001), BLACK, 0.8, 0.9),
        Look(
            block((0.0005, 0.026, 0.008), (dx + 0.0015, dy - panel, h - 0.05), 0.0004),
            "0.30 0.85 0.60 1",
        ),
        Look(rod(0.12, 0.006, 0.002, 48).at(0, -panel + t, 0.031), "0.80 0.88 0.90 1", 0.8, 0.8),
    ]
    width, depth = 2 * dy - 2 * panel - 0.003, 0.012  # of the door
    door_half = (depth, width / 2, h / 2 - 0.004)
    at = (depth, width / 2, 0)
    bar, bar_look = bar_handle(
        "door_handle", (2 * depth, width - 0.026, 0), "z", 0.15, 0.034, 0.007
    )
    door = Body(
        "door",
        1.6,
        [box_geom("door_panel", door_half, at), *bar],
        [
            Look(block(door_half, at, 0.006), DARK, 0.5, 0.6),
            Look(
                block(
                    (0.001, width / 2 - 0.05, h / 2 - 0.045),
                    (2 * depth, width / 2 - 0.012, 0),
                    0.0008,
                ),
                "0.03 0.04 0.05 1",
                0.9,
                0.9,
            ),
            Look(bar_look, STEEL, 0.7, 0.7),
        ],
        (dx + 0.003, -dy, h / 2 + 0.003),
        hinge("door_hinge", (0, 0, -1), (0, 1.9), 0.12),
        {"door_handle": (2 * depth + 0.034, width - 0.026, 0)},
    )
    button = Body(
        "start_button",
        0.02,
        [box_geom("start_button", (0.006, 0.03, 0.014), (0.008, 0, 0))],
        [Look(block((0.006, 0.03, 0.014), (0.008, 0, 0), 0.004), "0.85 0.33 0.25 1")],
        (dx, dy - panel, 0.06),
        spring("start_button_slide", (-1, 0, 0), 0.005, 3.0),
        {"start_button": (0.014, 0, 0)},
    )
    dial = Body(
        "dial",
        0.05,
        [rod_geom("dial_knob", 0.022, 0.022, (0.014, 0, 0), (0, 90, 0))],
        [
            Look(rod(0.022, 0.022, 0.004).turned("y", 90).at(0.014, 0, 0), STEEL, 0.7, 0.7),
            Look(block((0.001, 0.0015, 0.009), (0.025, 0, 0.010), 0.0005), BLACK),
        ],
        (dx, dy - panel, 0.145),
        hinge("dial_hinge", (-1, 0, 0), (0, 4.5), 0.02),
        {"dial_knob": (0.025, 0, 0)},
    )
    root = Body(
        "microwave",
        9.0,
        geoms,
        looks,
        sites={"microwave_inside": (0, -panel + t, 0.034), "microwave_top": (0, 0, h)},
        bodies=[door, button, dial],
    )
    return Kind(
        root,
        "A microwave oven with a door, a dial and a start button.",
        "appliances",
        "white",
        "metal",
        ["microwave oven", "oven"],
        excluded=[("microwave", "start_button"), ("microwave", "dial")],
        is_free=False,
    )


def laptop() -> Kind:
    """A laptop of 0.22 x 0.32 m whose lid is opened at its lip."""
    dx, dy, t = 0.11, 0.16, 0.008
    keys = []
    for row in range(5):
        n = 13 if row else 12
        for k in range(n):
            y = (k - (n - 1) / 2) * 0.0215
            if row == 4 and 3 < k < 9:
                continue
            keys.append(box((-0.065 + row * 0.0205, -y, 2 * t + 0.0004), (0.0085, 0.009, 0.0008)))
    keys.append(box((-0.065 + 4 * 0.0205, 0, 2 * t + 0.0004), (0.0085, 0.050, 0.0008)))
    key_mesh = keys[0]
    for key in keys[1:]:
        key_mesh = key_mesh + key
    base_looks = [
        Look(plate(rounded_outline(dx, dy, 0.012), 2 * t, 0.0025).at(0, 0, t), STEEL, 0.6, 0.6),
        Look(key_mesh, DARK),
        Look(box((0.072, 0, 2 * t), (0.026, 0.045, 0.0004)), "0.60 0.62 0.64 1", 0.4, 0.6),
    ]
    lid_half = (dx - 0.001, dy, 0.004)
    lip = (0.009, 0.035, 0.003)
    lid = Body(
        "lid",
        0.5,
        [
            box_geom("lid_panel", lid_half, (dx, 0, 0.004)),
            box_geom("lid_handle", lip, (2 * dx + lip[0], 0, 0.004)),
        ],
        [
            Look(
                plate(rounded_outline(dx - 0.001, dy, 0.012), 0.008, 0.002).at(dx, 0, 0.004),
                STEEL,
                0.6,
                0.6,
            ),
            Look(box((dx + 0.002, 0, -0.0002), (dx - 0.014, dy - 0.010, 0.0006)), BLACK, 0.8, 0.9),
            Look(block(lip, (2 * dx + lip[0] - 0.003, 0, 0.004), 0.002), DARK),
            Look(rod(0.016, 0.001).at(dx, 0, 0.0082), WHITE),
        ],
        (-dx, 0, 2 * t + 0.003),
        hinge("lid_hinge", (0, -1, 0), (0, 2.3), 0.7),
        {"lid_handle": (2 * dx + 2 * lip[0], 0, 0.004)},
    )
    root = Body(
        "laptop",
        1.3,
        [box_geom("base", (dx, dy, t), (0, 0, t))],
        [
            *base_looks,
            Look(rod(0.006, 0.20).turned("x", 90).at(-dx - 0.004, 0, 2 * t - 0.004), DARK),
        ],
        bodies=[lid],
    )
    return Kind(
        root,
        "A laptop computer; its lid has a lip to open it.",
        "electronics",
        "grey",
        "metal",
        ["laptop computer", "notebook computer"],
        is_free=False,
    )


def faucet() -> Kind:
    """A faucet, 0.24 m high; its lever lifts to open."""
    steel: dict[str, Any] = {"specular": 0.9, "shininess": 0.9}
    a = np.radians(np.linspace(0, 165, 14))
    bend = 0.055
    path: list[Vec] = [(0, 0, 0.10), (0, 0, 0.14)]
    path += [(bend - bend * math.cos(t), 0, 0.17 + bend * math.sin(t)) for t in a]
    end = np.array(path[-1]) + 0.02 * np.array([math.sin(a[-1]), 0, math.cos(a[-1])])
    path.append((float(end[0]), 0, float(end[2])))
    spout = sweep(path, [(0.010, 0.010)] * len(path), (0, 1, 0), 16)
    corners = [path[0], path[1], path[4], path[7], path[10], path[-1]]
    geoms = [
        rod_geom("flange", 0.030, 0.008, (0, 0, 0.004)),
        rod_geom("column", 0.021, 0.102, (0, 0, 0.055)),
        *[
            capsule_geom(f"spout_{i}", p, q, 0.010)
            for i, (p, q) in enumerate(itertools.pairwise(corners))
        ],
    ]
    # The lever is beside the column, so that it lifts freely below the spout.
    lever_path = [(0, 0, 0), (0.03, 0, 0.004), (0.07, 0, 0.012), (0.105, 0, 0.022)]
    lever = Body(
        "lever",
        0.12,
        [
            rod_geom("lever_hub", 0.016, 0.026, (0, 0, 0), (90, 0, 0)),
            *[
                capsule_geom("lever_handle" + (f"_{i}" if i else ""), p, q, 0.007)
                for i, (p, q) in enumerate(itertools.pairwise(lever_path[1:]))
            ],
            capsule_geom("lever_neck", lever_path[0], lever_path[1], 0.007),
        ],
        [
            Look(rod(0.016, 0.026, 0.003).turned("x", 90), STEEL, **steel),
            Look(
                sweep(
                    lever_path,
                    [(0.005, 0.010), (0.005, 0.010), (0.006, 0.010), (0.006, 0.008)],
                    (0, 1, 0),
                    12,
                ),
                STEEL,
                **steel,
            ),
        ],
        (0, -0.040, 0.075),
        hinge("lever_hinge", (0, -1, 0), (0, 0.9), 0.15),
        {"lever_handle": (0.085, 0, 0.016)},
    )
    root = Body(
        "faucet",
        1.4,
        geoms,
        [
            Look(rod(0.030, 0.008, 0.002).at(0, 0, 0.004), STEEL, **steel),
            Look(rod(0.021, 0.102, 0.005).at(0, 0, 0.055), STEEL, **steel),
            Look(rod(0.010, 0.014).turned("x", 90).at(0, -0.021, 0.075), STEEL, **steel),
            Look(spout, STEEL, **steel),
            Look(rod(0.0085, 0.001).at(*np.array(path[-1])), BLACK),
        ],
        sites={"spout": (float(end[0]), 0, float(end[2]))},
        bodies=[lever],
    )
    return Kind(
        root,
        "A faucet; its lever lifts to open it.",
        "fixtures",
        "silver",
        "metal",
        ["tap", "water tap"],
        is_free=False,
    )


def button_panel() -> Kind:
    """A console of 0.16 x 0.26 x 0.07 m with four buttons, a switch and a dial."""
    dx, dy, h = 0.08, 0.13, 0.05
    colours = {
        "red": "0.83 0.20 0.18 1",
        "green": "0.22 0.62 0.30 1",
        "blue": "0.18 0.40 0.78 1",
        "yellow": "0.93 0.76 0.18 1",
    }
    parts = []
    collars = []
    for i, (colour, rgba) in enumerate(colours.items()):
        y = (1.5 - i) * 0.058
        name = f"{colour}_button"
        parts.append(
            Body(
                name,
                0.03,
                [rod_geom(name, 0.018, 0.016, (0, 0, 0.010))],
                [Look(rod(0.018, 0.016, 0.004).at(0, 0, 0.010), rgba, 0.5, 0.6)],
                (0.028, y, h),
                spring(f"{name}_slide", (0, 0, -1), 0.008, 3.0),
                {name: (0, 0, 0.018)},
            )
        )
        collars.append(Look(rod(0.023, 0.004, 0.001).at(0.028, y, h), DARK, 0.5, 0.5))
    switch = Body(
        "switch",
        0.02,
        [capsule_geom("switch_handle", (0, 0, 0.004), (0, 0, 0.034), 0.006)],
        [
            Look(
                sweep(
                    [(0, 0, 0), (0, 0, 0.02), (0, 0, 0.034), (0, 0, 0.040)],
                    [(0.004, 0.004), (0.005, 0.005), (0.0065, 0.0065), (0.004, 0.004)],
                    (0, 1, 0),
                    16,
                ),
                STEEL,
                0.8,
                0.8,
            )
        ],
        (-0.035, 0.045, h + 0.006),
        hinge("switch_hinge", (0, 1, 0), (-0.5, 0.5), 0.02),
        {"switch_handle": (0, 0, 0.034)},
    )
    dial = Body(
        "dial",
        0.05,
        [rod_geom("dial_knob", 0.020, 0.024, (0, 0, 0.015))],
        [
            Look(rod(0.020, 0.024, 0.004).at(0, 0, 0.015), DARK, 0.5, 0.5),
            Look(box((0.011, 0, 0.0272), (0.007, 0.0016, 0.0005)), WHITE),
        ],
        (-0.035, -0.045, h),
        hinge("dial_hinge", (0, 0, 1), (0, 4.7), 0.02),
        {"dial_knob": (0, 0, 0.027)},
    )
    parts += [switch, dial]
    root = Body(
        "button_panel",
        1.2,
        [box_geom("console", (dx, dy, h / 2), (0, 0, h / 2))],
        [
            Look(block((dx, dy, h / 2), (0, 0, h / 2), 0.010), "0.78 0.79 0.80 1"),
            Look(
                plate(rounded_outline(dx - 0.012, dy - 0.012, 0.006), 0.001).at(0, 0, h),
                "0.93 0.93 0.92 1",
            ),
            *collars,
            Look(rod(0.010, 0.008, 0.002).at(-0.035, 0.045, h + 0.002), DARK, 0.5, 0.5),
        ],
        bodies=parts,
    )
    return Kind(
        root,
        "A console with four buttons, a switch and a dial; springs push the buttons back.",
        "controls",
        "grey",
        "plastic",
        ["control panel", "console", "buttons"],
        excluded=[("button_panel", part.name) for part in parts],
        is_free=False,
    )


def lid_box() -> Kind:
    """A wooden chest of 0.18 x 0.26 x 0.13 m with a hinged lid."""
    dx, dy, h, t = 0.09, 0.13, 0.10, 0.005
    walls = {
        "bottom": ((dx, dy, t), (0, 0, t)),
        "front": ((t, dy, h / 2 - t), (dx - t, 0, h / 2 + t)),
        "back": ((t, dy, h / 2 - t), (-dx + t, 0, h / 2 + t)),
        "left": ((dx - 2 * t, t, h / 2 - t), (0, dy - t, h / 2 + t)),
        "right": ((dx - 2 * t, t, h / 2 - t), (0, -dy + t, h / 2 + t)),
    }
    lid_half = (dx + 0.003, dy + 0.003, 0.007)
    lid_at = (dx + 0.002, 0, 0.009)
    grip = (0.014, 0.030, 0.006)
    grip_at = (2 * dx + 0.005 + grip[0], 0, 0.009)
    lid = Body(
        "lid",
        0.35,
        [
            box_geom("lid_panel", lid_half, lid_at),
            Geom(
                "lid_handle",
                box_geom("", grip, grip_at).attributes,
                8 * grip[0] * grip[1] * grip[2],
                contact=HANDLE_CONTACT,
            ),
        ],
        [
            Look(block(lid_half, lid_at, 0.004), WALNUT),
            Look(block(grip, (grip_at[0] - 0.004, 0, 0.009), 0.004), "0.80 0.66 0.30 1", 0.8, 0.8),
        ],
        (-dx, 0, h),
        hinge("lid_hinge", (0, -1, 0), (0, 1.9), 0.4),
        {"lid_handle": (grip_at[0] + grip[0], 0, 0.009)},
    )
    brass = "0.80 0.66 0.30 1"
    root = Body(
        "lid_box",
        1.0,
        [box_geom(name, half, pos) for name, (half, pos) in walls.items()],
        [
            *[Look(block(half, pos, 0.002), WALNUT) for half, pos in walls.values()],
            *[
                Look(
                    block((0.0015, 0.010, 0.014), (dx, sy * 0.10, h - 0.012), 0.001),
                    brass,
                    0.8,
                    0.8,
                )
                for sy in (-1, 1)
            ],
        ],
        sites={"lid_box_inside": (0, 0, 2 * t)},
        bodies=[lid],
    )
    return Kind(
        root,
        "A chest with a hinged lid.",
        "containers",
        "brown",
        "wood",
        ["chest", "box with a lid", "wooden box"],
        is_free=False,
    )


KINDS = (drawer_unit, microwave, laptop, faucet, button_panel, lid_box)
