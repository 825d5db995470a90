"""Draws docs/layers.png: the layers and who may include whom, from scripts/check_includes.py.

python docs/make_layers_figure.py
"""

from __future__ import annotations

import io
import sys

import matplotlib as mpl
from figures import DOCS, save
from matplotlib.figure import Figure
from PIL import Image

sys.path.insert(0, str(DOCS.parent / "scripts"))
from check_includes import TABLE  # the rules themselves

SOURCES = DOCS.parent / "src" / "robocell"
WIDE, HIGH = 1.5, 0.62  # of a box
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
    """The middle of each box. A new layer starts in the middle: give it a column."""
    return {layer: (COLUMNS.get(layer, 1.6), 1.35 * depth(layer)) for layer in layers}


def main() -> None:
    """Draws the layers that exist."""
    layers = [layer for layer in TABLE if (SOURCES / layer).is_dir()]
    at = places(layers)
    mpl.rcParams["font.size"] = 10
    figure = Figure(figsize=(7.2, 8.2), layout="constrained")
    axes = figure.add_subplot()
    for upper, lower in drawn_edges(layers):
        (x0, y0), (x1, y1) = at[upper], at[lower]
        axes.annotate(
            "",
            (x1, y1 + HIGH / 2),
            (x0, y0 - HIGH / 2),
            arrowprops={"arrowstyle": "-|>", "color": "#6b7680", "lw": 0.9},
        )
    for names, colour in COLOURS.items():
        for layer in names.split():
            if layer not in at:
                continue
            x, y = at[layer]
            box = mpl.patches.FancyBboxPatch(
                (x - WIDE / 2, y - HIGH / 2),
                WIDE,
                HIGH,
                boxstyle="round,pad=0,rounding_size=0.12",
                facecolor=colour,
                edgecolor="#40484f",
                linewidth=0.9,
            )
            axes.add_patch(box)
            axes.text(x, y, layer, ha="center", va="center")
    across, top = [x for x, _ in at.values()], max(y for _, y in at.values())
    axes.set(xlim=(min(across) - WIDE, max(across) + WIDE), ylim=(-HIGH, top + HIGH))
    axes.set_axis_off()
    stream = io.BytesIO()
    figure.savefig(stream, dpi=110)
    save(Image.open(stream), "layers.png")


if __name__ == "__main__":
    main()
