"""tests/coverage.md has every check, and names tests of both languages that exist."""

from __future__ import annotations

import ast
import functools
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "tests/coverage.md").read_text()
CHECKS = list(range(1, 75))


def rows() -> list[tuple[int, list[str]]]:
    """Number and the other cells of every row: check, C++, Python, example."""
    found = re.findall(r"^\| *(\d+) \|(.*)\|$", PAGE, re.MULTILINE)
    return [(int(number), [cell.strip() for cell in rest.split("|")]) for number, rest in found]


def named(cell: str) -> list[str]:
    """The tests of a cell; a name that begins with a dot or `::` is of the suite before."""
    names: list[str] = []
    for name in re.findall(r"`([^`]+)`", cell):
        if name.startswith("."):
            name = names[-1].split(".")[0] + name
        elif name.startswith("::"):
            before = next(each for each in reversed(names) if "::" in each)
            name = before.rpartition("::")[0] + name
        names.append(name)
    return names


@functools.cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text())


@functools.cache
def cxx_tests() -> set[tuple[str, str]]:
    files = ROOT.glob("src/robocell/**/*_test.cc")
    test = re.compile(r"TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)")
    return {found for f in files for found in test.findall(f.read_text())}


def has_test(body: list[ast.stmt], path: list[str]) -> bool:
    """Whether the function is there, in the very classes that are named, or the whole class."""
    kind = ast.ClassDef if path[1:] or path[0].startswith("Test") else ast.FunctionDef
    for node in body:
        if isinstance(node, kind) and node.name == path[0]:
            return not path[1:] or has_test(node.body, path[1:])
    return False


def files_of(name: str) -> list[Path]:
    return [*ROOT.glob(f"python/tests/{name}.py"), *ROOT.glob(f"tests/**/{name}.py")]


def exists(name: str) -> bool:
    if "::" in name:
        file, *path = name.split("::")
        return any(has_test(parsed(f).body, path) for f in files_of(file))
    suite, test = name.split(".")
    return any(s == suite and test in ("*", t) for s, t in cxx_tests())


def test_every_check_has_one_row():
    assert sorted(number for number, _ in rows()) == CHECKS


def test_every_check_has_a_test_in_both_languages_and_an_example():
    assert [
        f"{number}: {column}"
        for number, cells in rows()
        for column, cell in zip(("check", "C++", "Python", "example"), cells, strict=True)
        if not (named(cell) if column in ("C++", "Python") else cell)
    ] == []


def test_every_test_that_the_page_names_exists():
    names = [name for _, cells in rows() for cell in cells[1:3] for name in named(cell)]
    assert len(names) > 50
    assert [name for name in names if not exists(name)] == []


def test_every_test_that_the_text_names_exists():
    """Beside the table: tests, suites and files of tests."""
    text = re.sub(r"^\|.*\|$", "", PAGE, flags=re.MULTILINE)
    names = [name for name in named(text) if name not in ("Suite.Name", "file::test")]
    cxx = [name for name in names if re.fullmatch(r"(\w+/)?[A-Z]\w+\.(\w+|\*)", name)]
    python = [name for name in names if name.startswith("test_")]
    assert len(cxx) > 20
    assert len(python) > 20
    missing = [name for name in cxx if not exists(name.rpartition("/")[2])]
    missing += [name for name in python if "::" in name and not exists(name)]
    missing += [name for name in python if "::" not in name and not files_of(name)]
    assert missing == []
