"""The code in README.md runs and prints what it promises, from an install as a user has it.

The C++ of the pages in docs/ is compiled along with it.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
from test_docs_snippets import blocks
from test_packaging import BUILD, CONSUMER, ROOT, run

README = ROOT / "README.md"
# Pages whose blocks are whole statements; others leave out what is not their subject.
PAGES = ("assets", "control", "env", "media", "render", "scenes", "spec")
INCLUDES = """#include <algorithm>
#include <robocell/media/video_reader.h>
#include <robocell/media/video_writer.h>
#include <robocell/robot/joint_position_controller.h>
"""
GIVEN = "Scene scene, Robot robot, const Eigen::Vector3d& cube_in_world"  # what a block may use


def compiled_blocks() -> str:
    """Each page in its namespace, each of its blocks a function of what is given."""
    parts = []
    for page in PAGES:
        parts.append(f"namespace {page}_page {{")
        for i, block in enumerate(blocks(ROOT / "docs" / f"{page}.md", "cpp")):
            defines = re.search(r"^(class|struct) ", block, re.MULTILINE)
            parts.append(block if defines else f"void Block{i}({GIVEN}) {{ {{\n{block}}} }}")
        parts.append("}")
    return "\n".join(parts)


def test_the_c_plus_plus_compiles_and_runs_against_an_install(tmp_path: Path):
    if not (BUILD / "librobocell.so").exists():
        pytest.skip("build/release holds no library; run make build")
    prefix, source, build = (tmp_path / name for name in ("prefix", "source", "build"))
    run("cmake", "--install", BUILD, "--prefix", prefix)
    source.mkdir()
    program = blocks(README, "cpp")[0]
    (source / "main.cc").write_text(f"{INCLUDES}{program}\n{compiled_blocks()}\n")
    (source / "CMakeLists.txt").write_text((CONSUMER / "CMakeLists.txt").read_text())
    package = prefix / "lib/cmake/robocell"
    run("cmake", "-G", "Ninja", "-S", source, "-B", build, f"-Drobocell_DIR={package}")
    run("cmake", "--build", build)
    printed = run(build / "consumer")
    assert re.search(r"-?\d+\.\d+", printed), printed


def test_the_ten_lines_of_python_run(tmp_path: Path):
    script = tmp_path / "ten_lines.py"
    script.write_text(blocks(README, "python")[0])
    printed = run(sys.executable, script)
    assert re.search(r"-?\d+\.\d+", printed), printed
