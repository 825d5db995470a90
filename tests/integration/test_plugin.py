"""A task of a user's own in C++: examples/plugin, built and run as its CMakeLists.txt says."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from commands import ROOT, generate, refusal, robocell_command
from test_packaging import run

import robocell as rc

EXAMPLE = ROOT / "examples" / "plugin"
RC7 = ROOT / "models" / "robots" / "rc7" / "rc7.yaml"


@pytest.fixture(scope="module")
def plugin(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example, built against an installed robocell."""
    folder = tmp_path_factory.mktemp("plugin")
    run("cmake", "--install", rc.cmake_dir(), "--prefix", folder / "robocell")
    package = folder / "robocell" / "lib" / "cmake" / "robocell"
    run("cmake", "-G", "Ninja", "-S", EXAMPLE, "-B", folder / "build", f"-Drobocell_DIR={package}")
    run("cmake", "--build", folder / "build")
    return folder / "build" / "libstack.so"


@pytest.fixture
def run_file(tmp_path: Path) -> Path:
    text = (EXAMPLE / "stack.yaml").read_text()
    file = tmp_path / "stack.yaml"
    text = text.replace("imports: [../../build/plugin/libstack.so]\n", "")
    file.write_text(text.replace("../../models/robots/rc7/rc7.yaml", str(RC7)))
    return file


def files_of(folder: Path) -> dict[str, bytes]:
    return {file.parent.name: file.read_bytes() for file in sorted(folder.glob("s*/steps.h5"))}


def test_cubes_are_stacked_by_a_library(plugin: Path, run_file: Path, tmp_path: Path):
    named = ("--import", plugin, "--episodes", 2)
    generate(run_file, tmp_path / "two", *named, "--workers", 2)
    generate(run_file, tmp_path / "one", *named, "--workers", 1)
    assert files_of(tmp_path / "two") == files_of(tmp_path / "one")
    for episode in rc.Dataset(tmp_path / "two"):
        assert episode.success
        assert episode.metadata["instruction"] == "put the red cube on the blue one"
        red, blue = episode["objects/red/pose"][-1], episode["objects/blue/pose"][-1]
        assert red[2] - blue[2] == pytest.approx(0.04, abs=0.003)
    manifest = json.loads((tmp_path / "two" / "dataset.json").read_text())
    assert "code/libstack.so" in manifest["files"]
    # What reads the dataset needs no plugin, and what acts in it does.
    assert robocell_command("verify", tmp_path / "two").returncode == 0
    words = ("evaluate", tmp_path / "two", "--policy", "expert", "-n", "1")
    assert "no task 'stack'" in refusal(*words, "--output", tmp_path / "without")
    said = robocell_command(*words, "--import", plugin, "--output", tmp_path / "with")
    assert said.returncode == 0, said.stderr


def test_a_dataset_knows_what_its_library_held(plugin: Path, run_file: Path, tmp_path: Path):
    mine = Path(shutil.copy(plugin, tmp_path))
    generate(run_file, tmp_path / "out", "--import", mine, "--workers", 1, "--episodes", 1)
    with mine.open("ab") as library:
        library.write(b"another build")
    said = refusal(
        "generate", run_file, "--import", mine, "--output", tmp_path / "out", "--episodes", "2"
    )
    assert "code file libstack.so: changed since then" in said


def test_a_run_file_may_name_a_library(plugin: Path, run_file: Path, tmp_path: Path):
    shutil.copy(plugin, tmp_path)
    run_file.write_text(run_file.read_text() + "imports: [libstack.so]\n")
    generate(run_file, tmp_path / "out", "--workers", 1, "--episodes", 1)
    run_file.write_text(run_file.read_text().replace("edge: 0.04", "egde: 0.04"))
    said = refusal("generate", run_file, "--output", tmp_path / "no")
    assert "Did you mean 'edge'?" in said


def test_what_is_no_plugin_is_refused(run_file: Path, tmp_path: Path):
    (tmp_path / "text.so").write_text("not a library")
    for library, reason in (("text.so", "cannot load plugin"), ("gone.so", "No such file")):
        said = refusal(
            "generate", run_file, "--import", tmp_path / library, "--output", tmp_path / "out"
        )
        assert reason in said
        assert library in said
