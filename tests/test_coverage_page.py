"""docs/coverage.md names tests that exist."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs/coverage.md").read_text()


def named() -> list[str]:
    """The tests the tables name; a name that begins with a dot or `::` is of the suite before."""
    names: list[str] = []
    for row in re.findall(r"^\| *\d+ \|(.*)$", PAGE, re.MULTILINE):
        for cell in row.split("|")[1:3]:
            suite = ""
            for name in re.findall(r"`([^`]+)`", cell):
                if name.startswith((".", "::")):
                    name = suite + name
                suite = re.split(r"\.|::", name)[0]
                names.append(name)
    return names


def exists(name: str) -> bool:
    if "::" in name:
        file, *path = name.split("::")
        files = [*ROOT.glob(f"python/tests/{file}.py"), *ROOT.glob(f"tests/**/{file}.py")]
        kinds = ["class "] * (len(path) - 1) + ["def "]
        return any(
            all(kind + part in f.read_text() for kind, part in zip(kinds, path, strict=True))
            for f in files
        )
    suite, test = name.split(".")
    tests = rf"TEST(?:_F|_P)?\(\s*{suite},\s*{'' if test == '*' else test}\b"
    return any(re.search(tests, f.read_text()) for f in ROOT.glob("src/robocell/**/*_test.cc"))


def test_every_test_that_the_page_names_exists():
    names = named()
    assert len(names) > 50
    assert [name for name in names if not exists(name)] == []
