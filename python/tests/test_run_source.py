"""Where a run comes from: files, configurations in Python, modules; every problem has a place."""

import argparse
import contextlib
import json
import sys
from pathlib import Path

import pytest

import robocell as rc
from robocell.dataset_run import _run_of_text
from robocell.generate.protocol import Failure
from robocell.generate.run_source import (
    RunSource,
    import_module,
    import_named,
    is_of_users,
    place_of,
    where,
)

MODULE = """
import robocell as rc

def run():
    made = rc.RunConfig(run="made", robot=rc.RobotConfig.load(rc.models.robot_file("rc7")))
    made.output = "out"
    return made

made_already = run()
number = 3

def broken():
    raise ValueError("not today")
"""


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The name of a module in the working folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    name = f"runs_{abs(hash(tmp_path))}"
    (tmp_path / f"{name}.py").write_text(MODULE)
    yield name
    sys.modules.pop(name, None)


def test_a_function_and_a_value_of_a_module_or_its_file_are_runs(module):
    for source in (f"{module}:run", f"{module}.py:run", f"{module}:made_already"):
        assert RunSource(source).in_python
        run = RunSource(source).load(["seed=7", "episodes_per_scene=2"])
        assert (run.run, run.seed, run.episodes_per_scene) == ("made", 7, 2)


@pytest.mark.parametrize(
    ("name", "error", "told"),
    [
        ("nope", rc.NotFoundError, "has no 'nope'. Its configurations: made_already."),
        ("number", rc.SpecError, "expected a RunConfig or a function that returns one, got a int"),
        ("broken", rc.SpecError, "cannot be made: ValueError: not today ("),
    ],
)
def test_what_is_no_run_is_told(module, name, error, told):
    with pytest.raises(error) as raised:
        RunSource(f"{module}:{name}").load()
    assert told in str(raised.value)


def test_what_a_module_raises_is_told_with_file_and_line(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", list(sys.path))
    (tmp_path / "half_a_task.py").write_text("value = 1\n\nraise KeyError('mug')\n")
    with pytest.raises(rc.SpecError) as raised:
        import_module("half_a_task.py", tmp_path)
    assert f"KeyError: 'mug' ({tmp_path / 'half_a_task.py'}:3" in str(raised.value)
    assert "half_a_task" not in sys.modules
    (tmp_path / "no_python.py").write_text("def\n")
    with pytest.raises(rc.SpecError, match=r"SyntaxError: .*no_python\.py:1\)"):
        import_module("no_python.py", tmp_path)


def test_modules_that_are_nowhere_are_told_with_the_next_step(tmp_path):
    with pytest.raises(rc.SpecError, match=r"no such module in .* or install it"):
        import_module("nowhere_to_be_found", tmp_path)
    with pytest.raises(rc.SpecError, match="there is no such file"):
        import_module("nowhere.py", tmp_path)
    with pytest.raises(rc.SpecError, match=r"cannot import '.*nothing\.so'"):
        import_named("nothing.so", tmp_path)


def test_the_nearest_file_or_module_is_suggested(tmp_path):
    (tmp_path / "upright.py").write_text("")
    (tmp_path / "libstack.so").write_text("")
    with pytest.raises(rc.SpecError, match=r"no such file\. Did you mean 'upright\.py'\?$"):
        import_named("uprigt.py", tmp_path)
    with pytest.raises(rc.SpecError, match=r"no such file\. There are: upright\.py$"):
        import_named("stack.py", tmp_path)
    with pytest.raises(rc.SpecError, match=r"there is no folder '.*/tasks'$"):
        import_named("tasks/stack.py", tmp_path)
    with pytest.raises(rc.SpecError, match=r"or install it\. Did you mean 'upright'\?$"):
        import_named("uprigt", tmp_path)
    with pytest.raises(rc.SpecError, match=r"no such file\. Did you mean 'libstack\.so'\?$"):
        import_named("libstak.so", tmp_path)


def test_folders_are_no_modules(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", list(sys.path))
    folder = tmp_path / "folder_of_tasks"
    folder.mkdir()
    (folder / "stack.py").write_text("")
    for name in ("folder_of_tasks", "folder_of_tasks/"):
        with pytest.raises(rc.SpecError) as raised:
            import_module(name, tmp_path)
        assert "is a folder without an __init__.py; name a file in it" in str(raised.value)
        assert str(folder / "stack.py") in str(raised.value)
        sys.modules.pop("folder_of_tasks", None)
    (folder / "__init__.py").write_text("")
    with pytest.raises(rc.SpecError, match="import the package by its name: folder_of_tasks"):
        import_module("folder_of_tasks/", tmp_path)
    assert import_module("folder_of_tasks", tmp_path).__name__ == "folder_of_tasks"


def test_imports_of_a_run_file_are_told_with_their_place(tmp_path):
    file = tmp_path / "run.yaml"
    file.write_text("run: a\nimports:\n  - nowhere.py\n  - gone.so\n")
    with pytest.raises(rc.SpecError) as raised:
        RunSource(str(file)).load()
    path = tmp_path / "nowhere.py"
    said = f"{file}:3:5: imports: cannot import '{path}': there is no such file"
    assert str(raised.value) == said
    file.write_text("run: a\nimports: [gone.so]\n")
    with pytest.raises(rc.SpecError, match=r"run\.yaml:2:11: imports: cannot import '.*gone\.so'"):
        RunSource(str(file)).load()


def test_the_text_of_a_dataset_has_no_lines_and_columns():
    robot = rc.models.robot_file("rc7")
    text = f"run: a\nrobot: {robot}\ntask:\n  kind: stack_of_nobody\nepisods: 3\n"
    with pytest.raises(rc.SpecError) as raised:
        _run_of_text(text, "out/folder")
    said = str(raised.value)
    assert said.startswith("the run that made 'out/folder': 2 problems:")
    assert "  task.kind: no task 'stack_of_nobody'" in said
    assert "name it with --import" in said
    assert "folder:" not in said
    with pytest.raises(rc.SpecError, match=r"^the run that made 'out/folder': task\.kind: no task"):
        _run_of_text(text.replace("episods: 3", ""), "out/folder")


def test_another_file_of_the_name_of_a_loaded_module_is_refused(tmp_path):
    (tmp_path / "pytest.py").write_text("")
    with pytest.raises(rc.SpecError, match="a module 'pytest' is loaded from"):
        import_module("pytest.py", tmp_path)


def test_another_process_gets_the_same_source():
    source = RunSource("my.py:run", ("a", "b.py"), "random")
    parser = argparse.ArgumentParser()
    RunSource.add_options(parser)
    assert RunSource.of(parser.parse_args([*source.options(), "--", source.run])) == source


def test_an_error_without_code_of_a_user_has_no_place():
    assert place_of(ValueError("text")) == "ValueError: text"


@pytest.mark.parametrize(
    ("name", "whose"),
    [
        ("random.py", "Python"),
        ("json.py", "Python"),
        ("json", "Python"),
        ("robocell.py", "robocell"),
        ("gymnasium.py", "that robocell needs"),
        ("typer.py", "that robocell needs"),
    ],
)
def test_names_of_modules_that_others_need_are_refused(tmp_path: Path, name: str, whose: str):
    (tmp_path / name).write_text("x = 1\n")
    module = name.removesuffix(".py")
    before = sys.modules.get(module)
    with pytest.raises(rc.SpecError) as raised:
        import_named(name, tmp_path)
    said = whose if " " in whose else f"of {whose} itself"
    assert f"'{module}' is the name of a module {said}" in str(raised.value)
    assert f"such as my_{module}.py" in str(raised.value)
    assert sys.modules.get(module) is before


def raised_in(tmp_path: Path, call: str) -> Exception:
    """What a function of a user's module raised."""
    name = f"raises_{abs(hash(tmp_path))}"
    text = f"import json\nimport numpy as np\n\n\ndef judge():\n    return {call}\n"
    (tmp_path / f"{name}.py").write_text(text)
    module = import_module(f"{name}.py", tmp_path)
    try:
        with pytest.raises(BaseException) as raised:
            module.judge()
        return raised.value
    finally:
        sys.modules.pop(name)


@pytest.mark.parametrize(
    "call", ["json.loads('x')", "np.linalg.inv(np.zeros((2, 2)))", "eval('x y')", "[][0]", "exit()"]
)
def test_the_place_of_an_error_is_in_the_users_own_source(tmp_path, monkeypatch, call):
    monkeypatch.setattr(sys, "path", list(sys.path))
    error = raised_in(tmp_path, call)
    assert is_of_users(error)
    assert where(error).startswith(f" ({tmp_path}/")
    assert where(error).endswith(".py:6, in judge)")


def test_frames_of_pythons_own_library_are_no_users():
    with pytest.raises(ValueError) as raised:
        json.loads("x")
    error = raised.value
    assert "test_run_source.py" in where(error)
    error.__traceback__ = error.__traceback__.tb_next  # as when robocell calls it
    assert not is_of_users(error)
    assert where(error) == ""


def test_an_error_whose_text_cannot_be_made_is_told_by_its_class(tmp_path):
    class MuteError(Exception):
        def __str__(self) -> str:
            raise RuntimeError("no text")

    assert place_of(MuteError()) == "MuteError: (its text cannot be made)"
    assert Failure.of(MuteError()).message == "MuteError: (its text cannot be made)"


def test_a_module_that_exits_is_told_with_file_and_line(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", list(sys.path))
    file = tmp_path / "exits_at_once.py"
    file.write_text("import sys\n\n\nsys.exit(0)\n")
    with pytest.raises(rc.SpecError) as raised:
        import_module("exits_at_once.py", tmp_path)
    assert f"SystemExit: 0 ({file}:4, in <module>)" in str(raised.value)


def test_an_import_leaves_the_working_folder_as_it_was(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.chdir(tmp_path)
    for name, then in (("goes_away", ""), ("goes_and_raises", "raise KeyError('a')\n")):
        (tmp_path / f"{name}.py").write_text(f"import os\n\nos.chdir('/')\n{then}")
        with contextlib.suppress(rc.SpecError):
            import_module(f"{name}.py", tmp_path)
        assert Path.cwd() == tmp_path


def test_a_source_may_be_made_independent_of_the_working_folder(module, tmp_path):
    (tmp_path / "run.yaml").touch()
    source = RunSource("run.yaml", ("a.py",))
    assert source.absolute() == RunSource(str(tmp_path / "run.yaml"), ("a.py",))
    assert RunSource(f"{module}:run").absolute() == RunSource(f"{module}:run")
