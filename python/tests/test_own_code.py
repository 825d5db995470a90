"""Which sources are a user's own: all that a run's code is made of, found without importing it."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import robocell as rc
from robocell._own_code import code_of, is_own, modules_of_one_run, own_sources, set_modules_of_run
from robocell.policy import register_policy

Write = Callable[[dict[str, str]], None]


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Write:
    """Writes modules where Python finds them; they are forgotten after the test."""
    monkeypatch.syspath_prepend(str(tmp_path))
    before = set(sys.modules)

    def write_all(texts: dict[str, str]) -> None:
        for name, text in texts.items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text(text)
        importlib.invalidate_caches()

    yield write_all
    for name in set(sys.modules) - before:
        del sys.modules[name]


def names(paths: list[Path] | list[str], folder: Path) -> set[str]:
    return {str(Path(path).relative_to(folder.resolve())) for path in paths}


def test_finding_sources_imports_nothing(write: Write, tmp_path: Path):
    write(
        {
            "lazy_code.py": "def show():\n"
            "    from window_code import window\n"
            "    from window_code.inner import pane\n"
            "    import far_code.deep.module\n"
            "    from matplotlib.pyplot import show\n",
            "window_code/__init__.py": "raise RuntimeError('no display')\n",
            "window_code/inner.py": "raise RuntimeError('no display')\n",
            "far_code/deep/module.py": "raise RuntimeError('no display')\n",
        }
    )
    loaded = set(sys.modules)
    assert names(own_sources("lazy_code"), tmp_path) == {
        "lazy_code.py",
        "window_code/__init__.py",
        "window_code/inner.py",
        "far_code/deep/module.py",
    }
    assert set(sys.modules) == loaded


def test_finds_packages_above_folders_without_code(write: Write, tmp_path: Path):
    write(
        {
            "top_code.py": "from pack_code.inner.part import X\n",
            "pack_code/__init__.py": "",
            "pack_code/inner/part.py": "X = 1\n",
        }
    )
    expected = {"top_code.py", "pack_code/__init__.py", "pack_code/inner/part.py"}
    assert names(own_sources("top_code"), tmp_path) == expected
    importlib.import_module("top_code")
    assert names(own_sources("top_code"), tmp_path) == expected


def test_finds_modules_imported_by_a_call(write: Write, tmp_path: Path):
    write(
        {
            "calls_code/__init__.py": "",
            "calls_code/main.py": "import importlib\n"
            "from importlib import import_module\n"
            "A = importlib.import_module('plain_code').A\n"
            "B = import_module('.beside', __package__).B\n"
            "C = __import__('old_code').C\n"
            "D = [import_module(name) for name in ()]\n",
            "calls_code/beside.py": "B = 2\n",
            "plain_code.py": "A = 1\n",
            "old_code.py": "C = 3\n",
        }
    )
    importlib.import_module("calls_code.main")
    assert names(own_sources("calls_code.main"), tmp_path) == {
        "calls_code/__init__.py",
        "calls_code/main.py",
        "calls_code/beside.py",
        "plain_code.py",
        "old_code.py",
    }


def test_ignores_values_whose_attributes_raise(write: Write, tmp_path: Path):
    write(
        {
            "proxy_code.py": "class Proxy:\n"
            "    def __getattribute__(self, name):\n"
            "        raise RuntimeError('not bound')\n"
            "proxy = Proxy()\n"
        }
    )
    importlib.import_module("proxy_code")
    assert names(own_sources("proxy_code"), tmp_path) == {"proxy_code.py"}


def test_excludes_installed_modules_and_robocell():
    assert not is_own(Path(rc.__file__))
    assert not is_own(Path(rc._core.__file__))  # in a checkout in the build tree
    assert not is_own(Path(pytest.__file__))
    assert not is_own(Path(importlib.__file__))
    assert is_own(Path(__file__))
    assert own_sources("numpy.linalg", "json", None, "nowhere.at.all") == []


REGISTERS = {
    "task": (rc.register_task, "_register_task"),
    "expert": (rc.tasks.register_expert, "_register_expert"),
    "scene_source": (rc.scenes.register_scene_source, "_register_scene_source"),
    "sampler": (rc.tasks.register_sampler, "_register_sampler"),
    "feature": (rc.features.register_feature, "_register_feature"),
    "policy": (register_policy, "_register_expert"),
}


@pytest.mark.parametrize("what", REGISTERS)
def test_the_module_that_registers_is_part_of_the_code(
    what: str, write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    write(
        {
            "kinds_code.py": "def make(*_, **__): ...\n",
            "registers_code.py": "import functools, kinds_code\n"
            "def do(register):\n"
            "    made = functools.partial(kinds_code.make, size=0.25)\n"
            "    done = register('mine_of_test', made) if register.__name__.endswith('policy') "
            "else register('mine_of_test')(made)\n",
        }
    )
    function, in_core = REGISTERS[what]
    given: list[Callable[[], list[str]]] = []
    for module in (rc.tasks, rc.features):
        if hasattr(module, in_core):
            monkeypatch.setattr(module, in_core, lambda *args: given.append(args[-1]))
    importlib.import_module("registers_code").do(function)
    assert names(given[0](), tmp_path) == {"kinds_code.py", "registers_code.py"}


@pytest.mark.parametrize("what", ["expert", "sampler", "scene_source", "policy"])
def test_files_are_relative_to_the_module_that_registers(
    what: str, write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    write(
        {
            "files_code.py": "import kinds_code\n"
            "def do(register, policy, files):\n"
            "    if policy:\n"
            "        register('files_of_test', kinds_code.make, files=files)\n"
            "    else:\n"
            "        register('files_of_test', files=files)(kinds_code.make)\n",
            "kinds_code.py": "def make(*_, **__): ...\n",
            "w.pt": "1",
            "more/a.pt": "2",
            "more/in/b.pt": "3",
            "more/__pycache__/c.pyc": "4",
        }
    )
    monkeypatch.chdir("/")
    given: list[Callable[[], list[str]]] = []
    monkeypatch.setattr(rc.tasks, REGISTERS[what][1], lambda *args: given.append(args[-1]))
    do = importlib.import_module("files_code").do
    code = {"files_code.py", "kinds_code.py"}
    in_folder = {"more/a.pt", "more/in/b.pt"}
    for files, expected in (
        ("w.pt", {"w.pt"}),
        (Path("w.pt"), {"w.pt"}),
        ([str(tmp_path / "w.pt")], {"w.pt"}),
        (("w.pt", "more"), {"w.pt", *in_folder}),
    ):
        do(REGISTERS[what][0], what == "policy", files)
        assert names(given[-1](), tmp_path) == code | expected
    (tmp_path / "more/in/b.pt").unlink()
    assert names(given[-1](), tmp_path) == {*code, "w.pt", "more/a.pt"}
    with pytest.raises(TypeError, match="`files` lists paths of files and folders, got 3"):
        do(REGISTERS[what][0], what == "policy", [3])


def test_the_modules_of_a_run_are_part_of_its_code(write: Write, tmp_path: Path):
    write({"kinds_code.py": "def make(): ...\n", "patches_code.py": "import kinds_code\n"})
    code = code_of(importlib.import_module("kinds_code").make)
    with modules_of_one_run():
        set_modules_of_run(["patches_code"])
        assert names(code(), tmp_path) == {"kinds_code.py", "patches_code.py"}
    assert names(code(), tmp_path) == {"kinds_code.py"}
