"""A dataset for pages: the list of its episodes, and a player of each."""

from __future__ import annotations

import json
import threading
from collections import OrderedDict
from collections.abc import Mapping
from pathlib import Path

from robocell._core import Dataset
from robocell._web.episode_page import EpisodePage, row_of
from robocell._web.web_server import Reply

KEPT = 3  # episodes whose states are known


class DatasetPages:
    """A site of a dataset, or of one of its episodes.

    Args:
        folder: The dataset.
        only: Id of the only episode that is shown; None for all with a list.
    """

    def __init__(self, folder: str | Path, only: str | None = None) -> None:
        self._dataset = Dataset(folder)
        self._only = only
        self._pages: OrderedDict[str, EpisodePage] = OrderedDict()
        self._lock = threading.Lock()  # of the pages that are ready
        self._dataset_lock = threading.Lock()
        self._making = threading.Lock()  # one episode is simulated at a time; others are shown
        if only is not None:
            self._page(only)

    def page(self, query: Mapping[str, str]) -> tuple[str, str] | None:
        """Returns the player for `episode`, else the list."""
        name = self._only or query.get("episode")
        if name is None:
            return "dataset", f"Dataset {Path(self._dataset.folder).name}"
        found = self._page(name)
        return None if found is None else ("episode", found.title)

    def get(self, path: str, query: Mapping[str, str]) -> Reply | None:
        """Returns the list, or the numbers, shapes and videos of an episode."""
        if path == "list":
            return None if self._only else self._list()
        found = self._page(self._only or query.get("episode", ""))
        if found is None:
            return None
        if path == "episode":
            return Reply(found.content)
        if path == "geometry":
            return Reply(found.geometry)
        if path == "video":
            video = found.video(query.get("camera", ""))
            return None if video is None else Reply(video, "video/mp4")
        return None

    def visit(self) -> None:
        """Returns None: nothing here changes."""

    def _list(self) -> Reply:
        with self._dataset_lock:
            self._dataset.refresh()
            rows = [row_of(episode) for episode in self._dataset]
        text = json.dumps({"episodes": rows, "broken": self._dataset.broken})
        return Reply(text.encode(), "application/json")

    def _page(self, name: str) -> EpisodePage | None:
        if found := self._ready(name):
            return found
        with self._dataset_lock:
            if name not in self._dataset:
                return None
            episode = self._dataset[name]
        with self._making:
            if found := self._ready(name):
                return found
            made = EpisodePage(episode)
            with self._lock:
                self._pages[name] = made
                while len(self._pages) > KEPT:
                    self._pages.popitem(last=False)
            return made

    def _ready(self, name: str) -> EpisodePage | None:
        """Returns a page that is known, which is then the latest one."""
        with self._lock:
            if name in self._pages:
                self._pages.move_to_end(name)
            return self._pages.get(name)
