"""Robots of the Menagerie, and of packages where they are unpacked, work as `init` writes them."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from menagerie import require_menagerie
from robots_from_init import Row, _read_rows, _write_rows, measure, menagerie_models, package_models

EPISODES = 20
LEAST_SHARE = 0.9  # of all models
LEAST_IK = 99.0  # %
PACKAGES = os.environ.get("ROBOCELL_ROBOT_PACKAGES")  # see scripts/robots_from_init.py


def test_rows_describe_the_result_of_a_model():
    worked = Row("a/b", "1 arm, 1 gripper", 15, 0, 100.0, (19, 20))
    assert worked.works
    assert worked.line() == "| a/b | 1 arm, 1 gripper | 15 | ok | 100 % | 19 of 20 |"
    assert not Row("c", why="error: no").works
    assert not Row("d", "1 arm, 1 gripper", 15, 0, 100.0, (0, 20)).works
    assert "does not load: error: no" in Row("c", why="error: no").line()


def test_rows_are_kept_for_a_run_that_goes_on(tmp_path: Path):
    rows = {"a/b": Row("a/b", "1 arm", 12, 1, 99.5, (3, 4)), "c": Row("c", why="no")}
    _write_rows(tmp_path / "rows.json", rows)
    found = _read_rows(tmp_path / "rows.json")
    assert {name: row.line() for name, row in found.items()} == {
        name: row.line() for name, row in rows.items()
    }
    assert _read_rows(tmp_path / "none.json") == {}


def test_models_that_are_not_robots_are_excluded(tmp_path: Path):
    (tmp_path / "arm").mkdir()
    for name in ("arm", "arm_nohand", "scene", "mjx_arm"):
        (tmp_path / "arm" / f"{name}.xml").touch()
    assert sorted(menagerie_models(tmp_path)) == ["arm/arm", "arm/arm_nohand"]
    assert set(package_models(tmp_path).values()) == {None}


@pytest.mark.soak
def test_nine_of_ten_models_work_as_init_writes_them(tmp_path: Path):
    require_menagerie("franka_emika_panda", "ufactory_xarm7")
    models = menagerie_models(Path(os.environ["MENAGERIE_ROOT"]))
    if PACKAGES:
        models |= package_models(Path(PACKAGES))
    rows = [measure(name, file, EPISODES, tmp_path) for name, file in models.items() if file]
    table = "\n".join(row.line() for row in rows)
    assert sum(row.works for row in rows) >= LEAST_SHARE * len(rows), table
    assert all(row.ik >= LEAST_IK for row in rows if row.ik is not None), table
