"""The changelog names only what exists."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("src", "python/robocell", "python/bindings", "cmake", "models", "packages")
ELSEWHERE = {"pip", "random", "add_subdirectory", "find_package"}  # of other programs
KINDS = {".cc", ".h", ".py", ".yaml", ".cmake", ".in"}


def words_of_the_sources() -> set[str]:
    files = [f for folder in FOLDERS for f in (ROOT / folder).rglob("*") if f.suffix in KINDS]
    assert len(files) > 300
    texts = [(ROOT / "Makefile").read_text(), *(f.read_text() for f in files)]
    return {word for text in texts for word in re.findall(r"\w+", text)}


def test_every_name_exists_in_the_sources():
    known = words_of_the_sources() | ELSEWHERE
    names = re.findall(r"`([^`]+)`", (ROOT / "CHANGELOG.md").read_text())
    assert len(names) > 40
    words = [(name, word) for name in names for word in re.findall(r"[A-Za-z]\w+", name)]
    assert [name for name, word in words if word not in known] == []


def test_every_function_is_defined():
    """A word such as `steps` may stand in many places; followed by arguments it is a function."""
    python = "".join(f.read_text() for f in (ROOT / "python" / "robocell").rglob("*.py"))
    headers = "".join(f.read_text() for f in (ROOT / "src" / "robocell").rglob("*.h"))
    found = re.findall(r"^def (\w+)\(", python, re.MULTILINE)
    found += re.findall(r"\b([A-Z]\w+)\(", headers)
    called = re.findall(r"`(\w+)\(", (ROOT / "CHANGELOG.md").read_text())
    assert set(called) - ELSEWHERE - set(found) == set()


def test_a_release_is_short_and_so_are_its_lines():
    lines = [line for line in (ROOT / "CHANGELOG.md").read_text().splitlines() if line[:2] == "- "]
    assert [line for line in lines if len(line.split()) > 1 + 25] == []
    first = (ROOT / "CHANGELOG.md").read_text().partition("## [0.1.0]")[2].partition("\n## ")[0]
    assert first.count("\n- ") <= 80
