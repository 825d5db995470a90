"""Draws train_0_map.png: the map of a house as procthor-10k stores it.

Red is 255 on free floor, blue is the number of the room; texts relate pixels and world.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from PIL import Image
from PIL.PngImagePlugin import PngInfo

PX_PER_M = 50
LOW, HIGH = np.array([-1.0, -1.0]), np.array([8.0, 4.0])  # m, the map's corners
ROOMS = {2: ((0, 0), (3.95, 3)), 3: ((4.05, 0), (7, 3))}
DOOR = ((3.95, 1.0), (4.05, 2.0))
FURNITURE = [((1.4, 2.1), (2.6, 2.9)), ((6.35, 1.25), (6.85, 1.75))]


def main() -> None:
    """Draws it."""
    rows, columns = np.round((HIGH - LOW) * PX_PER_M).astype(int)
    middle = (LOW + HIGH) / 2
    world_to_map = [
        [-PX_PER_M, 0, 0, PX_PER_M * middle[0] + rows / 2],
        [0, -PX_PER_M, 0, PX_PER_M * middle[1] + columns / 2],
    ]
    row, column = np.mgrid[:rows, :columns]
    x = middle[0] - (row - rows / 2) / PX_PER_M
    y = middle[1] - (column - columns / 2) / PX_PER_M

    def inside(box: tuple[tuple[float, float], tuple[float, float]]) -> np.ndarray:
        (x0, y0), (x1, y1) = box
        return (x0 <= x) & (x <= x1) & (y0 <= y) & (y <= y1)

    image = np.zeros((rows, columns, 3), np.uint8)
    for number, box in ROOMS.items():
        image[inside(box)] = (255, 255, number)
    image[inside(DOOR)] = (255, 255, 2)
    for box in FURNITURE:
        image[inside(box), :2] = 0
    map_to_world = [
        [-1 / PX_PER_M, 0, middle[0] + rows / 2 / PX_PER_M],
        [0, -1 / PX_PER_M, middle[1] + columns / 2 / PX_PER_M],
        [0, 0, 0],
    ]
    texts = PngInfo()
    texts.add_text("world_to_map", json.dumps(np.array(world_to_map, float).tolist()))
    texts.add_text("map_to_world", json.dumps(np.array(map_to_world, float).tolist()))
    texts.add_text("px_per_m", json.dumps(float(PX_PER_M)))
    texts.add_text("room_ids_to_name", json.dumps({"2": "room|2", "3": "room|3"}))
    folder = Path(__file__).parent / "scenes/procthor-10k-train"
    Image.fromarray(image).save(folder / "train_0_map.png", pnginfo=texts)


if __name__ == "__main__":
    main()
