"""The recipes of CONTRIBUTING.md name files that exist."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "CONTRIBUTING.md").read_text()
FOLDERS = "benchmarks|docs|examples|models|python|scripts|src|tests"


def spelled_out(path: str) -> list[str]:
    """`a.{h,cc}` as `a.h` and `a.cc`."""
    found = re.fullmatch(r"(.*)\{([\w,]+)\}(.*)", path)
    return [f"{found[1]}{end}{found[3]}" for end in found[2].split(",")] if found else [path]


def is_there(path: str) -> bool:
    """A path of the repository, or the name of a file anywhere in it."""
    if re.match(rf"({FOLDERS})/", path):
        return any(ROOT.glob(path)) if "*" in path else (ROOT / path).exists()
    if (ROOT / path).exists():
        return True
    return any(file for folder in FOLDERS.split("|") for file in (ROOT / folder).rglob(path))


def test_every_file_that_a_recipe_names_exists():
    named = re.findall(r"`([\w./{},*-]+\.(?:\{h,cc\}|h|cc|py|md|yaml|txt))`", TEXT)
    paths = {path for name in named for path in spelled_out(name)} - {"robocell.h"}
    assert len(paths) > 40
    assert sorted(path for path in paths if not is_there(path)) == []


def test_there_is_a_recipe_for_each_part_that_users_replace():
    parts = ("robot", "task", "expert", "scene source", "feature", "renderer back end", "check")
    headings = re.findall(r"^### Add an? (.*)$", TEXT, re.MULTILINE)
    assert [part for part in parts if part not in headings] == []
