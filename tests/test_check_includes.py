"""The include table is enforced, and the enforcer notices."""

from __future__ import annotations

from pathlib import Path

import pytest

import check_includes

ROOT = Path(__file__).resolve().parents[1]


def findings_for(tmp_path: Path, file: str, *includes: str) -> list[str]:
    path = tmp_path / file
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("".join(f"#include {include}\n" for include in includes))
    return [str(finding) for finding in check_includes.check(tmp_path)]


@pytest.mark.proof
def test_this_repository_has_no_forbidden_include():
    assert [str(finding) for finding in check_includes.check(ROOT)] == []


def test_every_layer_of_the_table_names_known_layers():
    for layer in check_includes.TABLE:
        assert check_includes.allowed(layer) <= set(check_includes.TABLE)


@pytest.mark.parametrize(
    ("file", "include", "reason"),
    [
        ("base/a.cc", '"robocell/math/pose.h"', "base/ may not include"),
        ("spec/a.cc", '"robocell/mujoco/model.h"', "(it may include base, math)"),
        ("data/a.h", '"robocell/scene/scene.h"', "(it may include base, math, media)"),
        ("render/a.cc", '"robocell/robot/robot.h"', "render/ may not include"),
        ("kinematics/a.cc", '"robocell/robot/robot.h"', "kinematics/ may not include"),
        ("kinematics/a.cc", '"robocell/scene/scene.h"', "kinematics/ may not include"),
        ("kinematics/a.cc", '"robocell/spec/robot_spec.h"', "kinematics/ may not include"),
        ("scene/a.cc", '"robocell/diagnose/trials.h"', "scene/ may not include"),
        ("rollout/a.cc", '"robocell/diagnose/check_robot.h"', "rollout/ may not include"),
        ("control/a.cc", '"robocell/render/camera.h"', "control/ may not include"),
        ("motion/a.cc", '"robocell/scenes/support.h"', "motion/ may not include"),
        ("scenes/a.cc", '"robocell/task/task.h"', "scenes/ may not include"),
        ("env/a.cc", '"robocell/expert/pick_planner.h"', "env/ may not include"),
        ("task/a.cc", '"robocell/data/episode_writer.h"', "of data/ it knows the schema only"),
        ("expert/a.cc", '"robocell/data/dataset.h"', "of data/ it knows the schema only"),
        ("env/a.cc", '"robocell/data/hdf5.h"', "of data/ it knows the schema only"),
        ("math/a_test.cc", '"robocell/spec/spec.h"', "math/ may not include"),
        ("scene/a.cc", '"robocell/testing/menagerie.h"', "testing/ is for tests only"),
        ("scene/a.cc", '"robocell/robocell.h"', "is for users of the library"),
        ("scene/a.cc", '"robocell/bindings/a.h"', "there is no layer bindings/"),
        ("robot/a.cc", "<kdl/chain.hpp>", "only kinematics/ and python/bindings may include KDL"),
        ("spec/a.h", "<yaml-cpp/yaml.h>", "is heavy"),
        ("math/a.h", "<Eigen/Dense>", "is heavy"),
        ("assets/a.h", '"robocell/spec/yaml_reader.h"', "is internal"),
        ("extra/a.cc", "<vector>", "there is no layer extra/"),
    ],
)
def test_a_forbidden_include_is_found(tmp_path, file, include, reason):
    found = findings_for(tmp_path, f"src/robocell/{file}", include)
    assert len(found) == 1
    assert found[0].startswith(f"src/robocell/{file}:1: ")
    assert reason in found[0]


@pytest.mark.parametrize(
    ("file", "include"),
    [
        ("src/robocell/robot/a.cc", '"robocell/mujoco/model.h"'),
        ("src/robocell/robot/testing/a.h", '"robocell/testing/menagerie.h"'),
        ("src/robocell/task/a.h", '"robocell/render/camera.h"'),
        ("src/robocell/rollout/a.cc", '"robocell/data/episode.h"'),
        ("src/robocell/viewer/a.cc", '"robocell/render/renderer.h"'),
        ("src/robocell/math/a_test.cc", '"robocell/testing/menagerie.h"'),
        ("src/robocell/kinematics/a.cc", "<kdl/chain.hpp>"),
        ("src/robocell/math/a.h", "<Eigen/Core>"),
        ("src/robocell/spec/a.cc", "<yaml-cpp/yaml.h>"),
        ("src/robocell/spec/yaml_reader.h", "<yaml-cpp/yaml.h>"),
        ("src/robocell/assets/a.cc", '"robocell/spec/yaml_reader.h"'),
        ("src/robocell/robocell.h", '"robocell/scene/scene.h"'),
        ("python/bindings/scene.cc", '"robocell/rollout/plan.h"'),
        ("python/bindings/pick.cc", '"robocell/expert/pick_planner.h"'),
        ("python/bindings/diagnose.cc", '"robocell/expert/expert_kind.h"'),
    ],
)
def test_an_allowed_include_is_accepted(tmp_path, file, include):
    assert findings_for(tmp_path, file, include) == []


@pytest.mark.parametrize("file", ["src/robocell/rollout/a.cc", "python/bindings/diagnose.cc"])
@pytest.mark.parametrize("header", ["expert/pick_planner.h", "task/pick_task.h"])
def test_users_of_registries_include_no_concrete_task_or_expert(tmp_path, file, header):
    found = findings_for(tmp_path, file, f'"robocell/{header}"')
    assert len(found) == 1
    assert "by their registries only" in found[0]


def test_reports_the_line_of_the_include(tmp_path):
    found = findings_for(tmp_path, "src/robocell/base/a.cc", "<vector>", '"robocell/env/env.h"')
    assert found[0].startswith("src/robocell/base/a.cc:2: ")


def findings_among(tmp_path: Path, **headers: str) -> list[str]:
    """Findings where robocell.h includes public.h, and the headers of math/ have these texts."""
    folder = tmp_path / "src" / "robocell" / "math"
    folder.mkdir(parents=True)
    (folder.parent / "robocell.h").write_text('#include "robocell/math/public.h"\n')
    for name, text in {"public": "", **headers}.items():
        (folder / f"{name}.h").write_text(text)
    return [str(finding) for finding in check_includes.check(tmp_path)]


KERNEL = "namespace robocell::internal {\nvoid Work();\n}\n"
INCLUDE_KERNEL = '#include "robocell/math/kernel.h"\n'


def test_a_private_header_may_include_an_internal_header(tmp_path):
    (tmp_path / "src/robocell/math").mkdir(parents=True)
    (tmp_path / "src/robocell/math/public.cc").write_text(INCLUDE_KERNEL)
    assert check_includes.check(tmp_path) == []


def test_an_installed_header_may_not_include_an_internal_header(tmp_path):
    found = findings_among(tmp_path, public=INCLUDE_KERNEL, kernel=KERNEL)
    assert found == [
        "src/robocell/math/kernel.h:2: 'void Work()': it is internal, but installed headers "
        "include this one"
    ]


PIMPL = """#pragma once
namespace robocell {
namespace internal {
class Work;
}
class Public {
  internal::Work* work = nullptr;  // internal::Other is only a comment
};
}
"""


def test_an_installed_header_may_declare_an_internal_class(tmp_path):
    assert findings_among(tmp_path, public=PIMPL) == []


def test_an_installed_header_names_no_other_internal_class(tmp_path):
    found = findings_among(tmp_path, public=PIMPL.replace("class Work;", "class Other;"))
    assert len(found) == 1
    assert found[0].startswith("src/robocell/math/public.h:7: 'internal::Work'")


@pytest.mark.parametrize(
    "declaration",
    [
        "void Work();",
        "class Work {\n int n;\n};",
        "template <class T>\nvoid Work(T);",
        "int kWork = 1;",
    ],
)
def test_an_unshared_header_declares_in_the_internal_namespace(tmp_path, declaration):
    inside = f"namespace robocell::internal {{\n{declaration}\n}}\n"
    outside = f"namespace robocell {{\n\n{declaration}\n}}\n"
    found = findings_among(tmp_path, inside=inside, outside=outside)
    assert len(found) == 1
    assert found[0].startswith("src/robocell/math/outside.h:3: ")
    assert "declare it in robocell::internal" in found[0]


def test_an_unshared_header_may_declare_public_classes_and_define_their_members(tmp_path):
    text = "namespace robocell {\nclass Public;\nstruct Public::State {\n  int n = 0;\n};\n}\n"
    assert findings_among(tmp_path, state=text + KERNEL) == []


def test_headers_of_bindings_and_tests_use_the_namespace_robocell(tmp_path):
    bindings = tmp_path / "python" / "bindings"
    bindings.mkdir(parents=True)
    (bindings / "math.cc").write_text('#include "robocell/math/bound.h"\n')
    testing = tmp_path / "src" / "robocell" / "math" / "testing"
    public = "namespace robocell {\nvoid Work();\n}\n"
    testing.parent.mkdir(parents=True)
    testing.mkdir()
    (testing / "help.h").write_text(public)
    (testing.parent / "bound.h").write_text(public)
    assert check_includes.check(tmp_path) == []


def test_layers_that_know_tasks_by_the_registry_name_none(tmp_path):
    layers = tmp_path / "src" / "robocell"
    for layer in ("task", "spec", "env"):
        (layers / layer).mkdir(parents=True)
    (layers / "task" / "fold_config.h").write_text(
        "namespace robocell::internal {\nstruct FoldConfig {\n  double angle = 1;\n"
        '  static constexpr const char* kKind = "fold";\n};\n}\n'
    )
    spec = layers / "spec" / "run.cc"
    spec.write_text('// A run of "fold".\nauto* fields = task.If<FoldConfig>();\n')
    (layers / "env" / "a.cc").write_text('if (kind == "fold") return;\n')
    (layers / "env" / "a_test.cc").write_text('auto kind = "fold";\n')
    assert sorted(str(finding) for finding in check_includes.check(tmp_path)) == [
        'src/robocell/env/a.cc:1: "fold" is the name of a task: env/ knows tasks by registry only',
        "src/robocell/spec/run.cc:2: FoldConfig is the fields of task 'fold': "
        "spec/ knows tasks by registry only",
    ]


def test_a_function_is_defined_where_it_is_declared(tmp_path):
    folder = tmp_path / "src/robocell"
    (folder / "scene").mkdir(parents=True)
    (folder / "robot").mkdir()
    (folder / "scene/a.h").write_text("namespace robocell::internal {\nvoid Inspect(int x);\n}\n")
    source = folder / "robot/a.cc"
    source.write_text("namespace robocell::internal {\n\nvoid Inspect(int x) { Use(x); }\n}\n")
    (found,) = check_includes.check(tmp_path)
    assert str(found) == (
        "src/robocell/robot/a.cc:3: Inspect is declared in src/robocell/scene/a.h: define it there"
    )
    source.write_text("namespace robocell {\nnamespace {\nvoid Inspect(int x) { Use(x); }\n}\n}\n")
    assert check_includes.check(tmp_path) == [], "another function of the same name"


def test_the_listed_functions_are_defined_above(monkeypatch: pytest.MonkeyPatch):
    listed = check_includes.DEFINED_ABOVE
    monkeypatch.setattr(check_includes, "DEFINED_ABOVE", {})
    found = [str(finding) for finding in check_includes.check(ROOT)]
    assert len(found) == len(listed)
    for file, name in listed.items():
        assert any(f"{name} is declared in {file}" in line for line in found)
