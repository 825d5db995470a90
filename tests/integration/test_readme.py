"""The code in README.md compiles, runs and prints what it promises."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
from test_packaging import BUILD, CONSUMER, ROOT, run


def test_the_ten_lines_of_c_plus_plus_run(tmp_path: Path):
    if not (BUILD / "librobocell.so").exists():
        pytest.skip("build/release holds no library; run make build")
    code = re.search(r"```cpp\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert code
    source = tmp_path / "source"
    source.mkdir()
    (source / "main.cc").write_text(code[1])
    (source / "CMakeLists.txt").write_text((CONSUMER / "CMakeLists.txt").read_text())
    build = tmp_path / "build"
    run("cmake", "-G", "Ninja", "-S", source, "-B", build, f"-Drobocell_DIR={BUILD}")
    run("cmake", "--build", build)
    printed = run(build / "consumer")
    assert re.search(r"-?\d+\.\d+", printed), printed


def test_the_ten_lines_of_python_run(tmp_path: Path):
    code = re.search(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert code
    script = tmp_path / "ten_lines.py"
    script.write_text(code[1])
    printed = run(sys.executable, script)
    assert re.search(r"-?\d+\.\d+", printed), printed
