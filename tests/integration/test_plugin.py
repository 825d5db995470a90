"""A task of a user's own in C++: examples/plugin, built and run as its CMakeLists.txt says.

To compile plugins takes longer than to try them: `make check-proofs` does it.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from commands import ROOT, generate, refusal, robocell_command
from test_packaging import run

import robocell as rc
from made_once import made_once

EXAMPLE = ROOT / "examples" / "plugin"
RC7 = ROOT / "models" / "robots" / "rc7" / "rc7.yaml"


# A source that knows a room, in a plugin whose function throws afterwards on request.
LAB = """
#include <robocell/robocell.h>
#include <cstdlib>
#include <stdexcept>
struct LabConfig {
  double height = 0.5;
  static constexpr const char* kKind = "lab_of_plugin";
  static constexpr const char* kTypeName = "LabConfig";
  template <class V>
  static void Fields(V&& v) { v("height", &LabConfig::height, "Metres."); }
};
class Lab : public robocell::SceneSource {
 public:
  explicit Lab(const LabConfig&) {}
  std::optional<int> size() const override { return 1; }
  robocell::SceneSpec Make(int) override { return {.base = "tabletop", .add_floor = true}; }
  std::optional<robocell::SceneAnnotations> KnownAnnotations(int) override {
    robocell::SceneAnnotations known;
    known.rooms.push_back({.name = "kitchen"});
    return known;
  }
};
void RegisterLab() {
  using Kind = robocell::SceneSourceKindOf<LabConfig, Lab>;
  robocell::RegisterSceneSource<LabConfig>(std::make_shared<Kind>());
  if (std::getenv("LAB_FAILS") != nullptr) throw std::runtime_error("second kind failed");
}
ROBOCELL_PLUGIN(RegisterLab)
"""

LOAD_LAB = """
import sys
import robocell as rc
from robocell._core import load_plugin
lab, example, output = sys.argv[1:]
for _ in range(2):
    try:
        load_plugin(lab)
    except Exception as error:
        print(type(error).__name__, error)
config = rc.RunConfig.load(example, ["scenes={source: lab_of_plugin}", f"output={output}"])
print("rooms", [room.name for room in rc.scenes.make_scene_source(config).annotations(0).rooms])
rc.generate.prepare_dataset(config, validate=False)
"""


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The CMake package of an installed robocell."""

    def make(folder: Path) -> None:
        run("cmake", "--install", rc.cmake_dir(), "--prefix", folder)

    return made_once(tmp_path_factory, "installed", make) / "lib" / "cmake" / "robocell"


def build(source: Path, folder: Path, package: Path) -> None:
    run("cmake", "-G", "Ninja", "-S", source, "-B", folder, f"-Drobocell_DIR={package}")
    run("cmake", "--build", folder)


@pytest.fixture(scope="module")
def plugin(package: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example, built against an installed robocell."""

    def make(folder: Path) -> None:
        build(EXAMPLE, folder, package)

    return made_once(tmp_path_factory, "plugin", make) / "libstack.so"


@pytest.fixture(scope="module")
def lab(package: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A plugin whose code is above."""

    def make(folder: Path) -> None:
        cmake = (EXAMPLE / "CMakeLists.txt").read_text()
        (folder / "CMakeLists.txt").write_text(cmake)
        (folder / "stack.cc").write_text(LAB)
        build(folder, folder / "build", package)

    return made_once(tmp_path_factory, "lab", make) / "build" / "libstack.so"


def load_lab(lab: Path, output: Path, **environment: str) -> str:
    """What LOAD_LAB prints, in a process of its own: kinds are never forgotten."""
    words = (sys.executable, "-c", LOAD_LAB, lab, ROOT / "examples" / "demo.yaml", output)
    done = subprocess.run(
        words, env=os.environ | environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "code/libstack.so" in json.loads((output / "dataset.json").read_text())["files"]
    return done.stdout


@pytest.mark.proof
def test_annotations_of_a_library_source_are_visible_in_python(lab: Path, tmp_path: Path):
    assert load_lab(lab, tmp_path / "out") == "rooms ['kitchen']\n"


@pytest.mark.proof
def test_a_library_that_fails_halfway_stays_registered(lab: Path, tmp_path: Path):
    first, second, rooms = load_lab(lab, tmp_path / "out", LAB_FAILS="1").splitlines()
    assert first.startswith("Error plugin '")
    assert first.endswith("libstack.so' failed to register: second kind failed")
    assert "its registration failed before: second kind failed; start a new process" in second
    assert rooms == "rooms ['kitchen']"


@pytest.fixture
def run_file(tmp_path: Path) -> Path:
    text = (EXAMPLE / "stack.yaml").read_text()
    file = tmp_path / "stack.yaml"
    text = text.replace("imports: [../../build/plugin/libstack.so]\n", "")
    file.write_text(text.replace("../../models/robots/rc7/rc7.yaml", str(RC7)))
    return file


def files_of(folder: Path) -> dict[str, bytes]:
    return {file.parent.name: file.read_bytes() for file in sorted(folder.glob("s*/steps.h5"))}


@pytest.mark.proof
def test_a_library_stacks_cubes(plugin: Path, run_file: Path, tmp_path: Path):
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
    # Readers of the dataset need no plugin; whoever acts in it does.
    assert robocell_command("verify", tmp_path / "two").returncode == 0
    words = ("evaluate", tmp_path / "two", "--policy", "expert", "-n", "1")
    assert "no task 'red_on_blue'" in refusal(*words, "--output", tmp_path / "without")
    said = robocell_command(*words, "--import", plugin, "--output", tmp_path / "with")
    assert said.returncode == 0, said.stderr


@pytest.mark.proof
def test_a_dataset_records_the_hash_of_its_library(plugin: Path, run_file: Path, tmp_path: Path):
    mine = Path(shutil.copy(plugin, tmp_path))
    generate(run_file, tmp_path / "out", "--import", mine, "--workers", 1, "--episodes", 1)
    with mine.open("ab") as library:
        library.write(b"another build")
    said = refusal(
        "generate", run_file, "--import", mine, "--output", tmp_path / "out", "--episodes", "2"
    )
    assert "code file libstack.so: changed since then" in said


@pytest.mark.proof
def test_a_run_file_can_import_a_library(plugin: Path, run_file: Path, tmp_path: Path):
    shutil.copy(plugin, tmp_path)
    run_file.write_text(run_file.read_text() + "imports: [libstack.so]\n")
    generate(run_file, tmp_path / "out", "--workers", 1, "--episodes", 1)
    run_file.write_text(run_file.read_text().replace("edge: 0.04", "egde: 0.04"))
    said = refusal("generate", run_file, "--output", tmp_path / "no")
    assert "Did you mean 'edge'?" in said


def test_rejects_libraries_that_are_not_plugins(run_file: Path, tmp_path: Path):
    (tmp_path / "text.so").write_text("not a library")
    for library, reason in (
        ("text.so", "cannot load plugin"),
        ("gone.so", "there is no such file"),
    ):
        said = refusal(
            "generate", run_file, "--import", tmp_path / library, "--output", tmp_path / "out"
        )
        assert reason in said
        assert library in said
