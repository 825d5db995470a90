"""Robots of the Menagerie are fetched, pinned and copied, from archives of a made-up robot."""

from __future__ import annotations

import hashlib
import json
import os
import sys
import tarfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import mujoco_menagerie
import pytest

import robocell as rc
from robocell import _fetching as fetching
from robocell._cli.fetch import fetch as fetch_command
from robocell.compat.mj_kdl_wrapper import menagerie as guide
from toy_robots import shop, version_of

__all__ = ["shop"]  # a fixture


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


def test_a_fetched_robot_keeps_its_version_until_updated(shop):
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


def test_without_the_package_errors_have_the_install_command(tmp_path, monkeypatch):
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


def test_a_missing_pinned_version_error_names_its_package(shop):
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


def test_concurrently_fetched_robots_are_all_recorded(shop, tmp_path, monkeypatch):
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


def test_a_failed_copy_keeps_the_previous_one(shop, tmp_path, monkeypatch):
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
def test_without_tar_filters_rejects_archives_that_leave_the_folder(
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
        pytest.raises(OSError, match=f"archive holds '{name}', which is not a plain file in it"),
        fetching._extraction(),
    ):
        tar.extractall(folder, filter="data")
    assert not folder.exists(), "nothing of it"
    assert tarfile.TarFile.extractall is plain


def test_without_tar_filters_unpacks_plain_archives(
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
def test_rejects_unknown_robots_and_broken_records():
    with pytest.raises(
        rc.NotFoundError, match=r"'toy_amr'. Did you mean 'toy_arm'\?.*fetch --list"
    ):
        fetching.fetch("toy_amr")
    fetching.record_path().parent.mkdir(parents=True)
    fetching.record_path().write_text("[]")
    with pytest.raises(rc.IoError, match=r"menagerie\.json is not a record of fetched robots"):
        fetching.fetch("toy_arm")
