"""What the commands share: exit codes, messages, checks of arguments, wide tables."""

from pathlib import Path

import pytest
import typer
from rich.table import Table

import robocell as rc
from robocell._cli.common import (
    ExitCode,
    fail,
    print_warning,
    print_wide,
    require_folder,
    require_mapping,
    require_png,
    require_preset,
    require_run_source,
    require_spec_file,
)


def ended(capsys: pytest.CaptureFixture[str], call) -> tuple[int, str]:
    with pytest.raises(typer.Exit) as exit_:
        call()
    return exit_.value.exit_code, capsys.readouterr().err


def test_messages_go_to_stderr_with_their_severity(capsys):
    print_warning("it is slow")
    assert capsys.readouterr().err == "warning: it is slow\n"
    assert ended(capsys, lambda: fail("no robot")) == (ExitCode.USAGE, "error: no robot\n")
    assert ended(capsys, lambda: fail("x" * 300, ExitCode.OUTPUT)) == (3, f"error: {'x' * 300}\n")


def test_a_missing_spec_file_error_suggests_the_nearest_file(tmp_path: Path, capsys):
    (tmp_path / "arm.yaml").write_text("")
    require_spec_file(tmp_path / "arm.yaml", rc.RobotConfig)
    code, told = ended(capsys, lambda: require_spec_file(tmp_path / "amr.yaml", rc.RobotConfig))
    assert code == ExitCode.USAGE
    assert "no robot file" in told
    assert f"Did you mean '{tmp_path / 'arm.yaml'}'?" in told


def test_a_missing_dataset_or_run_file_error_suggests_the_nearest(tmp_path: Path, capsys):
    (tmp_path / "picks").mkdir()
    (tmp_path / "run.yaml").write_text("run: tiny")
    (tmp_path / "frozen.json").write_text("{}")
    near = {"pikcs": "picks", "picks2": "picks", "run": "run.yaml", "rnu.yaml": "run.yaml"}
    near["frozn.json"] = "frozen.json"
    for name, meant in near.items():
        code, told = ended(capsys, lambda name=name: require_run_source(str(tmp_path / name)))
        assert code == ExitCode.USAGE
        assert f"Did you mean '{tmp_path / meant}'?" in told
    for found in ("picks", "run.yaml", "frozen.json", "my.py:config"):
        require_run_source(str(tmp_path / found))


def test_a_missing_dataset_error_lists_datasets_alone(tmp_path: Path, capsys):
    for folder in ("notes", "picks/s0000_e0000", "empty_run"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "picks/s0000_e0000/episode.json").write_text("{}")
    (tmp_path / "empty_run/dataset.json").write_text("{}")
    _, told = ended(capsys, lambda: require_folder(tmp_path / "zzz", "dataset"))
    assert told.endswith(
        f"no dataset '{tmp_path / 'zzz'}'. Datasets in {tmp_path}/: empty_run, picks.\n"
    )


def test_missing_mapping_and_preset_files_are_wrong_commands(tmp_path: Path, capsys):
    for file in ("names.yaml", "mkdocs.yml"):
        (tmp_path / file).write_text("")
    for require in (require_mapping, lambda path: require_preset(str(path))):
        require(tmp_path / "names.yaml")
        _, told = ended(capsys, lambda require=require: require(tmp_path / "none.yaml"))
        assert "mkdocs" not in told, "any YAML file is no suggestion"
        code, told = ended(capsys, lambda require=require: require(tmp_path / "name.yaml"))
        assert code == ExitCode.USAGE
        assert f"Did you mean '{tmp_path / 'names.yaml'}'?" in told
    require_mapping(None)
    require_preset("droid")


def test_a_picture_path_must_be_a_png_in_an_existing_folder(tmp_path: Path, capsys):
    require_png(tmp_path / "a.png")
    require_png(tmp_path / "A.PNG")
    assert ended(capsys, lambda: require_png(tmp_path)) == (
        ExitCode.USAGE,
        f"error: '{tmp_path}' is a folder; give the picture a name: '{tmp_path / 'picture.png'}'\n",
    )
    code, told = ended(capsys, lambda: require_png(tmp_path / "a.jpg"))
    assert (code, "'a.png'" in told.replace(str(tmp_path) + "/", "")) == (ExitCode.USAGE, True)
    code, told = ended(capsys, lambda: require_png(tmp_path / "none" / "a.png"))
    assert code == ExitCode.OUTPUT
    assert "there is no folder" in told


def test_long_paths_are_not_wrapped(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    path = "/data/" + "folder/" * 30 + "episode"
    table = Table(show_header=False)
    table.add_row("dataset", path)
    print_wide(table)
    out = capsys.readouterr().out
    assert path in out
    assert all(line == line.rstrip() for line in out.splitlines())
