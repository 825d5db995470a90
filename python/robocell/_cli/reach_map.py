"""Output of `robocell reach`: a file of arrays, a picture, a page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell import Robot
from robocell._extras import needed_by

Array = NDArray[np.float64]
AXES = "xyz"
TITLES = {
    "fraction": "rotations reached, share",
    "manipulability": "mean manipulability",
}
COLOURS = {"fraction": "viridis", "manipulability": "magma"}


def corners(robot: Robot, layer: tuple[int, float] | None) -> tuple[Array, Array]:
    """Returns the corners (3,), m, of the box that the robot may reach, or of one layer of it."""
    lower, upper = robot.kinematics.reach_box()
    if layer:
        axis, place = layer
        lower[axis] = upper[axis] = place
    return lower, upper


def save(path: Path, found: Any) -> None:
    """Saves the map as arrays: fraction, manipulability (X, Y, Z), cell centres x, y, z."""
    np.savez_compressed(path, **vars(found))


def slices(found: Any) -> list[tuple[int, float, dict[str, Array]]]:
    """Returns 2D slices: the plane, or the three central planes of a volume.

    Returns:
        Of each the axis that it is across, where it is (m), and its values (U, V) by name, for the
        two other axes in order.
    """
    shape = found.fraction.shape
    flat = [axis for axis in range(3) if shape[axis] == 1]
    pieces = []
    for axis in flat[:1] or (2, 1, 0):
        middle = shape[axis] // 2
        values = {name: np.take(getattr(found, name), middle, axis=axis) for name in TITLES}
        pieces.append((axis, float(getattr(found, AXES[axis])[middle]), values))
    return pieces


def load_plots() -> None:
    """Loads the plot packages. Raises ModuleNotFoundError with the pip command."""
    with needed_by("robocell reach", "plots", "Numbers alone: robot.kinematics.reach_map"):
        import matplotlib.pyplot  # noqa: F401
        import plotly.subplots  # noqa: F401


def draw(path: Path, name: str, found: Any) -> None:
    """Draws a PNG with one row per slice: reached share beside manipulability."""
    import matplotlib as mpl

    mpl.use("agg")
    from matplotlib import pyplot

    pieces = slices(found)
    figure, grid = pyplot.subplots(
        len(pieces), 2, figsize=(10, 4.4 * len(pieces)), squeeze=False, layout="constrained"
    )
    for row, (axis, place, values) in zip(grid, pieces, strict=True):
        u, v = (a for a in range(3) if a != axis)
        edges = [_edges(getattr(found, AXES[a]), found.cell) for a in (u, v)]
        for axes, (kind, numbers) in zip(row, values.items(), strict=True):
            image = axes.pcolormesh(
                *edges,
                np.ma.masked_equal(numbers.T, 0),
                cmap=COLOURS[kind],
                vmin=0,
                vmax=1 if kind == "fraction" else None,
            )
            figure.colorbar(image, ax=axes, shrink=0.85)
            axes.set(
                aspect="equal",
                title=f"{TITLES[kind]} at {AXES[axis]} = {place:.2f} m",
                xlabel=f"{AXES[u]}, m",
                ylabel=f"{AXES[v]}, m",
            )
            axes.plot(0, 0, "+", color="tab:red", markersize=10)
    figure.suptitle(f"{name}, robot base frame (+)")
    figure.savefig(path, dpi=110)
    pyplot.close(figure)


def write_page(path: Path, name: str, found: Any) -> None:
    """Writes an HTML page that needs no network: heat maps, or a volume that can be turned."""
    import plotly.graph_objects as go
    from plotly.subplots import make_subplots

    flat = 1 in found.fraction.shape
    kinds = [{"type": "heatmap" if flat else "scene"}] * 2
    figure = make_subplots(1, 2, specs=[kinds], subplot_titles=list(TITLES.values()))
    for column, kind in enumerate(TITLES, start=1):
        bar = {"x": 0.45 if column == 1 else 1.0}
        if flat:
            axis, _, values = slices(found)[0]
            u, v = (getattr(found, AXES[a]) for a in range(3) if a != axis)
            numbers = np.where(values[kind] > 0, values[kind], np.nan).T
            figure.add_trace(
                go.Heatmap(x=u, y=v, z=numbers, colorscale=COLOURS[kind], colorbar=bar), 1, column
            )
            continue
        numbers = getattr(found, kind)
        x, y, z = np.meshgrid(found.x, found.y, found.z, indexing="ij")
        figure.add_trace(
            go.Volume(
                x=x.ravel(),
                y=y.ravel(),
                z=z.ravel(),
                value=numbers.ravel(),
                isomin=0.05 * float(numbers.max()),
                isomax=float(numbers.max()),
                opacity=0.15,
                surface_count=12,
                colorscale=COLOURS[kind],
                colorbar=bar,
            ),
            1,
            column,
        )
    if flat:
        u, v = (AXES[a] for a in range(3) if a != axis)
        figure.update_xaxes(title=f"{u}, m")
        figure.update_yaxes(title=f"{v}, m", scaleanchor="x")
    figure.update_layout(title=f"{name}: reach in the robot base frame")
    figure.write_html(path, include_plotlyjs=True)


def _edges(centres: Array, cell: float) -> Array:
    """Borders of cells (N + 1,) from their centres (N,)."""
    return np.append(centres - cell / 2, centres[-1] + cell / 2)
