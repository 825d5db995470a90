"""Draws docs/objects.png: a contact sheet of the objects of the catalogue, by category.

From the pictures beside the models, which scripts/make_pictures.py draws.

    python docs/make_objects_sheet.py
"""

from __future__ import annotations

from figures import save
from PIL import Image, ImageDraw, ImageFont

import robocell as rc

COLUMNS = 9
TILE = (150, 112)  # px, of a picture
LABEL = 18  # px, of its name
CROP = (290, 217)  # px of the middle of a picture, where the object is


def tile(kind: str) -> Image.Image:
    """The picture of an object with its name below."""
    picture = Image.open(rc.models.resolve(kind).replace(".xml", ".png")).convert("RGB")
    x, y = (picture.width - CROP[0]) // 2, (picture.height - CROP[1]) // 2
    cut = picture.crop((x, y, x + CROP[0], y + CROP[1]))
    made = Image.new("RGB", (TILE[0], TILE[1] + LABEL), "white")
    made.paste(cut.resize(TILE, Image.Resampling.LANCZOS), (0, 0))
    ImageDraw.Draw(made).text(
        (TILE[0] / 2, TILE[1] + LABEL / 2), kind, "black", ImageFont.load_default(12), anchor="mm"
    )
    return made


def main() -> None:
    """Draws it."""
    kinds = [
        kind
        for category, members in rc.tasks.object_categories().items()
        if category != "primitives"
        for kind in members
    ]
    rows = -(-len(kinds) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * TILE[0], rows * (TILE[1] + LABEL)), "white")
    for i, kind in enumerate(kinds):
        sheet.paste(tile(kind), (i % COLUMNS * TILE[0], i // COLUMNS * (TILE[1] + LABEL)))
    save(sheet, "objects.png")


if __name__ == "__main__":
    main()
