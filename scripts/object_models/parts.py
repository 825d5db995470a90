"""Models of the catalogue: bodies with what is seen, what collides and where the mass is.

A body's mass is shared among its collision geoms by volume, so that its inertia is that of its
shape. What is seen has no mass and does not collide.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from object_models.shapes import Mesh

SIDES = 12  # boxes in a ring
Vec = tuple[float, float, float]


@dataclass
class Geom:
    """A part that collides."""

    name: str
    attributes: str
    volume: float  # m^3
    mesh: Mesh | None = None  # of a convex hull
    weight: float = 1.0  # its density, compared with that of the body's other geoms
    contact: str = ""  # more MJCF attributes


@dataclass
class Look:
    """A part that is seen."""

    mesh: Mesh
    rgba: str
    specular: float = 0.3
    shininess: float = 0.4
    name: str = ""  # "" for the body's first


@dataclass
class Body:
    """A rigid part. Lengths are metres, masses kilograms."""

    name: str
    mass: float
    geoms: list[Geom]
    looks: list[Look]
    pos: Vec = (0, 0, 0)
    joint: str = ""  # MJCF of its joint
    sites: dict[str, Vec] = field(default_factory=dict)
    bodies: list[Body] = field(default_factory=list)


@dataclass
class Words:
    """What a kind is called, and how hands take it: the content of object.yaml."""

    category: str
    colour: str
    material: str
    synonyms: list[str] = field(default_factory=list)
    grasps: list[str] = field(default_factory=list)
    drawn_by_default: bool = False


@dataclass
class Kind:
    """A kind of the catalogue: its model and its words."""

    root: Body
    about: str
    category: str
    colour: str
    material: str
    synonyms: list[str] = field(default_factory=list)
    grasps: list[str] = field(default_factory=list)
    friction: str = "0.8 0.02 0.001"
    condim: int = 4
    is_free: bool = True  # its root has a free joint, and its origin is in the middle
    contact: str = ""  # more attributes of its collision geoms
    excluded: list[tuple[str, str]] = field(default_factory=list)  # bodies that do not collide

    @property
    def name(self) -> str:
        """Name of the kind."""
        return self.root.name


def numbers(values: Sequence[float] | np.ndarray) -> str:
    """Numbers as MJCF has them; ten micrometres are precise enough."""
    return " ".join(f"{round(float(v), 6) + 0.0:.6g}" for v in values)


def _pose(pos: Vec, euler: Vec) -> str:
    turn = f' euler="{numbers([math.radians(v) for v in euler])}"' if any(euler) else ""
    return f'pos="{numbers(pos)}"{turn}'


def box_geom(name: str, half: Vec, pos: Vec = (0, 0, 0), euler: Vec = (0, 0, 0)) -> Geom:
    """A box; angles in degrees, about its own x, y, z."""
    volume = 8 * half[0] * half[1] * half[2]
    return Geom(name, f'type="box" size="{numbers(half)}" {_pose(pos, euler)}', volume)


def rod_geom(
    name: str, radius: float, height: float, pos: Vec = (0, 0, 0), euler: Vec = (0, 0, 0)
) -> Geom:
    """A cylinder about its own z axis."""
    size = numbers((radius, height / 2))
    volume = math.pi * radius**2 * height
    return Geom(name, f'type="cylinder" size="{size}" {_pose(pos, euler)}', volume)


def ball_geom(name: str, radius: float, pos: Vec = (0, 0, 0)) -> Geom:
    """A sphere."""
    volume = 4 / 3 * math.pi * radius**3
    return Geom(name, f'type="sphere" size="{radius:.6g}" pos="{numbers(pos)}"', volume)


def ellipsoid_geom(name: str, radii: Vec, pos: Vec = (0, 0, 0)) -> Geom:
    """An ellipsoid."""
    volume = 4 / 3 * math.pi * radii[0] * radii[1] * radii[2]
    return Geom(name, f'type="ellipsoid" size="{numbers(radii)}" pos="{numbers(pos)}"', volume)


def capsule_geom(
    name: str, start: Sequence[float] | np.ndarray, end: Sequence[float] | np.ndarray, radius: float
) -> Geom:
    """A capsule between two points."""
    length = math.dist(start, end)
    volume = math.pi * radius**2 * (length + 4 / 3 * radius)
    ends = numbers((*start, *end))
    return Geom(name, f'type="capsule" fromto="{ends}" size="{radius:.6g}"', volume)


def hull_geom(name: str, mesh: Mesh) -> Geom:
    """A convex mesh."""
    return Geom(name, f'type="mesh" mesh="{name}"', mesh.volume(), mesh)


def ring_geoms(
    name: str,
    low: tuple[float, float],
    high: tuple[float, float],
    wall: float,
    sides: int = SIDES,
    center: Vec = (0, 0, 0),
) -> list[Geom]:
    """A ring of boxes whose outer faces go from one (radius, z) to another."""
    (r0, z0), (r1, z1) = low, high
    slope = math.atan2(r1 - r0, z1 - z0)  # about each box's own y axis
    half_width = max(r0, r1) * math.tan(math.pi / sides)
    half_height = math.hypot(r1 - r0, z1 - z0) / 2
    radius = (r0 + r1) / 2 - wall / 2 * math.cos(slope)
    z = (z0 + z1) / 2 + wall / 2 * math.sin(slope)
    geoms = []
    for k in range(sides):
        turn = 2 * math.pi * k / sides
        pos = (center[0] + radius * math.cos(turn), center[1] + radius * math.sin(turn))
        (c, s), (cs, ss) = (
            (math.cos(turn / 2), math.sin(turn / 2)),
            (math.cos(slope / 2), math.sin(slope / 2)),
        )
        quat = (c * cs, -s * ss, c * ss, s * cs)  # the turn about z after the slope about y
        half = (wall / 2, half_width, half_height)
        attributes = (
            f'type="box" size="{numbers(half)}" pos="{numbers((*pos, center[2] + z))}" '
            f'quat="{numbers(quat)}"'
        )
        geoms.append(Geom(f"{name}_{k}", attributes, 8 * half[0] * half[1] * half[2]))
    return geoms


class Writer:
    """Writes the folder of one kind: MJCF, meshes and words."""

    def __init__(self, kind: Kind, script: str) -> None:
        self.kind, self.script = kind, script
        self.meshes: dict[str, Mesh] = {}
        self.assets: list[str] = []
        self.materials: dict[str, str] = {}
        low, high = self.bounds()
        self.size = high - low
        self.shift = -(low + high) / 2 if kind.is_free else np.zeros(3)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of what is seen, with all joints at zero."""
        lows, highs = [], []

        def visit(body: Body, at: np.ndarray) -> None:
            at = at + np.array(body.pos)
            for look in body.looks:
                low, high = look.mesh.bounds()
                lows.append(low + at)
                highs.append(high + at)
            for child in body.bodies:
                visit(child, at)

        visit(self.kind.root, np.zeros(3))
        return np.min(lows, 0), np.max(highs, 0)

    def material(self, look: Look) -> str:
        """The name of the material of a part, which parts of one colour share."""
        key = f'rgba="{look.rgba}" specular="{look.specular:g}" shininess="{look.shininess:g}"'
        if key not in self.materials:
            count = len(self.materials)
            self.materials[key] = self.kind.name + (f"_{count}" if count else "")
        return self.materials[key]

    def add_mesh(self, name: str, mesh: Mesh, *, shell: bool) -> None:
        """Declares a mesh. What is seen may overlap itself; its inertia is never used."""
        self.meshes[name] = mesh
        attribute = ' inertia="shell"' if shell else ""
        self.assets.append(f'    <mesh name="{name}" file="{name}.obj"{attribute}/>')

    def body(self, body: Body, indent: str, *, is_root: bool) -> list[str]:
        """MJCF lines of a body and those in it."""
        pos = f' pos="{numbers(body.pos)}"' if any(body.pos) else ""
        lines = [f'{indent}<body name="{body.name}"{pos}>']
        inner = indent + "  "
        if is_root and self.kind.is_free:
            lines.append(f"{inner}<freejoint/>")
        if body.joint:
            lines.append(f"{inner}{body.joint}")
        shift = self.shift if is_root else np.zeros(3)
        merged: dict[str, Mesh] = {}
        for look in body.looks:
            material = self.material(look)
            mesh = look.mesh.at(*shift)
            merged[material] = merged[material] + mesh if material in merged else mesh
        for i, (material, mesh) in enumerate(merged.items()):
            name = body.name + (f"_{i}" if i else "")
            self.add_mesh(name, mesh, shell=True)
            lines.append(
                f'{inner}<geom name="{name}_visual" class="{self.kind.name}_visual" '
                f'mesh="{name}" material="{material}"/>'
            )
        total = sum(geom.volume * geom.weight for geom in body.geoms)
        frame = f' pos="{numbers(shift)}"' if any(shift) else ""
        lines.append(f'{inner}<frame childclass="{self.kind.name}_collision"{frame}>')
        for geom in body.geoms:
            if geom.mesh is not None:
                self.add_mesh(geom.name, geom.mesh, shell=False)
            mass = body.mass * geom.volume * geom.weight / total
            more = f" {geom.contact}" if geom.contact else ""
            lines.append(
                f'{inner}  <geom name="{geom.name}" {geom.attributes} mass="{mass:.4g}"{more}/>'
            )
        lines.append(f"{inner}</frame>")
        for name, site in body.sites.items():
            at = numbers(np.array(site) + shift)
            lines.append(f'{inner}<site name="{name}" pos="{at}" size="0.005" group="4"/>')
        for child in body.bodies:
            lines += self.body(child, inner, is_root=False)
        return [*lines, f"{indent}</body>"]

    def mjcf(self) -> str:
        """The model's text; `meshes` and `assets` follow from it."""
        kind = self.kind
        bodies = self.body(kind.root, "    ", is_root=True)
        materials = [f'    <material name="{name}" {key}/>' for key, name in self.materials.items()]
        origin = (
            "The origin is in the middle of its bounding box."
            if kind.is_free
            else "It stands on its origin, and its front looks to +x."
        )
        more = f" {kind.contact}" if kind.contact else ""
        excluded = [f'    <exclude body1="{a}" body2="{b}"/>' for a, b in kind.excluded]
        if excluded:
            excluded = ["  <contact>", *excluded, "  </contact>"]
        return "\n".join(
            [
                f"<!-- {kind.about} Written by scripts/{self.script}.",
                f"     {origin} -->",
                f'<mujoco model="{kind.name}">',
                '  <compiler angle="radian" inertiafromgeom="true"/>',
                "  <default>",
                f'    <default class="{kind.name}_visual">',
                '      <geom type="mesh" group="2" mass="0" contype="0" conaffinity="0"/>',
                "    </default>",
                f'    <default class="{kind.name}_collision">',
                f'      <geom group="3" friction="{kind.friction}" condim="{kind.condim}" '
                f'rgba="0.9 0.5 0.2 0.5"{more}/>',
                "    </default>",
                "  </default>",
                "  <asset>",
                *materials,
                *self.assets,
                "  </asset>",
                "  <worldbody>",
                *bodies,
                "  </worldbody>",
                *excluded,
                "</mujoco>",
                "",
            ]
        )

    def words(self) -> str:
        """The text of object.yaml."""
        kind = self.kind
        words = Words(kind.category, kind.colour, kind.material, kind.synonyms, kind.grasps)
        return words_text(words, self.size)

    def write(self, out: Path) -> None:
        """Writes out/NAME/."""
        folder = out / self.kind.name
        folder.mkdir(parents=True, exist_ok=True)
        text = self.mjcf()
        for name, mesh in self.meshes.items():
            (folder / f"{name}.obj").write_text(mesh.to_obj(5))
        (folder / f"{self.kind.name}.xml").write_text(text)
        (folder / "object.yaml").write_text(self.words())


def words_text(words: Words, size: np.ndarray) -> str:
    """The text of object.yaml; `size` is that of the bounding box."""
    lines = [
        f"category: {words.category}",
        f"colour: {words.colour}",
        f"material: {words.material}",
        f"synonyms: [{', '.join(words.synonyms)}]",
        f"size: [{', '.join(f'{round(float(v), 4):g}' for v in size)}]",
        f"grasps: [{', '.join(words.grasps)}]",
    ]
    if words.drawn_by_default:
        lines.append("drawn_by_default: true")
    return "\n".join(lines) + "\n"
