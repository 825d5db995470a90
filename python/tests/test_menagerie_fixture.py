"""The rule by which tests find the Menagerie and by which CI refuses skips."""

from __future__ import annotations

from pathlib import Path

import pytest

import menagerie as rule

pytest_plugins = ["pytester"]


def make_model(folder: Path) -> Path:
    folder.mkdir(parents=True)
    (folder / "arm.xml").write_text("<mujoco/>")
    return folder


def test_a_root_from_the_environment_is_used(tmp_path, monkeypatch):
    make_model(tmp_path / "arm")
    monkeypatch.setenv("MENAGERIE_ROOT", str(tmp_path))
    assert rule.require_menagerie("arm").path("arm", "arm.xml") == tmp_path / "arm" / "arm.xml"


def test_without_a_root_a_complete_cache_is_used(tmp_path, monkeypatch):
    folder = make_model(tmp_path / "models" / "arm-0123456789abcdef")
    monkeypatch.setenv("MENAGERIE_ROOT", "")
    monkeypatch.setenv("MENAGERIE_CACHE_DIR", str(tmp_path))
    assert rule.find_model("arm") is None, "half a download is no model"
    (folder / ".complete").write_text("{}")
    assert rule.find_model("arm") == folder
    assert rule.find_model("ar") is None


def test_a_missing_model_names_itself_the_place_and_the_command(tmp_path, monkeypatch):
    monkeypatch.setenv("MENAGERIE_ROOT", str(tmp_path))
    with pytest.raises(rule.MissingModelError) as error:
        rule.Menagerie().path("arm")
    assert str(error.value) == (
        f"Menagerie models missing: arm. Looked: MENAGERIE_ROOT ({tmp_path}), "
        "the cache of mujoco-menagerie. Fetch them: robocell fetch arm"
    )


@pytest.mark.parametrize("ci", ["true", ""])
def test_a_skip_is_a_failure_in_ci_only(pytester, monkeypatch, ci):
    """That of a test, and that of a file that skips itself."""
    monkeypatch.setenv("CI", ci)
    monkeypatch.setenv("MENAGERIE_ROOT", str(pytester.path))
    monkeypatch.setenv("MENAGERIE_CACHE_DIR", str(pytester.path))
    pytester.makeconftest(
        (rule.REPOSITORY / "conftest.py")
        .read_text()
        .replace("Path(__file__).parent", f"Path({str(rule.REPOSITORY)!r})")
    )
    pytester.makepyfile(
        test_one="def test_robot(menagerie): pass",
        test_two="import pytest; pytest.importorskip('no_such_package')",
    )
    result = pytester.runpytest_subprocess(
        "-rA", "-p", "no:cacheprovider", "--continue-on-collection-errors"
    )
    result.assert_outcomes(**{"errors" if ci else "skipped": 2})
    result.stdout.fnmatch_lines(["*Menagerie models missing: ufactory_xarm7*"])
    if ci:
        result.stdout.fnmatch_lines(["*was skipped, and CI allows no skip*"])
