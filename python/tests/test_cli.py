"""The command line as a person meets it: exit codes and the text of messages."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import robocell
from command_line import RC7, RUN, refused, robocell_command, write_robot, write_run
from robocell._cli.doctor import advice
from robocell._cli.generate import many_workers
from robocell._cli.probes import Finding, State
from robocell._generation.disk import require_writable


def test_help_lists_and_describes_every_command():
    text = robocell_command("--help").stdout
    for command in (
        "generate",
        "report",
        "verify",
        "replay",
        "merge",
        "split",
        "filter",
        "pack",
        "unpack",
        "export",
        "import",
        "benchmark",
        "check",
        "gripper-range",
        "ik-test",
        "reach",
        "fetch",
        "identify",
        "doctor",
    ):
        assert command in text
    assert "Set them" not in text
    assert robocell_command("generate", "--help").returncode == 0


def test_the_version_is_one_line_that_scripts_can_read():
    said = robocell_command("--version")
    assert (said.returncode, said.stdout) == (0, f"robocell {robocell.__version__}\n")
    assert "--version" in robocell_command("--help").stdout


def test_a_missing_file_error_lists_the_files_in_the_folder(tmp_path: Path):
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
    assert "'/dev/zero' is a device; give a robot file" in refused("check", "/dev/zero")
    assert "no dataset" in refused("verify", tmp_path / "none")
    assert "is a file; give the folder" in refused("verify", tmp_path / "run.yaml")


def test_the_error_identifies_a_file_of_another_kind(tmp_path: Path):
    text = refused("generate", RC7)
    assert "this looks like a robot file: it has name, model, " in text
    assert f"Look at the robot with `robocell check {RC7}`" in text
    run = write_run(tmp_path)
    text = refused("check", run)
    assert "this looks like a run file: it has " in text
    assert f"Make its dataset with `robocell generate {run}`" in text


def test_rejects_a_binary_file_and_names_the_byte(tmp_path: Path):
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


def test_an_unknown_key_error_has_the_line_and_the_nearest_key(tmp_path: Path):
    path = write_run(tmp_path)
    lines = path.read_text().splitlines()
    number = 1 + next(i for i, line in enumerate(lines) if line.startswith("task:"))
    path.write_text(path.read_text().replace("task:", "tsak:"))
    text = refused("generate", path)
    assert f"run.yaml:{number}:1" in text
    assert "tsak" in text
    assert "Did you mean 'task'?" in text


def test_overrides_are_validated_like_the_file(tmp_path: Path):
    path = write_run(tmp_path)
    text = refused("generate", path, "--set", "task.lift_hight=0.05")
    assert "--set task.lift_hight" in text
    assert "Did you mean 'lift_height'?" in text
    text = refused("generate", path, "--set", "rates.sim_ms=-1")
    assert "--set rates.sim_ms" in text
    assert "nonsense" in refused("generate", path, "--set", "nonsense")
    text = refused("generate", path, "--set", "cameras.streams.0.camera=exo_camera")
    assert "entries of lists have brackets: cameras.streams[0].camera" in text
    assert "--workers" in refused("generate", path, "--workers", "0")


def test_rejects_an_odd_video_size_before_creating_files(tmp_path: Path):
    cameras = {**RUN["cameras"], "resolution": [65, 48]}  # type: ignore[dict-item]
    text = refused("generate", write_run(tmp_path, cameras=cameras))
    assert "65" in text
    assert "even" in text
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("option", ["--workers=1", "--dry-run"])
def test_rejects_unknown_cameras_and_kinds_before_creating_files(tmp_path: Path, option: str):
    streams = [{"name": "wrist", "camera": "wirst_camera"}]
    changes = {"cameras": {"resolution": [64, 48], "streams": streams}}
    path = write_run(tmp_path, **changes)
    text = refused("generate", path, option)
    line = next(n for n, line in enumerate(path.read_text().splitlines(), 1) if "wirst" in line)
    assert f"{path}:{line}:" in text
    assert "(cameras.streams[0]).camera: stream 'wrist': no camera 'wirst_camera'" in text
    assert "Did you mean 'wrist_camera'?" in text
    assert "robot_0/" not in text
    task = {"kind": "pick", "objects": ["box", "mgu"]}
    text = refused("generate", write_run(tmp_path, task=task), option)
    assert "task.objects[1]: no kind of object 'mgu'" in text
    assert "Did you mean 'mug'?" in text
    assert not (tmp_path / "out").exists(), "so the corrected file begins a new dataset"


def test_rejects_an_unwritable_output_with_its_path(tmp_path: Path):
    (tmp_path / "file").write_text("")
    (tmp_path / "locked").mkdir(mode=0o500)
    folders = ["file"] if os.geteuid() == 0 else ["file", "locked"]  # root writes everywhere
    for folder in folders:
        output = tmp_path / folder / "out"
        text = refused("generate", write_run(tmp_path), "--output", output, code=3)
        assert f"'{output}'" in text


def test_an_empty_output_is_not_the_working_folder(tmp_path: Path):
    # A shell makes this of --output "$OUT" without OUT.
    text = refused("generate", write_run(tmp_path), "--output", "", code=2)
    assert "--output '': output: is required: the folder the dataset goes to" in text


def test_errors_quote_the_option_as_typed(tmp_path: Path):
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "a.txt").write_text("")
    text = refused("generate", write_run(tmp_path), "--output", tmp_path / "full", code=2)
    assert f"error: --output {tmp_path}/full: run " in text
    assert "--set" not in text


def tree(folder: Path) -> set[Path]:
    """All that is in a folder."""
    return set(folder.rglob("*"))


def test_a_dry_run_rejects_an_unwritable_output(tmp_path: Path):
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


def test_checking_a_writable_folder_changes_nothing(tmp_path: Path):
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
def test_rejects_a_number_out_of_range_with_option_and_range(
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


def test_rejects_an_invalid_shard(tmp_path: Path):
    path = write_run(tmp_path)
    assert "shard" in refused("generate", path, "--shard", "2/2")
    assert "write i/N" in refused("generate", path, "--shard", "half")


def test_rejects_a_changed_configuration_and_shows_the_difference(tmp_path: Path):
    path = write_run(tmp_path, cameras={"streams": []}, episodes_per_scene=1)
    robocell.generate.prepare_dataset(robocell.RunConfig.load(path))
    assert robocell_command("generate", path, "--seed", 7, "--dry-run").returncode == 0
    (tmp_path / "out" / "s0000_e0000").mkdir()
    text = refused("generate", path, "--seed", 7)
    assert "seed: 0 then, 7 now" in text
    assert "seed: 0 then, 7 now" in refused("generate", path, "--seed", 7, "--dry-run")
    assert "give another `output`" in text


def test_a_dry_run_reports_the_plan_and_writes_nothing(tmp_path: Path):
    result = robocell_command("generate", write_run(tmp_path), "--dry-run", "--shard", "0/2")
    assert result.returncode == 0
    assert "episodes: 1 planned, 0 on the disk, 1 to make" in result.stdout
    assert "estimate (from 1 episode, 1 with cameras):" in result.stdout
    for label in ("episodes:", "frames:", "size:", "time:", "memory:"):
        assert f"\n  {label} " in result.stdout
    assert not (tmp_path / "out").exists()


def test_a_damaged_episode_error_contains_the_repair_command(tmp_path: Path):
    path = write_run(tmp_path)
    robocell.generate.prepare_dataset(robocell.RunConfig.load(path))
    damaged = tmp_path / "out" / "s0000_e0000"
    damaged.mkdir()
    (damaged / "episode.json").write_text("{")
    text = refused("generate", path, code=3)
    assert "s0000_e0000" in text
    command = f"robocell verify --repair {tmp_path / 'out'}"
    assert command in text
    verified = robocell_command("verify", tmp_path / "out")
    assert verified.returncode == 1
    assert f"To set damaged files aside: {command};" in verified.stdout
    assert robocell_command(*command.split()[1:]).returncode == 0
    assert not damaged.exists()
    assert robocell_command("verify", tmp_path / "out").returncode == 0


def test_repair_lists_unrepaired_damage_and_exits_with_1(tmp_path: Path):
    run = write_run(tmp_path, episodes_per_scene=1, cameras={"streams": []})
    assert robocell_command("generate", run).returncode == 0
    out = tmp_path / "out"
    (model,) = (path for path in (out / "models").iterdir() if path.name.startswith("rc7-"))
    (model / "rc7.xml").write_text("<mujoco/>")
    (out / "dataset.json").write_text("{")
    result = robocell_command("verify", "--repair", "--decode-videos", out)
    assert result.returncode == 1, result.stdout
    assert f"moved aside: {out / '.quarantine' / 'dataset.json'}" in result.stdout
    assert f"not repaired: models/{model.name}: it is missing" in result.stdout
    assert robocell_command("generate", run).returncode == 0, "the way on that it names"
    assert robocell_command("verify", out).returncode == 0
    assert robocell_command("replay", "--check", out).returncode == 0


@pytest.mark.parametrize("command", [["generate"], ["generate", "--dry-run"]])
def test_rejects_oversized_images_at_once(tmp_path: Path, command: list[str]):
    run = write_run(tmp_path)
    text = refused(*command, run, "--set", "cameras.resolution=[100000,100000]")
    assert "stream 'wrist' (cameras.streams[0]): size 100000x100000 is too large" in text
    assert "at most 16384 pixels; correct the stream's width and height" in text
    assert not (tmp_path / "out").exists()


def test_tables_do_not_wrap_values_longer_than_the_terminal():
    joint = "a_joint_with_a_very_long_name/" * 10
    script = (
        "from rich.table import Table\n"
        "from robocell._cli.common import print_wide\n"
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


def test_missing_encoders_and_gl_are_reported_before_creating_files(tmp_path: Path):
    run = write_run(tmp_path, cameras={**RUN["cameras"], "renderer": {"backend": "auto"}})
    for variable, code, text in (
        ("ROBOCELL_FFMPEG", 3, "records 1 camera stream, on this machine that fails: ROBOCELL_FFM"),
        ("ROBOCELL_GL", 2, "on this machine that fails: environment variable ROBOCELL_GL: no GL"),
    ):
        for more in ([], ["--dry-run"]):
            result = robocell_command("generate", run, *more, environment={variable: "/no"})
            assert result.returncode == code, result.stderr
            assert text in result.stderr
    assert not (tmp_path / "out").exists()


def test_verify_rejects_a_folder_that_is_not_a_dataset(tmp_path: Path):
    (tmp_path / "notes.txt").touch()
    for more in ([], ["--repair"]):
        text = refused("verify", tmp_path, *more)
        assert "is not a dataset: it has neither a dataset.json nor episodes, it holds n" in text
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_the_doctor_names_versions_graphics_and_encoder():
    result = robocell_command("doctor")
    assert result.returncode == 0, result.stdout
    for text in ("mujoco", "graphics: egl", "video", "libx264", "disk"):
        assert text in result.stdout
    assert "this machine can generate datasets" in result.stdout


def test_the_doctor_names_known_defects_of_the_engine_and_the_guards_against_them():
    defects = robocell.diagnose.known_engine_defects()
    assert (robocell.diagnose.mujoco_version() == "4.0.0") == bool(defects)
    words = " ".join(robocell_command("doctor").stdout.split())
    for defect in defects:
        assert f"known mujoco: {defect.name} {defect.what}." in words
        assert f"Guard: {defect.guard or 'none'}." in words
        assert f"Fixed in MuJoCo {defect.fixed_in}." in words


def test_the_doctor_prints_a_fix_for_each_problem(tmp_path: Path):
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
        "video is broken: sudo apt install ffmpeg",
        "menagerie (for robots named `menagerie:...`; built-in robots do not need it) is optional: "
        "mujoco-menagerie prefetch x",
        "parts of robocell will not work until this is fixed",
    ]
    result = robocell_command("doctor", environment={"ROBOCELL_FFMPEG": tmp_path / "none"})
    assert result.returncode == 1
    assert "video is broken: sudo apt install ffmpeg" in result.stdout


def test_warns_about_more_workers_than_cores(tmp_path: Path):
    result = robocell_command("generate", write_run(tmp_path), "--workers=999", "--dry-run")
    assert result.returncode == 0, result.stderr
    assert "warning: 999 workers on " in result.stderr
    assert "more workers than cores are not faster" in result.stderr
    cores = len(os.sched_getaffinity(0))
    assert many_workers(cores) == ""
    assert f"{8 * cores} are started, and --workers {cores} is enough" in result.stderr
    assert f"workers:  {8 * cores}\n" in result.stdout
    assert "are started" not in many_workers(8 * cores)
