"""The picture of `robocell check`: the whole robot and what is near it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import robocell as rc
from robocell._cli.robot_picture import SIZE_PX, robot_points, view_of
from robocell._cli.robot_scene import load_robot
from robocell._cli.robot_table import frames

MAST = """<mujoco><worldbody><body name="mast">
<geom type="box" size="0.1 0.1 {half}" pos="0 0 {half}"/>
<body name="link" pos="0 0 {top}"><joint name="hip" axis="0 1 0" range="-90 90"/>
<geom type="capsule" size="0.05" fromto="0 0 0 {reach} 0 0" mass="1"/>
<site name="tip" pos="{reach} 0 0"/>
</body></body></worldbody><actuator><position name="drive" joint="hip" kp="900" kv="90"/></actuator>
</mujoco>"""


@pytest.mark.parametrize(("tall", "reach"), [(6, 0.5), (0.4, 3)])
def test_a_picture_shows_the_whole_robot_and_its_surroundings(
    tmp_path: Path, tall: float, reach: float
):
    (tmp_path / "mast.xml").write_text(MAST.format(half=tall / 2, top=tall, reach=reach))
    robot_file = tmp_path / "mast.yaml"
    robot_file.write_text(
        "name: mast\nmodel: mast.xml\n"
        "move_groups: {arm: {kind: arm, joints: [hip], leaf: {site: tip}}}\n"
        "cameras:\n"
        f"  - {{name: near, attach_to: {{body: mast}}, pos: [0, -1, {tall}], fovy: 60}}\n"
        "  - {name: far, attach_to: {body: mast}, pos: [0, 500, 0], fovy: 60}\n"
    )
    loaded = load_robot(robot_file)
    loaded.scene.reset()
    width, height = SIZE_PX[0] // 8, SIZE_PX[1] // 8
    view = rc.render.Renderer(loaded.scene).render(view_of(loaded), width=width, height=height)
    points = np.vstack([robot_points(loaded), frames(loaded)["near"].translation])
    seen = view["extrinsics"] @ np.vstack([points.T, np.ones(len(points))])
    across, down, depth = view["intrinsics"] @ seen[:3]
    assert np.all(depth > 0)
    assert np.all((across / depth > 0) & (across / depth < width))
    assert np.all((down / depth > 0) & (down / depth < height))
    filled = max(np.ptp(across / depth) / width, np.ptp(down / depth) / height)
    assert filled > 0.5, "and not as a dot"
