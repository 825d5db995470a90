"""Every public name has a docstring, and the examples in docstrings print what they show."""

from __future__ import annotations

import doctest
import sys
from pathlib import Path

import pytest
from test_docs_snippets import make_demo
from test_packaging import ROOT

sys.path.append(str(ROOT / "scripts" / "docsite"))
from public_docstrings import docstrings
from python_reference import EXAMPLES_START

DOCSTRINGS = docstrings()
WITH_EXAMPLE = {name: text for name, text in DOCSTRINGS.items() if ">>> " in text}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder as the examples expect it: robocell's own files, and a dataset of `make demo`."""
    path = tmp_path_factory.mktemp("examples")
    for name in ("examples", "models"):
        (path / name).symlink_to(ROOT / name)
    make_demo(path)
    return path


def test_every_public_name_has_a_docstring():
    assert len(DOCSTRINGS) > 1000
    assert [name for name, text in DOCSTRINGS.items() if not text] == []


def test_the_hundred_names_that_people_use_most_have_an_example():
    assert len(WITH_EXAMPLE) >= 100


@pytest.mark.parametrize("name", WITH_EXAMPLE)
def test_an_example_prints_what_it_shows(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(folder)
    names: dict[str, object] = {}
    exec(EXAMPLES_START.read_text(), names)
    example = doctest.DocTestParser().get_doctest(WITH_EXAMPLE[name], names, name, None, None)
    said: list[str] = []
    doctest.DocTestRunner(verbose=False).run(example, out=said.append)
    assert "".join(said) == ""
