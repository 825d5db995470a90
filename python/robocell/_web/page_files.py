"""The files of the page."""

from __future__ import annotations

import html
from importlib import resources

FILES = {
    "page.css": "text/css",
    "page.js": "text/javascript",
    "scene_view.js": "text/javascript",
    "live.js": "text/javascript",
    "episode.js": "text/javascript",
    "dataset.js": "text/javascript",
    "teleop.js": "text/javascript",
    "vendor/three.min.js": "text/javascript",
}


def page_file(name: str) -> bytes:
    """Returns a file of the page."""
    return resources.files("robocell._web").joinpath("page", *name.split("/")).read_bytes()


def index_page(kind: str, title: str) -> str:
    """Returns the document with the part of the page that shows a site, and its title."""
    page = page_file("index.html").decode()
    return page.replace("{{title}}", html.escape(title)).replace("{{kind}}", html.escape(kind))
