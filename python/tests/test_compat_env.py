"""Resets of the guide's Env: keyframes by the models' numbers, and the one hook."""

from __future__ import annotations

import gc
import weakref
from pathlib import Path

import mujoco
import numpy as np
import pytest

import robocell as rc
import robocell.compat.mj_kdl_wrapper as mjk

ARM = """
<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="base">
      <body name="upper" pos="0 0 0.2">
        <joint name="a" axis="0 1 0" range="-2 2"/>
        <geom size="0.02" fromto="0 0 0 0.2 0 0" type="capsule" mass="0.5"/>
        <body name="lower" pos="0.2 0 0">
          <joint name="b" axis="0 1 0" range="-2 2"/>
          <geom size="0.02" fromto="0 0 0 0.2 0 0" type="capsule" mass="0.3"/>
        </body>
      </body>
    </body>
  </worldbody>
  <keyframe>
    <key name="{first}" qpos="0.1 0.2"/>
    <key name="{second}" qpos="0.3 0.4"/>
    <key qpos="0.5 0.6"/>
  </keyframe>
</mujoco>
"""
LID = """
<mujoco>
  <worldbody>
    <body name="lid">
      <joint name="turn" axis="0 0 1"/>
      <geom size="0.05" mass="0.1"/>
    </body>
  </worldbody>
  <keyframe>
    <key name="ajar" qpos="0.7"/>
  </keyframe>
</mujoco>
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "lid.xml").write_text(LID)
    for file, first, second in (("one", "folded", "reach"), ("two", "up", "home")):
        (tmp_path / f"{file}.xml").write_text(ARM.format(first=first, second=second))
    return tmp_path


def env_of(folder: Path, *arms: str, lid: bool = False) -> mjk.Env:
    spec = mjk.SceneSpec(timestep=0.002, add_floor=False, add_skybox=False)
    for i, arm in enumerate(arms):
        robot = mjk.RobotSpec()
        robot.path = str(folder / f"{arm}.xml")
        robot.prefix = f"r{i}_" if i else ""
        robot.pos = [0, i, 0]
        spec.robots = [*spec.robots, robot]
    if lid:
        lid_object = mjk.SceneObject(name="box", mjcf_path=str(folder / "lid.xml"))
        lid_object.pos = [1, 0, 0]
        spec.objects = [lid_object]
    return mjk.Env.build(spec)


@pytest.mark.parametrize("arm", ["one", "two"])
def test_the_number_of_a_keyframe_is_the_models(folder: Path, arm: str):
    model = mujoco.MjModel.from_xml_path(str(folder / f"{arm}.xml"))
    data = mujoco.MjData(model)
    env = env_of(folder, arm)
    for number in range(model.nkey):
        mujoco.mj_resetDataKeyframe(model, data, number)
        options = mjk.ResetOptions()
        options.keyframe = number
        ways = (
            env.reset(options),
            env.reset(keyframe=number),
            env.reset(keyframe=np.int64(number)),
        )
        for info in ways:
            assert np.array_equal(env.scene.data.qpos, data.qpos)
            assert env.keyframes()[info.keyframe].endswith(model.key(number).name)
    assert options.keyframe == model.nkey - 1, "options stay as they are"


def test_keyframes_of_several_models_are_numbered_consecutively(folder: Path):
    env = env_of(folder, "one", "two", lid=True)
    reached = []
    for number in range(7):
        env.reset(keyframe=number)
        joints = (env.scene.data.joint(name) for name in ("a", "b", "r1_a", "r1_b", "box_turn"))
        reached.append([round(joint.qpos[0], 3) for joint in joints])
    home = [0, 0, 0.3, 0.4, 0]
    assert reached == [
        [0.1, 0.2, *home[2:]],
        [0.3, 0.4, *home[2:]],
        [0.5, 0.6, *home[2:]],
        [0, 0, 0.1, 0.2, 0],
        home,
        [0, 0, 0.5, 0.6, 0],
        [*home[:4], 0.7],
    ]


def test_an_unknown_keyframe_number_error_lists_all_keyframes(folder: Path):
    env = env_of(folder, "one")
    for number in (3, -1):
        with pytest.raises(rc.NotFoundError) as error:
            env.reset(keyframe=number)
        assert str(error.value) == (
            f"no keyframe {number}. The keyframes of the models: 0 folded, 1 reach, 2 key2"
        )
    with pytest.raises(TypeError, match=r"keyframe: expected a number, a name or .*; got True"):
        env.reset(keyframe=True)


def test_names_and_other_options_match_robocell(folder: Path):
    env = env_of(folder, "one")
    assert env.reset(keyframe="reach").keyframe == env.keyframes().index("reach")
    assert env.reset().keyframe == 0
    assert not env.reset(mjk.ResetOptions(keyframe=1, use_keyframe=False)).used_keyframe
    with pytest.raises(TypeError, match="keyfrme"):
        env.reset(keyfrme=1)


def test_a_model_without_keyframes_has_the_scenes_home(folder: Path):
    text = (folder / "lid.xml").read_text()
    (folder / "plain.xml").write_text(text.partition("<keyframe>")[0] + "</mujoco>")
    assert env_of(folder, "plain").reset(keyframe=0).keyframe == 0


def test_a_hook_can_be_set_again_after_clearing(folder: Path):
    env = env_of(folder, "one")
    first, second = [], []
    for clear in (env.clear_reset_hooks, env.scene.clear_reset_hooks):
        env.on_reset = first.append
        clear()
        assert env.on_reset is None
        env.reset()
        assert not first
        env.on_reset = None
        env.on_reset = second.append
        env.reset()
        assert len(second) == 1
        second.clear()
    env.on_reset = first.append
    env.reset()
    assert (len(first), len(second)) == (1, 0), "it replaced the one before"


def test_a_hook_that_was_replaced_is_released(folder: Path):
    class Hook:
        def __call__(self, context: mjk.ResetContext) -> None:
            pass

    env, hook = env_of(folder, "one"), Hook()
    env.on_reset, gone = hook, weakref.ref(hook)
    assert env.on_reset is hook
    env.on_reset = None
    del hook
    gc.collect()
    assert gone() is None
