"""Every public name has a docstring, and the examples in docstrings print what they show."""

from __future__ import annotations

import doctest
import re
import sys
from pathlib import Path

import pytest
from test_docs_snippets import put_demo, put_models
from test_packaging import ROOT

sys.path.append(str(ROOT / "scripts" / "docsite"))
import most_used_names
from public_docstrings import docstrings, returned_types
from python_reference import EXAMPLES_START

DOCSTRINGS = docstrings()
# (n,), (4, 4), a matrix, a row of each copy, or lists for each group.
SHAPE = re.compile(
    r"\(\s*(?:\d+|[a-zA-Z]\w*|\.\.\.)\s*,|\b\d+x\d+\b|\brow|\bmatrix|\(\)|\bshape\b|\bper group\b"
)
WITH_EXAMPLE = {name: text for name, text in DOCSTRINGS.items() if ">>> " in text}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder as the examples expect it: robocell's own files, and a dataset of `make demo`."""
    path = tmp_path_factory.mktemp("examples")
    put_models(path)
    put_demo(path, tmp_path_factory)
    return path


def test_every_public_name_has_a_docstring():
    assert len(DOCSTRINGS) > 1000
    assert [name for name, text in DOCSTRINGS.items() if not text] == []


def test_every_array_has_its_shape_in_the_docstring():
    missing = []
    for name, returned in returned_types().items():
        if "NDArray" in returned and not SHAPE.search(DOCSTRINGS.get(name, "")):
            missing.append(name)
    assert missing == []


def has_example(name: str) -> bool:
    """Whether the name has an example: its own, or for a member one of its class that uses it."""
    owner, _, member = name.rpartition(".")
    example = "\n".join(
        re.findall(r"^ *(?:>>>|\.\.\.) .*", DOCSTRINGS.get(owner, ""), re.MULTILINE)
    )
    return name in WITH_EXAMPLE or bool(re.search(rf"\.{member}\b", example))


def test_the_hundred_most_used_names_have_an_example():
    names = most_used_names.most_used(most_used_names.python_counts())
    assert len(names) == most_used_names.MOST
    assert [name for name in names if not has_example(name)] == []


@pytest.mark.parametrize("name", WITH_EXAMPLE)
def test_an_example_prints_its_output(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(folder)
    names: dict[str, object] = {}
    exec(EXAMPLES_START.read_text(), names)
    example = doctest.DocTestParser().get_doctest(WITH_EXAMPLE[name], names, name, None, None)
    said: list[str] = []
    doctest.DocTestRunner(verbose=False).run(example, out=said.append)
    assert "".join(said) == ""
