"""`robocell fetch`, with archives of a made-up robot instead of the network."""

from __future__ import annotations

import os
import pwd
import subprocess
import sys
from pathlib import Path

import mujoco_menagerie
import pytest

import robocell as rc
from robocell import _fetching as fetching
from robocell.compat.mj_kdl_wrapper import menagerie as guide
from robocell.compat.mj_kdl_wrapper._fetch import main as fetch_for_the_guide
from toy_robots import shop, version_of

__all__ = ["shop"]  # a fixture


@pytest.mark.usefixtures("shop")
def test_without_a_network_the_error_names_alternatives(tmp_path, monkeypatch):
    monkeypatch.setenv("MENAGERIE_BASE_URL", (tmp_path / "nowhere").as_uri())
    with pytest.raises(rc.IoError) as error:
        fetching.fetch("toy_arm")
    assert str(error.value).startswith("robot 'toy_arm' could not be fetched: file://")
    assert f"copy {tmp_path / 'cache'} from a machine that has it, or set MENAGERIE_ROOT" in str(
        error.value
    )
    assert fetching.read_record(fetching.record_path()) == {}


def test_a_missing_model_error_contains_the_fetch_command(shop, tmp_path, monkeypatch):
    shop("one", "kinova_gen3", "gen3")
    monkeypatch.setenv("MENAGERIE_BASE_URL", (tmp_path / "nowhere").as_uri())
    for name in ("toy_arm", "kinova_gen3"):
        with pytest.raises(rc.NotFoundError) as error:
            rc.menagerie.model_path(name)
        message = str(error.value)
        assert message.startswith(f"menagerie robot '{name}' not found")
        assert f"MENAGERIE_ROOT (not set), {tmp_path}/cache/models/{name}-*" in message
        assert f"Fetch it with: robocell fetch {name}\n" in message
        assert "Downloading it failed: " in message
        assert "mj-kdl" not in message
    for name, with_the_guides in (("kinova_gen3", True), ("toy_arm", False)):
        monkeypatch.setattr(fetching, "known_robots", lambda: [mujoco_menagerie.get("toy_arm")])
        with pytest.raises(rc.NotFoundError, match=f"'{name}' not found") as error:
            guide.model_path(name)
        assert ("\nmj-kdl-fetch-menagerie fetches it" in str(error.value)) == with_the_guides


class TestTheGuidesCommand:
    """mj-kdl-fetch-menagerie, on a machine that has nothing yet."""

    @pytest.fixture
    def run(self, shop, capsys, monkeypatch):
        """Runs it with arguments: exit code, standard output and standard error."""
        shop("one", "kinova_gen3", "gen3")
        shop("one", "robotiq_2f85", "2f85")

        def run(*arguments: str) -> tuple[int, str, str]:
            monkeypatch.setattr("sys.argv", ["mj-kdl-fetch-menagerie", *arguments])
            with pytest.raises(SystemExit) as end:
                fetch_for_the_guide()
            return (int(end.value.code or 0), *capsys.readouterr())

        return run

    def test_the_command_downloads_and_records_missing_models(self, run, tmp_path):
        code, out, err = run()
        assert (code, err) == (0, "")
        paths = dict(line.split(": ") for line in out.splitlines())
        assert set(paths) == {*guide.ASSETS, guide.GRIPPER_ASSET, "kinova_gen3", "robotiq_2f85"}
        assert all(Path(path).is_file() for path in paths.values())
        for robot in ("kinova_gen3", "robotiq_2f85"):
            assert version_of(paths[robot]) == "one"
            assert (tmp_path / "user" / "mj_kdl_wrapper") in Path(paths[robot]).parents
            assert guide.model_path(robot) == paths[robot]
        record = fetching.read_record(fetching.record_path())
        assert set(record) == {"kinova_gen3", "robotiq_2f85"}

    def test_the_command_fills_a_folder_with_downloads(self, run, tmp_path):
        assert run("--dest", str(tmp_path / "dest"))[0] == 0
        for file in ("menagerie/kinova_gen3/gen3.xml", "assets/robotiq_2f85/2f85.xml"):
            assert version_of(tmp_path / "dest" / file) == "one"

    def test_without_a_network_the_command_fails_and_names_alternatives(
        self, run, tmp_path, monkeypatch
    ):
        monkeypatch.setenv("MENAGERIE_BASE_URL", (tmp_path / "nowhere").as_uri())
        code, out, err = run()
        assert (code, out) == (3, "")
        assert err.startswith("error: robot 'kinova_gen3' could not be fetched: file://")
        assert "or set MENAGERIE_ROOT" in err
        assert "Traceback" not in err

    def test_a_folder_that_cannot_be_written_fails(self, run, tmp_path):
        (tmp_path / "file").write_text("")
        code, out, err = run("--dest", str(tmp_path / "file"))
        assert (code, out) == (3, "")
        assert err.startswith("error: ")
        assert str(tmp_path / "file") in err

    def test_a_wrong_variable_is_a_usage_error(self, run, monkeypatch):
        monkeypatch.setenv("MJ_KDL_MODEL", "/nonexistent")
        code, out, err = run()
        assert (code, out) == (2, "")
        text = "MJ_KDL_MODEL is '/nonexistent', which is not a file: correct it or unset it"
        assert err == f"error: {text}\n"


def test_the_command_lists_and_fails_as_documented(tmp_path):
    def robocell(*arguments: str) -> subprocess.CompletedProcess[str]:
        environment = os.environ | {
            "MENAGERIE_CACHE_DIR": str(tmp_path / "cache"),
            "XDG_CACHE_HOME": str(tmp_path),
            "MENAGERIE_BASE_URL": (tmp_path / "nowhere").as_uri(),
        }
        return subprocess.run(
            [sys.executable, "-m", "robocell", "fetch", *arguments],
            env=environment, capture_output=True, text=True, timeout=60, check=False,
        )  # fmt: skip

    listing = robocell("--list", "kinova_gen3")
    assert (listing.returncode, "kinova_gen3" in listing.stdout) == (0, True), listing.stderr
    offline = robocell("robotiq_2f85")
    assert (offline.returncode, "could not be fetched" in offline.stderr) == (3, True)
    listing = robocell("--list", "kinova", "KUKA")
    assert "kinova_gen3" in listing.stdout
    assert "kuka_iiwa_14" in listing.stdout
    assert "franka" not in listing.stdout
    nothing = robocell("--list", "no_such_robot")
    told = "no robot has 'no_such_robot' in its name. `robocell fetch --list` lists all robots."
    assert (nothing.returncode, told in nothing.stderr) == (2, True), nothing.stderr
    part = robocell("kuka")
    assert part.returncode == 2
    assert "With 'kuka' in the name: kuka_iiwa_14." in part.stderr
    unknown = robocell("kinova_gen4")
    assert (unknown.returncode, "Did you mean" in unknown.stderr) == (2, True), unknown.stderr


def test_without_home_the_cache_is_where_the_library_looks(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("HOME", "")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    home = Path(pwd.getpwuid(os.getuid()).pw_dir)
    assert fetching._user_cache() == home / ".cache"
