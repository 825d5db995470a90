"""Takes pictures of pages of the built site, wide and narrow, for a person to look at.

    make site
    python scripts/docsite/screenshots.py                  # into build/site/screenshots
    python scripts/docsite/screenshots.py control.html     # another page
    python scripts/docsite/screenshots.py --search "write a task"   # what the search finds first

Needs Debian's chromium, which runs without a display.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from urllib.parse import quote

SITE = Path(__file__).resolve().parents[2] / "build" / "site"
WIDTHS = (1400, 420)  # px
PAGES = (
    "index.html",
    "tutorials/own_task.html",
    "environments.html",
    "reference/python/scene.html",
    "reference/cpp/robocell/scene/scene.html",
    "gallery/examples.html",
    "troubleshooting.html",
)
RESULT = re.compile(r'<a href="([^"]+)" class="md-search-result__link"')


def chromium(*options: str) -> str:
    """Runs the browser without a display; returns what it prints."""
    with tempfile.TemporaryDirectory(prefix="robocell_") as profile:
        command = ["chromium", "--headless=new", "--no-sandbox", "--disable-gpu"]
        command += ["--hide-scrollbars", f"--user-data-dir={profile}", *options]
        done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=120)
    return done.stdout


def url(page: str) -> str:
    """The address of a page of the site on this disk."""
    return (SITE / "html" / page).as_uri()


def take(page: str, width: int) -> Path:
    """Takes a picture of the top of a page."""
    folder = SITE / "screenshots"
    folder.mkdir(parents=True, exist_ok=True)
    picture = folder / f"{page.removesuffix('.html').replace('/', '_')}-{width}.png"
    chromium(f"--window-size={width},1600", f"--screenshot={picture}", url(page))
    return picture


def found(words: str) -> list[str]:
    """The pages that the site's search finds, best first."""
    html = chromium(
        "--virtual-time-budget=20000", "--dump-dom", f"{url('index.html')}?q={quote(words)}"
    )
    links = [re.split("[?#]", link)[0].split("/html/")[-1] for link in RESULT.findall(html)]
    return list(dict.fromkeys(links))


def main() -> int:
    """Takes the pictures, or searches."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("pages", nargs="*", default=PAGES, help="pages below build/site/html")
    parser.add_argument("--search", metavar="WORDS", help="print what the site's search finds")
    arguments = parser.parse_args()
    if not (SITE / "html").is_dir():
        print(f"no site in {SITE / 'html'}; run `make site` first", file=sys.stderr)
        return 2
    if arguments.search:
        print("\n".join(found(arguments.search)[:5]))
        return 0
    for page in arguments.pages:
        for width in WIDTHS:
            print(take(page, width))
    return 0


if __name__ == "__main__":
    sys.exit(main())
