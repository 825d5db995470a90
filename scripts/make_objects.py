"""Writes the mesh objects of models/objects: one folder each with meshes, an MJCF and object.yaml.

What is seen are meshes made here by turning, extruding and lofting. What collides is a hand-made
convex decomposition: primitives where they fit, else small convex meshes. Every object has one root
body with a free joint, its origin in the middle of its bounding box, and its mass on the collision
geoms. object_models/ describes the kinds. Not needed to use robocell: the results are in the
repository.

    python scripts/make_objects.py [--out models/objects]
"""

from __future__ import annotations

import argparse
from pathlib import Path

from object_models import blocks, bottles, boxes, classic, food, kitchen, tools, utensils
from object_models.parts import Writer

SCRIPT = Path(__file__).name


def main() -> None:
    """Writes all objects."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    default = Path(__file__).resolve().parent.parent / "models" / "objects"
    parser.add_argument("--out", type=Path, default=default)
    out = parser.parse_args().out
    for make in classic.KINDS:
        classic.write(make(), out)
    for module in (kitchen, utensils, bottles, tools, boxes, food, blocks):
        for describe in module.KINDS:
            Writer(describe(), SCRIPT).write(out)


if __name__ == "__main__":
    main()
