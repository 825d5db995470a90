"""The guide's caches: `menagerie` and `assets` below ``~/.cache/mj_kdl_wrapper``."""

from __future__ import annotations

import shutil
from pathlib import Path

import mujoco
import pytest

import robocell.compat.mj_kdl_wrapper as mjk
from robocell import NotFoundError, menagerie
from robocell import _fetching as fetching
from robocell.compat.mj_kdl_wrapper._fetch import main


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache; robots come from where the tests have them."""
    from menagerie import require_menagerie

    require_menagerie("kinova_gen3", "robotiq_2f85")
    folders = {name: menagerie.folder(name) for name in ("kinova_gen3", "robotiq_2f85")}
    monkeypatch.setattr(menagerie, "folder", folders.__getitem__)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.delenv("MENAGERIE_ROOT", raising=False)
    for name in ("MODEL", "GRIPPER", "TABLE", "BOTTLE", "RECEIVER", "MENAGERIE"):
        monkeypatch.delenv(f"MJ_KDL_{name}", raising=False)
    return tmp_path / "cache" / "mj_kdl_wrapper"


def test_fetching_fills_the_caches_and_paths_point_there(cache: Path, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["mj-kdl-fetch-menagerie"])
    with pytest.raises(SystemExit) as end:
        main()
    assert not end.value.code
    printed = dict(line.split(": ") for line in capsys.readouterr().out.splitlines())
    assert printed["kinova_gen3"] == str(cache / "menagerie" / "kinova_gen3" / "gen3.xml")
    assert mjk.menagerie.model_path("kinova_gen3") == printed["kinova_gen3"]
    assert mjk.menagerie.model_path("robotiq_2f85") == str(
        cache / "menagerie" / "robotiq_2f85" / "2f85.xml"
    )
    for asset in [*mjk.menagerie.ASSETS, mjk.menagerie.GRIPPER_ASSET]:
        path = mjk.menagerie.asset_path(asset)
        assert path == printed[asset] == str(cache / "assets" / asset)
        assert mujoco.MjModel.from_xml_path(path).nbody


def test_without_a_cache_built_in_files_are_found(cache: Path):
    assert not cache.exists()
    assert Path(mjk.menagerie.asset_path("table.xml")).is_file()
    assert cache not in Path(mjk.menagerie.asset_path("table.xml")).parents


def test_fetching_keeps_existing_files(cache: Path):
    arm = cache / "menagerie" / "kinova_gen3" / "gen3.xml"
    table = cache / "assets" / "table.xml"
    for file in (arm, table):
        file.parent.mkdir(parents=True)
        file.write_text("<mujoco/>")
    mjk.menagerie.fetch()
    assert arm.read_text() == table.read_text() == "<mujoco/>"
    assert mjk.menagerie.model_path("kinova_gen3") == str(arm)
    assert mjk.menagerie.asset_path("table.xml") == str(table)
    assert (cache / "assets" / "mug.xml").is_file()


@pytest.fixture
def own_search(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Robocell's own search finds the robots of the tests."""

    def model_path(name: str) -> str:
        robot, _, file = name.partition("/")
        return str(Path(menagerie.folder(robot)) / (file or fetching.main_file(robot)))

    monkeypatch.setattr(menagerie, "model_path", model_path)


@pytest.mark.usefixtures("own_search")
def test_a_partially_fetched_robot_is_found_elsewhere_and_completed(cache: Path):
    arm = cache / "menagerie" / "kinova_gen3"
    (arm / "assets").mkdir(parents=True)
    (arm / "assets" / "base_link.obj").write_text("cut of")
    (arm / "mine.txt").write_text("mine")
    elsewhere = Path(mjk.menagerie.model_path("kinova_gen3"))
    assert elsewhere.is_file()
    assert cache not in elsewhere.parents
    assert cache not in Path(mjk.menagerie.model_path("kinova_gen3/gen3.xml")).parents
    mjk.menagerie.fetch()
    assert mjk.menagerie.model_path("kinova_gen3") == str(arm / "gen3.xml")
    assert mujoco.MjModel.from_xml_path(str(arm / "gen3.xml")).nbody
    assert (arm / "mine.txt").read_text() == "mine"


@pytest.mark.usefixtures("own_search")
@pytest.mark.parametrize("copies", [0, 1, 12])
def test_a_fetch_survives_interruption_at_any_file(cache: Path, monkeypatch, copies: int):
    copied, copyfile = [], shutil.copyfile

    def interrupted(source: Path, target: Path) -> None:
        if len(copied) == copies:
            Path(target).write_text("<mujoco")
            raise KeyboardInterrupt
        copied.append(copyfile(source, target))

    monkeypatch.setattr(shutil, "copyfile", interrupted)
    with pytest.raises(KeyboardInterrupt):
        mjk.menagerie.fetch()
    monkeypatch.setattr(shutil, "copyfile", copyfile)
    assert not list(cache.rglob(".*.*")), "no parts of files"
    for path in (mjk.menagerie.model_path("kinova_gen3"), mjk.menagerie.asset_path("mug.xml")):
        assert mujoco.MjModel.from_xml_path(path).nbody
    for path in mjk.menagerie.fetch().values():
        assert cache in Path(path).parents
        assert mujoco.MjModel.from_xml_path(path).nbody


def test_rejects_a_source_without_its_main_file(cache: Path, tmp_path: Path, monkeypatch):
    (tmp_path / "kinova_gen3").mkdir()
    folder = menagerie.folder
    sources = {"kinova_gen3": str(tmp_path / "kinova_gen3"), "robotiq_2f85": folder("robotiq_2f85")}
    monkeypatch.setattr(menagerie, "folder", sources.__getitem__)
    with pytest.raises(NotFoundError, match=r"kinova_gen3 has no 'gen3\.xml'\. Delete the folder"):
        mjk.menagerie.fetch()
    assert not (cache / "menagerie" / "kinova_gen3").exists()


def test_variables_take_precedence_over_the_cache(cache: Path, tmp_path: Path, monkeypatch):
    mjk.menagerie.fetch()
    mine = tmp_path / "mine.xml"
    mine.write_text("<mujoco/>")
    for variable, path in (
        ("MJ_KDL_MODEL", lambda: mjk.menagerie.model_path("kinova_gen3")),
        ("MJ_KDL_GRIPPER", lambda: mjk.menagerie.asset_path("robotiq_2f85/2f85.xml")),
        ("MJ_KDL_TABLE", lambda: mjk.menagerie.asset_path("table.xml")),
        ("ROBOCELL_OVERRIDE_TABLE", lambda: mjk.menagerie.asset_path("table.xml")),
        ("ROBOCELL_OVERRIDE_KINOVA_GEN3", lambda: mjk.menagerie.model_path("kinova_gen3")),
    ):
        with monkeypatch.context() as one:
            one.setenv(variable, str(mine))
            assert path() == str(mine), variable
        assert cache in Path(path()).parents, variable


def test_a_robot_in_the_cache_only_is_found(cache: Path):
    model = cache / "menagerie" / "my_arm" / "arm.xml"
    model.parent.mkdir(parents=True)
    model.write_text("<mujoco/>")
    assert mjk.menagerie.model_path("my_arm/arm.xml") == str(model)
