"""Writes the vessels and the articulated equipment of models/equipment.

The open bottle to pour from and the receiver are made like the mesh objects (make_objects.py): what
is seen is a turned mesh, what collides is a bottom and rings of boxes around the hollow, so that
small things can be poured. Each has a site `mouth` in the middle of its opening, z outwards.
object_models/furniture.py describes what has joints. The other equipment is written by hand.

    python scripts/make_equipment.py [--out models/equipment]
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from object_models import furniture
from object_models.classic import Model, cylinder, write
from object_models.parts import Writer
from object_models.shapes import arc, lathe

SIDES = 12  # boxes in a ring
# Stiff, whatever falls on it: with the engine's defaults small grains sink through a thin bottom.
STIFF = 'solref="0.004 1" priority="1"'


def ring(
    name: str, low: tuple[float, float], high: tuple[float, float], wall: float, mass: float
) -> list[str]:
    """MJCF of a ring of boxes whose outer faces go from one (radius, z) to another.

    `wall` is their thickness in metres, `mass` that of the whole ring in kg.
    """
    (r0, z0), (r1, z1) = low, high
    slope = math.atan2(r1 - r0, z1 - z0)  # about each box's own y axis
    half_width = max(r0, r1) * math.tan(math.pi / SIDES)
    half_height = math.hypot(r1 - r0, z1 - z0) / 2
    radius = (r0 + r1) / 2 - wall / 2 * math.cos(slope)
    z = (z0 + z1) / 2 + wall / 2 * math.sin(slope)
    lines = []
    for k in range(SIDES):
        turn = 2 * math.pi * k / SIDES
        pos = (radius * math.cos(turn), radius * math.sin(turn), z)
        (c, s), (cs, ss) = (
            (math.cos(turn / 2), math.sin(turn / 2)),
            (math.cos(slope / 2), math.sin(slope / 2)),
        )
        quat = (c * cs, -s * ss, c * ss, s * cs)  # the turn about z after the slope about y
        lines.append(
            f'<geom name="{name}_{k}" type="box" '
            f'size="{wall / 2:.4g} {half_width:.4f} {half_height:.5f}" '
            f'pos="{" ".join(f"{v:.5f}" for v in pos)}" '
            f'quat="{" ".join(f"{v:.6f}" for v in quat)}" mass="{mass / SIDES:.4g}"/>'
        )
    return lines


def mouth(z: float) -> str:
    """MJCF of the site in the middle of the opening."""
    return f'<site name="mouth" pos="0 0 {z:.4g}" size="0.005" group="4"/>'


def open_bottle() -> Model:
    """A bottle without a cap, 60 mm wide and 150 mm high; the neck is 40 mm wide, 34 mm inside."""
    r, h, wall, neck = 0.030, 0.075, 0.003, 0.020
    bottom = 0.008
    profile = [
        (0, -h),
        *arc(r - 0.004, -h + 0.004, 0.004, -90, 0),
        (r, 0.025),
        (neck, 0.050),
        *arc(neck - wall / 2, h - wall / 2, wall / 2, 0, 180),
        (neck - wall, 0.050 - 0.001),
        (r - wall, 0.025 - 0.001),
        (r - wall, -h + bottom),
        (0, -h + bottom),
    ]
    collision = [
        cylinder("open_bottle_bottom", r - 0.001, -h, -h + bottom, 0.015),
        *ring("open_bottle_wall", (r, -h), (r, 0.026), wall, 0.07),
        *ring("open_bottle_shoulder", (r, 0.025), (neck, 0.051), wall, 0.015),
        *ring("open_bottle_neck", (neck, 0.050), (neck, h), wall, 0.015),
        mouth(h),
    ]
    about = "An open bottle to pour from."
    return Model("open_bottle", about, lathe(profile), "0.24 0.56 0.46 1", collision, {}, STIFF)


def receiver() -> Model:
    """A vessel to pour into, 130 mm wide at the top and 80 mm high."""
    foot, rim, h, wall, bottom = 0.050, 0.065, 0.040, 0.004, 0.008
    profile = [
        (0, -h),
        (foot, -h),
        *arc(rim - wall / 2, h - wall / 2, wall / 2, 0, 180),
        (foot - wall, -h + bottom),
        (0, -h + bottom),
    ]
    collision = [
        cylinder("receiver_bottom", foot - 0.001, -h, -h + bottom, 0.06),
        *ring("receiver_wall", (foot, -h), (rim, h), wall, 0.12),
        mouth(h),
    ]
    about = "A vessel to pour into."
    return Model("receiver", about, lathe(profile), "0.88 0.86 0.80 1", collision, {}, STIFF)


def main() -> None:
    """Writes them."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    default = Path(__file__).resolve().parent.parent / "models" / "equipment"
    parser.add_argument("--out", type=Path, default=default)
    out = parser.parse_args().out
    for make in (open_bottle, receiver):
        write(make(), out, "make_equipment.py")
    for describe in furniture.KINDS:
        Writer(describe(), Path(__file__).name).write(out)


if __name__ == "__main__":
    main()
