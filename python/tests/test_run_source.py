"""Where a run comes from: files, configurations in Python, modules; every problem has a place."""

import argparse
import contextlib
import json
import os
import sys
from pathlib import Path

import pytest

import robocell as rc
from robocell._generation.job import Job
from robocell._generation.run_source import (
    RunSource,
    import_module,
    import_named,
)
from robocell.evaluate import evaluate

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


def test_a_policy_is_evaluated_without_noise_and_source_episodes(module):
    sets = ["noise.translation=0.01", "noise.start_translation=0.1", "augment.dataset=out/few"]
    run = RunSource(f"{module}:run").load(sets)
    assert run.noise is not None
    assert run.noise.start_translation == 0.1
    run = RunSource(f"{module}:run", policy="random").load(sets)
    assert run.noise is None
    assert run.augment is None


@pytest.mark.parametrize(
    ("name", "error", "told"),
    [
        ("nope", rc.NotFoundError, "has no 'nope'. Its configurations: made_already."),
        ("number", rc.SpecError, "expected a RunConfig or a function that returns one, got a int"),
        ("broken", rc.SpecError, "cannot be made: ValueError: not today ("),
    ],
)
def test_rejects_values_that_are_not_runs(module, name, error, told):
    with pytest.raises(error) as raised:
        RunSource(f"{module}:{name}").load()
    assert told in str(raised.value)


def test_an_exception_in_a_module_names_file_and_line(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", list(sys.path))
    (tmp_path / "half_a_task.py").write_text("value = 1\n\nraise KeyError('mug')\n")
    with pytest.raises(rc.SpecError) as raised:
        import_module("half_a_task.py", tmp_path)
    assert f"KeyError: 'mug' ({tmp_path / 'half_a_task.py'}:3" in str(raised.value)
    assert "half_a_task" not in sys.modules
    (tmp_path / "no_python.py").write_text("def\n")
    with pytest.raises(rc.SpecError, match=r"SyntaxError: .*no_python\.py:1\)"):
        import_module("no_python.py", tmp_path)


def test_a_missing_module_error_explains_the_next_step(tmp_path):
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


def test_rejects_folders_as_modules(tmp_path, monkeypatch):
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


@pytest.mark.parametrize(
    ("name", "said"),
    [
        (".", r"is a folder without an __init__\.py; name a file in it, such as .*stack\.py"),
        ("press.yaml", r"it is no Python file; name a module \(tasks\) or its file \(tasks\.py\)"),
        ("./press.yaml", "it is no Python file"),
        ("..stack", "it is no module's name; name a module"),
        ("my-tasks", "it is no module's name; name a module"),
    ],
)
def test_rejects_names_that_are_no_modules(tmp_path: Path, name: str, said: str):
    (tmp_path / "stack.py").write_text("")
    (tmp_path / "press.yaml").write_text("")
    with pytest.raises(rc.SpecError, match=f"cannot import '.*': .*{said}"):
        import_named(name, tmp_path)


def test_a_python_file_is_no_run_file(module):
    with pytest.raises(rc.SpecError, match=rf"is Python: write {module}\.py:NAME, .*RunConfig"):
        RunSource(f"{module}.py").load()
    Path("tasks_alone.py").write_text("")
    with pytest.raises(rc.NotFoundError, match=r"no 'run'\. Name a RunConfig in it, or a function"):
        RunSource("tasks_alone.py:run").load()


def test_a_missing_configuration_error_lists_the_functions_of_the_module(tmp_path: Path):
    file = tmp_path / "stacking.py"
    file.write_text("def config(): ...\ndef _hidden(): ...\ndef judge(scene): ...\n")
    with pytest.raises(rc.NotFoundError, match=r"Its functions: config\.$"):
        RunSource(f"{file}:my_run").load()


def test_an_unknown_kind_names_the_imports_of_the_run_file(tmp_path):
    file = tmp_path / "run.yaml"
    file.write_text("run: a\nrobot: rc7\ntask: {kind: weld}\noutput: out\n")
    with pytest.raises(rc.SpecError, match=r"--import, or in the run file: imports: \[tasks\.py\]"):
        RunSource(str(file)).load()


def test_import_errors_name_the_place_in_the_run_file(tmp_path):
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


def test_rejects_another_file_with_the_name_of_a_loaded_module(tmp_path):
    (tmp_path / "pytest.py").write_text("")
    with pytest.raises(rc.SpecError, match="a module 'pytest' is loaded from"):
        import_module("pytest.py", tmp_path)


def test_another_process_gets_the_same_source():
    source = RunSource("my.py:run", ("a", "b.py"), "random")
    parser = argparse.ArgumentParser()
    RunSource.add_options(parser)
    assert RunSource.of(parser.parse_args([*source.options(), "--", source.run])) == source


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
def test_rejects_names_of_modules_in_use(tmp_path: Path, name: str, whose: str):
    (tmp_path / name).write_text("x = 1\n")
    module = name.removesuffix(".py")
    before = sys.modules.get(module)
    with pytest.raises(rc.SpecError) as raised:
        import_named(name, tmp_path)
    said = whose if " " in whose else f"of {whose} itself"
    assert f"'{module}' is the name of a module {said}" in str(raised.value)
    assert f"such as my_{module}.py" in str(raised.value)
    assert sys.modules.get(module) is before


def test_reports_file_and_line_of_a_module_that_exits(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", list(sys.path))
    file = tmp_path / "exits_at_once.py"
    file.write_text("import sys\n\n\nsys.exit(0)\n")
    with pytest.raises(rc.SpecError) as raised:
        import_module("exits_at_once.py", tmp_path)
    assert f"SystemExit: 0 ({file}:4, in <module>)" in str(raised.value)


def test_an_import_keeps_the_working_folder(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.chdir(tmp_path)
    for name, then in (("goes_away", ""), ("goes_and_raises", "raise KeyError('a')\n")):
        (tmp_path / f"{name}.py").write_text(f"import os\n\nos.chdir('/')\n{then}")
        with contextlib.suppress(rc.SpecError):
            import_module(f"{name}.py", tmp_path)
        assert Path.cwd() == tmp_path


def test_a_source_can_be_made_absolute(module, tmp_path):
    (tmp_path / "run.yaml").touch()
    source = RunSource("run.yaml", ("a.py",))
    assert source.absolute() == RunSource(str(tmp_path / "run.yaml"), ("a.py",))
    assert RunSource(f"{module}:run").absolute() == RunSource(f"{module}:run")


def test_errors_beside_exception_in_a_module_have_a_place_too(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", list(sys.path))
    (tmp_path / "cancelled_task.py").write_text(
        "import asyncio\nraise asyncio.CancelledError('late')\n"
    )
    with pytest.raises(rc.SpecError, match=r"CancelledError: late \(.*cancelled_task\.py:2"):
        import_module("cancelled_task.py", tmp_path)
    (tmp_path / "interrupted_task.py").write_text("raise KeyboardInterrupt\n")
    with pytest.raises(KeyboardInterrupt):
        import_module("interrupted_task.py", tmp_path)


def test_rejects_paths_that_are_not_utf_8(tmp_path, monkeypatch):
    said = r"the path '.*b\\xffd.*' is not valid UTF-8, in which datasets and run files are written"
    monkeypatch.chdir(tmp_path)
    (tmp_path / "run.yaml").write_text("run: a\n")
    folder = os.fsdecode(b"b\xffd")
    (tmp_path / folder).mkdir()
    for make in (
        lambda: RunSource(f"{folder}/run.yaml"),
        lambda: RunSource("run.yaml", (f"{folder}/tasks.py",)),
        lambda: Job(Path("run.yaml"), [f"output={json.dumps(folder)}"]),
        lambda: Job(Path("run.yaml"), [f"output={folder}"]),
        lambda: evaluate("run.yaml", "random", output=folder),
        lambda: evaluate(folder, "random"),
    ):
        with pytest.raises(rc.ArgumentError, match=said):
            make()
    monkeypatch.chdir(tmp_path / folder)
    with pytest.raises(rc.ArgumentError, match=said):
        RunSource("../run.yaml")
