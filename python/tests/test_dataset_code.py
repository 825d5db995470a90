"""A dataset's environment, evaluation and replay need the code that made it: all of its modules."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import robocell as rc
from robocell._dataset_run import run_of_dataset
from robocell._generation.run_source import RunSource
from robocell._own_code import modules_of_one_run
from robocell.envs import from_dataset

TASK = """
import robocell as rc

class Waits(rc.tasks.Task):
    def judge(self, scene):
        return rc.tasks.TaskVerdict(0.5, True)
    def instruction(self):
        return "wait"

class Waiting(rc.tasks.Expert):
    def __init__(self, run, start):
        super().__init__()
        self.left = 3
    def begin(self, scene, rng): ...
    def act(self, scene, rng):
        self.left -= 1
        return {"rc7": {"gripper": rc.control.GroupCommand.opening(0.5)}}
    def done(self):
        return self.left <= 0
    def failure(self):
        return ""
    def phase(self):
        return 0
    def phase_names(self):
        return ["wait"]

rc.register_task("waits_NUMBER")(Waits)
rc.tasks.register_expert("waits_NUMBER")(Waiting)
"""
PATCH = "import {task}\n{task}.Waits.instruction = lambda self: 'patched'\n"
RUN = """
run: waits
robot: {robot}
task: {{kind: waits_{number}}}
imports: [{task}.py, {patch}.py]
scenes: {{source: tabletop}}
episodes: 1
output: out
"""
ACTS = """
from robocell.policy import Policy
class Waits(Policy):
    def act(self, observation):
        return {"robots/rc7/action/gripper": 0.3}
"""


class Made:
    """A dataset of a task in one module that another one changes."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.number = folder, abs(hash(folder))
        self.task, self.patch = f"task_{self.number}", f"patch_{self.number}"
        (folder / f"{self.task}.py").write_text(TASK.replace("NUMBER", str(self.number)))
        (folder / f"{self.patch}.py").write_text(PATCH.format(task=self.task))
        robot = rc.models.robot_file("rc7")
        text = RUN.format(robot=robot, task=self.task, patch=self.patch, number=self.number)
        (folder / "run.yaml").write_text(text)
        run = RunSource(str(folder / "run.yaml")).load()
        rc.generate.prepare_dataset(run)
        rc.generate.Runner(run).run(rc.generate.make_plan(run)[0])
        self.dataset = Path(run.output)
        assert rc.Dataset(self.dataset)[0].metadata["instruction"] == "patched"
        self.forget()

    def forget(self) -> None:
        for name in (self.task, self.patch):
            sys.modules.pop(name, None)


@pytest.fixture
def made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Made]:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    with modules_of_one_run():
        made = Made(tmp_path)
        yield made
    made.forget()


def evaluated(made: Made, imports: list[str], policy: str) -> rc.RunConfig:
    return RunSource(str(made.dataset), tuple(imports), policy).load(["output=evaluated"])


@pytest.mark.proof
def test_all_modules_of_the_run_give_its_environment(made: Made):
    env = from_dataset(made.dataset, imports=[f"{made.task}.py", f"{made.patch}.py"])
    assert env.reset(seed=0)[1]["instruction"] == "patched"
    (made.folder / f"acts_{made.number}.py").write_text(ACTS)
    run = evaluated(made, [made.task, made.patch], f"acts_{made.number}:Waits")
    assert run.expert == f"acts_{made.number}:Waits"


def test_rejects_a_module_that_is_not_imported(made: Made):
    said = rf"the code that made '.*' had '{made.patch}\.py' too, which is not imported here"
    with pytest.raises(rc.SpecError, match=said):
        from_dataset(made.dataset, imports=[made.task])
    with pytest.raises(rc.SpecError, match=said):
        evaluated(made, [made.task], "expert")
    sys.path.append(str(made.folder))
    __import__(made.patch)  # however it is imported
    from_dataset(made.dataset)


def test_rejects_a_module_that_changed(made: Made):
    with (made.folder / f"{made.patch}.py").open("a") as file:
        file.write("LIMIT = 2\n")
    said = rf"made with other code: .*{made.patch}\.py changed since then"
    imports = [made.task, made.patch]
    with pytest.raises(rc.SpecError, match=said):
        from_dataset(made.dataset, imports=imports)
    with pytest.raises(rc.SpecError, match=said):
        run_of_dataset(made.dataset, imports)
    with pytest.raises(rc.SpecError, match=said):
        evaluated(made, imports, "expert")


def test_code_of_an_expert_that_is_not_registered_is_not_needed(made: Made, monkeypatch):
    kinds = [kind for kind in rc.tasks.expert_kinds() if kind != f"waits_{made.number}"]
    monkeypatch.setattr("robocell._dataset_run.expert_kinds", lambda: kinds)
    env = from_dataset(made.dataset, imports=[made.task])
    row, _ = env.reset(seed=0)
    recorded = rc.Dataset(made.dataset)[0]
    for name in env.observations:
        assert np.array_equal(row[name], recorded[name][0]), name


def test_rejects_a_policy_whose_module_registers_another_task(made: Made):
    module = f"replaces_{made.number}"
    (made.folder / f"{module}.py").write_text(
        ACTS + f"import {made.task}, robocell as rc\n"
        f"rc.register_task('waits_{made.number}')(type('Other', ({made.task}.Waits,), {{}}))\n"
    )
    with (
        pytest.warns(UserWarning, match=rf"{made.task}\.py' is replaced by .*{module}\.py'"),
        pytest.raises(rc.SpecError, match=rf"made with other code: .*{module}\.py"),
    ):
        evaluated(made, [made.task, made.patch], f"{module}:Waits")
