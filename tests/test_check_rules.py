"""The house rules are enforced, and the enforcer notices bad samples and spares good ones."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import pytest

import check_rules

ROOT = Path(__file__).resolve().parents[1]
SPEC = "mjsBody* body = mjs_findBody(spec, name);\n"


def reasons(path: str, text: str) -> list[str]:
    return [finding.reason for finding in check_rules.check_text(path, text)]


@pytest.mark.proof
def test_this_repository_follows_the_rules():
    assert [str(finding) for finding in check_rules.check(ROOT)] == []


def test_engine_string_names_match_the_header():
    header = (Path(mujoco.__file__).parent / "include/mujoco/mjspec.h").read_text()
    fields = set(re.findall(r"mjString(?:Vec)?\*\s+(\w+);", header)) - {"data", "target"}
    listed = set(check_rules.ENGINE_STRINGS.split("|")) - {"userdata"}
    assert fields == listed


@pytest.mark.parametrize(
    "line",
    [
        "std::string s = *body->name;",
        "  return *spec->modelname;",
        "f(a, *geom->meshname);",
        "if (body->name->empty()) {",
        "*geom->material = 3;",
        "Read(*bodies[i]->childclass);",
    ],
)
def test_dereferencing_an_engine_string_is_found(line):
    found = reasons("src/robocell/scene/a.cc", SPEC + line)
    assert len(found) == 1
    assert "use mjs_getString" in found[0]


@pytest.mark.parametrize("line", ["starts = task_->Starts(rng);", "task().Arrange(scene, rng)"])
def test_a_bare_call_of_a_hook_of_a_task_is_found(line):
    (found,) = reasons("src/robocell/env/a.cc", line)
    assert "through task/task_calls.h" in found
    assert reasons("src/robocell/task/task_calls.cc", line) == []
    assert reasons("examples/a.cc", line) == []


@pytest.mark.parametrize(
    "line",
    [
        "const char* s = mjs_getString(body->name);",
        'mjs_setString(geom->material, "red");',
        "double area = width * body->size[0];",
        "// never *body->name",
        "n = a * item->info.size();",
        "f(*body->name);  // rule-ok: this body is ours",
    ],
)
def test_other_uses_of_names_are_accepted(line):
    assert reasons("src/robocell/scene/a.cc", SPEC + line) == []


@pytest.mark.parametrize(
    "line",
    [
        "for (int a = 0; a < m->nu; ++a) names.push_back(a);",
        "for (int a = 0; a < model()->nu; ++a) {",
        "const double gear = m->actuator_gear[6 * actuator];",
        "return m_->actuator_lengthrange[2 * a];",
        '{mjOBJ_ACTUATOR, "actuator", &mjModel::nu},',
    ],
)
def test_counting_actuators_by_their_inputs_or_outputs_is_found(line):
    found = reasons("src/robocell/robot/a.cc", line)
    assert len(found) == 1
    assert "mujoco/actuators.h" in found[0]
    assert reasons("src/robocell/robot/a_test.cc", line) == []


@pytest.mark.parametrize(
    "line",
    [
        "for (int a = 0; a < m->nactuator; ++a) {",
        "std::copy_n(m->key_ctrl + key * m->nu, m->nu, data->ctrl);",
        "const double gear = Gear(m, a);",
        "std::copy_n(authored->gear, 6, actuator->gear);",
    ],
)
def test_other_uses_of_actuators_are_accepted(line):
    assert reasons("src/robocell/robot/a.cc", line) == []


def test_files_that_do_not_touch_the_engines_spec_may_have_optional_names():
    assert reasons("src/robocell/spec/a.cc", "use(*robot->name);") == []


@pytest.mark.parametrize(
    ("path", "line", "count"),
    [
        ("src/robocell/scene/a.cc", "double wxyz[4];", 1),
        ("src/robocell/scene/a.cc", "double quat_wxyz_of_base[4];", 1),
        ("src/robocell/scene/a.cc", "Pose::FromWxyz(p, q);", 0),
        ("src/robocell/scene/a.cc", "// wxyz here", 0),
        ("src/robocell/mujoco/a.cc", "double wxyz[4];", 0),
    ],
)
def test_wxyz_stays_in_mujoco(path, line, count):
    assert len(reasons(path, line)) == count


@pytest.mark.parametrize(
    ("path", "line"),
    [
        ("src/robocell/task/a.cc", "std::uniform_real_distribution<double> u;"),
        ("src/robocell/task/a.cc", "std::mt19937 generator;"),
        ("src/robocell/task/a.cc", "int i = rand();"),
        ("python/robocell/a.py", "x = np.random.rand(3)"),
        ("python/robocell/a.py", "import random"),
    ],
)
def test_an_unseeded_generator_is_found(path, line):
    assert len(reasons(path, line)) == 1


def test_a_seeded_generator_is_accepted():
    assert reasons("python/robocell/a.py", "rng = np.random.default_rng(seed)") == []


@pytest.mark.parametrize("path", ["/home/ann/models", "/work/here", "/Users/ann"])
def test_a_path_of_one_machine_is_found_in_any_file(path):
    assert len(reasons("docs/a.md", f"see {path}")) == 1


@pytest.mark.parametrize("text", ["~/work/x", "../work/x", "network/home/x", "/usr/share/x"])
def test_other_paths_are_accepted(text):
    assert reasons("docs/a.md", text) == []


def sources(root: Path, *names: str, listed: str = "") -> list[str]:
    """The findings for a repository with these files."""
    for name in names:
        path = root / "src" / "robocell" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("")
    (root / "scripts").mkdir()
    (root / check_rules.ELSEWHERE).write_text("# reasons\n" + listed)
    return [str(finding) for finding in check_rules.untested(root)]


def test_a_source_has_a_test_of_its_name(tmp_path: Path):
    found = sources(tmp_path, "a/one.cc", "a/one_test.cc", "a/two.cc", "a/testing/three.cc")
    assert found == ["src/robocell/a/two.cc:1: no test of this name: write 'a/two_test.cc'"]


def test_a_source_can_be_tested_in_another_file(tmp_path: Path):
    assert sources(tmp_path, "a/one.cc", "b/two_test.cc", listed="a/one.cc: b/two_test.cc\n") == []


def test_invalid_entries_are_reported(tmp_path: Path):
    listed = "a/one.cc: b/gone_test.cc\na/gone.cc: a/one_test.cc\n"
    found = sources(tmp_path, "a/one.cc", "a/one_test.cc", listed=listed)
    assert found == [
        "scripts/tested_elsewhere.txt:2: 'a/one.cc' has a test of its own, or is gone",
        "scripts/tested_elsewhere.txt:2: no test 'b/gone_test.cc'",
        "scripts/tested_elsewhere.txt:3: 'a/gone.cc' has a test of its own, or is gone",
    ]


def test_the_list_only_gets_shorter(tmp_path: Path):
    count = check_rules.MOST_ELSEWHERE + 1
    names = [f"a/s{i}.cc" for i in range(count)]
    listed = "".join(f"{name}: a/all_test.cc\n" for name in names)
    found = sources(tmp_path, *names, "a/all_test.cc", listed=listed)
    assert len(found) == 1
    assert "only gets shorter" in found[0]


def test_the_limit_is_the_length_of_the_list():
    """So that whoever shortens the list lowers the limit too."""
    lines = (ROOT / check_rules.ELSEWHERE).read_text().splitlines()
    listed = [line for line in lines if not line.startswith("#")]
    assert len(listed) == check_rules.MOST_ELSEWHERE


@pytest.mark.parametrize(
    ("path", "line", "missing"),
    [
        ("src/robocell/a/b.cc", "// As in gone.h, and in there.h.", ["gone.h"]),
        ("src/robocell/a/b.cc", "// See a/soft_gone-inl.h.", ["a/soft_gone-inl.h"]),
        ("src/robocell/a/b.cc", '#include "elsewhere.h"  // <vector.h> and mujoco.h', []),
        ("docs/a.md", "| `there.h`, `gone.h` |", ["gone.h"]),
        ("scripts/a.py", "gone.h", []),
    ],
)
def test_named_headers_exist(path: str, line: str, missing: list[str]):
    found = check_rules.missing_headers(path, line, {"there.h"})
    assert [finding.reason for finding in found] == [f"there is no header '{n}'" for n in missing]


def test_a_public_module_lists_its_names():
    def found(**texts: str) -> list[str]:
        modules = {f"python/robocell/{path}": text for path, text in texts.items()}
        return [str(each) for each in check_rules.python_modules(modules)]

    code = "def f() -> None: ...\n"
    public = "python/robocell/a.py:1: no `__all__`: list what is public, or begin its name with '_'"
    assert found(**{"a.py": code}) == [public]
    assert found(**{"a.py": f"__all__ = ['f']\n{code}"}) == []
    assert found(**{"_a.py": code, "_b/a.py": code, "__main__.py": code}) == []
    assert found(**{"b/__init__.py": '"""Only words."""\n'}) == []
    assert len(found(**{"b/__init__.py": code})) == 1
    twice = ["python/robocell/data/_a.py:1: 'python/robocell/_a.py' has the same name"]
    assert found(**{"_a.py": code, "data/_a.py": code}) == twice
