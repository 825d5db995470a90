"""The code in docs/ is code: Python runs, C++ compiles, and commands print what the pages show."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import console_blocks
import pytest
from commands import robocell_command, warnings_of
from test_packaging import ROOT, run

from made_once import made_once
from menagerie import require_menagerie

DOCS = ROOT / "docs"
PAGES = sorted(page for page in DOCS.rglob("*.md") if page.parent.name != "decisions")
WITH_COMMANDS = [page for page in PAGES if console_blocks.commands(page)]
# Pages that take seconds, of which there are quicker ones of the same kind: `make check` runs them.
LONG = {
    "the commands": {
        "concepts/determinism",
        "concepts/durability",
        "howto/benchmark",
        "howto/evaluate_policy",
        "howto/many_machines",
        "howto/record_depth",
        "howto/render_kept",
        "howto/resume_run",
        "tutorials/arm_in_houses",
        "tutorials/first_dataset",
        "tutorials/own_robot",
        "tutorials/own_task",
        "tutorials/train_and_evaluate",
    },
    "the python": {
        "data",
        "environments",
        "export",
        "howto/train_diffusion_policy",
        "howto/train_groot",
        "howto/train_openpi",
        "howto/train_robomimic",
    },
}


def name_of(page: Path) -> str:
    return str(page.relative_to(DOCS).with_suffix(""))


def each(pages: list[Path], part: str) -> list[Any]:
    """Parameters: the pages, of which the long ones are proofs."""
    names = {name_of(page): page for page in pages}
    assert LONG[part] <= names.keys(), "a page has another name now"
    marks = {name: [pytest.mark.proof] for name in LONG[part]}
    return [pytest.param(page, id=name, marks=marks.get(name, ())) for name, page in names.items()]


def blocks(page: Path, language: str) -> list[str]:
    found = re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)
    return [str(block) for block in found]


def put_models(folder: Path) -> None:
    """Puts the folders of the repository there that pages and examples name."""
    for name in ("examples", "models"):
        (folder / name).symlink_to(ROOT / name)


def put_demo(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    """Puts a small dataset of `make demo` there, which is made once."""

    def make(made: Path) -> None:
        put_models(made)
        small = ("--episodes", 2, "--workers", 1, "--set", "cameras.resolution=[64, 48]")
        done = robocell_command("generate", "examples/demo.yaml", *small, cwd=made)
        assert done.returncode == 0, done.stderr

    made = made_once(tmp_path_factory, "small_demo", make)
    shutil.copytree(made / "experiment_output", folder / "experiment_output")


def prepare(page: Path, folder: Path) -> None:
    """The files that a page takes as given, and those that it shows."""
    put_models(folder)
    console_blocks.write_files(page, folder)


@pytest.mark.parametrize("page", each([p for p in PAGES if blocks(p, "python")], "the python"))
def test_the_python_of_a_page_runs_from_top_to_bottom(
    page: Path, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
):
    code = "\n".join(blocks(page, "python"))
    if "fr3_2f85" in code:
        require_menagerie("franka_fr3", "robotiq_2f85")
    prepare(page, tmp_path)
    if "experiment_output/demo" in code:
        put_demo(tmp_path, tmp_path_factory)
    script = tmp_path / "page.py"
    script.write_text(code)
    done = subprocess.run(
        [sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert warnings_of(done.stderr) == ""


@pytest.mark.parametrize("page", each(WITH_COMMANDS, "the commands"))
def test_the_commands_of_a_page_print_the_shown_output(page: Path, tmp_path: Path):
    prepare(page, tmp_path)
    for command in console_blocks.commands(page):
        printed = console_blocks.run(command.line, tmp_path)
        assert console_blocks.agrees(command.printed, printed), "\n".join(
            [f"$ {command.line}", *printed, "", "but the page shows", *command.printed]
        )


def test_each_how_to_shows_a_command_or_a_program():
    pages = [page for page in (DOCS / "howto").glob("*.md") if page.stem != "index"]
    without = [p.stem for p in pages if not blocks(p, "python") and not console_blocks.commands(p)]
    assert pages
    assert without == []


def test_the_list_of_all_fields_matches_the_specs():
    run(sys.executable, ROOT / "docs" / "make_spec_fields.py", "--check")
