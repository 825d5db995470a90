"""Bottles."""

from __future__ import annotations

from collections.abc import Sequence

from object_models.parts import (
    Body,
    Kind,
    Look,
    rod_geom,
)
from object_models.shapes import (
    arc,
    lathe,
)

CREAM = "0.93 0.90 0.82 1"


def _bottle(
    name: str,
    profile: Sequence[tuple[float, float]],
    rods: Sequence[tuple[str, float, float, float]],
    mass: float,
    looks: list[Look],
    rgba: str,
    specular: float,
) -> Body:
    geoms = [
        rod_geom(f"{name}_{part}", r, hi - lo, (0, 0, (lo + hi) / 2)) for part, r, lo, hi in rods
    ]
    return Body(name, mass, geoms, [Look(lathe(profile, 40), rgba, specular, 0.8), *looks])


def water_bottle() -> Kind:
    """A water bottle of plastic, 62 mm wide and 200 mm high."""
    r, h = 0.031, 0.10
    profile = [
        (0, -h),
        *arc(r - 0.006, -h + 0.006, 0.006, -90, 0, 4),
        (r, -0.04),
        (r - 0.002, -0.036),
        (r - 0.002, -0.002),
        (r, 0.002),
        (r, 0.030),
        (0.026, 0.052),
        (0.015, 0.068),
        (0.013, 0.074),
        (0.013, 0.082),
        (0, 0.082),
    ]
    cap = lathe([(0, 0.080), (0.0155, 0.080), (0.0155, h - 0.002), (0.0140, h), (0, h)], 32)
    label = lathe(
        [(r - 0.002, -0.034), (r - 0.0012, -0.034), (r - 0.0012, -0.004), (r - 0.002, -0.004)], 40
    )
    rods = [
        ("body", r, -h, 0.034),
        ("shoulder", 0.025, 0.034, 0.055),
        ("neck", 0.015, 0.055, 0.080),
        ("cap", 0.0155, 0.080, h),
    ]
    body = _bottle(
        "water_bottle",
        profile,
        rods,
        0.35,
        [Look(cap, "0.18 0.42 0.80 1"), Look(label, "0.18 0.42 0.80 1")],
        "0.66 0.83 0.92 1",
        0.9,
    )
    return Kind(
        body,
        "A plastic water bottle.",
        "bottles",
        "blue",
        "plastic",
        ["plastic bottle"],
        ["side"],
    )


def wine_bottle() -> Kind:
    """A wine bottle, 62 mm wide and 260 mm high."""
    r, h = 0.031, 0.13
    profile = [
        (0, -h),
        *arc(r - 0.004, -h + 0.004, 0.004, -90, 0, 4),
        (r, 0.020),
        *arc(r - 0.026, 0.020, 0.026, 8, 60, 6),
        (0.0145, 0.058),
        (0.0135, 0.075),
        (0.0130, h - 0.014),
        (0.0148, h - 0.012),
        (0.0148, h),
        (0, h),
    ]
    foil = lathe(
        [
            (0.0135, 0.080),
            (0.0142, 0.080),
            (0.0138, h - 0.013),
            (0.0151, h - 0.012),
            (0.0151, h + 0.0003),
            (0, h + 0.0003),
            (0, h),
            (0.013, h - 0.013),
        ],
        32,
    )
    label = lathe([(r, -0.080), (r + 0.0004, -0.080), (r + 0.0004, 0.0), (r, 0.0)], 40)
    rods = [
        ("body", r, -h, 0.024),
        ("shoulder", 0.028, 0.024, 0.040),
        ("collar", 0.019, 0.040, 0.056),
        ("neck", 0.0143, 0.056, h),
    ]
    body = _bottle(
        "wine_bottle",
        profile,
        rods,
        0.62,
        [Look(foil, "0.48 0.10 0.14 1", 0.5, 0.5), Look(label, CREAM)],
        "0.08 0.22 0.13 1",
        0.9,
    )
    return Kind(body, "A wine bottle.", "bottles", "green", "glass", ["bottle of wine"], ["side"])


def sauce_bottle() -> Kind:
    """A squeeze bottle with a pointed nozzle."""
    r, h = 0.027, 0.085
    profile = [
        (0, -h),
        *arc(r - 0.004, -h + 0.004, 0.004, -90, 0, 4),
        (r, 0.025),
        *arc(r - 0.010, 0.025, 0.010, 0, 80, 5),
        (0, 0.036),
    ]
    nozzle = lathe(
        [
            (0, 0.034),
            (0.019, 0.034),
            (0.019, 0.046),
            (0.014, 0.049),
            (0.006, 0.056),
            (0.0030, h),
            (0, h),
        ],
        32,
    )
    rods = [("body", r, -h, 0.030), ("cap", 0.0192, 0.030, 0.047), ("nozzle", 0.0055, 0.047, h)]
    label = lathe([(r, -0.055), (r + 0.0004, -0.055), (r + 0.0004, -0.005), (r, -0.005)], 40)
    body = _bottle(
        "sauce_bottle",
        profile,
        rods,
        0.24,
        [Look(nozzle, CREAM), Look(label, "0.96 0.80 0.24 1")],
        "0.80 0.16 0.12 1",
        0.5,
    )
    return Kind(
        body,
        "A squeeze bottle.",
        "bottles",
        "red",
        "plastic",
        ["ketchup", "ketchup bottle", "squeeze bottle"],
        ["side"],
    )


KINDS = (water_bottle, wine_bottle, sauce_bottle)
