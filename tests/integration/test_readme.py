"""The ten lines of README.md and docs/install.md run against an install, and print a pose.

The C++ of the other pages in docs/ is compiled along with them.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
from test_docs_snippets import blocks
from test_packaging import BUILD, CONSUMER, ROOT, run

README = ROOT / "README.md"
INSTALL = ROOT / "docs" / "install.md"
INCLUDES = """#include <algorithm>
#include <filesystem>
#include <robocell/math/interpolation.h>
#include <robocell/media/video_reader.h>
#include <robocell/media/video_writer.h>
#include <robocell/mujoco/compile.h>
#include <robocell/mujoco/step.h>
#include <robocell/robot/joint_position_controller.h>
namespace fs = std::filesystem;
"""
# Every page with C++, and what its blocks take as given.
GIVEN = {
    "assets": "",
    "base": "uint64_t run_seed, std::string scene_name, int index, int attempt, fs::path dataset,"
    " std::string text",
    "control": "Robot robot",
    "data": "std::vector<std::string> joints, std::vector<double> q, std::vector<uint8_t> rgb,"
    " std::vector<uint16_t> millimetres",
    "env": "Scene scene",
    "environments": "EnvConfig config",
    "grasps": "Robot robot",
    "kinematics": "const mjModel* model, void (*Command)(std::span<const double>)",
    "math": "Pose base_in_world, Pose tcp_in_base, Pose target, Pose difference, Pose start,"
    " Pose goal, PoseMoveLimits limits, double time",
    "media": "",
    "motion": "Robot robot, Pose down, std::vector<double> q",
    "mujoco": "",
    "render": "Scene scene, Eigen::Vector3d cube_in_world",
    "robots": "Robot robot",
    "scenes": "Scene scene, Robot robot",
    "spec": "",
    "viewer": "Robot robot",
}


def compiled_blocks() -> str:
    """Each page in its namespace, each of its blocks a function of what is given."""
    parts = []
    for page, given in GIVEN.items():
        parts.append(f"namespace {page}_page {{")
        for i, block in enumerate(blocks(ROOT / "docs" / f"{page}.md", "cpp")):
            defines = re.search(r"^(class|struct) ", block, re.MULTILINE)
            parts.append(block if defines else f"void Block{i}({given}) {{ {{\n{block}}} }}")
        parts.append("}")
    return "\n".join(parts)


def test_every_page_is_covered():
    with_code = {page.stem for page in (ROOT / "docs").rglob("*.md") if blocks(page, "cpp")}
    assert with_code == {*GIVEN, "install", "tasks"}


def test_the_plugin_of_the_page_on_tasks_is_the_example():
    (shown,) = blocks(ROOT / "docs" / "tasks.md", "cpp")
    lines = (ROOT / "examples" / "plugin" / "stack.cc").read_text().splitlines()
    assert [line for line in shown.splitlines() if line not in lines] == []


# A program against an install is built in test_packaging.py, the examples of the reference in
# test_cpp_examples.py.
@pytest.mark.proof
def test_the_c_plus_plus_compiles_and_runs_against_an_install(tmp_path: Path):
    if not (BUILD / "librobocell.so").exists():
        pytest.skip("build/release holds no library; run make build")
    prefix, source, build = (tmp_path / name for name in ("prefix", "source", "build"))
    run("cmake", "--install", BUILD, "--prefix", prefix)
    source.mkdir()
    program = blocks(INSTALL, "cpp")[0]
    (source / "main.cc").write_text(f"{INCLUDES}{program}\n{compiled_blocks()}\n")
    (source / "CMakeLists.txt").write_text((CONSUMER / "CMakeLists.txt").read_text())
    package = prefix / "lib/cmake/robocell"
    run("cmake", "-G", "Ninja", "-S", source, "-B", build, f"-Drobocell_DIR={package}")
    run("cmake", "--build", build)
    printed = run(build / "consumer")
    assert re.search(r"-?\d+\.\d+", printed), printed


@pytest.mark.proof
def test_the_commands_of_the_c_plus_plus_build_and_run_it(tmp_path: Path):
    if not (BUILD / "librobocell.so").exists():
        pytest.skip("build/release holds no library; run make build")
    (tmp_path / "main.cc").write_text(blocks(INSTALL, "cpp")[0])
    (tmp_path / "CMakeLists.txt").write_text(blocks(INSTALL, "cmake")[0])
    python = tmp_path / "bin" / "python"
    python.parent.mkdir()
    python.symlink_to(sys.executable)
    command = f'cd "{tmp_path}" && PATH="{python.parent}:$PATH" && set -e\n'
    commands = next(block for block in blocks(INSTALL, "sh") if "cmake_dir" in block)
    printed = run("bash", "-c", command + commands)
    assert re.search(r"-?\d+\.\d+", printed.splitlines()[-1]), printed


def test_an_install_is_found_by_its_prefix(tmp_path: Path):
    if not (BUILD / "librobocell.so").exists():
        pytest.skip("build/release holds no library; run make build")
    prefix = tmp_path / "prefix"
    run("cmake", "--install", BUILD, "--prefix", prefix)
    (tmp_path / "main.cc").write_text("int main() {}")
    (tmp_path / "CMakeLists.txt").write_text(blocks(INSTALL, "cmake")[0])
    build = tmp_path / "build"
    run("cmake", "-S", tmp_path, "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}")
    found = re.search(r"robocell_DIR:PATH=(.*)", (build / "CMakeCache.txt").read_text())
    assert found
    assert Path(found[1]) == prefix / "lib/cmake/robocell"


def test_the_ten_lines_of_python_run(tmp_path: Path):
    script = tmp_path / "ten_lines.py"
    script.write_text(blocks(README, "python")[0])
    printed = run(sys.executable, script)
    assert re.search(r"-?\d+\.\d+", printed), printed
