"""Every example runs as it stands, and its two languages print and draw the same.

`make test` runs a few in Python; `make check` compiles and runs them all.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from commands import warnings_of
from test_packaging import BUILD, ROOT

EXAMPLES = ROOT / "examples"
PYTHON = sorted(EXAMPLES.glob("[0-9]*.py"))
QUICK = {"01_build_and_control", "04_own_task", "08_come_and_go"}


def start(*command: Path | str, **variables: str) -> subprocess.CompletedProcess[str]:
    env = {**os.environ, **variables}
    return subprocess.run(
        command, capture_output=True, text=True, timeout=300, check=False, env=env
    )


def run(*command: Path | str, **variables: str) -> str:
    done = start(*command, **variables)
    assert done.returncode == 0, done.stdout + done.stderr
    assert warnings_of(done.stderr) == ""
    return done.stdout


def program_of(path: Path) -> Path:
    """The same example in C++."""
    program = BUILD / f"example_{path.stem}"
    if not program.exists():
        pytest.fail("build/release holds no examples; build the target `examples`")
    return program


@pytest.mark.parametrize("name", sorted(QUICK))
def test_an_example_prints_and_draws(name: str, tmp_path: Path) -> None:
    assert run(sys.executable, EXAMPLES / f"{name}.py", tmp_path)
    assert list(tmp_path.rglob("picture.png"))


@pytest.mark.proof
@pytest.mark.parametrize("path", PYTHON, ids=lambda path: path.stem)
def test_an_example_is_the_same_in_both_languages(path: Path, tmp_path: Path) -> None:
    program = program_of(path)
    printed = run(sys.executable, path, tmp_path / "python")
    assert printed
    assert run(program, tmp_path / "cpp") == printed
    drawn, drawn_in_cpp = (
        {file.relative_to(folder): file.read_bytes() for file in folder.rglob("picture.png")}
        for folder in (tmp_path / "python", tmp_path / "cpp")
    )
    assert drawn, "every example draws what it is about"
    assert drawn == drawn_in_cpp


BLACK_TABLE = """<mujoco><worldbody><body name="table">
<geom type="box" size="0.3 0.3 0.02" pos="0 0 -0.02" rgba="0 0 0 1"/><site name="table_top"/>
</body></worldbody></mujoco>"""


@pytest.mark.proof
def test_an_example_uses_an_overridden_model(tmp_path: Path) -> None:
    """The table of the frames: where it stands is the example's, what it is is ours."""
    example = EXAMPLES / "14_frames.py"
    languages = {"python": (sys.executable, example), "cpp": (program_of(example),)}
    table, none = tmp_path / "black.xml", tmp_path / "none.xml"
    table.write_text(BLACK_TABLE)
    pictures = {}
    for language, command in languages.items():
        for name, variables in (("own", {}), ("black", {"ROBOCELL_OVERRIDE_TABLE": str(table)})):
            folder = tmp_path / f"{language}_{name}"
            run(*command, folder, **variables)
            pictures[language, name] = [file.read_bytes() for file in steps_of(folder)]
        wrong = start(*command, tmp_path / "wrong", ROBOCELL_OVERRIDE_TABLE=str(none))
        assert wrong.returncode != 0
        told = f"ROBOCELL_OVERRIDE_TABLE is '{none}', which is not a file; it replaces"
        assert told in wrong.stderr
    own, black = pictures["python", "own"], pictures["python", "black"]
    assert [a == b for a, b in zip(own, black, strict=True)] == [True] + [False] * 5, (
        "the table comes in the second of the steps"
    )
    assert pictures["cpp", "own"] == own
    assert pictures["cpp", "black"] == black


def steps_of(folder: Path) -> list[Path]:
    """The pictures of the example's steps, in their order."""
    return [folder / f"step_{number}.png" for number in range(1, 7)]


def test_every_example_exists_in_both_languages_and_is_listed() -> None:
    names = [path.stem for path in PYTHON]
    assert names == sorted(p.stem for p in EXAMPLES.glob("[0-9]*.cc"))
    assert set(names) > QUICK
    page = (EXAMPLES / "README.md").read_text()
    for name in names:
        assert f"({name}.py)" in page
        assert f"({name}.cc)" in page
        assert f"(../docs/example_{name[:2]}.png)" in page
