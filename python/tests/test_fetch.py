"""`robocell fetch`, with archives of a made-up robot instead of the network."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import tarfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import mujoco_menagerie
import pytest

import robocell as rc
from robocell import fetching
from robocell.cli.fetch import fetch as fetch_command
from robocell.compat.mj_kdl_wrapper import menagerie as guide
from robocell.compat.mj_kdl_wrapper.fetch import main as fetch_for_the_guide

MODEL = (
    "<mujoco model='{0}'><worldbody><body name='base'><geom size='.1'/></body></worldbody></mujoco>"
)


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Publishes versions of robots, at first of ``toy_arm``; caches are empty."""
    monkeypatch.delenv("MENAGERIE_ROOT", raising=False)
    monkeypatch.setenv("MENAGERIE_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "user"))
    archives = tmp_path / "archives"
    archives.mkdir()
    monkeypatch.setenv("MENAGERIE_BASE_URL", archives.as_uri())
    here: dict[str, mujoco_menagerie.Robot] = {}

    def publish(version: str, name: str = "toy_arm", model: str = "arm") -> None:
        source = tmp_path / version / name
        source.mkdir(parents=True)
        (source / f"{model}.xml").write_text(MODEL.format(version))
        archive = archives / f"{name}-{version}.tar.xz"
        with tarfile.open(archive, "w:xz") as tar:
            tar.add(source, name)
        here[name] = mujoco_menagerie.Robot(
            name, "A toy", "arm", "Apache-2.0", hashlib.sha1(version.encode()).hexdigest(),
            archive.name, hashlib.sha256(archive.read_bytes()).hexdigest(), archive.stat().st_size,
            1, (mujoco_menagerie.EntryPoint(model, "robot", f"{model}.xml"),), model, None,
        )  # fmt: skip

    def get(name: str) -> mujoco_menagerie.Robot:
        if name not in here:
            raise mujoco_menagerie.UnknownRobotError(name, here)
        return here[name]

    monkeypatch.setattr(mujoco_menagerie, "get", get)
    monkeypatch.setattr(mujoco_menagerie, "commit", lambda: "c0ffee" * 6)
    publish("one")
    return publish


def version_of(path: str | Path) -> str:
    return Path(path).read_text().split("'")[1]


@pytest.mark.usefixtures("shop")
def test_a_robot_is_fetched_recorded_and_found():
    fetched = fetching.fetch("toy_arm")
    assert rc.menagerie.model_path("toy_arm") == str(fetched.folder / "arm.xml")
    recorded = json.loads(fetching.record_path().read_text())["robots"]["toy_arm"]
    digest = hashlib.sha256((fetched.folder / "arm.xml").read_bytes()).hexdigest()
    assert recorded["files"] == {"arm.xml": digest}
    assert recorded["commit"] == "c0ffee" * 6
    assert recorded["package"] == mujoco_menagerie.__version__
    assert fetching.fetch("toy_arm") == fetched, "a second time nothing happens"


def test_it_stays_at_its_version_until_it_is_updated(shop):
    first = fetching.fetch("toy_arm")
    shop("two")
    kept = fetching.fetch("toy_arm")
    assert (kept.folder, kept.newer, version_of(kept.folder / "arm.xml")) == (
        first.folder, True, "one",
    )  # fmt: skip
    new = fetching.fetch("toy_arm", update=True)
    assert version_of(new.folder / "arm.xml") == "two"
    assert version_of(rc.menagerie.model_path("toy_arm")) == "two"
    assert fetching.read_record(fetching.record_path())["toy_arm"] == new.pin


def test_a_pinned_version_is_found_though_the_cache_has_a_newer_one(shop):
    fetching.fetch("toy_arm")
    record = fetching.record_path().read_text()
    shop("two")
    fetching.fetch("toy_arm", update=True)
    fetching.record_path().write_text(record)  # as if another program had fetched it
    assert version_of(rc.menagerie.model_path("toy_arm")) == "one"
    fetching.record_path().unlink()
    assert version_of(rc.menagerie.model_path("toy_arm")) == "two"


def test_without_the_package_every_way_says_how_to_get_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco_menagerie", None)
    (tmp_path / "kinova_gen3").mkdir()
    monkeypatch.setenv("MJ_KDL_MENAGERIE", str(tmp_path))
    for way in (
        lambda: fetching.fetch("kinova_gen3"),
        lambda: fetch_command(["kinova_gen3"]),
        lambda: guide.model_path("kinova_gen3"),
    ):
        with pytest.raises(rc.NotFoundError, match="not installed: pip install mujoco-menagerie"):
            way()


def test_a_pinned_version_that_is_gone_names_the_package_that_has_it(shop):
    first = fetching.fetch("toy_arm")
    shop("two")
    (first.folder / ".complete").unlink()
    with pytest.raises(rc.NotFoundError, match=rf"mujoco-menagerie=={first.pin.package}`, or this"):
        fetching.fetch("toy_arm")


@pytest.mark.usefixtures("shop")
def test_a_changed_file_is_an_error_that_names_it():
    folder = fetching.fetch("toy_arm").folder
    (folder / "arm.xml").write_text("<mujoco/>")
    with pytest.raises(rc.IoError, match=r"'toy_arm' is not what was fetched: arm\.xml changed in"):
        fetching.fetch("toy_arm")


def test_a_folder_filled_with_robots_is_a_root(shop, tmp_path, monkeypatch):
    fetched = fetching.fetch("toy_arm")
    root = tmp_path / "root"
    assert fetching.copy_to(fetched, root) == root / "toy_arm"
    assert sorted(p.name for p in (root / "toy_arm").iterdir()) == ["arm.xml"]
    assert fetching.read_record(root / fetching.RECORD) == {"toy_arm": fetched.pin}
    monkeypatch.setenv("MENAGERIE_ROOT", str(root))
    assert rc.menagerie.model_path("toy_arm") == str(root / "toy_arm" / "arm.xml")
    shop("two")
    new = fetching.fetch("toy_arm", update=True)
    with pytest.raises(rc.ArgumentError, match="holds other files; fetch with --update"):
        fetching.copy_to(new, root)
    fetching.copy_to(new, root, update=True)
    assert version_of(root / "toy_arm" / "arm.xml") == "two"


def test_robots_that_are_fetched_at_the_same_time_are_all_recorded(shop, tmp_path, monkeypatch):
    names = [f"arm_{n}" for n in range(6)]
    for name in names:
        shop("one_of_" + name, name)
    read = fetching.read_record
    together = threading.Barrier(len(names), timeout=30)

    def slow(path: Path) -> dict[str, fetching.Pin]:
        record = read(path)
        time.sleep(0.02)  # what another one writes now must not be lost
        return record

    monkeypatch.setattr(fetching, "read_record", slow)

    def fetch(name: str) -> None:
        together.wait()
        fetching.copy_to(fetching.fetch(name), tmp_path / "root")

    with ThreadPoolExecutor(len(names)) as pool:
        list(pool.map(fetch, names))
    assert sorted(read(fetching.record_path())) == names
    assert sorted(read(tmp_path / "root" / fetching.RECORD)) == names
    lock = f".{fetching.RECORD}.lock"
    assert sorted(os.listdir(tmp_path / "root")) == sorted([*names, fetching.RECORD, lock])


def test_a_copy_that_fails_keeps_the_former_one(shop, tmp_path, monkeypatch):
    root = tmp_path / "root"
    fetching.copy_to(fetching.fetch("toy_arm"), root)
    shop("two")
    new = fetching.fetch("toy_arm", update=True)
    before = sorted(os.listdir(root))
    rename = Path.rename

    def fail(self: Path, target: Path) -> Path:
        if target == root / "toy_arm" and "one" not in (self / "arm.xml").read_text():
            raise OSError("the disk is gone")
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", fail)
    with pytest.raises(OSError, match="the disk is gone"):
        fetching.copy_to(new, root, update=True)
    assert version_of(root / "toy_arm" / "arm.xml") == "one"
    assert sorted(os.listdir(root)) == before


@pytest.mark.usefixtures("shop")
def test_without_a_network_it_says_what_else_there_is(tmp_path, monkeypatch):
    monkeypatch.setenv("MENAGERIE_BASE_URL", (tmp_path / "nowhere").as_uri())
    with pytest.raises(rc.IoError) as error:
        fetching.fetch("toy_arm")
    assert str(error.value).startswith("robot 'toy_arm' could not be fetched: file://")
    assert f"copy {tmp_path / 'cache'} from a machine that has it, or set MENAGERIE_ROOT" in str(
        error.value
    )
    assert fetching.read_record(fetching.record_path()) == {}


def test_a_model_that_is_nowhere_is_told_with_the_command_that_fetches_it(
    shop, tmp_path, monkeypatch
):
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

    def test_it_downloads_and_records_what_is_not_here(self, run, tmp_path):
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

    def test_it_fills_a_folder_with_what_it_downloaded(self, run, tmp_path):
        assert run("--dest", str(tmp_path / "dest"))[0] == 0
        for file in ("menagerie/kinova_gen3/gen3.xml", "assets/robotiq_2f85/2f85.xml"):
            assert version_of(tmp_path / "dest" / file) == "one"

    def test_without_a_network_it_fails_and_says_what_else_there_is(
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

    def test_a_wrong_variable_is_a_wrong_use(self, run, monkeypatch):
        monkeypatch.setenv("MJ_KDL_MODEL", "/nonexistent")
        code, out, err = run()
        assert (code, out) == (2, "")
        told = "error: MJ_KDL_MODEL is '/nonexistent', which is no file: correct it or unset it\n"
        assert err == told


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("../outside.xml", tarfile.REGTYPE),
        ("toy_arm/../../outside.xml", tarfile.REGTYPE),
        ("/tmp/outside.xml", tarfile.REGTYPE),
        ("toy_arm/link", tarfile.SYMTYPE),
        ("toy_arm/hard", tarfile.LNKTYPE),
        ("toy_arm/pipe", tarfile.FIFOTYPE),
    ],
)
def test_where_python_has_no_filters_an_archive_reaches_nowhere_else(
    name: str, kind: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Before 3.11.4; the archive's members are looked at before any is unpacked."""
    monkeypatch.delattr(tarfile, "data_filter", raising=False)
    plain, folder = tarfile.TarFile.extractall, tmp_path / "deep" / "folder"
    with tarfile.open(tmp_path / "a.tar", "w") as tar:
        tar.addfile(tarfile.TarInfo("toy_arm/arm.xml"))
        member = tarfile.TarInfo(name)
        member.type, member.linkname = kind, "/etc/passwd"
        tar.addfile(member)
    with (
        tarfile.open(tmp_path / "a.tar") as tar,
        pytest.raises(OSError, match=f"the archive holds '{name}', which is no plain file in it"),
        fetching._extraction(),
    ):
        tar.extractall(folder, filter="data")
    assert not folder.exists(), "nothing of it"
    assert tarfile.TarFile.extractall is plain


def test_where_python_has_no_filters_plain_archives_are_unpacked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.delattr(tarfile, "data_filter", raising=False)
    (tmp_path / "arm.xml").write_text("arm")
    with tarfile.open(tmp_path / "a.tar", "w") as tar:
        tar.add(tmp_path / "arm.xml", "toy_arm/arm.xml")
    with tarfile.open(tmp_path / "a.tar") as tar, fetching._extraction():
        tar.extractall(tmp_path / "out", filter="data")
    assert (tmp_path / "out/toy_arm/arm.xml").read_text() == "arm"


@pytest.mark.usefixtures("shop")
def test_unknown_robots_and_broken_records_are_told():
    with pytest.raises(
        rc.NotFoundError, match=r"'toy_amr'. Did you mean 'toy_arm'\?.*fetch --list"
    ):
        fetching.fetch("toy_amr")
    fetching.record_path().parent.mkdir(parents=True)
    fetching.record_path().write_text("[]")
    with pytest.raises(rc.IoError, match=r"menagerie\.json is no record of fetched robots"):
        fetching.fetch("toy_arm")


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
