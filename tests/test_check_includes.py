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
        ("scene/a.cc", '"robocell/diagnose/finding.h"', "scene/ may not include"),
        ("rollout/a.cc", '"robocell/diagnose/check_robot.h"', "rollout/ may not include"),
        ("control/a.cc", '"robocell/render/camera.h"', "control/ may not include"),
        ("motion/a.cc", '"robocell/scenes/support.h"', "motion/ may not include"),
        ("scenes/a.cc", '"robocell/task/task.h"', "scenes/ may not include"),
        ("env/a.cc", '"robocell/expert/pick_planner.h"', "env/ may not include"),
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
def test_an_allowed_include_is_not(tmp_path, file, include):
    assert findings_for(tmp_path, file, include) == []


@pytest.mark.parametrize("file", ["src/robocell/rollout/a.cc", "python/bindings/diagnose.cc"])
@pytest.mark.parametrize("header", ["expert/pick_planner.h", "task/pick_task.h"])
def test_who_knows_tasks_and_experts_by_their_registries_knows_no_concrete_one(
    tmp_path, file, header
):
    found = findings_for(tmp_path, file, f'"robocell/{header}"')
    assert len(found) == 1
    assert "by their registries only" in found[0]


def test_the_line_of_the_include_is_named(tmp_path):
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


def test_a_header_that_is_not_installed_may_include_one_of_the_namespace_internal(tmp_path):
    (tmp_path / "src/robocell/math").mkdir(parents=True)
    (tmp_path / "src/robocell/math/public.cc").write_text(INCLUDE_KERNEL)
    assert check_includes.check(tmp_path) == []


def test_what_an_installed_header_includes_must_be_installed_so_it_is_not_internal(tmp_path):
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
def test_a_header_that_nobody_else_uses_declares_in_the_namespace_internal(tmp_path, declaration):
    inside = f"namespace robocell::internal {{\n{declaration}\n}}\n"
    outside = f"namespace robocell {{\n\n{declaration}\n}}\n"
    found = findings_among(tmp_path, inside=inside, outside=outside)
    assert len(found) == 1
    assert found[0].startswith("src/robocell/math/outside.h:3: ")
    assert "declare it in robocell::internal" in found[0]


def test_it_may_declare_what_is_public_and_define_what_is_within_a_public_class(tmp_path):
    text = "namespace robocell {\nclass Public;\nstruct Public::State {\n  int n = 0;\n};\n}\n"
    assert findings_among(tmp_path, state=text + KERNEL) == []


def test_headers_of_the_bindings_and_of_tests_stay_in_the_namespace_robocell(tmp_path):
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
