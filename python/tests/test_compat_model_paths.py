"""Where the guide's models and assets are found: the variables, and the command that fetches."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest

import robocell.compat.mj_kdl_wrapper as mjk
from robocell.compat.mj_kdl_wrapper._fetch import main


@pytest.fixture(scope="module", autouse=True)
def in_a_fetched_folder(tmp_path_factory: pytest.TempPathFactory):
    """Started in a folder that `mj-kdl-fetch-menagerie --dest` filled: `assets/...` is there."""
    from menagerie import require_menagerie

    require_menagerie("kinova_gen3", "robotiq_2f85")
    folder = tmp_path_factory.mktemp("guide")
    mjk.menagerie.fetch(folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        yield folder


class TestModelPaths:
    def test_user_files_take_precedence(self, tmp_path, monkeypatch):
        mine = tmp_path / "mine.xml"
        mine.write_text("<mujoco/>")
        for variable, path in (
            ("MJ_KDL_MODEL", lambda: mjk.menagerie.model_path("kinova_gen3")),
            ("MJ_KDL_GRIPPER", lambda: mjk.menagerie.asset_path("robotiq_2f85/2f85.xml")),
            ("MJ_KDL_TABLE", lambda: mjk.menagerie.asset_path("table.xml")),
            ("MJ_KDL_BOTTLE", lambda: mjk.menagerie.asset_path("bottle.xml")),
            ("MJ_KDL_RECEIVER", lambda: mjk.menagerie.asset_path("receiver.xml")),
        ):
            assert Path(path()).is_file()
            monkeypatch.setenv(variable, str(mine))
            assert path() == str(mine)
            monkeypatch.setenv(variable, "/nonexistent")
            with pytest.raises(RuntimeError, match=f"^{variable} is '/nonexistent', which is not"):
                path()
            monkeypatch.delenv(variable)

    def test_a_custom_variable_takes_precedence(self, tmp_path, monkeypatch):
        mine = tmp_path / "mine.xml"
        mine.write_text("<mujoco/>")
        paths = (
            lambda: mjk.menagerie.model_path("kinova_gen3", env_var="MY_ARM"),
            lambda: mjk.menagerie.asset_path("table.xml", env_var="MY_ARM"),
            lambda: mjk.menagerie.asset_path("robotiq_2f85/2f85.xml", env_var="MY_ARM"),
        )
        for path in paths:
            assert path() != str(mine)
        monkeypatch.setenv("MY_ARM", str(mine))
        assert [path() for path in paths] == [str(mine)] * 3
        monkeypatch.setenv("MY_ARM", "/nonexistent")
        for path in paths:
            with pytest.raises(RuntimeError, match=r"^MY_ARM is '/nonexistent', which is not a f"):
                path()

    def test_a_user_root_comes_after_user_files(self, in_a_fetched_folder, monkeypatch):
        root = in_a_fetched_folder / "menagerie"
        monkeypatch.setenv("MJ_KDL_MENAGERIE", str(root))
        assert mjk.menagerie.model_path("kinova_gen3") == str(root / "kinova_gen3" / "gen3.xml")
        monkeypatch.setenv("MJ_KDL_MENAGERIE", "/nonexistent")
        with pytest.raises(RuntimeError, match=r"^MJ_KDL_MENAGERIE is '/nonexistent', which holds"):
            mjk.menagerie.model_path("kinova_gen3")

    @pytest.mark.parametrize("variable", ["MJ_KDL_MENAGERIE", "XDG_CACHE_HOME"])
    def test_custom_robots_are_found_in_a_root_or_the_cache(self, tmp_path, monkeypatch, variable):
        monkeypatch.setenv(variable, str(tmp_path))
        cache = mjk.menagerie.cache_dir() / "menagerie"
        folder = (tmp_path if variable == "MJ_KDL_MENAGERIE" else cache) / "my_arm"
        folder.mkdir(parents=True)
        (folder / "left.xml").write_text("<mujoco/>")
        left = str((folder / "left.xml").resolve())
        assert mjk.menagerie.model_path("my_arm") == left, "its only model"
        (folder / "right.xml").write_text("<mujoco/>")
        assert mjk.menagerie.model_path("my_arm/left.xml") == left
        for name, wrong in (("my_arm", "no main file"), ("my_arm/lft.xml", "no file 'lft.xml'")):
            with pytest.raises(
                RuntimeError, match=f"'my_arm' has {wrong}.*left.xml, right.xml"
            ) as e:
                mjk.menagerie.model_path(name)
            assert "model_path('my_arm/left.xml')" in str(e.value)

    def test_the_most_specific_variable_wins(self, in_a_fetched_folder, tmp_path, monkeypatch):
        arm, gripper, mine = (tmp_path / f"{name}.xml" for name in ("arm", "gripper", "mine"))
        for file in (arm, gripper, mine):
            file.write_text("<mujoco/>")

        def models() -> list[str]:
            names = ("kinova_gen3", "robotiq_2f85")
            return [mjk.menagerie.model_path(name, env_var="MY_MODEL") for name in names]

        root = in_a_fetched_folder / "menagerie"
        of_root = [str(root / "kinova_gen3/gen3.xml"), str(root / "robotiq_2f85/2f85.xml")]
        for variable, value, expected in (
            ("MENAGERIE_ROOT", "/nonexistent", None),
            ("MJ_KDL_MENAGERIE", root, of_root),
            ("MJ_KDL_MODEL", arm, [str(arm), of_root[1]]),
            ("MJ_KDL_GRIPPER", gripper, [str(arm), str(gripper)]),
            ("MJ_KDL_MENAGERIE", "/nonexistent", [str(arm), str(gripper)]),
            ("MY_MODEL", mine, [str(mine)] * 2),
        ):
            monkeypatch.setenv(variable, str(value))
            if expected:
                assert models() == expected, variable

    def test_rejects_unknown_robots_with_any_variables(self, tmp_path, monkeypatch):
        for _ in range(2):
            with pytest.raises(RuntimeError, match=r"no robot 'kinova_gen4'.*mean 'kinova_gen3'\?"):
                mjk.menagerie.model_path("kinova_gen4")
            (tmp_path / "mine.xml").write_text("<mujoco/>")
            monkeypatch.setenv("MJ_KDL_MODEL", str(tmp_path / "mine.xml"))

    def test_an_unknown_asset_error_lists_the_assets(self):
        with pytest.raises(RuntimeError, match=r"no asset 'tabel\.xml'\. The assets: table\.xml, "):
            mjk.menagerie.asset_path("tabel.xml")

    def test_every_asset_of_the_folder_loads(self, in_a_fetched_folder):
        for asset in [*mjk.menagerie.ASSETS, mjk.menagerie.GRIPPER_ASSET]:
            assert mujoco.MjModel.from_xml_path(str(in_a_fetched_folder / "assets" / asset)).nbody

    def test_the_command_prints_where_everything_is(self, tmp_path, capsys, monkeypatch):
        monkeypatch.setattr("sys.argv", ["mj-kdl-fetch-menagerie", "--dest", str(tmp_path)])
        with pytest.raises(SystemExit) as end:
            main()
        assert not end.value.code
        lines = dict(line.split(": ") for line in capsys.readouterr().out.splitlines())
        assert lines["cabinet/cabinet.xml"] == str(tmp_path / "assets" / "cabinet" / "cabinet.xml")
        assert lines["kinova_gen3"] == str(tmp_path / "menagerie" / "kinova_gen3" / "gen3.xml")
        assert all(Path(path).is_file() for path in lines.values())
