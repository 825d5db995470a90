"""Writes the vessels and the articulated equipment of models/equipment.

The open bottle to pour from and the receiver are made like the mesh objects (make_objects.py): what
is seen is a turned mesh, what collides is a bottom and rings of boxes around the hollow, so that
small things can be poured. The rings end above the underside: the bottom alone touches what the
vessel stands on, in a few contacts. Each has a site `mouth` in the middle of its opening, z
outwards. object_models/furniture.py describes what has joints. The other equipment is written by
hand.

    python scripts/make_equipment.py [--out models/equipment]
"""

from __future__ import annotations

import argparse
import itertools
import math
from dataclasses import dataclass
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
        *ring("open_bottle_wall", (r, -h + bottom / 2), (r, 0.026), wall, 0.07),
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
    low = -h + bottom / 2
    low_radius = foot + (rim - foot) * (low + h) / (2 * h)
    collision = [
        cylinder("receiver_bottom", foot - 0.001, -h, -h + bottom, 0.06),
        *ring("receiver_wall", (low_radius, low), (rim, h), wall, 0.12),
        mouth(h),
    ]
    about = "A vessel to pour into."
    return Model("receiver", about, lathe(profile), "0.88 0.86 0.80 1", collision, {}, STIFF)


@dataclass
class Hole:
    """A block with holes from above: slots, or one round hole."""

    name: str
    about: str
    slots: list[tuple[float, float, float, float]]  # middles and half widths of slots
    diameter: float = 0  # of one round hole, instead of slots
    depth: float = 0.03
    half: float = 0.045  # of the block, along x and y
    floor: float = 0.012  # thickness under the holes
    mass: float = 2.5

    def outline(self) -> tuple[float, float]:
        """Half widths of what all its holes lie in."""
        if self.diameter:
            return self.diameter / 2, self.diameter / 2
        return (
            max(abs(x) + hx for x, _, hx, _ in self.slots),
            max(abs(y) + hy for _, y, _, hy in self.slots),
        )

    def walls(self) -> list[str]:
        """MJCF of the boxes around the holes."""
        z0 = self.floor / 2  # the origin is in the middle of the block
        half_height = self.depth / 2
        boxes: list[tuple[float, float, float, float, float]] = []  # x, y, half x, half y, turn
        if self.diameter:
            sides, r = 24, self.diameter / 2
            wall = (self.half - r) / 2
            width = (r + 2 * wall) * math.tan(math.pi / sides)
            for k in range(sides):
                turn = 2 * math.pi * k / sides
                at = r + wall
                boxes.append((at * math.cos(turn), at * math.sin(turn), wall, width, turn))
        else:
            ox, oy = self.outline()
            wall_x, wall_y = (self.half - ox) / 2, (self.half - oy) / 2
            boxes += [(s * (ox + wall_x), 0, wall_x, self.half, 0) for s in (-1, 1)]
            boxes += [(0, s * (oy + wall_y), ox, wall_y, 0) for s in (-1, 1)]
            ends = sorted((x - hx, x + hx) for x, _, hx, _ in self.slots)
            for (_, left), (right, _) in itertools.pairwise(ends):
                boxes.append(((left + right) / 2, 0, (right - left) / 2, oy, 0))
        lines = []
        for k, (x, y, hx, hy, turn) in enumerate(boxes):
            quat = f"{math.cos(turn / 2):.6f} 0 0 {math.sin(turn / 2):.6f}"
            lines.append(
                f'<geom name="{self.name}_wall_{k}" class="{self.name}_wall" '
                f'size="{hx:.5f} {hy:.5f} {half_height:.5f}" pos="{x:.5f} {y:.5f} {z0:.5f}" '
                f'quat="{quat}" mass="{self.mass / 2 / len(boxes):.5g}"/>'
            )
        return lines

    def mjcf(self) -> str:
        """The model."""
        height = self.depth + self.floor
        hx, hy = self.outline()
        size = f"{hx:.5f} {self.depth / 2:.5f}" if self.diameter else ""
        size = size or f"{hx:.5f} {hy:.5f} {self.depth / 2:.5f}"
        site = "cylinder" if self.diameter else "box"
        walls = "\n".join(f"      {line}" for line in self.walls())
        return f"""<!-- {self.about} Written by scripts/make_equipment.py.
     The origin is in the middle of the block; the site `hole` fills what an object is put into. -->
<mujoco model="{self.name}">
  <compiler angle="radian" inertiafromgeom="true"/>
  <default>
    <default class="{self.name}_wall">
      <geom type="box" material="{self.name}" friction="0.3 0.01 0.001" solref="0.004 1"
            priority="1"/>
    </default>
  </default>
  <asset>
    <material name="{self.name}" rgba="0.55 0.57 0.60 1" specular="0.4" shininess="0.5"/>
  </asset>
  <worldbody>
    <body name="{self.name}">
      <freejoint/>
      <geom name="{self.name}_floor" type="box" size="{self.half} {self.half} {self.floor / 2:.4g}"
            pos="0 0 {(self.floor - height) / 2:.5f}" mass="{self.mass / 2}" friction="1 0.02 0.001"
            condim="4" material="{self.name}"/>
{walls}
      <site name="hole" type="{site}" size="{size}" pos="0 0 {self.floor / 2:.5f}" group="4"/>
    </body>
  </worldbody>
</mujoco>
"""

    def write(self, out: Path) -> None:
        """Writes its folder."""
        folder = out / self.name
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{self.name}.xml").write_text(self.mjcf())


CLEARANCE = 0.001  # m, of the blades of a plug in all
BLADE = (0.004, 0.011, 0.015)  # half sizes of a blade, m
BLADES = 0.009  # m from the middle to that of a blade


def holes() -> list[Hole]:
    """The blocks that pegs and the plug go into."""
    slot = (BLADE[0] + CLEARANCE / 2, BLADE[1] + CLEARANCE / 2)
    return [
        Hole("square_hole", "A block with a square hole of 30 mm.", [(0, 0, 0.015, 0.015)]),
        Hole("round_hole", "A block with a round hole of 30 mm.", [], diameter=0.03),
        Hole(
            "socket", "A socket for the plug.", [(s * BLADES, 0, *slot) for s in (-1, 1)],
            depth=2 * BLADE[2],
        ),
    ]  # fmt: skip


def plug() -> str:
    """MJCF of the plug."""
    half, top = (0.017, 0.015, 0.035), 0.035
    middle = top - 2 * half[2] - BLADE[2]
    blades = "\n".join(
        f'      <geom name="plug_blade_{k}" type="box" size="{BLADE[0]} {BLADE[1]} {BLADE[2]}" '
        f'pos="{s * BLADES} 0 {middle:.4g}" mass="0.01" rgba="0.8 0.7 0.4 1"/>'
        for k, s in enumerate((-1, 1))
    )
    return f"""<!-- A plug with two blades. Written by scripts/make_equipment.py.
     The origin is in the middle of its grip. -->
<mujoco model="plug">
  <compiler angle="radian" inertiafromgeom="true"/>
  <default>
    <geom friction="1 0.02 0.001" condim="4" solref="0.004 1"/>
  </default>
  <worldbody>
    <body name="plug">
      <freejoint/>
      <geom name="plug_grip" type="box" size="{half[0]} {half[1]} {half[2]}" mass="0.06"
            rgba="0.2 0.2 0.22 1"/>
{blades}
    </body>
  </worldbody>
</mujoco>
"""


def main() -> None:
    """Writes them."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    default = Path(__file__).resolve().parent.parent / "models" / "equipment"
    parser.add_argument("--out", type=Path, default=default)
    out = parser.parse_args().out
    for make in (open_bottle, receiver):
        write(make(), out, "make_equipment.py")
    for hole in holes():
        hole.write(out)
    (out / "plug").mkdir(parents=True, exist_ok=True)
    (out / "plug" / "plug.xml").write_text(plug())
    for describe in furniture.KINDS:
        Writer(describe(), Path(__file__).name).write(out)


if __name__ == "__main__":
    main()
