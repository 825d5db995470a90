"""Draws docs/houses_mixed.png: one episode of each run of examples/houses, by its three cameras."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import yaml
from figures import DOCS, save, sheet, spread

import robocell as rc

HOUSES = DOCS.parent / "examples" / "houses"
WIDTH = 200  # of an image


def main() -> None:
    """Draws the picture; with a folder, of the dataset that is there."""
    with tempfile.TemporaryDirectory() as name:
        dataset = Path(sys.argv[1]) if len(sys.argv) > 1 else make(Path(name))
        rows = []
        for run in runs():
            episode = next(each for each in rc.Dataset(dataset) if each.id.startswith(f"{run}_"))
            middle = [spread(episode.frames(camera), 3)[1] for camera in ("high", "wrist")]
            rows.append([*spread(episode.frames("side"), 3), *middle])
    save(sheet(rows), "houses_mixed.png", 5 * WIDTH)


def runs() -> list[str]:
    """Returns the names of the runs of the example."""
    content = yaml.safe_load((HOUSES / "houses.yaml").read_text())
    return [Path(each["run"]).stem for each in content["runs"]]


def make(folder: Path) -> Path:
    """Makes one episode of each run, and returns the dataset."""
    parts = [{"run": str(HOUSES / f"{run}.yaml"), "episodes": 1} for run in runs()]
    file, out = folder / "houses.yaml", folder / "out"
    file.write_text(yaml.safe_dump({"run": "houses", "runs": parts, "output": str(out)}))
    subprocess.run([sys.executable, "-m", "robocell", "generate", str(file)], check=True)
    return out


if __name__ == "__main__":
    main()
