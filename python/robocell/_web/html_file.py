"""A page in one file, for notebooks and for sending: its data are in it, and it needs no server."""

from __future__ import annotations

import base64
import html
import re
from collections.abc import Mapping

from robocell._core import Episode, Scene
from robocell._web.episode_page import EpisodePage
from robocell._web.page_files import index_page, page_file
from robocell._web.scene_geometry import geometry_of

HEIGHT = 480  # pixels of the picture in a notebook
SCRIPT = re.compile(r'<script src="([\w/.]+)"></script>\n')
STYLE = re.compile(r'<link rel="stylesheet" href="([\w.]+)">')
POLICY = (
    '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; script-src '
    "'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; media-src blob:\">"
)


class Shown:
    """A page of a scene or an episode. A notebook shows it; `save` writes it into a file.

    Attributes:
        html: The page.
    """

    def __init__(self, page: str) -> None:
        self.html = page

    def _repr_html_(self) -> str:
        """Returns the page in a frame of its own, which can do nothing but draw."""
        return (
            f'<iframe sandbox="allow-scripts" style="width:100%;height:{HEIGHT}px;border:0" '
            f'srcdoc="{html.escape(self.html, quote=True)}"></iframe>'
        )

    def save(self, path: str) -> None:
        """Writes the page into an HTML file."""
        from robocell._core import atomic_write

        atomic_write(path, self.html.encode())


def page_of_scene(scene: Scene) -> Shown:
    """Returns a page of a scene in its present state."""
    return Shown(_page("still", f"Scene {scene.name}", {"geometry": geometry_of(scene)}))


def page_of_episode(episode: Episode) -> Shown:
    """Returns a page that plays an episode, with its videos."""
    made = EpisodePage(episode)
    data = {"episode": made.content, "geometry": made.geometry}
    for camera in episode.cameras:
        if video := made.video(camera):
            data[f"video-{camera}"] = video
    return Shown(_page("episode", made.title, data))


def _page(kind: str, title: str, data: Mapping[str, bytes]) -> str:
    """Returns the document with its files and its data in it."""
    page = index_page(kind, title)
    page = STYLE.sub(lambda found: f"{POLICY}\n<style>{_text(found[1])}</style>", page)
    embedded = "".join(
        f'<script type="text/plain" data-name="{html.escape(name, quote=True)}">'
        f"{base64.b64encode(content).decode()}</script>\n"
        for name, content in data.items()
    )
    page = SCRIPT.sub(lambda found: f"<script>{_text(found[1])}</script>\n", page)
    return page.replace('<div id="app"></div>\n', f'<div id="app"></div>\n{embedded}')


def _text(file: str) -> str:
    """Returns a file of the page as it may stand in a document."""
    return page_file(file).decode().replace("</script", "<\\/script")
