"""The site is made of what the repository has: links, headers, notebooks, and every public name."""

from __future__ import annotations

import json
import os
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "scripts" / "docsite"))

import cpp_reference  # noqa: E402
import markdown_dialect  # noqa: E402
import notebook_pages  # noqa: E402
import python_reference  # noqa: E402
import search_words  # noqa: E402

HEADER = """// A thing that turns. Angles are radians.
//
//   Thing thing;
//   thing.Turn(1);
#pragma once

#include <string>

namespace robocell {

class Other;

// How far, with `unit`.
struct Angle {
  double value = 0;  // rad
};

class Thing {
 public:
  Thing() = default;
  // Turns.
  void Turn(double angle) {
    angle_ += angle;
    Check();
  }
  double angle() const { return angle_; }

 protected:
  virtual void Check() {}

 private:
  double angle_ = 0;
};

// Two of a kind.
double Sum(double a, double b);
double Sum(const Angle& a, const Angle& b);

}  // namespace robocell
"""


@pytest.fixture
def page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    (tmp_path / "robocell").mkdir()
    (tmp_path / "robocell" / "thing.h").write_text(HEADER)
    monkeypatch.setattr(cpp_reference, "SRC", tmp_path)
    return cpp_reference.page("robocell/thing.h")


def test_a_header_page_begins_with_its_comment_and_example(page: str):
    assert page.startswith(
        "# thing.h\n\n[All headers](../headers.md)\n\nA thing that turns. Angles are radians."
    )
    assert "```cpp\nThing thing;\nthing.Turn(1);\n```" in page


def test_a_header_page_has_each_declaration_with_its_comment(page: str):
    assert re.findall("^## .*", page, re.MULTILINE) == [
        "## `struct Angle`",
        "## `class Thing`",
        "## `Sum`",
    ]
    assert "How far, with `unit`." in page
    assert "double Sum(double a, double b);\ndouble Sum(const Angle& a, const Angle& b);" in page


def test_private_members_and_bodies_are_left_out(page: str):
    assert "angle_ = 0" not in page
    assert "angle_ += angle" not in page
    assert "  void Turn(double angle);" in page
    assert "virtual void Check() {}" in page


def test_every_public_header_has_a_page_with_declarations():
    pages = cpp_reference.pages()
    for header in cpp_reference.public_headers():
        text = pages[f"reference/cpp/{header.removesuffix('.h')}.md"]
        assert len(text.splitlines()) > 3, header
        if header not in ("robocell/robocell.h", "robocell/mujoco/forward.h"):  # declare nothing
            assert "\n## " in text, header


def test_every_module_of_the_package_that_conventions_name_is_a_topic():
    text = (ROOT / "docs" / "conventions.md").read_text()
    rows = re.findall(r"^\| ((?:`\w+`,? ?)+) \|", text, re.MULTILINE)
    named = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    assert "kinematics" in named
    assert named - {*python_reference.TOPICS} == {"compat"}  # has a page of its own


def test_every_topic_exists_and_has_names():
    for topic in python_reference.TOPICS:
        assert python_reference.public_names(python_reference.source(topic)), topic


def test_github_markdown_is_converted_for_the_site():
    written = "Text:\n- one\n  more\n- two\n  ```\n  code\n  ```\n| a |\n|---|\n```\n  kept\n```\n"
    assert markdown_dialect.for_python_markdown(written) == (
        "Text:\n\n- one\n    more\n- two\n\n    ```\n    code\n    ```\n\n"
        "| a |\n|---|\n\n```\n  kept\n```\n"
    )


def test_every_page_of_docs_is_in_the_navigation():
    navigation = (ROOT / "mkdocs.yml").read_text()
    docs = ROOT / "docs"
    pages = [page.relative_to(docs) for page in docs.rglob("*.md")]
    missing = [str(p) for p in pages if p.parts[0] != "decisions" and str(p) not in navigation]
    assert missing == []


@pytest.mark.parametrize("folder", ["package", "stubs", "examples", "models/arm"])
def test_a_notebook_is_rebuilt_when_its_sources_change(
    folder: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    files = {"package": "a.py", "stubs": "_core.so", "examples": "a.yaml", "models/arm": "arm.xml"}
    for place, name in files.items():
        (tmp_path / place).mkdir(parents=True)
        (tmp_path / place / name).touch()
    for path in tmp_path.rglob("*"):
        os.utime(path, (1000, 1000))
    monkeypatch.setattr(notebook_pages, "PACKAGE", tmp_path / "package")
    monkeypatch.setattr(notebook_pages, "STUBS", tmp_path / "stubs")
    monkeypatch.setattr(notebook_pages, "SHARED", (tmp_path / "examples", tmp_path / "models"))
    assert notebook_pages.newest_source() == 1000
    os.utime(tmp_path / folder / files[folder], (2000, 2000))
    assert notebook_pages.newest_source() == 2000
    cached = tmp_path / "examples" / "__pycache__" / "a.pyc"
    cached.parent.mkdir()
    cached.touch()
    assert notebook_pages.newest_source() == 2000, "caches do not count"


def test_notebooks_are_kept_without_output():
    notebooks = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))
    assert len(notebooks) >= 3
    for notebook in notebooks:
        for cell in json.loads(notebook.read_text())["cells"]:
            assert not cell.get("outputs"), notebook.name
            assert cell.get("execution_count") is None, notebook.name


def test_the_navigation_names_each_notebook():
    navigation = (ROOT / "mkdocs.yml").read_text()
    for notebook in (ROOT / "docs" / "notebooks").glob("*.ipynb"):
        assert f"notebooks/{notebook.stem}.md" in navigation


def test_search_words_refer_to_existing_pages():
    pages = [ROOT / "docs" / uri for uri in search_words.WORDS]
    assert [page for page in pages if not page.is_file()] == []
    folders = {uri for uri in search_words.BOOST if "." not in uri} - {"reference", "files"}
    assert [name for name in folders if not (ROOT / "docs" / name).is_dir()] == []


def test_search_splits_words_and_keeps_names_whole():
    config = (ROOT / "mkdocs.yml").read_text()
    separator = re.compile(re.search(r"separator: '(.*)'", config)[1])
    words = [word for word in separator.split("How do I write a task") if word]
    assert words == ["write", "task"]
    assert separator.split("max_relative_movement") == ["max_relative_movement"]
