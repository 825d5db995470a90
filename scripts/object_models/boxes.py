"""Boxes and books."""

from __future__ import annotations

from object_models.parts import Body, Kind, Look, Vec, box_geom
from object_models.shapes import box, extrude, rounded_box

KRAFT = "0.72 0.56 0.38 1"


def cardboard_box() -> Kind:
    """A closed box of 120 x 62 x 60 mm."""
    half = (0.060, 0.031, 0.030)
    tape = "0.86 0.77 0.58 1"
    looks = [
        Look(rounded_box(half, 0.0012, 1), KRAFT, 0.1, 0.2),
        Look(box((0, 0, half[2]), (half[0], 0.010, 0.0003)), tape, 0.5, 0.5),
        *[
            Look(box((s * half[0], 0, half[2] - 0.011), (0.0003, 0.010, 0.011)), tape, 0.5, 0.5)
            for s in (-1, 1)
        ],
        Look(box((0, 0, half[2] + 0.0003), (half[0], 0.0005, 0.0001)), "0.55 0.42 0.28 1"),
        Look(box((0.030, -half[1], 0.004), (0.018, 0.0003, 0.012)), "0.95 0.94 0.90 1"),
        *[
            Look(
                box(
                    (0.030, -half[1] - 0.0002, 0.009 - 0.005 * i),
                    (0.013 - 0.003 * i, 0.0002, 0.0009),
                ),
                "0.25 0.25 0.27 1",
            )
            for i in range(3)
        ],
    ]
    root = Body("cardboard_box", 0.14, [box_geom("cardboard_box_body", half)], looks)
    return Kind(
        root,
        "A closed cardboard box.",
        "boxes",
        "brown",
        "cardboard",
        ["parcel", "carton"],
        ["top", "side"],
    )


def cereal_box() -> Kind:
    """A cereal box of 50 x 130 x 190 mm."""
    x, y, z = 0.025, 0.065, 0.095
    looks = [
        Look(rounded_box((x, y, z), 0.001, 1), "0.90 0.44 0.12 1", 0.4, 0.5),
        Look(box((0, 0, -z + 0.026), (x + 0.0002, y + 0.0002, 0.022)), "0.20 0.34 0.66 1"),
    ]
    for s in (-1, 1):
        bowl = extrude(
            [(0.036, 0.012), (-0.036, 0.012), (-0.024, -0.016), (0.024, -0.016)][::-1], 0.0005
        )
        looks.append(
            Look(
                bowl.turned("x", 90).turned("z", 90).at(s * (x + 0.0003), 0, -0.030),
                "0.96 0.95 0.92 1",
            )
        )
        for k in range(7):
            ring = rounded_box((0.0004, 0.0052, 0.0052), 0.0004, 1).turned("x", 45)
            looks.append(
                Look(
                    ring.at(s * (x + 0.0004), -0.027 + 0.009 * k, -0.014 + 0.004 * (k % 2)),
                    "0.95 0.78 0.30 1",
                )
            )
        looks.append(
            Look(box((s * (x + 0.0002), 0, 0.052), (0.0003, 0.048, 0.020)), "0.98 0.96 0.90 1")
        )
        for k, width in enumerate((0.040, 0.028)):
            looks.append(
                Look(
                    box((s * (x + 0.0005), 0, 0.059 - 0.014 * k), (0.0003, width, 0.004)),
                    "0.80 0.16 0.14 1",
                )
            )
    root = Body("cereal_box", 0.32, [box_geom("cereal_box_body", (x, y, z))], looks)
    return Kind(
        root,
        "A cereal box.",
        "boxes",
        "orange",
        "cardboard",
        ["cereal", "box of cereal"],
        ["top", "side"],
    )


def _slats(name: str, parts: dict[str, tuple[Vec, Vec]]) -> tuple[list, list[Look]]:
    geoms = [box_geom(f"{name}_{part}", half, pos) for part, (half, pos) in parts.items()]
    looks = [
        Look(rounded_box(half, 0.0012, 1).at(*pos), "0.76 0.60 0.40 1", 0.1, 0.2)
        for half, pos in parts.values()
    ]
    return geoms, looks


def crate() -> Kind:
    """An open crate of 180 x 130 x 80 mm, made of slats."""
    x, y, h, t = 0.090, 0.065, 0.080, 0.0035
    parts: dict[str, tuple[Vec, Vec]] = {"bottom": ((x - 2 * t, y - 2 * t, t), (0, 0, t))}
    for i, z in enumerate((0.012, 0.040, 0.068)):
        for sign, side in ((1, "left"), (-1, "right")):
            parts[f"{side}_{i}"] = ((x, t, 0.012), (0, sign * (y - t), z))
        for sign, side in ((1, "front"), (-1, "back")):
            name = f"handle_{side}" if i == 2 else f"{side}_{i}"
            parts[name] = ((t, y - 2 * t, 0.012), (sign * (x - t), 0, z))
    for i, (sx, sy) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        parts[f"post_{i}"] = (
            (0.006, 0.006, h / 2),
            (sx * (x - 2 * t - 0.006), sy * (y - 2 * t - 0.006), h / 2),
        )
    geoms, looks = _slats("crate", parts)
    return Kind(
        Body("crate", 0.34, geoms, looks),
        "An open crate of slats.",
        "boxes",
        "brown",
        "wood",
        ["wooden crate", "open box"],
        ["handle"],
    )


def book() -> Kind:
    """A book of 150 x 105 x 24 mm, lying on its back."""
    x, y, z = 0.0525, 0.075, 0.012
    cover = "0.16 0.36 0.34 1"
    gold = "0.85 0.70 0.32 1"
    looks = [
        Look(rounded_box((x, y, 0.0015), 0.001, 1).at(0, 0, z - 0.0015), cover, 0.3, 0.3),
        Look(rounded_box((x, y, 0.0015), 0.001, 1).at(0, 0, -z + 0.0015), cover, 0.3, 0.3),
        Look(rounded_box((0.002, y, z), 0.0015, 2).at(-x + 0.002, 0, 0), cover, 0.3, 0.3),
        Look(box((0.0005, 0, 0), (x - 0.003, y - 0.003, z - 0.002)), "0.94 0.92 0.84 1", 0.1, 0.1),
        Look(box((0.004, 0, z), (0.0006 + x - 0.012, 0.0005 + y - 0.012, 0.0001)), gold),
        Look(box((0.004, 0, z + 0.0001), (x - 0.0125, y - 0.0130, 0.0001)), cover, 0.3, 0.3),
        *[
            Look(
                box(
                    (-0.016 + 0.010 * i, 0, z + 0.0002),
                    (0.0028 - 0.0008 * i, 0.036 - 0.010 * i, 0.0001),
                ),
                gold,
            )
            for i in range(3)
        ],
        *[Look(box((-x, s * 0.050, 0), (0.0002, 0.0018, z - 0.0015)), gold) for s in (-1, 1)],
    ]
    root = Body("book", 0.27, [box_geom("book_body", (x, y, z))], looks)
    return Kind(root, "A book that lies on its back.", "books", "green", "paper", ["hardback"], [])


def standing_book() -> Kind:
    """A paperback of 36 x 110 x 150 mm that stands on its lower edge."""
    x, y, z = 0.018, 0.055, 0.075
    cover = "0.62 0.18 0.24 1"
    cream = "0.95 0.91 0.80 1"
    looks = [
        *[
            Look(rounded_box((0.0012, y, z), 0.0008, 1).at(s * (x - 0.0012), 0, 0), cover, 0.4, 0.4)
            for s in (-1, 1)
        ],
        Look(rounded_box((x, 0.0015, z), 0.0010, 1).at(0, -y + 0.0015, 0), cover, 0.4, 0.4),
        Look(box((0, 0.0005, 0), (x - 0.0022, y - 0.0015, z - 0.0012)), cream, 0.1, 0.1),
        *[Look(box((s * x, 0, 0.030), (0.0002, 0.040, 0.018)), cream) for s in (-1, 1)],
        *[
            Look(
                box((s * (x + 0.0002), 0, 0.036 - 0.011 * i), (0.0002, 0.032 - 0.010 * i, 0.003)),
                cover,
            )
            for s in (-1, 1)
            for i in range(2)
        ],
        Look(box((0, -y, 0.020), (0.006, 0.0002, 0.035)), cream),
    ]
    root = Body("standing_book", 0.30, [box_geom("standing_book_body", (x, y, z))], looks)
    return Kind(
        root,
        "A paperback that stands on its lower edge.",
        "books",
        "red",
        "paper",
        ["paperback", "novel"],
        ["top", "side"],
    )


KINDS = (cardboard_box, cereal_box, crate, book, standing_book)
