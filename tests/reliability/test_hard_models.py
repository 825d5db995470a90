"""Models that are hard on the engine: files that crashed or stalled a version of it, or still do.

Each file of hard_models/ is under one of the headings below, which say what MuJoCo 4.0.0 does with
it. A version that does something else fails a test here: then the file belongs under another one.
"""

from __future__ import annotations

import json
import re
import resource
import shlex
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest
import storm
import yaml
from processes import bare_environment

import robocell
from command_line import robocell_command

MODELS = Path(__file__).parent / "hard_models"
GIGABYTE = 1 << 30

# End the process that reads them.
CRASHING = {
    "attaches_itself": signal.SIGSEGV,
    "attach_circle_a": signal.SIGSEGV,
    "attach_circle_b": signal.SIGSEGV,
    "hfield_overflow": signal.SIGSEGV,
}
# Take hours, and ever more memory.
STALLING = ["replicate_a_billion", "replicate_in_replicate"]
# The engine's library throws C++ exceptions, which ended the process before robocell caught them.
THREW = r"the engine threw a C\+\+ exception, as it does when a size is too large for the memory"
THROWING = {
    "mesh_plate_too_fine": rf"scene 's' / base: .*mesh_plate_too_fine.xml.*: {THREW}",
    "hfield_beyond_memory": rf"scene 's' / base: .*hfield_beyond_memory.xml.*: {THREW}",
    "user_data_beyond_memory": f"scene 's': building the model: {THREW}",
}
# Refused with the engine's reason. Neighbours of crashes: indices and sizes out of range.
REFUSED = {
    "texture_beyond_memory": "Could not allocate memory for texture",
    "size_beyond_memory": "Could not allocate memory",
    "includes_itself": r"includes_itself.xml.*already included",
    "mesh_face_out_of_range": r"in face 0, vertex index 99999999 does not exist",
    "mesh_with_nan": r"mesh_with_nan.xml:2: vertex=.* nan .* is not a number",
    "skin_out_of_range": "face vertex index 7777777 out of range in skin",
}
# Crashed earlier versions, and are harmless now.
LOADING = ["mesh_unused_convex", "attach_in_replicate"]
PARTS = ["attach_in_replicate_middle", "attach_in_replicate_part"]  # read by others

BUILD = """
import sys, robocell
spec = robocell.SceneSpec(name="s", timestep=0.002, add_floor=False, add_skybox=False)
spec.base = sys.argv[1]
try:
    scene = robocell.Scene.build(spec)
    scene.step_n(10)
except robocell.Error as error:
    print(type(error).__name__, error)
else:
    print("built")
after = robocell.SceneSpec(name="after", timestep=0.002, add_floor=True, add_skybox=False)
robocell.Scene.build(after)
"""
READ = "import sys, mujoco; mujoco.MjModel.from_xml_path(sys.argv[1])"


def limit_memory() -> None:
    """So that a large size is too large on a machine of any size; no core files."""
    resource.setrlimit(resource.RLIMIT_AS, (4 * GIGABYTE, 4 * GIGABYTE))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def in_a_process(code: str, model: str, timeout_s: float = 120) -> subprocess.CompletedProcess[str]:
    """Lets a process have the model's path."""
    return subprocess.run(
        [sys.executable, "-c", code, str(MODELS / f"{model}.xml")],
        env=bare_environment(),
        capture_output=True,
        text=True,
        timeout=timeout_s,
        preexec_fn=limit_memory,
    )


def test_every_file_is_under_one_heading():
    headings = [*CRASHING, *STALLING, *THROWING, *REFUSED, *LOADING, *PARTS]
    assert sorted(headings) == sorted(file.stem for file in MODELS.glob("*.xml"))
    assert all((MODELS / f"{name}.xml").stat().st_size < 1000 for name in headings)


# The circles are one kind of crash.
@pytest.mark.parametrize("code", [READ, BUILD], ids=["mujoco", "robocell"])
@pytest.mark.parametrize(
    "model",
    [pytest.param(name, marks=pytest.mark.proof if "circle" in name else ()) for name in CRASHING],
)
def test_some_models_crash_the_engine(model: str, code: str):
    assert in_a_process(code, model).returncode == -CRASHING[model]


@pytest.mark.parametrize("model", [STALLING[0], pytest.param(STALLING[1], marks=pytest.mark.proof)])
def test_some_models_stall_the_engine(model: str):
    with pytest.raises(subprocess.TimeoutExpired):
        in_a_process(READ, model, timeout_s=3)


@pytest.mark.parametrize(("model", "said"), THROWING.items())
def test_an_engine_exception_becomes_an_error_and_the_process_survives(model: str, said: str):
    done = in_a_process(BUILD, model)
    assert done.returncode == 0, done.stderr
    assert re.match(f"EngineError {said}", done.stdout), done.stdout


@pytest.mark.parametrize(("model", "said"), REFUSED.items())
def test_models_rejected_by_the_engine_give_an_error_with_the_reason(model: str, said: str):
    done = in_a_process(BUILD, model)
    assert done.returncode == 0, done.stderr
    assert re.match(f"SpecError scene 's'.*{said}", done.stdout), done.stdout


@pytest.mark.parametrize("model", LOADING)
def test_models_that_crashed_before_build(model: str):
    done = in_a_process(BUILD, model)
    assert (done.returncode, done.stdout) == (0, "built\n"), done.stderr


def test_rejects_elements_nested_too_deeply(tmp_path: Path):
    deep = tmp_path / "deep.xml"
    deep.write_text(f"<mujoco><worldbody>{'<body>' * 100_000}{'</body>' * 100_000}")
    done = in_a_process(BUILD, str(deep.with_suffix("")))
    assert done.returncode == 0, done.stderr
    assert "element nesting is too deep" in done.stdout


def test_a_scene_whose_object_was_removed_can_be_saved(tmp_path: Path):
    """google-deepmind/mujoco#2327: saving after a body was removed crashed 3.2.6."""
    spec = robocell.SceneSpec(name="s", timestep=0.002, add_floor=True, add_skybox=False)
    for name in ("stays", "goes"):
        spec.objects.append(
            robocell.SceneObject(
                name=name, shape="sphere", size=[0.02] * 3, rgba=[1] * 4, mass=0.1,
                friction=[0.8, 0.02, 0.001], pos=[0.1 * len(name), 0, 0.1],
            )
        )  # fmt: skip
    scene = robocell.Scene.build(spec)
    scene.remove_object("goes")
    scene.save_xml(tmp_path / "saved.xml")
    text = (tmp_path / "saved.xml").read_text()
    assert "stays" in text
    assert "goes" not in text


GOOD = ["good_0", "good_1", "good_2"]


def generate_with(
    folder: Path, models: Sequence[str], *options: object
) -> subprocess.CompletedProcess[str]:
    """Runs the command over scenes of which some are these models, and others are good ones."""
    tabletop = Path(robocell.models.__file__).parents[2] / "models/scenes/tabletop.xml"
    for name in GOOD:
        (folder / f"{name}.xml").write_bytes(tabletop.read_bytes())
    files = [GOOD[0], *models[: len(models) // 2], GOOD[1], *models[len(models) // 2 :], GOOD[2]]
    paths = [str((folder if name in GOOD else MODELS) / f"{name}.xml") for name in files]
    run = {
        **storm.RUN,
        "scenes": {"source": "files", "files": paths},
        "episodes_per_scene": 1,
        "cameras": {"streams": []},
        "output": str(folder / "out"),
    }
    (folder / "run.yaml").write_text(yaml.safe_dump(run))
    command = ("generate", folder / "run.yaml", "--workers", 2, *options)
    return robocell_command(*command, preexec_fn=limit_memory)


def require_quarantine(
    folder: Path, done: subprocess.CompletedProcess[str], reasons: dict[str, str]
) -> list[dict[str, str]]:
    """The good scenes' episodes are there, the others' are listed; the entries of those."""
    assert done.returncode == 1, done.stderr
    assert "Traceback" not in done.stderr
    result = robocell.data.verify(folder / "out")
    assert result.ok, str(result)
    assert len(result.good) == len(GOOD)
    totals = json.loads((folder / "out/report.json").read_text())["commands"][0]["totals"]
    scenes = yaml.safe_load((folder / "run.yaml").read_text())["scenes"]["files"]
    unmade = {Path(scenes[int(one["id"][1:5])]).stem: one for one in totals["unmade"]}
    assert unmade.keys() == reasons.keys()
    for model, entry in unmade.items():
        assert reasons[model] in entry["reason"], entry
        assert f"try it alone: {entry['reproduce']}" in done.stderr
        deaths = [death for death in totals["deaths"] if death["item"] == entry["id"]]
        assert len(deaths) == 3
    return list(unmade.values())


# One of them is in test_engine_crash.py.
@pytest.mark.proof
def test_models_that_crash_lose_workers_but_not_the_run(tmp_path: Path):
    done = generate_with(tmp_path, list(CRASHING))
    reasons = {name: f"was killed by {number.name}" for name, number in CRASHING.items()}
    entries = require_quarantine(tmp_path, done, reasons)
    for entry in entries[:1]:  # it does what it says; each takes three more processes
        program, *arguments = shlex.split(entry["reproduce"])
        assert program == "robocell"
        again = robocell_command(*arguments, preexec_fn=limit_memory)
        assert again.returncode == 1, again.stderr
        assert f"{entry['id']} could not be made" in again.stderr


# Each of four processes stalls for four seconds.
@pytest.mark.parametrize(
    "models",
    [
        pytest.param(STALLING[:1], marks=pytest.mark.proof),
        pytest.param(STALLING, marks=pytest.mark.soak),
    ],
    ids=["one", "all"],
)
def test_models_that_stall_lose_time_but_not_the_run(tmp_path: Path, models: list[str]):
    done = generate_with(tmp_path, models, "--item-timeout", 4)
    assert "could not be looked through within 4 s" in done.stderr
    require_quarantine(tmp_path, done, dict.fromkeys(models, "took more than 4 s"))
