"""Draws docs/layers.svg: the layers and who may include whom, from scripts/check_includes.py.

python docs/make_layers_figure.py [--check]

With --check it writes nothing and fails when the picture is not that of the rules.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS.parent / "scripts"))
from check_includes import TABLE  # noqa: E402  the rules themselves

SOURCES = DOCS.parent / "src" / "robocell"
PICTURE = DOCS / "layers.svg"
WIDE, HIGH = 104, 40  # of a box, pixels
COLUMN, ROW, MARGIN = 74, 74, 14  # distance of columns and rows, white around all
# Chosen so that no arrow crosses a box.
COLUMNS = {
    **{"base": 0, "math": -2.2, "mujoco": 0, "media": 2.2, "spec": -3, "data": 4.4},
    **{"assets": -3.3, "kinematics": -1.1, "scene": 0, "robot": -0.8, "motion": -2.2},
    **{"render": 0.4, "control": 2.6, "scenes": -0.9, "features": 4.2, "task": 1.6},
    **{"expert": 0.6, "env": 2.6, "rollout": 1.6, "diagnose": 1.6},
}
COLOURS = {
    "base math media mujoco spec assets": "#dfe7ee",  # values and the engine
    "scene kinematics robot control render motion": "#cfe6d4",  # the simulation
    "scenes features task expert env": "#fbe3b8",  # cells and tasks
    "data rollout diagnose": "#f6cfc6",  # datasets
}


def direct(layer: str) -> set[str]:
    """Names of the layers in the layer's row of the rules."""
    return {name.removeprefix("+") for name in TABLE[layer].split()}


def reachable(layer: str) -> set[str]:
    """Names of all layers below."""
    below = direct(layer)
    return below.union(*(reachable(name) for name in below)) if below else below


def drawn_edges(layers: list[str]) -> list[tuple[str, str]]:
    """Pairs (upper, lower) without those that follow from the others."""
    return [
        (layer, name)
        for layer in layers
        for name in direct(layer)
        if not any(name in reachable(other) for other in direct(layer) - {name})
    ]


def depth(layer: str) -> int:
    """The row of a layer: above all that it includes."""
    if layer == "render":
        return depth("control")
    return 1 + max(map(depth, direct(layer)), default=-1)


def places(layers: list[str]) -> dict[str, tuple[float, float]]:
    """The middle of each box, pixels. A new layer starts in the middle: give it a column."""
    left = min(COLUMNS.values())
    top = max(map(depth, layers))
    return {
        layer: (
            MARGIN + WIDE / 2 + COLUMN * (COLUMNS.get(layer, 1.6) - left),
            MARGIN + HIGH / 2 + ROW * (top - depth(layer)),
        )
        for layer in layers
    }


def colour_of(layer: str) -> str:
    """The fill of a box."""
    return next((colour for names, colour in COLOURS.items() if layer in names.split()), "#ffffff")


def drawing() -> str:
    """The picture of the layers that exist."""
    layers = [layer for layer in TABLE if (SOURCES / layer).is_dir()]
    at = places(layers)
    width = max(x for x, _ in at.values()) + WIDE / 2 + MARGIN
    height = max(y for _, y in at.values()) + HIGH / 2 + MARGIN
    return "\n".join([*elements(at, width, height), "</svg>", ""])


def elements(at: dict[str, tuple[float, float]], width: float, height: float) -> Iterator[str]:
    """The lines of the picture: arrows first, so that boxes lie above them."""
    yield (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}"'
        f' viewBox="0 0 {width:.0f} {height:.0f}" font-family="sans-serif" font-size="15">'
    )
    yield "<title>The layers of robocell, each with arrows to those that it includes</title>"
    yield (
        '<defs><marker id="tip" viewBox="0 0 10 10" refX="10" refY="5" markerWidth="8"'
        ' markerHeight="8" orient="auto"><path d="M0 1 10 5 0 9z" fill="#6b7680"/></marker></defs>'
    )
    yield f'<rect width="{width:.0f}" height="{height:.0f}" fill="#ffffff"/>'
    for upper, lower in sorted(drawn_edges(list(at))):
        (x0, y0), (x1, y1) = at[upper], at[lower]
        yield (
            f'<line x1="{x0:.0f}" y1="{y0 + HIGH / 2:.0f}" x2="{x1:.0f}" y2="{y1 - HIGH / 2:.0f}"'
            ' stroke="#6b7680" stroke-width="1.2" marker-end="url(#tip)"/>'
        )
    for layer, (x, y) in at.items():
        yield (
            f'<rect x="{x - WIDE / 2:.0f}" y="{y - HIGH / 2:.0f}" width="{WIDE}" height="{HIGH}"'
            f' rx="8" fill="{colour_of(layer)}" stroke="#40484f"/>'
        )
        yield f'<text x="{x:.0f}" y="{y + 5:.0f}" text-anchor="middle">{layer}</text>'


def main() -> int:
    """Writes the picture, or compares it."""
    if "--check" not in sys.argv:
        PICTURE.write_text(drawing())
        print(PICTURE)
    elif not PICTURE.is_file() or PICTURE.read_text() != drawing():
        print("docs/layers.svg is not as scripts/check_includes.py: run docs/make_layers_figure.py")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
