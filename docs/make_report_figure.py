"""Draws docs/report.png: the page of `robocell report --output` in a browser.

It needs Chromium (Debian's package `chromium`); without it the picture stays as it is.

    python docs/make_report_figure.py [DATASET]
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from figures import DOCS, save
from PIL import Image

RUN = DOCS.parent / "examples" / "pick_and_place.yaml"
# A sixth of the picks takes more actions than these, so that the page shows failures.
RUN_OPTIONS = ("keep=all", "max_attempts=1", "rates.max_steps=215")
EPISODES = 48
WIDTH = 1240  # px of the window
PARTS = ("#success", "#coverage")  # beside each other
SHOWN = 1560  # px of each


def robocell(*arguments: object) -> None:
    """Runs a command; `generate` ends with 1 when an item fails, which is what is wanted here."""
    result = subprocess.run([sys.executable, "-m", "robocell", *map(str, arguments)], check=False)
    if result.returncode not in (0, 1):
        raise SystemExit(result.returncode)


def made(dataset: Path) -> Path:
    """Makes the dataset and returns its folder."""
    options = [part for option in RUN_OPTIONS for part in ("--set", option)]
    robocell("generate", RUN, "--output", dataset, "--episodes", EPISODES, *options)
    return dataset


def picture(page: Path, part: str) -> Image.Image:
    """Returns the top of the page, or of one of its later parts without the rest."""
    moved = page.with_name("part.html")
    hidden = "header p:first-of-type"  # the folder, which differs from machine to machine
    if part != PARTS[0]:
        hidden = f"header, nav, .tiles, section:not({part})"
    hide = f"<style>{hidden} {{ display: none }}</style></head>"
    moved.write_text(page.read_text().replace("</head>", hide, 1))
    file = page.with_name("part.png")
    subprocess.run(
        [
            "chromium",
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--hide-scrollbars",
            f"--user-data-dir={page.parent / 'profile'}",
            f"--window-size={WIDTH},{SHOWN}",
            "--virtual-time-budget=20000",
            f"--screenshot={file}",
            moved.as_uri(),
        ],
        check=True,
        capture_output=True,
    )
    with Image.open(file) as image:
        return image.convert("RGB").crop((0, 0, WIDTH, SHOWN))


def main() -> None:
    """Draws it."""
    if not shutil.which("chromium"):
        print("docs/report.png stays as it is: there is no program `chromium`")
        return
    with tempfile.TemporaryDirectory() as folder:
        dataset = Path(sys.argv[1]) if sys.argv[1:] else made(Path(folder) / "picks")
        page = Path(folder) / "report.html"
        robocell("report", dataset, "-o", page)
        parts = [picture(page, part) for part in PARTS]
    whole = Image.new("RGB", (2 * WIDTH + 20, SHOWN), "white")
    for place, part in enumerate(parts):
        whole.paste(part, (place * (WIDTH + 20), 0))
    save(whole, "report.png", 1600)


if __name__ == "__main__":
    main()
