"""The built-in models keep what models/README.md says of them; judged by plain mujoco."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

import make_equipment
import make_objects

MODELS = Path(__file__).resolve().parents[2] / "models"
# What tasks draw by default; test_catalogue.py judges all kinds.
OBJECTS = sorted(
    p.parent.name
    for p in MODELS.glob("objects/*/object.yaml")
    if "drawn_by_default: true" in p.read_text()
)
RC7 = MODELS / "robots" / "rc7" / "rc7.xml"


def object_file(name: str) -> Path:
    return MODELS / "objects" / name / f"{name}.xml"


def collision_points(model: mujoco.MjModel, data: mujoco.MjData, body: int) -> np.ndarray:
    """Corners of the boxes around a body's collision geoms; (n, 3), world."""
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    points = []
    for geom in np.flatnonzero((model.geom_contype != 0) & (model.geom_bodyid == body)):
        box = model.geom_aabb[geom]
        rotation = data.geom_xmat[geom].reshape(3, 3)
        points.append((box[:3] + signs * box[3:]) @ rotation.T + data.geom_xpos[geom])
    return np.vstack(points)


@pytest.fixture
def rc7() -> tuple[mujoco.MjModel, mujoco.MjData]:
    spec = mujoco.MjSpec.from_file(str(RC7))
    for body in spec.bodies[1:]:
        body.gravcomp = 1
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    return model, data


def pad_gap(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    pads = [model.geom(f"{side}_finger_pad").id for side in ("left", "right")]
    return mujoco.mj_geomDistance(model, data, *pads, 0.2, None)


@pytest.mark.parametrize("vessel", ["open_bottle", "receiver"])
def test_a_vessel_stands_on_its_bottom_alone(vessel: str):
    spec = mujoco.MjSpec.from_file(str(MODELS / "equipment" / vessel / f"{vessel}.xml"))
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[1, 1, 0.1])
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[2] = 0.08
    for _ in range(150):
        mujoco.mj_step(model, data)
    upright = data.xmat[1].reshape(3, 3)[2, 2]
    assert upright > 0.9999
    # A ring of walls on the ground would make ten times as many contacts, each of which costs time.
    assert {model.geom(g).name for c in data.contact for g in c.geom if g} == {f"{vessel}_bottom"}
    assert 3 <= data.ncon <= 4


def test_the_generator_reproduces_the_objects_of_the_repository(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.argv", ["make_objects.py", "--out", str(tmp_path)])
    make_objects.main()
    written = sorted(p.relative_to(tmp_path) for p in tmp_path.rglob("*.*"))
    files = [p for p in MODELS.glob("objects/*/*") if p.suffix != ".png"]
    kept = sorted(p.relative_to(MODELS / "objects") for p in files)
    assert written == kept
    for path in written:
        assert (tmp_path / path).read_bytes() == (MODELS / "objects" / path).read_bytes(), path


def test_the_generator_reproduces_the_equipment_of_the_repository(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.argv", ["make_equipment.py", "--out", str(tmp_path)])
    make_equipment.main()
    written = sorted(p.relative_to(tmp_path) for p in tmp_path.rglob("*.*"))
    assert {str(p.parent) for p in written} >= {"open_bottle", "receiver", "lid_box", "microwave"}
    for path in written:
        assert (tmp_path / path).read_bytes() == (MODELS / "equipment" / path).read_bytes(), path


@pytest.mark.parametrize("name", OBJECTS)
def test_an_object_has_one_free_root_with_its_name(name):
    model = mujoco.MjModel.from_xml_path(str(object_file(name)))
    assert (model.nbody, model.njnt) == (2, 1)
    assert model.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE
    assert model.body(1).name == name
    assert 0.05 < model.body_mass[1] < 0.3


@pytest.mark.parametrize("name", OBJECTS)
def test_an_object_is_centred_and_its_collision_and_visual_shapes_agree(name):
    model = mujoco.MjModel.from_xml_path(str(object_file(name)))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    touch = collision_points(model, data, body=1)
    geom, mesh = model.geom(f"{name}_visual").id, model.mesh(name)
    first = int(mesh.vertadr[0])
    vertices = model.mesh_vert[first : first + int(mesh.vertnum[0])]
    sight = vertices @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
    np.testing.assert_allclose(touch.min(0), sight.min(0), atol=1.5e-3)
    np.testing.assert_allclose(touch.max(0), sight.max(0), atol=1.5e-3)
    height = (sight[:, 2].max() + sight[:, 2].min()) / 2
    assert abs(height) < 1e-4


@pytest.mark.parametrize("name", OBJECTS)
def test_an_object_on_the_table_stays_there(name):
    spec = mujoco.MjSpec.from_file(str(MODELS / "scenes" / "tabletop.xml"))
    child = mujoco.MjSpec.from_file(str(object_file(name)))
    body = spec.worldbody.add_frame().attach_body(child.body(name), "object_", "")
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    height = data.site("table_top").xpos[2] - collision_points(model, data, body.id)[:, 2].min()
    data.qpos[2] = height
    mujoco.mj_step(model, data, 500)
    np.testing.assert_allclose(data.qpos[:3], [0, 0, height], atol=2e-3)
    assert np.abs(data.qvel).max() < 0.02


def test_rc7_at_home_points_its_gripper_down_and_its_x_axis_outwards(rc7):
    _, data = rc7
    rotation = data.site("tcp").xmat.reshape(3, 3)
    np.testing.assert_allclose(rotation[:, 2], [0, 0, -1], atol=1e-4)
    np.testing.assert_allclose(rotation[:, 0], [1, 0, 0], atol=1e-4)
    assert data.ncon == 0


def test_rc7_follows_a_motion_and_does_not_overshoot(rc7):
    model, data = rc7
    start = data.qpos[:7].copy()
    goal = start + np.array([0.8, 0.6, -0.7, -0.7, 0.8, 0.4, 1.0])
    for step in range(500):
        s = (step + 1) / 500
        data.ctrl[:7] = start + (10 * s**3 - 15 * s**4 + 6 * s**5) * (goal - start)
        mujoco.mj_step(model, data)
        assert np.abs(data.qpos[:7] - data.ctrl[:7]).max() < 0.07
    for _ in range(250):
        mujoco.mj_step(model, data)
        assert ((data.qpos[:7] - goal) * np.sign(goal - start)).max() < 5e-4
    np.testing.assert_allclose(data.qpos[:7], goal, atol=5e-4)


def test_the_gripper_of_rc7_opens_90_mm_and_closes_to_2(rc7):
    model, data = rc7
    assert pad_gap(model, data) == pytest.approx(0.090, abs=1e-4)
    data.ctrl[7] = 0
    mujoco.mj_step(model, data, 300)
    assert pad_gap(model, data) == pytest.approx(0.002, abs=1e-4)
