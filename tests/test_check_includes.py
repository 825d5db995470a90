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
    ],
)
def test_an_allowed_include_is_not(tmp_path, file, include):
    assert findings_for(tmp_path, file, include) == []


def test_the_line_of_the_include_is_named(tmp_path):
    found = findings_for(tmp_path, "src/robocell/base/a.cc", "<vector>", '"robocell/env/env.h"')
    assert found[0].startswith("src/robocell/base/a.cc:2: ")


def test_a_public_header_includes_nothing_of_the_namespace_internal(tmp_path):
    folder = tmp_path / "src" / "robocell" / "math"
    folder.mkdir(parents=True)
    kernel = "namespace robocell::internal {\nvoid Work();\n}\n"
    (folder / "kernel.h").write_text(kernel)
    include = '#include "robocell/math/kernel.h"\n'
    (folder / "other_kernel.h").write_text(include + kernel)
    (folder / "public.cc").write_text(include)
    assert check_includes.check(tmp_path) == []
    (folder / "public.h").write_text("#pragma once\n" + include)
    assert [str(finding) for finding in check_includes.check(tmp_path)] == [
        'src/robocell/math/public.h:2: "robocell/math/kernel.h" is of robocell::internal and not '
        "installed: include it in .cc files"
    ]
