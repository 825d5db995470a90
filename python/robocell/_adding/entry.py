"""The text and the files of an entry of the catalogue that is made from a mesh."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from robocell._adding.hulls import Hull, volume_of
from robocell._adding.meshes import Coloured, Shape

COLOURS = {
    "black": (0.08, 0.08, 0.08),
    "white": (0.93, 0.93, 0.93),
    "grey": (0.55, 0.55, 0.55),
    "red": (0.80, 0.15, 0.13),
    "orange": (0.92, 0.50, 0.10),
    "yellow": (0.93, 0.82, 0.20),
    "green": (0.22, 0.58, 0.26),
    "blue": (0.18, 0.38, 0.76),
    "purple": (0.52, 0.28, 0.64),
    "pink": (0.93, 0.55, 0.66),
    "brown": (0.45, 0.29, 0.16),
}


@dataclass
class Words:
    """What a user says about an object."""

    category: str = "own"
    colour: str = ""
    material: str = ""
    synonyms: list[str] = field(default_factory=list)


def colour_word(shape: Shape) -> str:
    """Returns the word nearest to the colour that most triangles have."""
    rgba = max(shape.parts, key=lambda part: len(part.faces)).rgba
    return min(COLOURS, key=lambda name: float(np.sum((np.array(COLOURS[name]) - rgba[:3]) ** 2)))


def write_mesh_entry(
    folder: Path, name: str, shape: Shape, hulls: list[Hull], mass: float, friction: float
) -> None:
    """Writes NAME.xml with a mesh for each colour and one for each convex part."""
    assets, looks, parts = [], [], []
    for i, part in enumerate(shape.parts):
        mesh = name if i == 0 else f"{name}_{i}"
        _write_obj(folder / f"{mesh}.obj", part)
        rgba = _numbers(part.rgba)
        assets.append(f'    <material name="{mesh}" rgba="{rgba}" specular="0.3" shininess="0.4"/>')
        assets.append(f'    <mesh name="{mesh}" file="{mesh}.obj" inertia="shell"/>')
        looks.append(
            f'      <geom name="{mesh}_visual" type="mesh" mesh="{mesh}" material="{mesh}" '
            'group="2" mass="0" contype="0" conaffinity="0"/>'
        )
    volumes = [volume_of(hull) for hull in hulls]
    for i, (vertices, faces) in enumerate(hulls):
        mesh = f"{name}_part_{i}"
        _write_obj(folder / f"{mesh}.obj", Coloured(vertices, faces, (0, 0, 0, 1)))
        assets.append(f'    <mesh name="{mesh}" file="{mesh}.obj"/>')
        share = mass * volumes[i] / sum(volumes)
        parts.append(
            f'      <geom name="{mesh}" type="mesh" mesh="{mesh}" group="3" mass="{share:.6g}" '
            f'friction="{friction:g} 0.02 0.002" condim="6" rgba="0.9 0.5 0.2 0.5"/>'
        )
    lines = [
        "<!-- Written by robocell add-object. The origin is in the middle of its bounding box. -->",
        f'<mujoco model="{name}">',
        '  <compiler angle="radian" inertiafromgeom="true"/>',
        "  <asset>",
        *assets,
        "  </asset>",
        "  <worldbody>",
        f'    <body name="{name}">',
        "      <freejoint/>",
        *looks,
        *parts,
        "    </body>",
        "  </worldbody>",
        "</mujoco>",
        "",
    ]
    (folder / f"{name}.xml").write_text("\n".join(lines))


def write_words(folder: Path, words: Words, size: np.ndarray) -> None:
    """Writes object.yaml. JSON texts are YAML texts."""
    lines = [
        f"category: {json.dumps(words.category)}",
        f"colour: {json.dumps(words.colour, ensure_ascii=False)}",
        f"material: {json.dumps(words.material, ensure_ascii=False)}",
        f"synonyms: {json.dumps(words.synonyms, ensure_ascii=False)}",
        f"size: [{', '.join(f'{value:.4g}' for value in size)}]",
    ]
    (folder / "object.yaml").write_text("\n".join(lines) + "\n", encoding="utf-8")


def _write_obj(path: Path, part: Coloured) -> None:
    lines = [f"v {x:.7g} {y:.7g} {z:.7g}" for x, y, z in part.vertices]
    lines += [f"f {a} {b} {c}" for a, b, c in part.faces + 1]
    path.write_text("\n".join(lines) + "\n")


def _numbers(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:.4g}" for value in values)
