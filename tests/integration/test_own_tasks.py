"""A task and an expert of a user's module, through the command line like a built-in one."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import ROOT, generate, refusal, robocell_command

import robocell as rc
from made_once import made_once
from robocell._generation.run_source import RunSource
from robocell._own_code import own_sources

EXAMPLE = ROOT / "examples" / "stack_cubes.py"
RC7 = ROOT / "models" / "robots" / "rc7" / "rc7.yaml"


@pytest.fixture
def run_file(tmp_path: Path) -> Path:
    """A copy of the example, which a test may change."""
    return copy_example(tmp_path)


def copy_example(folder: Path) -> Path:
    """The example's run file with its module, which need nothing else of their folder."""
    shutil.copy(EXAMPLE, folder)
    text = (ROOT / "examples" / "stack_cubes.yaml").read_text()
    text = text.replace("../models/robots/rc7/rc7.yaml", str(RC7))
    (folder / "stack_cubes.yaml").write_text(text)
    return folder / "stack_cubes.yaml"


@pytest.fixture(scope="module")
def stacked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two episodes of the example, made by one worker. No test may change it."""

    def make(folder: Path) -> None:
        generate(copy_example(folder), folder / "out", "--workers", 1, "--episodes", 2)

    return made_once(tmp_path_factory, "stacked", make) / "out"


def files_of(folder: Path) -> dict[str, bytes]:
    return {
        f"{file.parent.name}/{file.name}": file.read_bytes()
        for file in sorted(folder.glob("s*/steps.h5"))
    }


def test_any_number_of_workers_stacks_cubes(stacked: Path, run_file: Path, tmp_path: Path):
    generate(run_file, tmp_path / "two", "--workers", 2, "--episodes", 2)
    dataset = rc.Dataset(tmp_path / "two")
    assert len(dataset) == 2
    for episode in dataset:
        assert episode.success
        assert episode.metadata["task"] == "red_on_blue"
        assert episode.metadata["instruction"] == "put the red cube on the blue one"
        red, blue = episode["objects/red/pose"][-1], episode["objects/blue/pose"][-1]
        assert red[2] - blue[2] == pytest.approx(0.04, abs=0.003)
        assert rc.data.verify_replay(episode).ok
    assert files_of(tmp_path / "two") == files_of(stacked)


def test_a_dataset_of_a_custom_task_has_an_environment(
    stacked: Path, run_file: Path, tmp_path: Path
):
    """In an environment of its own, the recorded actions give the recorded rows and success."""
    script = tmp_path / "act.py"
    script.write_text(
        "import json\nimport sys\nimport numpy as np\nimport robocell as rc\n"
        "from robocell.envs import from_dataset\n"
        "dataset = rc.Dataset(sys.argv[1])\n"
        "env = from_dataset(dataset, imports=[sys.argv[2]], privileged=True)\n"
        "for index, episode in enumerate(dataset):\n"
        "    row, info = env.reset(seed=index)\n"
        "    assert info['instruction'] == episode.metadata['instruction']\n"
        "    columns = {name: episode[name] for name in [*env.observations, *env.actions]}\n"
        "    equal = done = 0\n"
        "    while not done:\n"
        "        for name in env.observations:\n"
        "            assert np.array_equal(columns[name][equal], row[name]), (equal, name)\n"
        "        action = {name: columns[name][equal] for name in env.actions}\n"
        "        row, _, terminated, truncated, info = env.step(action)\n"
        "        done, equal = terminated or truncated, equal + 1\n"
        "    print(json.dumps([equal, len(episode), info['is_success'], len(env.observations)]))\n"
    )
    words = [sys.executable, script, stacked, run_file.with_name("stack_cubes.py")]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    acted = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(acted) == 2
    for equal, rows, success, observations in acted:
        assert (equal, success) == (rows, True)
        assert observations > 5


@pytest.mark.proof  # as tasks of robocell's own in test_generate.py
def test_a_custom_task_can_be_sharded_and_planned(stacked: Path, run_file: Path, tmp_path: Path):
    """Shards of one output make what one command makes, and a dry run makes nothing."""
    words = ("--workers", 1, "--episodes", 2)
    for shard in ("0/2", "1/2"):
        generate(run_file, tmp_path / "shards", *words, "--shard", shard)
    assert len(files_of(tmp_path / "shards")) == 2
    assert files_of(tmp_path / "shards") == files_of(stacked)
    dry = tmp_path / "dry"
    result = robocell_command("generate", run_file, "--output", dry, "--dry-run", *map(str, words))
    assert result.returncode == 0, result.stderr
    said = " ".join(result.stdout.split())
    assert "2 episodes" in said
    assert not dry.exists()


@pytest.mark.proof  # as tasks of robocell's own in test_generate.py
def test_a_killed_run_resumes(run_file: Path, tmp_path: Path):
    out = tmp_path / "out"
    words = ["generate", str(run_file), "--output", str(out), "--workers", "2", "--episodes", "4"]
    process = subprocess.Popen(
        [*[sys.executable, "-m", "robocell"], *words],
        start_new_session=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    deadline = time.monotonic() + 120
    while not list(out.glob("s*/episode.json")) and time.monotonic() < deadline:
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    made = files_of(out)
    assert made
    generate(run_file, out, "--workers", 2, "--episodes", 4)
    again = files_of(out)
    assert len(again) == 4
    assert made.items() <= again.items()


def test_a_dataset_records_the_hash_of_its_code(stacked: Path, run_file: Path, tmp_path: Path):
    out = shutil.copytree(stacked, tmp_path / "out")
    module = run_file.with_name("stack_cubes.py")
    module.write_text(module.read_text().replace("self.edge / 3", "self.edge / 4"))
    said = refusal("generate", run_file, "--output", out, "--episodes", "3")
    assert "code file stack_cubes.py: changed since then" in said
    # Those who read a dataset need no code.
    module.unlink()
    assert robocell_command("verify", out).returncode == 0
    assert "2 episodes" in robocell_command("report", out).stdout


def test_a_module_can_be_imported_from_the_command_line(run_file: Path, tmp_path: Path):
    text = run_file.read_text().replace("imports: [stack_cubes.py]\n", "")
    run_file.write_text(text)
    said = refusal("generate", run_file, "--output", tmp_path / "out")
    assert "no task 'red_on_blue'" in said
    assert "--import" in said
    module = run_file.with_name("stack_cubes.py")
    generate(run_file, tmp_path / "out", "--import", module, "--workers", 1, "--episodes", 1)
    assert len(rc.Dataset(tmp_path / "out")) == 1


def test_a_configuration_can_be_built_in_python(run_file: Path, tmp_path: Path):
    module = run_file.with_name("cell.py")
    module.write_text(
        "import robocell as rc\nimport stack_cubes\n\n\n"
        "def config():\n"
        "    run = rc.RunConfig(run='made', episodes_per_scene=1, output='out')\n"
        f"    run.robot = rc.RobotConfig.load({str(RC7)!r})\n"
        "    run.task = {'kind': 'red_on_blue', 'edge': 0.05}\n"
        "    return run\n"
    )
    generate(f"{module}:config", tmp_path / "out", "--workers", 2, "--seed", 3)
    episode = rc.Dataset(tmp_path / "out")[0]
    assert episode.metadata["seed"] == 3
    manifest = json.loads((tmp_path / "out" / "dataset.json").read_text())
    assert {"code/cell.py", "code/stack_cubes.py"} & set(manifest["files"])
    assert "has no 'confg'" in refusal("generate", f"{module}:confg", "--output", tmp_path / "no")


@pytest.mark.parametrize(
    ("code", "message"),
    [
        ("import not_there_at_all\n", "No module named 'not_there_at_all'"),
        ("def f(:\n", "SyntaxError"),
        ("x = 1\nraise ValueError('no cubes')\n", "ValueError: no cubes"),
    ],
)
def test_an_import_that_fails_ends_the_run_first(
    run_file: Path, tmp_path: Path, code: str, message: str
):
    run_file.with_name("stack_cubes.py").write_text(code)
    said = refusal("generate", run_file, "--output", tmp_path / "out")
    assert message in said
    assert "stack_cubes.py" in said
    assert not (tmp_path / "out").exists()


def test_an_exception_of_a_task_names_its_line(run_file: Path, tmp_path: Path):
    module = run_file.with_name("stack_cubes.py")
    text = module.read_text().replace(
        "aside = float(np", 'raise RuntimeError("out of cubes")\n        aside = float(np'
    )
    module.write_text(text)
    line = 1 + text[: text.index("raise RuntimeError")].count("\n")
    result = robocell_command("generate", run_file, "--output", tmp_path / "out", "--episodes", "1")
    assert result.returncode == 1
    said = " ".join((result.stdout + result.stderr).split())
    assert "RuntimeError: out of cubes" in said
    assert f"stack_cubes.py:{line}, in judge" in said


@pytest.mark.proof  # as the exception above
def test_a_none_result_error_names_the_function(run_file: Path, tmp_path: Path):
    module = run_file.with_name("stack_cubes.py")
    text = module.read_text().replace(
        "return rc.tasks.TaskVerdict(", "return None and rc.tasks.TaskVerdict("
    )
    module.write_text(text)
    line = 1 + text[: text.index("def judge")].count("\n")
    result = robocell_command("generate", run_file, "--output", tmp_path / "out", "--episodes", "1")
    assert result.returncode == 1
    said = " ".join((result.stdout + result.stderr).split())
    assert "Stack.judge() must return a TaskVerdict, got None" in said
    assert f"stack_cubes.py:{line}, in judge" in said


def test_a_run_source_imports_only_the_given_modules(tmp_path: Path):
    with pytest.raises(rc.SpecError, match="there is no such file"):
        RunSource(str(tmp_path / "run.yaml"), ("gone.py",)).load()
    with pytest.raises(rc.SpecError, match="no such module"):
        RunSource(str(tmp_path / "run.yaml"), ("gone_module",)).load()


@pytest.mark.proof  # as the exception above
def test_errors_raised_in_user_code_name_its_line(run_file: Path, tmp_path: Path):
    module = run_file.with_name("stack_cubes.py")
    text = module.read_text().replace(
        "aside = float(np", 'scene.body_pose("cubee")\n        aside = float(np'
    )
    module.write_text(text)
    line = 1 + text[: text.index('scene.body_pose("cubee")')].count("\n")
    result = robocell_command("generate", run_file, "--output", tmp_path / "out", "--episodes", "1")
    said = " ".join((result.stdout + result.stderr).split())
    assert "no body 'cubee'" in said
    assert f"stack_cubes.py:{line}, in judge" in said


def test_an_exception_ends_a_rollout_and_the_next_one_starts(run_file: Path, tmp_path: Path):
    module = run_file.with_name("stack_cubes.py")
    text = module.read_text().replace(
        "def act(\n",
        "def begin(self, scene, rng):\n"
        "        Stacker.begun = getattr(Stacker, 'begun', 0) + 1\n"
        "        if Stacker.begun < 3:\n"
        "            raise RuntimeError('not today')\n"
        "        super().begin(scene, rng)\n\n"
        "    def act(\n",
        1,
    )
    module.write_text(text)
    generate(run_file, tmp_path / "out", "--workers", 1, "--episodes", 1)
    (episode,) = rc.Dataset(tmp_path / "out")
    earlier = episode.metadata["earlier_attempts"]
    raised = [attempt["failed"] for attempt in earlier if "failed" in attempt]
    assert len(raised) == 2
    assert all("RuntimeError: not today" in reason for reason in raised)


def evaluated(run_file: Path, output: Path, episodes: int, code: int) -> dict[str, Any]:
    words = ("--policy", "expert", "-n", episodes, "--no-cameras", "--json", "--output", output)
    result = robocell_command("evaluate", run_file, *words)
    assert result.returncode == code, result.stdout + result.stderr
    return json.loads(result.stdout)


@pytest.mark.proof  # policies that raise are in test_policy.py
def test_in_an_evaluation_an_expert_that_raises_fails(run_file: Path, tmp_path: Path):
    """Generation takes another start; an evaluation does not, for the sake of the comparison."""
    module = run_file.with_name("stack_cubes.py")
    text = module.read_text()
    whole = evaluated(run_file, tmp_path / "whole", 3, 0)
    assert whole["policy_errors"] == 0
    broken = text.replace(
        "def act(\n",
        "def begin(self, scene, rng):\n"
        "        red, blue = (scene.body_pose(name).translation[1] for name in ('red', 'blue'))\n"
        "        if red > blue:\n"
        "            raise RuntimeError('not this side')\n"
        "        super().begin(scene, rng)\n\n"
        "    def act(\n",
        1,
    )
    module.write_text(broken)
    line = 1 + broken[: broken.index("raise RuntimeError")].count("\n")
    result = evaluated(run_file, tmp_path / "broken", 3, 0)
    assert (result["rollouts"], result["unmade"]) == (3, 0)
    assert 0 < result["policy_errors"] < 3
    for episode in rc.Dataset(tmp_path / "broken"):
        twin = rc.Dataset(tmp_path / "whole")[episode.id]
        for column in ("objects/red/pose", "objects/blue/pose"):
            assert np.array_equal(episode[column][0], twin[column][0])
        if episode["objects/red/pose"][0, 1] > episode["objects/blue/pose"][0, 1]:
            assert episode.end_reason.startswith("policy error: RuntimeError: not this side (")
            assert episode.end_reason.endswith(f"stack_cubes.py:{line}, in begin)")
        else:
            assert len(episode) == len(twin), "the guard changes nothing"


@pytest.mark.proof  # as the expert above
def test_in_an_evaluation_a_task_that_raises_costs_the_rollout(run_file: Path, tmp_path: Path):
    module = run_file.with_name("stack_cubes.py")
    text = module.read_text().replace(
        "aside = float(np", 'raise RuntimeError("out of cubes")\n        aside = float(np'
    )
    module.write_text(text)
    words = ("--policy", "expert", "-n", "1", "--no-cameras", "--output", tmp_path / "out")
    result = robocell_command("evaluate", run_file, *words)
    said = " ".join(result.stderr.split())
    assert result.returncode != 0
    assert "something else than the policy raised in the rollout" in said
    assert "RuntimeError: out of cubes" in said
    assert "errors of the policy" not in said, "there was no rollout"
    assert not list((tmp_path / "out").glob("s*"))


def test_overrides_of_a_configuration_keep_the_folders_of_its_files(tmp_path: Path):
    (tmp_path / "cell_of_test.py").write_text(
        "import robocell as rc\n"
        f"config = rc.RunConfig.load({str(ROOT / 'examples' / 'demo.yaml')!r})\n"
    )
    source = RunSource(f"{tmp_path / 'cell_of_test.py'}:config")
    run = source.load(["robot.gravcomp=false", "seed=7"])
    assert run.seed == 7
    assert run.robot.gravcomp is False
    rc.diagnose.check_run(run)


@pytest.mark.proof
def test_a_dataset_environment_requires_the_original_code(
    stacked: Path, run_file: Path, tmp_path: Path
):
    out = shutil.copytree(stacked, tmp_path / "out")
    module = run_file.with_name("stack_cubes.py")
    words = ("evaluate", out, "--policy", "expert", "-n", "1", "--import", module)
    said = robocell_command(*words, "--output", tmp_path / "same")
    assert said.returncode == 0, said.stderr
    replay = robocell_command("replay", out, "--import", module)
    assert replay.returncode == 0, replay.stderr
    assert "code: unchanged since the dataset was made" in replay.stdout
    module.write_text(module.read_text() + "\n# changed\n")
    said = refusal(*words, "--output", tmp_path / "changed")
    assert "stack_cubes.py changed since then" in said
    said = refusal("replay", out, "--import", module)
    assert "stack_cubes.py changed since then" in said
    assert "Without --import only the recorded controls are simulated" in said
    assert robocell_command("replay", out).returncode == 0, "it needs no code"


def test_a_missing_task_error_explains_how_to_import_it(stacked: Path):
    code = f"from robocell.envs import from_dataset\nfrom_dataset({str(stacked)!r})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    for said in (done.stderr, refusal("evaluate", stacked, "--policy", "expert")):
        assert "no task 'red_on_blue'" in said
        assert "name it with --import my_tasks.py on the command line" in said
        assert "or with imports=['my_tasks.py'] in Python" in said


def test_imported_modules_are_part_of_the_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    for name, text in {
        "sizes_of_test.py": "EDGE = 0.04\n",
        "late_of_test.py": "LATE = 1\n",
        "kit_of_test/__init__.py": "",
        "kit_of_test/tools.py": "from . import parts\n",
        "kit_of_test/parts.py": "PART = 2\n",
        "main_of_test.py": "from sizes_of_test import EDGE\nimport kit_of_test.tools\n"
        "def f():\n    from late_of_test import LATE\n    return LATE\n",
    }.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    import importlib

    importlib.import_module("main_of_test")
    names = {str(path.relative_to(tmp_path)) for path in own_sources("main_of_test")}
    assert names == {
        "sizes_of_test.py",
        "late_of_test.py",
        "main_of_test.py",
        "kit_of_test/__init__.py",
        "kit_of_test/tools.py",
        "kit_of_test/parts.py",
    }


def test_code_files_with_equal_names_are_all_recorded(tmp_path: Path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    for folder in ("a", "b"):
        (tmp_path / folder / "weights.txt").write_text(folder)
    rc.tasks.register_expert(
        "two_files_of_test", files=[tmp_path / f / "weights.txt" for f in "ab"]
    )(lambda run, start: rc.tasks.PickPlanner(run, start))
    run = rc.RunConfig.load(ROOT / "examples" / "demo.yaml")
    run.cameras.streams.clear()
    run.expert, run.output = "two_files_of_test", str(tmp_path / "out")
    rc.generate.prepare_dataset(run)
    files = json.loads((tmp_path / "out" / "dataset.json").read_text())["files"]
    assert {"code/weights.txt", "code/weights.txt (2)"} <= set(files)


MINI_LIBRARY = """
import robocell as rc


class Mini(rc.tasks.Task):
    def prepare(self, spec, rng):
        ball = rc.SceneObject(name="ball", shape=rc.Shape.SPHERE, size=[0.03, 0, 0], mass=0.05)
        ball.rgba, ball.friction = [1, 0.5, 0, 1], [1, 0.02, 0.001]
        spec.objects.append(ball)

    def judge(self, scene):
        return rc.tasks.TaskVerdict(reward=0.5, success=True)

    def instruction(self):
        return "open the hand"

    def objects(self):
        return ["ball"]


class Opens(rc.tasks.Expert):
    def __init__(self, run, start, opening=1.0):
        super().__init__()
        self.left, self.opening = 5, opening

    def begin(self, scene, rng):
        pass

    def act(self, scene, rng):
        self.left -= 1
        return {"rc7": {"gripper": rc.control.GroupCommand.opening(self.opening)}}

    def done(self):
        return self.left <= 0

    def failure(self):
        return ""

    def phase(self):
        return 0

    def phase_names(self):
        return ["hold"]
"""
MINI_TASKS = """
import functools

import mini_library as lib

import robocell as rc

rc.register_task("mini")(lib.Mini)
rc.tasks.register_expert("mini")(functools.partial(lib.Opens, opening=1.0))
"""
MINI_RUN = f"""
run: mini
imports: [mini_tasks.py, mini_changes.py]
robot: {RC7}
task: {{kind: mini}}
scenes: {{source: tabletop}}
episodes: 2
workers: 1
max_attempts: 2
"""


@pytest.fixture
def mini(tmp_path: Path) -> Path:
    """A run whose task is in one module, is registered by another, and changed by a third."""
    (tmp_path / "mini_library.py").write_text(MINI_LIBRARY)
    (tmp_path / "mini_tasks.py").write_text(MINI_TASKS)
    (tmp_path / "mini_changes.py").write_text("import mini_library\n\nmini_library.LENGTH = 5\n")
    (tmp_path / "mini.yaml").write_text(MINI_RUN)
    return tmp_path / "mini.yaml"


@pytest.mark.proof  # which modules these are, is above and in test_own_code.py
def test_every_imported_module_is_part_of_the_run(mini: Path, tmp_path: Path):
    out = tmp_path / "out"
    generate(mini, out, "--episodes", 1)
    files = json.loads((out / "dataset.json").read_text())["files"]
    assert {"code/mini_library.py", "code/mini_tasks.py", "code/mini_changes.py"} <= set(files)
    for name, old, new in (
        ("mini_tasks.py", "opening=1.0", "opening=0.25"),
        ("mini_changes.py", "LENGTH = 5", "LENGTH = 6"),
    ):
        module = mini.with_name(name)
        text = module.read_text()
        module.write_text(text.replace(old, new))
        said = refusal("generate", mini, "--output", out, "--episodes", 2)
        assert f"code file {name}: changed since then" in said
        module.write_text(text)
    generate(mini, out, "--episodes", 2)
    assert len(rc.Dataset(out)) == 2


def test_code_can_change_the_working_folder(
    mini: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """At its import and in its methods; the command's paths stay those of its own folder."""
    monkeypatch.chdir(tmp_path)
    module = mini.with_name("mini_library.py")
    text = "import os\n\nos.chdir('/')\n" + module.read_text()
    module.write_text(text.replace("self.left -= 1", "self.left -= 1\n        os.chdir('/')"))
    generate(Path("mini.yaml"), Path("out"), "--episodes", 1)
    assert len(rc.Dataset(tmp_path / "out")) == 1
