"""The charts of a report, as parts of an HTML page that has plotly in it.

Names come from files that others wrote, so each is escaped before plotly reads it as markup.
"""

from __future__ import annotations

import html
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from robocell._report.motion import Gripper, JointNumbers, Tcp
from robocell._report.rollouts import Rate

BLUE, GREEN, RED, GREY, ORANGE = "#2f6db5", "#2e8b57", "#c8453b", "#8a94a3", "#d98c1f"
SCALE = [[0, "#f3f6fb"], [0.3, "#b9d0ec"], [0.65, "#5b93d3"], [1, "#173f74"]]
LONGEST = 46  # characters of a label


def plotly_script() -> str:
    """Returns the text of plotly.js, without tags."""
    from plotly.offline import get_plotlyjs

    return str(get_plotlyjs())


def rates(groups: Sequence[Rate]) -> str:
    """Returns success rates with their 95 % intervals, one line each."""
    labels = [label(f"{rate.name}  ({rate.successes}/{rate.rollouts})") for rate in groups]
    shares = [100 * rate.share for rate in groups]
    trace = {
        "type": "scatter",
        "mode": "markers",
        "x": shares,
        "y": list(range(len(labels))),
        "text": labels,
        "marker": {"color": BLUE, "size": 9},
        "error_x": {
            "type": "data",
            "symmetric": False,
            "array": [100 * rate.interval[1] - s for rate, s in zip(groups, shares, strict=True)],
            "arrayminus": [
                s - 100 * rate.interval[0] for rate, s in zip(groups, shares, strict=True)
            ],
            "color": BLUE,
            "thickness": 1.6,
            "width": 4,
        },
        "hovertemplate": "%{text}<br>%{x:.1f} %<extra></extra>",
    }
    return _part(
        [trace],
        60 + 26 * len(groups),
        xaxis={
            "range": [-3, 103],
            "tickvals": [0, 50, 100],
            "ticktext": ["0", "50 %", "100 %"],
            "tickangle": 0,
        },
        yaxis=_lines(labels),
    )


def bars(counts: Mapping[str, float], colour: str, suffix: str = "", most: int = 12) -> str:
    """Returns horizontal bars, the longest first; what is beyond `most` becomes 'others'."""
    ordered = sorted(counts.items(), key=lambda entry: -entry[1])
    shown = ordered[:most]
    if rest := sum(number for _, number in ordered[most:]):
        shown.append(("others", rest))
    values = [number for _, number in shown]
    labels = [label(name) for name, _ in shown]
    trace = {
        "type": "bar",
        "orientation": "h",
        "x": values,
        "y": list(range(len(shown))),
        "customdata": labels,
        "text": [f"{value:.4g}{suffix}" for value in values],
        "textposition": "auto",
        "marker": {"color": colour},
        "hovertemplate": "%{customdata}: %{x:.5g}" + suffix + "<extra></extra>",
    }
    return _part(
        [trace],
        60 + 26 * len(shown),
        yaxis=_lines(labels),
        bargap=0.3,
    )


def steps(counts: Mapping[str, int]) -> str:
    """Returns how many remain at each stage, from the first to the last."""
    trace = {
        "type": "funnel",
        "y": [label(name) for name in counts],
        "x": list(counts.values()),
        "textinfo": "value+percent previous",
        "marker": {"color": [GREY, "#6f9bd1", BLUE, GREEN, "#1f6b41"][: len(counts)]},
        "connector": {"fillcolor": "#eef2f8"},
    }
    return _part([trace], 60 + 46 * len(counts), yaxis={"automargin": True})


def histogram(values: Mapping[str, Sequence[float]], title: str, bins: int = 40) -> str:
    """Returns counts of numbers by name, one colour each; `title` names the axis."""
    every = np.concatenate([np.asarray(v, float) for v in values.values()])
    every = every[np.isfinite(every)]
    least, greatest = float(every.min()), float(every.max())
    if greatest <= least:
        least, greatest = least - 0.5, greatest + 0.5
    bins = max(5, min(bins, math.ceil(2 * math.sqrt(len(every)))))
    edges = np.linspace(least, greatest, bins + 1)
    traces = []
    for (name, numbers), colour in zip(values.items(), (BLUE, RED, ORANGE, GREY), strict=False):
        counted, _ = np.histogram(numbers, edges)
        traces.append(
            {
                "type": "bar",
                "x": ((edges[1:] + edges[:-1]) / 2).tolist(),
                "y": counted.tolist(),
                "width": float(edges[1] - edges[0]),
                "name": label(name),
                "marker": {"color": colour, "opacity": 0.85},
                "hovertemplate": "%{x:.4g}: %{y}<extra></extra>",
            }
        )
    return _part(
        traces,
        260,
        barmode="stack",
        bargap=0.04,
        showlegend=len(traces) > 1,
        xaxis={"title": {"text": title}},
        yaxis={"title": {"text": "count"}, "automargin": True},
    )


def joints(numbers: Sequence[JointNumbers]) -> str:
    """Returns where each joint was within its limits: a row of colours for each."""
    z = [
        [float(share) if share else None for share in each.density / max(each.density.max(), 1e-12)]
        for each in numbers
    ]
    trace = {
        "type": "heatmap",
        "z": z,
        "x": ((np.arange(40) + 0.5) * 2.5).tolist(),
        "y": [label(each.name) for each in numbers],
        "colorscale": SCALE,
        "showscale": False,
        "ygap": 5,
        "hovertemplate": "%{y}: %{x:.0f} % of the range<extra></extra>",
    }
    return _part(
        [trace],
        90 + 32 * len(numbers),
        xaxis={"range": [0, 100], "ticksuffix": " %", "title": {"text": "of the joint's range"}},
        yaxis={"autorange": "reversed", "automargin": True, "type": "category"},
    )


def tcp(path: Tcp) -> str:
    """Returns the positions of a TCP from above and from the side."""
    points = path.points()
    traces = []
    for place, (u, v) in enumerate(((0, 1), (0, 2)), start=1):
        grid, us, vs = _density(points[:, u], points[:, v])
        traces.append(
            {
                "type": "heatmap",
                "z": grid,
                "x": us,
                "y": vs,
                "xaxis": "x" if place == 1 else "x2",
                "yaxis": "y" if place == 1 else "y2",
                "colorscale": SCALE,
                "showscale": False,
                "hovertemplate": f"{'xyz'[u]} %{{x:.2f}} m, {'xyz'[v]} %{{y:.2f}} m<extra></extra>",
            }
        )
        traces.append(
            {
                "type": "scatter",
                "mode": "markers",
                "x": [0],
                "y": [0],
                "xaxis": "x" if place == 1 else "x2",
                "yaxis": "y" if place == 1 else "y2",
                "marker": {"symbol": "cross", "size": 10, "color": RED},
                "hovertemplate": f"origin: {label(path.frame)}<extra></extra>",
            }
        )
    return _part(
        traces,
        420,
        showlegend=False,
        xaxis={"domain": [0, 0.47], "title": {"text": "x, m"}, "constrain": "domain"},
        yaxis={"title": {"text": "y, m (from above)"}, "scaleanchor": "x"},
        xaxis2={
            "domain": [0.55, 1],
            "title": {"text": "x, m"},
            "anchor": "y2",
            "constrain": "domain",
        },
        yaxis2={"title": {"text": "z, m (from the side)"}, "scaleanchor": "x2", "anchor": "x2"},
    )


def gripper(events: Gripper) -> str:
    """Returns when the gripper closed and opened, over the length of the episodes."""
    values = {
        name: [100 * moment for moment in moments]
        for name, moments in (("closes", events.closings), ("opens", events.openings))
        if moments
    }
    return histogram(values, "% of the episode") if values else ""


def label(text: str) -> str:
    """Returns a text that plotly shows as it is, cut if it is long."""
    text = " ".join(text.split())
    return html.escape(text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…")


def _lines(labels: Sequence[str]) -> dict[str, Any]:
    """Returns a vertical axis with one label a line; equal labels stay apart."""
    count = len(labels)
    return {
        "range": [count - 0.5, -0.5],
        "tickvals": list(range(count)),
        "ticktext": list(labels),
        "automargin": True,
        "zeroline": False,
    }


def _density(x: Any, y: Any) -> tuple[list[list[float | None]], list[float], list[float]]:
    """Returns a grid of square cells with the root of the share of points in each."""
    edge = max(float(np.ptp(x)), float(np.ptp(y)), 1e-3) / 48
    edges = [
        float(values.min()) - edge / 2 + edge * np.arange(int(np.ptp(values) / edge) + 3)
        for values in (x, y)
    ]
    counted, _, _ = np.histogram2d(x, y, bins=edges)
    shares = np.sqrt(counted.T / counted.max())
    grid = [[round(float(v), 4) if v else None for v in row] for row in shares]
    us, vs = (((each[1:] + each[:-1]) / 2).round(5).tolist() for each in edges)
    return grid, us, vs


def _part(traces: list[dict[str, Any]], height: int, **layout: Any) -> str:
    from plotly.graph_objects import Figure

    axis = {"gridcolor": "#e6eaf0", "zerolinecolor": "#c9d1dc", "linecolor": "#c9d1dc"}
    given = {
        "template": "none",
        "font": {"family": "system-ui, sans-serif", "size": 12.5, "color": "#27303d"},
        "margin": {"l": 50, "r": 18, "t": 12, "b": 42},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "hoverlabel": {"font": {"size": 12}},
        "legend": {"orientation": "h", "y": 1.12},
        "height": height,
        **layout,
    }
    for name in ("xaxis", "yaxis", *(key for key in layout if "axis" in key)):
        given[name] = {**axis, **given.get(name, {})}
    figure = Figure(data=traces, layout=given)
    return str(
        figure.to_html(
            full_html=False,
            include_plotlyjs=False,
            config={"displaylogo": False, "displayModeBar": False, "responsive": True},
        )
    )
