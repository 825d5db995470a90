"""The command line as a person meets it: exit codes and the text of messages."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

import robocell
from robocell._startup import is_command
from robocell.cli.doctor import advice
from robocell.cli.generate import many_workers
from robocell.cli.probes import Finding, State
from robocell.cli.robot_checks import idle_actuators
from robocell.cli.robot_scene import load_robot
from robocell.generate.disk import require_writable

REPOSITORY = Path(__file__).resolve().parents[2]
RC7 = Path(robocell.models.robot_file("rc7"))

RUN = {
    "run": "tiny",
    "robot": str(RC7),
    "task": {
        "kind": "pick",
        "base_distance": [0.3, 0.55],
        "base_height_offset": -0.25,
        "base_height_noise": [-0.15, 0.1],
    },
    "scenes": {"source": "tabletop"},
    "episodes_per_scene": 2,
    "cameras": {"resolution": [64, 48], "streams": [{"name": "wrist", "camera": "wrist_camera"}]},
    "rates": {"policy_ms": 66, "control_ms": 2, "sim_ms": 2, "max_steps": 500},
}


def write_run(folder: Path, **changes: object) -> Path:
    """A run file; `changes` replace top-level fields."""
    path = folder / "run.yaml"
    path.write_text(yaml.safe_dump({**RUN, "output": str(folder / "out"), **changes}))
    return path


def robocell_command(
    *arguments: object, environment: dict[str, object] | None = None, **options: object
) -> subprocess.CompletedProcess[str]:
    """Runs the command line in a process of its own."""
    given = {name: str(value) for name, value in (environment or {}).items()}
    own = {"PYTHONPATH": os.pathsep.join(sys.path), "COLUMNS": "200"}
    return subprocess.run(
        [sys.executable, "-m", "robocell", *map(str, arguments)],
        env={**os.environ, **own, **given},
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
        **options,  # type: ignore[call-overload]
    )


def refused(*arguments: object, code: int = 2) -> str:
    """Standard error of a command that must end with `code` and without a traceback."""
    result = robocell_command(*arguments)
    assert result.returncode == code, result.stdout + result.stderr
    assert "Traceback" not in result.stderr
    return result.stderr


def test_every_command_is_listed_with_what_it_does():
    text = robocell_command("--help").stdout
    for command in (
        "generate",
        "report",
        "verify",
        "replay",
        "check",
        "gripper-range",
        "ik-test",
        "fetch",
        "doctor",
    ):
        assert command in text
    assert "Set them" not in text
    assert robocell_command("generate", "--help").returncode == 0


def test_an_unknown_file_is_told_with_what_is_there(tmp_path: Path):
    write_run(tmp_path)
    text = refused("generate", tmp_path / "runn.yaml")
    assert f"no run file '{tmp_path}/runn.yaml'. In {tmp_path}: run.yaml." in text
    assert f"Did you mean '{tmp_path}/run.yaml'?" in text
    assert "How to write a run file: docs/generate.md" in text
    with pytest.raises(robocell.IoError) as raised:
        robocell.RunConfig.load(tmp_path / "runn.yaml")
    assert str(raised.value) in text
    assert f"there is no folder '{tmp_path}/none'" in refused(
        "generate", tmp_path / "none" / "a.yaml"
    )
    assert "is a folder; give a run file" in refused("generate", tmp_path)
    assert "no dataset" in refused("verify", tmp_path / "none")
    assert "is a file; give the folder" in refused("verify", tmp_path / "run.yaml")


def test_the_wrong_kind_of_file_is_told_by_its_kind(tmp_path: Path):
    text = refused("generate", RC7)
    assert "this looks like a robot file: it has name, model, " in text
    assert f"Look at the robot with `robocell check {RC7}`" in text
    run = write_run(tmp_path)
    text = refused("check", run)
    assert "this looks like a run file: it has " in text
    assert f"Make its dataset with `robocell generate {run}`" in text


def test_a_file_that_is_no_text_is_told_with_the_byte(tmp_path: Path):
    path = tmp_path / "image.yaml"
    path.write_bytes(b"name: a\n\x89PNG")
    assert f"{path}:2:1: byte 0x89 at offset 8 is not UTF-8" in refused("check", path)
    path.write_bytes(b"name: a\0b\n")
    assert f"{path}:1:8: byte 0x00 at offset 7 cannot stand in a text" in refused("check", path)
    path.write_bytes(bytes(range(256)))
    refused("generate", path)


def test_one_misspelt_key_is_one_problem(tmp_path: Path):
    path = write_robot(tmp_path, lambda config: config.update(mode=config.pop("model")))
    text = refused("check", path)
    assert "Did you mean 'model'?" in text
    assert "problems" not in text
    assert "is required" not in text


def test_an_unknown_key_is_told_with_its_line_and_the_nearest_key(tmp_path: Path):
    path = write_run(tmp_path)
    lines = path.read_text().splitlines()
    number = 1 + next(i for i, line in enumerate(lines) if line.startswith("task:"))
    path.write_text(path.read_text().replace("task:", "tsak:"))
    text = refused("generate", path)
    assert f"run.yaml:{number}:1" in text
    assert "tsak" in text
    assert "Did you mean 'task'?" in text


def test_an_override_goes_through_the_same_checks(tmp_path: Path):
    path = write_run(tmp_path)
    text = refused("generate", path, "--set", "task.lift_hight=0.05")
    assert "--set task.lift_hight" in text
    assert "Did you mean 'lift_height'?" in text
    text = refused("generate", path, "--set", "rates.sim_ms=-1")
    assert "--set rates.sim_ms" in text
    assert "nonsense" in refused("generate", path, "--set", "nonsense")
    assert "--workers" in refused("generate", path, "--workers", "0")


def test_an_odd_video_size_is_refused_before_anything_is_made(tmp_path: Path):
    cameras = {**RUN["cameras"], "resolution": [65, 48]}  # type: ignore[dict-item]
    text = refused("generate", write_run(tmp_path, cameras=cameras))
    assert "65" in text
    assert "even" in text
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("option", ["--workers=1", "--dry-run"])
def test_what_the_robot_or_the_catalogue_lacks_is_told_before_anything_is_made(
    tmp_path: Path, option: str
):
    streams = [{"name": "wrist", "camera": "wirst_camera"}]
    changes = {"cameras": {"resolution": [64, 48], "streams": streams}}
    path = write_run(tmp_path, **changes)
    text = refused("generate", path, option)
    line = next(n for n, line in enumerate(path.read_text().splitlines(), 1) if "wirst" in line)
    assert f"{path}:{line}:" in text
    assert "cameras.streams[0].camera: stream 'wrist': no camera 'wirst_camera'" in text
    assert "Did you mean 'wrist_camera'?" in text
    assert "robot_0/" not in text
    task = {"kind": "pick", "objects": ["box", "mgu"]}
    text = refused("generate", write_run(tmp_path, task=task), option)
    assert "task.objects[1]: task: no kind 'mgu'" in text
    assert "Did you mean 'mug'?" in text
    assert not (tmp_path / "out").exists(), "so the corrected file begins a new dataset"


def test_an_unwritable_output_is_refused_with_its_path(tmp_path: Path):
    (tmp_path / "file").write_text("")
    (tmp_path / "locked").mkdir(mode=0o500)
    folders = ["file"] if os.geteuid() == 0 else ["file", "locked"]  # root writes everywhere
    for folder in folders:
        output = tmp_path / folder / "out"
        text = refused("generate", write_run(tmp_path), "--output", output, code=3)
        assert f"'{output}'" in text


def tree(folder: Path) -> set[Path]:
    """All that is in a folder."""
    return set(folder.rglob("*"))


def test_a_dry_run_refuses_an_output_that_cannot_be_written(tmp_path: Path):
    run = write_run(tmp_path)
    (tmp_path / "file").write_text("")
    before = tree(tmp_path)
    text = refused("generate", run, "--output", tmp_path / "file" / "out", "--dry-run", code=3)
    assert f"'{tmp_path / 'file'}' is a file, and a dataset is a folder" in text
    text = refused("generate", run, "--output", "/proc/none/out", "--dry-run", code=3)
    assert (
        "output '/proc/none/out': cannot write into '/proc': no folder can be made there. " in text
    )
    assert "Name another one (--output), or make that folder writable" in text
    assert tree(tmp_path) == before


def test_what_can_be_written_is_left_as_it_was(tmp_path: Path):
    for output in (tmp_path, tmp_path / "a" / "b"):
        require_writable(output)
    assert tree(tmp_path) == set()
    locked = [Path("/proc")]
    if os.geteuid() != 0:  # root writes everywhere else
        tmp_path.chmod(0o500)
        locked.append(tmp_path)
    for folder in locked:
        with pytest.raises(robocell.IoError, match=f"cannot write into '{folder}': "):
            require_writable(folder)


@pytest.mark.parametrize(
    ("option", "value", "least"),
    [("--seed", -1, 0), ("--episodes", 0, 1), ("--workers", 0, 1)],
)
def test_a_number_out_of_range_is_refused_with_option_and_range(
    tmp_path: Path, option: str, value: int, least: int
):
    text = refused("generate", write_run(tmp_path), option, value)
    words = " ".join(text.replace("│", " ").split())
    assert f"Invalid value for '{option}': " in words
    assert any(allowed in words for allowed in (f"greater than or equal to {least}", f"x>={least}"))
    field = option.removeprefix("--")
    text = refused("generate", write_run(tmp_path), "--set", f"{field}={value}")
    wrong = "must be greater than 0" if least else "must not be negative"
    assert f"{field}: {value} {wrong}" in text


def test_a_shard_that_does_not_exist_is_refused(tmp_path: Path):
    path = write_run(tmp_path)
    assert "shard" in refused("generate", path, "--shard", "2/2")
    assert "write i/N" in refused("generate", path, "--shard", "half")


def test_a_changed_configuration_is_refused_with_what_differs(tmp_path: Path):
    path = write_run(tmp_path)
    robocell.prepare_dataset(robocell.RunConfig.load(path))
    assert robocell_command("generate", path, "--seed", 7, "--dry-run").returncode == 0
    (tmp_path / "out" / "s0000_e0000").mkdir()
    text = refused("generate", path, "--seed", 7)
    assert "seed: 0 then, 7 now" in text
    assert "seed: 0 then, 7 now" in refused("generate", path, "--seed", 7, "--dry-run")
    assert "give another `output`" in text


def test_a_dry_run_tells_what_there_is_to_do_and_does_nothing(tmp_path: Path):
    result = robocell_command("generate", write_run(tmp_path), "--dry-run", "--shard", "0/2")
    assert result.returncode == 0
    assert "episodes: 1, 0 of them made, 1 to do" in result.stdout
    assert "takes about, after 1 without and 1 with cameras:" in result.stdout
    for label in ("episodes:", "frames:", "size:", "time:", "memory:"):
        assert f"\n  {label} " in result.stdout
    assert not (tmp_path / "out").exists()


def test_damaged_episodes_are_told_with_the_command_that_sets_them_aside(tmp_path: Path):
    path = write_run(tmp_path)
    robocell.prepare_dataset(robocell.RunConfig.load(path))
    damaged = tmp_path / "out" / "s0000_e0000"
    damaged.mkdir()
    (damaged / "episode.json").write_text("{")
    text = refused("generate", path, code=3)
    assert "s0000_e0000" in text
    command = f"robocell verify --repair {tmp_path / 'out'}"
    assert command in text
    assert robocell_command("verify", tmp_path / "out").returncode == 1
    assert robocell_command(*command.split()[1:]).returncode == 0
    assert not damaged.exists()
    assert robocell_command("verify", tmp_path / "out").returncode == 0


def test_repair_says_what_it_could_not_mend_and_ends_with_1(tmp_path: Path):
    run = write_run(tmp_path, episodes_per_scene=1, cameras={"streams": []})
    assert robocell_command("generate", run).returncode == 0
    out = tmp_path / "out"
    (model,) = (path for path in (out / "models").iterdir() if path.name.startswith("rc7-"))
    (model / "rc7.xml").write_text("<mujoco/>")
    (out / "dataset.json").write_text("{")
    result = robocell_command("verify", "--repair", "--decode-videos", out)
    assert result.returncode == 1, result.stdout
    assert f"moved aside: {out / '.quarantine' / 'dataset.json'}" in result.stdout
    assert f"not mended: models/{model.name}: it is missing" in result.stdout
    assert robocell_command("generate", run).returncode == 0, "the way on that it names"
    assert robocell_command("verify", out).returncode == 0
    assert robocell_command("replay", "--check", out).returncode == 0


def write_robot(folder: Path, change: Callable[[dict[str, Any]], object]) -> Path:
    """The built-in robot's file with a change."""
    config = yaml.safe_load(RC7.read_text())
    config["model"] = str(RC7.parent / config["model"])
    change(config)
    path = folder / "robot.yaml"
    path.write_text(yaml.safe_dump(config))
    return path


def test_check_of_a_file_that_only_names_a_model_says_what_the_model_has(tmp_path: Path):
    path = tmp_path / "new.yaml"
    path.write_text(f"name: new\nmodel: {RC7.parent / 'rc7.xml'}\n")
    text = refused("check", path)
    assert "robot 'new' has no arm group" in text
    assert "move_groups" in text
    assert "Its joints: joint1, joint2" in text
    assert "Its sites: " in text
    assert "Robot::FromScene" not in text


def set_in(*keys: str | int, value: object) -> Callable[[dict[str, Any]], object]:
    """A change: config[key][key]... = value."""

    def change(config: Any) -> None:
        for key in keys[:-1]:
            config = config[key]
        config[keys[-1]] = value

    return change


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (set_in("move_groups", "arm", "joints", value="joint2..joint8"), "no joint 'joint8'"),
        (set_in("move_groups", "arm", "leaf", value={"body": "base_link"}), "nothing moves"),
        (set_in("model", value="menagerie:no_robot/no.xml"), "robocell fetch no_robot"),
        (set_in("base", "size", value=[0.2, 0.2]), "base.size: expected a list of 3 numbers"),
        (set_in("home", "arm", 0, value=float("nan")), "home.arm[0]: nan is not a finite number"),
    ],
)
def test_a_wrong_robot_file_is_told_with_the_place(
    tmp_path: Path, change: Callable[[dict[str, Any]], object], told: str
):
    assert told in refused("check", write_robot(tmp_path, change))


def test_what_is_wrong_with_the_model_is_told_with_the_line_of_the_robot_file(tmp_path: Path):
    path = write_robot(tmp_path, set_in("move_groups", "arm", "leaf", value={"site": "tpc"}))
    number = 1 + next(i for i, line in enumerate(path.read_text().splitlines()) if "tpc" in line)
    text = refused("check", path)
    assert f"{path}:{number}:" in text
    assert "robot 'rc7': move_groups.arm.leaf: no site 'tpc'. Its sites:" in text
    assert "scene" not in text


def test_a_missing_mesh_is_told_with_robot_and_model(tmp_path: Path):
    model = tmp_path / "arm.xml"
    model.write_text(
        '<mujoco><asset><mesh name="link" file="link.stl"/></asset><worldbody><body name="b">'
        '<geom type="mesh" mesh="link"/></body></worldbody></mujoco>'
    )
    path = tmp_path / "arm.yaml"
    path.write_text("name: arm\nmodel: arm.xml\n")
    text = refused("check", path)
    assert f"{path}:2:8: robot 'arm': {model} refers to the file 'link.stl' (mesh 'link'" in text
    assert f"there is no {tmp_path}/link.stl." in text
    assert "Get the model with all its files" in text


def test_a_picture_is_a_png_or_refused_before_anything_is_done(tmp_path: Path):
    text = refused("check", RC7, "--picture", tmp_path / "rc7.jpg")
    assert f"pictures are PNG files: give '{tmp_path}/rc7.png'" in text
    assert not list(tmp_path.iterdir())
    assert "there is no folder" in refused(
        "check", RC7, "--picture", tmp_path / "none" / "a.png", code=3
    )
    text = refused("check", RC7, "--picture", tmp_path)
    assert f"'{tmp_path}' is a folder; give the picture a name: '{tmp_path}/picture.png'" in text


@pytest.mark.parametrize("command", [["generate"], ["generate", "--dry-run"]])
def test_images_beyond_all_size_are_refused_before_anything_is_done(
    tmp_path: Path, command: list[str]
):
    run = write_run(tmp_path)
    text = refused(*command, run, "--set", "cameras.resolution=[100000,100000]")
    assert "cameras.streams[0]: size 100000x100000 is too large" in text
    assert "at most 16384 pixels; correct the stream's width and height" in text
    assert not (tmp_path / "out").exists()


def test_lights_of_a_model_are_a_note_and_nothing_wrong(tmp_path: Path):
    lit = tmp_path / "lit.xml"
    text = (RC7.parent / "rc7.xml").read_text()
    lit.write_text(text.replace("<worldbody>", '<worldbody><light name="lamp"/>', 1))
    result = robocell_command("check", write_robot(tmp_path, set_in("model", value=str(lit))))
    assert result.returncode == 0, result.stderr
    assert "note: robot 'rc7': only body 'base_link' of " in result.stdout
    assert "light 'lamp'; the scene has its own" in result.stdout
    assert "nothing found wrong" in result.stdout
    assert result.stderr == ""


def test_tables_do_not_break_what_is_longer_than_the_terminal():
    joint = "a_joint_with_a_very_long_name/" * 10
    script = (
        "from rich.table import Table\n"
        "from robocell.cli.common import print_wide\n"
        "table = Table()\n"
        f"table.add_row('label', {joint!r})\n"
        "print_wide(table)\n"
    )
    result = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "COLUMNS": "40"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert joint in result.stdout


def test_a_robot_without_gripper_is_told_with_its_groups(tmp_path: Path):
    def remove_gripper(config: dict[str, Any]) -> None:
        for field in ("move_groups", "home", "control", "home_noise"):
            config[field].pop("gripper")

    path = write_robot(tmp_path, remove_gripper)
    assert "robot 'rc7' has no gripper. Its move groups: arm (arm)" in refused(
        "gripper-range", path
    )
    warnings = robocell_command("check", path).stderr
    assert "no move group has the actuators gripper: nothing will command them" in warnings


@pytest.mark.parametrize("controller", ["joint_velocity", "joint_torque", "joint_impedance"])
def test_actuators_that_were_added_for_a_controller_are_not_idle(tmp_path: Path, controller: str):
    def choose(config: dict[str, Any]) -> None:
        config["control"]["arm"] = controller
        config["move_groups"].pop("gripper")
        for field in ("home", "control", "home_noise"):
            config[field].pop("gripper")

    loaded = load_robot(write_robot(tmp_path, choose))
    assert loaded.scene.model.nu == 7 + 1 + 7
    assert idle_actuators(loaded) == [
        "no move group has the actuators gripper: nothing will command them"
    ]


def test_check_warns_of_what_is_valid_but_looks_wrong(tmp_path: Path):
    def spoil(config: dict[str, Any]) -> None:
        config.update(gravcomp=False, stiffness=20.0)

    result = robocell_command("check", write_robot(tmp_path, spoil))
    assert result.returncode == 0, result.stderr
    assert "drifts by" in result.stderr
    assert "gravcomp: true" in result.stderr
    assert "nothing found wrong" not in result.stdout


def test_a_distance_that_the_gripper_does_not_have_is_refused_by_check_and_by_runs(tmp_path: Path):
    distance = {"closed": 0.0, "open": 0.9}
    robot = write_robot(tmp_path, set_in("move_groups", "gripper", "distance", value=distance))
    text = "move_groups.gripper.distance: the fingers are 0.002 m apart when closed and 0.090 m "
    assert text in refused("check", robot)
    run = write_run(tmp_path, robot=str(robot))
    for more in ([], ["--dry-run"]):
        assert f"robot.{text}" in refused("generate", run, *more)
    assert not (tmp_path / "out").exists()


def test_what_check_warns_of_runs_warn_of_and_say_from_where_the_robot_would_reach(tmp_path: Path):
    robot = write_robot(tmp_path, set_in("force_limit", value=0.01))
    warned = "pushes with all it may, 0.01 N m"
    assert warned in robocell_command("check", robot).stderr
    task = {"kind": "pick", "objects": ["box"], "base_distance": [0.3, 0.5]}
    task |= {"base_height_offset": 0.4, "base_height_noise": [0.0, 0.0]}
    run = write_run(tmp_path, robot=str(robot), task=task, max_attempts=1, episodes_per_scene=1)
    result = robocell_command("generate", run)
    assert result.returncode == 1, result.stdout + result.stderr
    assert warned in result.stderr
    said = " ".join((result.stdout + result.stderr).split())
    assert "a grasp from above, pregrasp and lift included, is in reach with" in said
    assert "the run says 0.4, with noise 0 ... 0, and 0.3 ... 0.5" in said


@pytest.mark.parametrize("control", ["", "control: {arm: joint_position}\n"])
def test_an_arm_of_motors_is_refused_by_check_and_by_runs(tmp_path: Path, control: str):
    (tmp_path / "bob.xml").write_text(
        '<mujoco><worldbody><body name="base"><geom size="0.05"/><body name="link" pos="0 0 0.1">'
        '<joint name="hip" axis="0 1 0" range="-90 90"/><geom type="capsule" size="0.02" '
        'fromto="0 0 0 0 0 0.3"/><site name="tip" pos="0 0 0.3"/></body></body></worldbody>'
        '<actuator><motor name="drive" joint="hip"/></actuator></mujoco>'
    )
    robot = tmp_path / "bob.yaml"
    robot.write_text(
        "name: bob\nmodel: bob.xml\nmove_groups:\n"
        "  arm: {kind: arm, joints: [hip], actuators: [drive], leaf: {site: tip}}\n" + control
    )
    result = robocell_command("check", robot)
    assert result.returncode == 2
    assert "actuator 'drive' is no position servo of one of its joints" in result.stderr
    assert "give the group another controller, or the model a servo" in result.stderr
    assert "robot 'bob' / group 'arm'" in result.stderr
    for hint in ("gravcomp", "stiffness"):
        assert hint not in result.stderr
    run = write_run(tmp_path, robot=str(robot))
    assert "drive' is no position servo of one of its joints" in refused("generate", run)
    if not control:
        assert "none" in next(line for line in result.stdout.splitlines() if "drive" in line)


def test_what_this_machine_lacks_is_told_before_anything_is_made(tmp_path: Path):
    run = write_run(tmp_path)
    for variable, code, text in (
        ("ROBOCELL_FFMPEG", 3, "records 1 camera stream, on this machine that fails: ROBOCELL_FFM"),
        ("ROBOCELL_GL", 2, "on this machine that fails: environment variable ROBOCELL_GL: no GL"),
    ):
        for more in ([], ["--dry-run"]):
            result = robocell_command("generate", run, *more, environment={variable: "/no"})
            assert result.returncode == code, result.stderr
            assert text in result.stderr
    assert not (tmp_path / "out").exists()


def test_verify_of_what_is_no_dataset_says_so(tmp_path: Path):
    (tmp_path / "notes.txt").touch()
    for more in ([], ["--repair"]):
        text = refused("verify", tmp_path, *more)
        assert "is no dataset: it has neither a dataset.json nor episodes, it holds notes.t" in text
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_the_range_of_grippers_is_printed_in_this_form():
    result = robocell_command("gripper-range", RC7)
    assert result.returncode == 0, result.stderr
    first, second = result.stdout.splitlines()
    assert first == "Gripper finger ranges:"
    config = robocell.RobotConfig.load(RC7)
    assert second.startswith("    Gripper 'gripper': ")
    closed, opened = map(float, second.rpartition(": ")[2].split(" - "))
    if config.move_groups["gripper"].distance:
        distance = config.move_groups["gripper"].distance
        assert (closed, opened) == (distance.closed, distance.open)
    assert 0 <= closed < opened < 0.2


def test_check_shows_the_robot_and_finds_nothing_wrong_with_the_builtin_one(tmp_path: Path):
    picture = tmp_path / "rc7.png"
    result = robocell_command("check", RC7, "--picture", picture)
    assert result.returncode == 0, result.stderr
    for text in ("move groups: arm (arm), gripper (gripper)", "reach: ", "tcp", "wrist_camera"):
        assert text in result.stdout
    ctrl = robocell.RobotConfig.load(RC7).move_groups["gripper"].ctrl
    assert ctrl is not None
    assert (
        f"    Gripper 'gripper': ctrl {ctrl.closed:g} closed, {ctrl.open:g} open\n" in result.stdout
    )
    assert "nothing found wrong" in result.stdout, result.stderr
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_ik_test_solves_what_the_robot_can_reach():
    for parallel in ((), ("--parallel",)):
        result = robocell_command("ik-test", RC7, "--samples", 200, *parallel)
        assert result.returncode == 0, result.stdout + result.stderr
        assert "of 200 at 1e-05 m, rad" in result.stdout


def test_the_doctor_names_versions_graphics_and_encoder():
    result = robocell_command("doctor")
    assert result.returncode == 0, result.stdout
    for text in ("mujoco", "graphics: egl", "video", "libx264", "disk"):
        assert text in result.stdout
    assert "everything that is needed to generate datasets is here" in result.stdout


def test_the_doctor_tells_what_to_do_about_what_is_missing(tmp_path: Path):
    found = {
        finding.what: finding
        for finding in (
            Finding("video", State.BROKEN, "no ffmpeg found", "sudo apt install ffmpeg"),
            Finding("menagerie", State.MISSING, "nothing in .cache", "mujoco-menagerie prefetch x"),
            Finding("disk", State.OK, "9 GB free", "make room"),
        )
    }
    assert advice(list(found.values())) == [
        "",
        "video must be mended: sudo apt install ffmpeg",
        "menagerie (for robots named `menagerie:...`; the built-in ones need it not) is optional: "
        "mujoco-menagerie prefetch x",
        "until this is mended, not all of robocell can be used",
    ]
    result = robocell_command("doctor", environment={"ROBOCELL_FFMPEG": tmp_path / "none"})
    assert result.returncode == 1
    assert "video must be mended: sudo apt install ffmpeg" in result.stdout


def test_more_workers_than_cores_are_told(tmp_path: Path):
    result = robocell_command("generate", write_run(tmp_path), "--workers=999", "--dry-run")
    assert result.returncode == 0, result.stderr
    assert "warning: 999 workers on " in result.stderr
    assert "make nothing faster" in result.stderr
    cores = len(os.sched_getaffinity(0))
    assert many_workers(cores) == ""
    assert f"{8 * cores} are started, and --workers {cores} is enough" in result.stderr
    assert f"workers:  {8 * cores}\n" in result.stdout
    assert "are started" not in many_workers(8 * cores)


CTRL_C_AT_IMPORT = """
import builtins, os, signal
signal.signal(signal.SIGINT, signal.default_int_handler)
real = builtins.__import__
def load(name, *rest, **more):
    if name == "{module}":
        os.kill(os.getpid(), signal.SIGINT)
    return real(name, *rest, **more)
builtins.__import__ = load
"""


def interrupted_at_import(
    folder: Path, module: str, *arguments: str
) -> subprocess.CompletedProcess[str]:
    """Runs Python, with Ctrl-C when it comes to import a module."""
    (folder / "sitecustomize.py").write_text(CTRL_C_AT_IMPORT.format(module=module))
    return subprocess.run(
        [sys.executable, *arguments],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), *sys.path])},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("module", ["robocell._core", "typer", "robocell.cli.generate"])
def test_ctrl_c_while_the_command_is_loaded_leaves_no_traceback(tmp_path: Path, module: str):
    result = interrupted_at_import(tmp_path, module, "-m", "robocell", "doctor")
    assert (result.returncode, result.stderr) == (-signal.SIGINT, "")


def test_a_program_that_imports_robocell_keeps_its_ctrl_c(tmp_path: Path):
    code = "try: import robocell\nexcept KeyboardInterrupt: print('heard')"
    result = interrupted_at_import(tmp_path, "robocell._core", "-c", code)
    assert (result.returncode, result.stdout) == (0, "heard\n")


@pytest.mark.parametrize(
    ("line", "command"),
    [
        ("/usr/bin/robocell generate run.yaml", True),
        ("python -m robocell check", True),
        ("/usr/bin/python3 -X dev -u -m robocell", True),
        ("python3 /opt/bin/robocell check", True),
        ("python -m robocell.generate.worker", False),
        ("python -m pytest robocell", False),
        ("python script.py robocell", False),
        ("python -c code robocell", False),
        ("python", False),
    ],
)
def test_what_counts_as_the_command(line: str, command: bool):
    assert is_command(line.split()) is command


@pytest.mark.parametrize("command", ["check", "generate"])
def test_a_model_file_in_the_place_of_a_yaml_file_is_told(command: str):
    model = RC7.with_suffix(".xml")
    text = refused(command, model)
    assert f"{model}: this is XML, a model file; a YAML file is wanted here" in text
