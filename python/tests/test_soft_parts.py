"""Tendons, flexes and skins of pages are where the engine's own visualiser draws them."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest

from robocell._web.packed import Packed, unpacked
from robocell._web.soft_parts import SoftParts

SOFT = """
<mujoco>
  <asset>
    <material name="red" rgba="1 0 0 1"/>
  </asset>
  <worldbody>
    <site name="anchor" pos="0.3 0 1"/>
    <geom name="drum" type="cylinder" size="0.12 0.2" pos="0.15 0 0.75" euler="90 0 0"/>
    <site name="side" pos="0.15 0 0.95"/>
    <body name="upper" pos="0 0 1">
      <joint name="hinge" axis="0 1 0"/>
      <geom size="0.03" pos="0 0 -0.2"/>
      <site name="tip" pos="0 0 -0.25"/>
      <body name="lower" pos="0 0 -0.3">
        <joint axis="1 0 0"/>
        <geom size="0.03" pos="0 0 -0.1"/>
        <site name="toe" pos="0 0 -0.1"/>
      </body>
    </body>
    <body pos="0 0.6 0.6">
      <freejoint/>
      <geom size="0.01"/>
    </body>
    <flexcomp type="grid" count="4 3 1" spacing="0.1 0.1 0.1" pos="0 1 0.5" name="cloth" dim="2"
      radius="0.001" rgba="0 0 1 1"/>
    <flexcomp type="grid" count="3 3 3" spacing="0.1 0.1 0.1" pos="0 2 0.5" name="block" dim="3"
      radius="0.001"/>
    <flexcomp type="grid" count="5 1 1" spacing="0.1 0.1 0.1" pos="0 3 0.5" name="rope" dim="1"
      radius="0.005"/>
  </worldbody>
  <tendon>
    <spatial name="cable" material="red" width="0.01">
      <site site="anchor"/>
      <geom geom="drum" sidesite="side"/>
      <site site="tip"/>
      <pulley divisor="2"/>
      <site site="tip"/>
      <site site="toe"/>
    </spatial>
    <spatial name="hidden" group="4"><site site="anchor"/><site site="toe"/></spatial>
    <fixed name="joints"><joint joint="hinge" coef="1"/></fixed>
  </tendon>
</mujoco>
"""


def skin() -> str:
    """Returns a strip that hangs on both links."""
    rng = np.random.default_rng(0)
    vertices = rng.uniform([-0.05, -0.05, 0.4], [0.05, 0.05, 1], (12, 3))
    upper = rng.uniform(0, 1, 12)

    def text(values: Any) -> str:
        return " ".join(map(str, np.ravel(values)))

    def bone(body: str, pos: str, quat: str, weights: Any) -> str:
        return (
            f'<bone body="{body}" bindpos="{pos}" bindquat="{quat}" vertid="{text(range(12))}" '
            f'vertweight="{text(weights)}"/>'
        )

    return (
        f'<deformable><skin name="strip" rgba="0 1 0 1" vertex="{text(vertices)}" '
        f'face="{text([[i, i + 1, i + 2] for i in range(10)])}">'
        + bone("upper", "0 0 1", "1 0 0 0", upper)
        + bone("lower", "0 0 0.7", "0.9 0.1 0.3 0.3", 1 - upper)
        + "</skin></deformable></mujoco>"
    )


def soft_model() -> str:
    """Returns a model with tendons, flexes and a skin."""
    return SOFT.replace("</mujoco>", skin())


@pytest.fixture(scope="module")
def model() -> Any:
    return mujoco.MjModel.from_xml_string(soft_model())


def moved(model: Any, steps: int) -> Any:
    data = mujoco.MjData(model)
    data.qvel[:2] = (3, 2)
    for _ in range(steps):
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    return data


@pytest.mark.parametrize("steps", [0, 60])
def test_points_are_where_the_engine_draws(model: Any, steps: int):
    data = moved(model, steps)
    seen = mujoco.MjvScene(model, maxgeom=1000)
    option = mujoco.MjvOption()
    option.flags[mujoco.mjtVisFlag.mjVIS_TENDON] = True
    camera = mujoco.MjvCamera()
    mujoco.mjv_updateScene(model, data, option, None, camera, mujoco.mjtCatBit.mjCAT_ALL, seen)
    soft = SoftParts(model)
    parts = soft.header(Packed())
    points = soft.points(data)
    assert points.shape == (soft.count, 3)
    assert [part["kind"] for part in parts] == ["segments", *["surface"] * 2, "segments", "surface"]
    cable, cloth, block, rope, strip = (
        points[part["first"] : part["first"] + part["count"]] for part in parts
    )
    drawn = [
        geom for geom in seen.geoms[: seen.ngeom] if geom.objtype == mujoco.mjtObj.mjOBJ_TENDON
    ]
    ends = cable.reshape(-1, 2, 3)
    ends = ends[np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) > 0]
    # A connector begins at its `pos`, or has its middle there. The engine draws an arc on a drum,
    # where a page draws its chord.
    at = np.array([geom.pos for geom in drawn])
    is_drawn = [
        min(np.linalg.norm(at - place, axis=1).min() for place in (start, (start + end) / 2)) < 1e-5
        for start, end in ends
    ]
    wraps = steps == 0
    assert len(ends) == (4 if wraps else 2)
    assert sum(is_drawn) >= len(ends) - wraps
    for i, found in enumerate((cloth, block)):
        first, count = model.flex_vertadr[i], model.flex_vertnum[i]
        np.testing.assert_allclose(found, data.flexvert_xpos[first : first + count], atol=1e-6)
    assert rope.shape == (8, 3)
    np.testing.assert_allclose(strip.reshape(-1), seen.skinvert[: 3 * 12], atol=1e-5)


def test_the_header_has_triangles_and_colours(model: Any):
    packed = Packed()
    soft = SoftParts(model)
    header, array = unpacked(packed.block({"soft": soft.header(packed)}))
    cable, cloth, block, rope, strip = header["soft"]
    assert cable["rgba"] == [1, 0, 0, 1]
    assert cable["radius"] == pytest.approx(0.01)
    assert cloth["rgba"] == [0, 0, 1, 1]
    assert array(cloth["faces"]).size == 3 * 12  # 3 x 2 squares
    assert array(block["faces"]).size == 3 * 48  # 6 sides of 2 x 2 squares
    assert array(strip["faces"]).size == 30
    assert rope["count"] == 8
    for part in (cloth, block, strip):
        assert array(part["faces"]).max() < part["count"]


def test_a_model_without_soft_parts_has_no_points():
    model: Any = mujoco.MjModel.from_xml_string("<mujoco><worldbody/></mujoco>")
    soft = SoftParts(model)
    assert soft.points(mujoco.MjData(model)).shape == (0, 3)
    assert soft.header(Packed()) == []
