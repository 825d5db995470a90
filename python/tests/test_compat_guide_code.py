"""Every code block of the guide of mj_kdl_wrapper runs as it is written."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import robocell.compat.mj_kdl_wrapper as mjk
from compat_guide_code import BLOCKS, IMPORT
from test_kdl_chain import needs_pykdl

GUIDE = Path(__file__).resolve().parents[3] / "shared/reference/seeds/python-bindings-guide.txt"
# A line of code looks like this; prose ends with a full stop or has neither of these.
CODE = re.compile(
    r"^(import |def |for |while |if |assert |print\(|[a-z_][\w.\[\]]* = "
    r"|[a-z_]+\.[\w.]+\(.*\)$|fps=|scene,$|\"sim|mjk\.|\)$|q\[|pass$)"
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with `assets`, in which the guide's program is started."""
    from menagerie import require_menagerie

    require_menagerie("kinova_gen3", "robotiq_2f85")
    there = tmp_path_factory.mktemp("guide_code")
    mjk.menagerie.fetch(there)
    return there


def before(text: str) -> str:
    """What runs before a block; `block:NAME;` stands for the code of another block."""
    if text.startswith("block:"):
        name, rest = text.removeprefix("block:").split(";", 1)
        return BLOCKS[name][1] + rest
    return text


@needs_pykdl
@pytest.mark.parametrize("name", BLOCKS)
def test_a_block_runs_as_written(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(folder)
    level = mjk.get_log_level()
    setup, code = BLOCKS[name]
    names: dict[str, object] = {}
    exec(IMPORT + before(setup), names)
    try:
        exec(compile(code, name, "exec", dont_inherit=True), names)
    finally:
        mjk.set_log_level(level)


def guide_lines() -> list[str]:
    """The guide's lines of code."""
    if not GUIDE.is_file():
        pytest.skip(f"{GUIDE} is not here")
    text = GUIDE.read_text()
    lines = [line.strip() for line in text.splitlines()]
    return [line for line in lines if CODE.match(line) and not line.endswith((".", ":."))]


def test_no_line_of_the_guides_code_is_missing_or_changed():
    ours = [line.strip() for _, code in BLOCKS.values() for line in code.splitlines()]
    theirs = [line for line in guide_lines() if line != "import mj_kdl_wrapper as mjk"]
    assert len(theirs) > 120
    assert theirs == ours
