"""The examples of the C++ reference compile, run, and print what they show.

To compile them takes longer than all else: `make check` does it. `make test` compiles a program
against an install (test_packaging.py).
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from test_docs_snippets import put_demo, put_models
from test_packaging import BUILD, CONSUMER, ROOT, run

from made_once import made_once

sys.path.append(str(ROOT / "scripts" / "docsite"))
import cpp_reference
import most_used_names

EXAMPLES = {example.title: example for example in cpp_reference.examples()}


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program of all examples, built against an install."""
    if not (BUILD / "librobocell.so").exists():
        pytest.skip("build/release holds no library; run make build")

    def make(folder: Path) -> None:
        prefix, source, build = (folder / name for name in ("prefix", "source", "build"))
        run("cmake", "--install", BUILD, "--prefix", prefix)
        source.mkdir()
        (source / "main.cc").write_text(cpp_reference.EXAMPLES.read_text())
        (source / "CMakeLists.txt").write_text((CONSUMER / "CMakeLists.txt").read_text())
        package = prefix / "lib/cmake/robocell"
        run("cmake", "-G", "Ninja", "-S", source, "-B", build, f"-Drobocell_DIR={package}")
        run("cmake", "--build", build)

    return made_once(tmp_path_factory, "cpp_examples", make) / "build" / "consumer"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder as the examples expect it: robocell's own files, and a dataset of `make demo`."""
    path = tmp_path_factory.mktemp("work")
    put_models(path)
    put_demo(path, tmp_path_factory)
    return path


def shown_output(code: str) -> list[str]:
    """What the comments of the lines that print say."""
    return re.findall(r"cout <<[^;]*;\s*// (.*)", code)


def agrees(shown: str, printed: str) -> bool:
    """Whether a line is the shown one; '...' at its end stands for any text."""
    start = shown.removesuffix("...")
    return printed.startswith(start) if shown.endswith("...") else printed == shown


@pytest.mark.proof
@pytest.mark.parametrize("title", EXAMPLES)
def test_an_example_prints_its_output(title: str, program: Path, folder: Path):
    done = subprocess.run([program, title], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    printed, shown = done.stdout.splitlines(), shown_output(EXAMPLES[title].code)
    assert len(printed) == len(shown), printed
    assert [(a, b) for a, b in zip(shown, printed, strict=True) if not agrees(a, b)] == []


@pytest.mark.proof
def test_the_reference_has_every_example_of_the_program(program: Path):
    assert sorted(EXAMPLES) == run(program).split()


def test_every_example_is_on_the_page_of_each_of_its_names():
    on_pages: dict[str, str] = {}
    for header in cpp_reference.public_headers():
        text = cpp_reference.page(header)
        lines = (cpp_reference.SRC / header).read_text().split("\n")
        for declaration in cpp_reference.declarations(lines):
            for name in declaration.names:
                plain = name.split(" ")[-1]
                on_pages[plain] = on_pages.get(plain, "") + text
    for example in EXAMPLES.values():
        for name in example.names:
            assert example.code in on_pages[name], (example.title, name)


def test_the_hundred_most_used_names_have_an_example():
    names = most_used_names.most_used(most_used_names.cpp_counts())
    assert len(names) == most_used_names.MOST
    examples = EXAMPLES.values()
    assert [name for name in names if not any(each.uses(name) for each in examples)] == []
