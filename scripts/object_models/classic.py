"""Objects with one colour and one hand-written collision model: the mug, the bottle and others.

The bytes of these files are part of what runs reproduce, so they keep their own writer.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from object_models.parts import Words, words_text
from object_models.shapes import SEGMENTS, Mesh, arc, between, box, extrude, lathe, tube


@dataclass
class Model:
    """An object: its visual mesh, its colour and the MJCF lines of its collision geoms."""

    name: str
    about: str
    visual: Mesh
    rgba: str
    collision: list[str]
    meshes: dict[str, Mesh] = field(default_factory=dict)
    contact: str = ""  # more attributes of its collision geoms
    words: Words | None = None


def cylinder(name: str, radius: float, z_low: float, z_high: float, mass: float) -> str:
    """MJCF of an upright cylinder about the object's z axis."""
    size, pos = f"{radius:.4g} {(z_high - z_low) / 2:.4g}", f"0 0 {(z_high + z_low) / 2:.4g}"
    return f'<geom name="{name}" type="cylinder" size="{size}" pos="{pos}" mass="{mass}"/>'


def mug() -> Model:
    """A cup, 60 mm wide and 80 mm high, with a handle in +x."""
    r, h, wall = 0.030, 0.040, 0.004
    profile = [
        (0, -h),
        *arc(r - 0.005, -h + 0.005, 0.005, -90, 0),
        *arc(r - wall / 2, h - wall / 2, wall / 2, 0, 180),
    ]
    profile += [(r - wall, -h + wall + 0.003), (0, -h + wall)]
    angles = np.radians(np.linspace(75, -75, 17))
    handle = np.column_stack(
        [r - 0.003 + 0.022 * np.cos(angles), 0 * angles, 0.026 * np.sin(angles)]
    )
    sides = 12
    half = (r - wall / 2) * math.tan(math.pi / sides) + 0.0005
    collision = [cylinder("mug_bottom", r - 0.001, -h, -h + wall, 0.02)]
    for k in range(sides):
        angle = 2 * math.pi * k / sides
        x, y = (r - wall / 2) * math.cos(angle), (r - wall / 2) * math.sin(angle)
        collision.append(
            f'<geom name="mug_wall_{k}" type="box" '
            f'size="{wall / 2:.4g} {half:.4f} {h - wall / 2:.4g}" '
            f'pos="{x:.5f} {y:.5f} {wall / 2:.4g}" euler="0 0 {angle:.5f}" mass="0.0065"/>'
        )
    corners = handle[[0, 5, 11, 16]]
    for k, (a, b) in enumerate(itertools.pairwise(corners)):
        ends = " ".join(f"{v:.5f}" for v in (*a, *b))
        collision.append(
            f'<geom name="mug_handle_{k}" type="capsule" fromto="{ends}" size="0.004" '
            f'mass="0.003"/>'
        )
    return Model(
        "mug",
        "A cup with a handle in +x.",
        lathe(profile) + tube(handle, 0.0042),
        "0.25 0.47 0.72 1",
        collision,
        words=Words(
            "kitchen", "blue", "ceramic", ["cup with a handle", "coffee mug"], ["top"], True
        ),
    )


def bottle() -> Model:
    """A bottle, 56 mm wide and 140 mm high; the neck is 28 mm wide."""
    profile = [
        (0, -0.07),
        *arc(0.023, -0.065, 0.005, -90, 0),
        (0.028, 0.015),
        *arc(0.018, 0.015, 0.010, 10, 60),
    ]
    profile += [
        (0.014, 0.035),
        (0.012, 0.042),
        (0.012, 0.052),
        (0.014, 0.053),
        (0.014, 0.069),
        (0.013, 0.07),
        (0, 0.07),
    ]
    collision = [
        cylinder("bottle_body", 0.028, -0.07, 0.016, 0.080),
        cylinder("bottle_shoulder", 0.0235, 0.016, 0.025, 0.007),
        cylinder("bottle_collar", 0.0165, 0.025, 0.035, 0.004),
        cylinder("bottle_neck", 0.012, 0.035, 0.053, 0.004),
        cylinder("bottle_cap", 0.014, 0.053, 0.070, 0.005),
    ]
    return Model(
        "bottle",
        "A bottle with a cap.",
        lathe(profile),
        "0.20 0.58 0.42 1",
        collision,
        words=Words("bottles", "green", "plastic", ["flask"], ["top"], True),
    )


def spool() -> Model:
    """A spool, 56 mm high, with 60 mm flanges and a 32 mm waist."""
    profile = [
        (0, -0.028),
        (0.029, -0.028),
        (0.030, -0.027),
        (0.030, -0.021),
        (0.029, -0.020),
        *arc(0.020, -0.016, 0.004, 270, 180),
    ]
    profile += [
        *arc(0.020, 0.016, 0.004, 180, 90),
        (0.029, 0.020),
        (0.030, 0.021),
        (0.030, 0.027),
        (0.029, 0.028),
        (0, 0.028),
    ]
    collision = [
        cylinder("spool_lower_flange", 0.030, -0.028, -0.020, 0.022),
        cylinder("spool_waist", 0.016, -0.020, 0.020, 0.036),
        cylinder("spool_upper_flange", 0.030, 0.020, 0.028, 0.022),
    ]
    return Model(
        "spool",
        "A spool that stands on a flange.",
        lathe(profile),
        "0.80 0.35 0.28 1",
        collision,
        words=Words("tools", "red", "plastic", ["reel", "bobbin"], ["top"], True),
    )


def nut() -> Model:
    """A hexagonal nut, 44 mm across flats, 32 mm high, with a 22 mm hole."""
    flat, hole, height = 0.022, 0.011, 0.032
    corner = flat / math.cos(math.pi / 6)
    turn = np.radians(np.arange(0, 360, 360 / SEGMENTS))
    # Distance of the outline at each angle: the side's normal points along the nearest 60 degrees.
    outer = flat / np.cos((turn + math.pi / 6) % (math.pi / 3) - math.pi / 6)
    rings = [(outer, -height / 2), (outer, height / 2)]
    rings += [(0 * turn + hole, height / 2), (0 * turn + hole, -height / 2)]
    visual = between(rings, turn)
    corners = [
        (corner * math.cos(a), corner * math.sin(a)) for a in np.radians(np.arange(30, 390, 60))
    ]
    # One convex piece, the hole filled: six pieces around it would stand on 24 contacts.
    collision = ['<geom name="nut_hull" type="mesh" mesh="nut_hull" mass="0.08"/>']
    hull = {"nut_hull": extrude(corners, height)}
    return Model(
        "nut",
        "A hexagonal nut; solid to the touch.",
        visual,
        "0.66 0.67 0.70 1",
        collision,
        hull,
        words=Words("tools", "grey", "metal", ["hexagonal nut"], ["top"], True),
    )


def bracket() -> Model:
    """An angle bracket: a 64 x 32 mm foot and a 50 mm upright, both 12 mm thick."""
    foot, upright = (
        ((0, 0, -0.019), (0.032, 0.016, 0.006)),
        ((-0.026, 0, 0.006), (0.006, 0.016, 0.019)),
    )
    rib = Mesh(
        np.array(
            [
                (x, y, z)
                for y in (-0.003, 0.003)
                for x, z in ((-0.020, -0.013), (0.006, -0.013), (-0.020, 0.013))
            ]
        ),
        [[0, 1, 2], [5, 4, 3], [0, 3, 4, 1], [1, 4, 5, 2], [2, 5, 3, 0]],
    )
    collision = []
    for part, (pos, half), mass in (("foot", foot, 0.045), ("upright", upright, 0.03)):
        place = f'size="{" ".join(map(str, half))}" pos="{" ".join(map(str, pos))}"'
        collision.append(f'<geom name="bracket_{part}" type="box" {place} mass="{mass}"/>')
    collision.append('<geom name="bracket_rib" type="mesh" mesh="bracket_rib" mass="0.003"/>')
    visual = box(*foot) + box(*upright) + rib
    return Model(
        "bracket",
        "An angle bracket with a rib.",
        visual,
        "0.86 0.66 0.20 1",
        collision,
        {"bracket_rib": rib},
        words=Words("tools", "yellow", "metal", ["angle bracket"], ["top"], True),
    )


TEMPLATE = """<!-- {about} Written by scripts/{script}.
     The origin is in the middle of its bounding box. -->
<mujoco model="{name}">
  <compiler angle="radian" inertiafromgeom="true"/>
  <default>
    <default class="{name}_collision">
      <geom group="3" friction="0.8 0.02 0.001" condim="4" rgba="0.9 0.5 0.2 0.5"{contact}/>
    </default>
  </default>
  <asset>
    <material name="{name}" rgba="{rgba}" specular="0.3" shininess="0.4"/>
{assets}
  </asset>
  <worldbody>
    <body name="{name}">
      <freejoint/>
      <geom name="{name}_visual" type="mesh" mesh="{name}" material="{name}" group="2" mass="0"
            contype="0" conaffinity="0"/>
      <frame childclass="{name}_collision">
{collision}
      </frame>
    </body>
  </worldbody>
</mujoco>
"""


def write(model: Model, out: Path, script: str = "make_objects.py") -> None:
    """Writes the folder of one object; `script` is named in the file."""
    folder = out / model.name
    folder.mkdir(parents=True, exist_ok=True)
    meshes = {model.name: model.visual, **model.meshes}
    for name, mesh in meshes.items():
        (folder / f"{name}.obj").write_text(mesh.to_obj())
    # A visual mesh may be a shell or overlap itself; its inertia is never used.
    shell = {model.name: ' inertia="shell"'}
    assets = [f'    <mesh name="{n}" file="{n}.obj"{shell.get(n, "")}/>' for n in meshes]
    lines = [f"        {line}" for line in model.collision]
    text = TEMPLATE.format(
        about=model.about,
        script=script,
        contact=f" {model.contact}" if model.contact else "",
        name=model.name,
        rgba=model.rgba,
        assets="\n".join(assets),
        collision="\n".join(lines),
    )
    (folder / f"{model.name}.xml").write_text(text)
    if model.words:
        low, high = model.visual.bounds()
        (folder / "object.yaml").write_text(words_text(model.words, high - low))


KINDS = (mug, bottle, spool, nut, bracket)
