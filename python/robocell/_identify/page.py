"""A page of what was identified: values with their intervals, and residuals over time."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import Any

from robocell._core import atomic_write
from robocell._extras import needed_by
from robocell._identify.fitting import Identified


def write_page(found: Identified, path: Path) -> None:
    """Writes the page, one file that needs no network. Raises IoError."""
    with needed_by("the page of an identification", "identify"):
        from plotly.graph_objects import Figure
        from plotly.subplots import make_subplots

    count = len(found.joints)
    names = [escape(name) for name in found.joints]
    residuals: Any = make_subplots(rows=count, cols=1, shared_xaxes=True, subplot_titles=names)
    off = 1000 * (found.simulated - found.measured)
    for i, name in enumerate(names):
        residuals.add_scatter(x=found.time, y=off[:, i], name=name, row=i + 1, col=1)
    residuals.update_layout(
        height=160 * count + 120,
        showlegend=False,
        title="Residuals: simulated less measured, mrad or mm",
    )
    residuals.update_xaxes(title_text="time, s", row=count, col=1)
    shares: Any = Figure()
    shown = [each for each in found.parameters if each.is_shown]
    shares.add_scatter(
        x=[escape(f"{each.name} {each.joint}".strip()) for each in shown],
        y=[0.0] * len(shown),
        error_y={"array": [100 * each.error / max(abs(each.value), 1e-12) for each in shown]},
        mode="markers",
    )
    shares.update_layout(title="95 % intervals, in percent of the values", yaxis_ticksuffix=" %")
    rows = "".join(
        f"<tr><td>{each.name}<td>{escape(each.joint)}<td>{each.before:.4g}<td>{each.value:.4g}"
        f"<td>{f'± {each.error:.2g}' if each.is_shown else 'not shown by the motion'}"
        f"<td>{each.unit}"
        for each in found.parameters
    )
    page = (
        "<!doctype html><meta charset='utf-8'><title>Identification</title>"
        "<style>body{font:15px sans-serif;margin:2em auto;max-width:60em}"
        "td,th{padding:.2em .8em;text-align:left}</style>"
        f"<h1>Identification</h1><p>RMS of the residuals: {found.rms_before:.3g} with the model's "
        f"values, {found.rms:.3g} fitted.</p>"
        "<table><tr><th>value<th>joint<th>model<th>fitted<th>95 %<th>unit"
        f"{rows}</table>"
        f"{shares.to_html(full_html=False, include_plotlyjs='inline')}"
        f"{residuals.to_html(full_html=False, include_plotlyjs=False)}"
    )
    atomic_write(path, page.encode())
