"""Tools whose models stand on a free joint of their own, mounted on an arm."""

from __future__ import annotations

from pathlib import Path

import init_models
import robocell as rc


def test_the_free_joint_of_a_tool_is_left_out_with_a_note(tmp_path: Path):
    (tmp_path / "arm.xml").write_text(init_models.arm_without_hand())
    (tmp_path / "hand.xml").write_text(init_models.hand_alone())
    config = rc.RobotConfig.from_yaml(
        "name: arm\nmodel: arm.xml\nroot_body: base\n"
        "attachments: [{mjcf_path: hand.xml, attach_to: {site: flange}, prefix: h_}]\n"
        "move_groups: {arm: {kind: arm, joints: j1..j6, leaf: {site: flange}}}\n",
        directory=str(tmp_path),
    )
    spec = rc.SceneSpec(name="tool", timestep=0.002, add_floor=False, add_skybox=False)
    spec.robots.append(rc.RobotSpec(name="arm", config=config))
    scene = rc.Scene.build(spec)
    model = scene.model
    assert 0 not in model.jnt_type[:]  # no free joint
    assert any("the free joint of 'hand' is left out: it is mounted here" in n for n in scene.notes)
    hand = next(b for b in range(model.nbody) if model.body(b).name.endswith("h_hand"))
    assert model.body(model.body_parentid[hand]).name.endswith("l6")
