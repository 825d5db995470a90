"""Robots of an environment that come in one model, beside the same robots from their own files."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import robocell as rc

RC7 = rc.models.robot_file("rc7")
STANDS = {
    "left": rc.Pose(translation=[0.1, 0.3, 0.2], rpy=[-0.4, 0.1, 0]),
    "right": rc.Pose(translation=[0, -0.3, 0.2], rpy=[0.4, 0, 0.2]),
}
ROOT = rc.Pose(translation=[1, 2, 0], rpy=[0, 0, 0.5])


def model(folder: Path, prefix: str = "robot") -> Path:
    """A torso with both arms."""
    spec = mujoco.MjSpec()
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 10
    torso = spec.worldbody.add_body(name="torso", pos=[9, 9, 9])  # authored; environments drop it
    torso.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.05, 0.2, 0.1])
    for name, pose in STANDS.items():
        arm = mujoco.MjSpec.from_file(rc.models.resolve("rc7"))
        for key in arm.keys:
            arm.delete(key)
        frame = torso.add_frame(pos=pose.translation, quat=np.roll(pose.quaternion, 1))
        frame.attach_body(arm.body("base_link"), f"{prefix}{name}_", "")
    path = folder / "duo.xml"
    path.write_text(spec.to_xml())
    return path


def fields() -> dict[str, object]:
    return {
        "name": "duo",
        "robots": dict.fromkeys(STANDS, RC7),
        "root_frame_to_world": ROOT,
        "control_mode": "cartesian_tquat",
        "sim": {"async_control": True},
    }


def seen(env: rc.Env, steps: int) -> np.ndarray:
    observation, _ = env.reset(seed=4)
    rows = [observation]
    up = {"tquat": [0.01, 0, 0.02, 0, 0, 0, 1], "gripper": 0}
    down = {"tquat": [0, 0.01, -0.02, 0, 0, 0, 1], "gripper": 1}
    for i in range(steps):
        both = (up, down) if i % 2 == 0 else (down, up)
        observation, *_, info = env.step(dict(zip(STANDS, both, strict=True)))
        assert info["collisions"] == []
        rows.append(observation)
    return np.array([[*r[n]["tquat"], *r[n]["joints"], *r[n]["gripper"]] for r in rows for n in r])


def test_a_combined_model_has_the_same_robots(tmp_path):
    apart = rc.Env(rc.EnvConfig(**fields(), robot_to_shared_base_frame=STANDS))
    together = rc.Env(
        rc.EnvConfig(**fields(), alternative_combined_robot_mjcf=str(model(tmp_path)))
    )
    for name, pose in STANDS.items():
        found = together.scene.robot(name).base_in_world
        assert found.is_close(ROOT * pose, 1e-5, 1e-5)
    assert together.scene.body_pose("torso").is_close(ROOT, 1e-9, 1e-9)
    assert np.allclose(seen(apart, 6), seen(together, 6), atol=1e-4)
    lower, upper = (range_["left"]["tquat"] for range_ in together.observation_range)
    assert np.all(lower < upper)


def test_reports_the_collision_of_one_robot_only(tmp_path):
    config = rc.EnvConfig(**fields(), alternative_combined_robot_mjcf=str(model(tmp_path)))
    config.sim = {"async_control": True, "on_collision": "report"}
    config.world_frame_objects = {"wall": ("table", ROOT * rc.Pose(translation=[0.5, 0.6, 0.35]))}
    env = rc.Env(config)
    env.reset(seed=0)
    hit: set[str] = set()
    for _ in range(40):
        down = {"tquat": [0, 0, -0.03, 0, 0, 0, 1], "gripper": 1}
        still = {"tquat": [0, 0, 0, 0, 0, 0, 1], "gripper": 1}
        *_, info = env.step({"left": down, "right": still})
        hit |= {name for name, each in info["robots"].items() if each["collision"]}
    assert hit == {"left"}


def test_element_names_must_start_with_robot_names(tmp_path):
    config = rc.EnvConfig(**fields(), alternative_combined_robot_mjcf=str(model(tmp_path, "arm_")))
    with pytest.raises(rc.SpecError) as error:
        rc.Scene.build(rc.envs.env_scene_spec(config))
    assert "the names of robot 'left' must begin with 'robotleft_'; its bodies are " in str(
        error.value
    )
    assert "arm_left_base_link" in str(error.value)


def test_robots_keep_their_poses_in_the_combined_model(tmp_path):
    config = rc.EnvConfig(**fields(), robot_to_shared_base_frame=STANDS)
    config.alternative_combined_robot_mjcf = str(model(tmp_path))
    with pytest.raises(rc.SpecError, match="the robots stand where alternative_combined_robot_mj"):
        rc.envs.env_scene_spec(config)


def test_a_robot_is_part_of_an_earlier_one(tmp_path):
    spec = rc.envs.env_scene_spec(
        rc.EnvConfig(**fields(), alternative_combined_robot_mjcf=str(model(tmp_path)))
    )
    assert (spec.robots[0].part_of, spec.robots[1].part_of) == ("", "left")
    spec.robots[1].prefix = "r_"
    with pytest.raises(rc.SpecError, match=r"prefix: must be that of robot 'left', which it is pa"):
        rc.Scene.build(spec)
    spec.robots[1].part_of = "lefft"
    with pytest.raises(rc.SpecError, match=r"robot 'right': part_of: no earlier robot 'lefft'"):
        rc.Scene.build(spec)
