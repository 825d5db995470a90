"""Every kind of the catalogue keeps what its object.yaml and its model say; judged by MuJoCo."""

from __future__ import annotations

import functools
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yaml
from hand_over_object import HandOverObject

MODELS = Path(__file__).resolve().parents[2] / "models"
OBJECTS = sorted(p.parent.name for p in MODELS.glob("objects/*/object.yaml"))
ARTICULATED = sorted(p.parent.name for p in MODELS.glob("equipment/*/object.yaml"))
CATEGORIES = {"kitchen", "tools", "boxes", "fruit", "bottles", "blocks", "toys", "books"}
MOST_POSES = 400  # of a hand, until one takes the object
SAMPLES = 4000  # points in each geom
RNG_SEED = 3


def folder(name: str) -> Path:
    return MODELS / ("objects" if name in OBJECTS else "equipment") / name


@functools.cache
def words(name: str) -> dict:
    return yaml.safe_load((folder(name) / "object.yaml").read_text())


@functools.cache
def alone(name: str) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(folder(name) / f"{name}.xml"))


def on_a_floor(name: str) -> mujoco.MjModel:
    spec = mujoco.MjSpec.from_file(str(folder(name) / f"{name}.xml"))
    spec.worldbody.add_geom(
        name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[2, 2, 0.1], friction=[0.8, 0.02, 1e-3]
    )
    return spec.compile()


def half_extents(kind: int, size: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Half sizes of the box around a primitive, along the axes of the world."""
    turn = matrix.reshape(3, 3)
    along = np.abs(turn[:, 2])
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        return np.full(3, size[0])
    if kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
        return np.linalg.norm(turn * size, axis=1)
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        return along * size[1] + size[0]
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        return along * size[1] + size[0] * np.sqrt(np.maximum(1 - along**2, 0))
    return np.abs(turn) @ size


def corners(model: mujoco.MjModel, data: mujoco.MjData, *, seen: bool) -> np.ndarray:
    """Vertices of meshes and corners of boxes around primitives, (n, 3) in the world."""
    points = []
    for geom in range(model.ngeom):
        collides = bool(model.geom_contype[geom])
        if collides == seen or model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE:
            continue
        if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
            mesh = model.geom_dataid[geom]
            first = model.mesh_vertadr[mesh]
            local = model.mesh_vert[first : first + model.mesh_vertnum[mesh]]
            turned = local @ data.geom_xmat[geom].reshape(3, 3).T
        else:
            half = half_extents(model.geom_type[geom], model.geom_size[geom], data.geom_xmat[geom])
            turned = np.array([-half, half])
        points.append(turned + data.geom_xpos[geom])
    return np.vstack(points)


def at_rest(model: mujoco.MjModel) -> mujoco.MjData:
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data


def test_the_catalogue_has_forty_kinds_and_their_categories():
    assert len(OBJECTS) >= 40
    assert {words(name)["category"] for name in OBJECTS} == CATEGORIES
    assert len(ARTICULATED) >= 7
    defaults = [name for name in OBJECTS if words(name).get("drawn_by_default")]
    assert defaults == ["bottle", "bracket", "mug", "nut", "spool"]


def test_the_list_of_models_has_each_kind_with_its_size():
    rows = (MODELS / "README.md").read_text().splitlines()
    for name in OBJECTS:
        row = next(row for row in rows if f"| `{name}` |" in row)
        if not words(name).get("drawn_by_default"):
            assert " × ".join(f"{1000 * side:.0f}" for side in words(name)["size"]) in row, name
            assert (", ".join(words(name)["grasps"]) or "–") in row, name
        assert (folder(name) / f"{name}.png").is_file()


@pytest.mark.parametrize("name", OBJECTS)
def test_an_object_has_its_size_and_words(name):
    model = alone(name)
    data = at_rest(model)
    assert (model.nbody, model.njnt, model.body(1).name) == (2, 1, name)
    assert model.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE
    seen, felt = corners(model, data, seen=True), corners(model, data, seen=False)
    size = seen.max(0) - seen.min(0)
    np.testing.assert_allclose(size, words(name)["size"], atol=2e-4)
    # The handle of the mug and the foot of the bracket have the place that they always had.
    if not words(name).get("drawn_by_default"):
        np.testing.assert_allclose(seen.max(0) + seen.min(0), 0, atol=2e-4)
    tolerance = 0.003 if model.geom_type.max() == mujoco.mjtGeom.mjGEOM_MESH else 0.0015
    assert np.all(np.abs(felt.min(0) - seen.min(0))[2] < tolerance), "stands where it is seen"
    np.testing.assert_allclose(felt.max(0) - felt.min(0), size, atol=0.006)
    assert all(isinstance(words(name)[key], str) for key in ("category", "colour", "material"))
    assert set(words(name)["grasps"]) <= {"top", "side", "rim", "handle"}


@pytest.mark.parametrize("name", OBJECTS)
def test_an_object_rests_without_sinking_or_moving(name):
    model = on_a_floor(name)
    data = at_rest(model)
    data.qpos[2] -= corners(model, data, seen=False)[:, 2].min()
    start = data.qpos.copy()
    mujoco.mj_step(model, data, 500)
    assert data.ncon > 0
    assert min(contact.dist for contact in data.contact) > -1e-3
    np.testing.assert_allclose(data.qpos[:3], start[:3], atol=2e-3)
    assert abs(data.qpos[3:7] @ start[3:7]) > np.cos(np.radians(2) / 2)
    assert np.abs(data.qvel).max() < 0.02


def points_inside(model: mujoco.MjModel, geom: int, rng: np.random.Generator) -> np.ndarray:
    """Points spread evenly in a geom; (n, 3) in its frame."""
    kind, size = model.geom_type[geom], model.geom_size[geom]
    box = model.geom_aabb[geom]
    points = box[:3] + box[3:] * rng.uniform(-1, 1, (SAMPLES, 3))
    x, y, z = points.T
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        return points[np.hypot(x, y) < size[0]]
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        return points[x**2 + y**2 + z**2 < size[0] ** 2]
    if kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
        return points[((points / size) ** 2).sum(1) < 1]
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        over = np.maximum(np.abs(z) - size[1], 0)
        return points[x**2 + y**2 + over**2 < size[0] ** 2]
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = model.geom_dataid[geom]
        first, count = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
        start, number = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        vertices = model.mesh_vert[start : start + number]
        a, b, c = (vertices[model.mesh_face[first : first + count, i]] for i in range(3))
        normals = np.cross(b - a, c - a)
        return points[np.all(points @ normals.T <= (normals * a).sum(1) + 1e-12, axis=1)]
    return points


@pytest.mark.parametrize("name", OBJECTS)
def test_mass_and_inertia_are_those_of_the_shapes_that_collide(name):
    model = alone(name)
    data = at_rest(model)
    rng = np.random.default_rng(RNG_SEED)
    points, weights, volume = [], [], 0.0
    for geom in np.flatnonzero(model.geom_contype):
        inside = points_inside(model, geom, rng)
        volume += np.prod(2 * model.geom_aabb[geom, 3:]) * len(inside) / SAMPLES
        points.append(inside @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom])
        weights.append(volume)
    # Geoms keep their mass after compiling only as the body's: the spec still has each.
    spec = mujoco.MjSpec.from_file(str(folder(name) / f"{name}.xml"))
    masses = [spec.geoms[geom].mass for geom in np.flatnonzero(model.geom_contype)]
    mass = float(np.sum(masses))
    assert model.body_mass[1] == pytest.approx(mass, rel=1e-6)
    center = sum(m * p.mean(0) for m, p in zip(masses, points, strict=True)) / mass
    np.testing.assert_allclose(center, data.xipos[1], atol=2e-3)
    inertia = np.zeros((3, 3))
    for m, p in zip(masses, points, strict=True):
        arm = p - data.xipos[1]
        inertia += m * (np.mean((arm**2).sum(1)) * np.eye(3) - arm.T @ arm / len(arm))
    turn = data.ximat[1].reshape(3, 3)
    told = turn @ np.diag(model.body_inertia[1]) @ turn.T
    np.testing.assert_allclose(inertia, told, atol=0.04 * np.trace(told) / 2)
    assert 40 < mass / volume < 9000, f"{mass / volume:.0f} kg/m^3"


@pytest.mark.parametrize("name", [name for name in OBJECTS if words(name)["grasps"]])
def test_two_fingers_take_an_object_as_its_grasps_say(name):
    hand = HandOverObject(folder(name) / f"{name}.xml")
    found = {kind for kind in words(name)["grasps"] if hand.find(kind, MOST_POSES, RNG_SEED)}
    assert found == set(words(name)["grasps"])


def test_what_is_too_wide_for_two_fingers_is_not_taken():
    for name, kind in (("book", "top"), ("book", "side"), ("bowl", "side"), ("plate", "top")):
        hand = HandOverObject(folder(name) / f"{name}.xml")
        assert not hand.find(kind, 40, RNG_SEED), (name, kind)


@pytest.mark.parametrize("name", [name for name in OBJECTS if "rim" in words(name)["grasps"]])
def test_a_rim_is_a_thin_wall(name):
    model = alone(name)
    rims = [geom for geom in range(model.ngeom) if "rim" in model.geom(geom).name]
    assert rims
    assert all(2 * model.geom_size[geom].min() < 0.01 for geom in rims)


@pytest.mark.parametrize("name", [name for name in OBJECTS if "handle" in words(name)["grasps"]])
def test_a_handle_is_found_by_its_name(name):
    names = [alone(name).geom(geom).name for geom in range(alone(name).ngeom)]
    assert any("handle" in geom for geom in names)


@pytest.mark.parametrize("name", ARTICULATED)
def test_what_opens_stays_where_it_is_left_and_buttons_return(name):
    model = on_a_floor(name)
    assert model.njnt > 0
    for joint in range(model.njnt):
        data = at_rest(model)
        assert data.ncon == 0
        low, high = model.jnt_range[joint]
        address = model.jnt_qposadr[joint]
        for share in np.linspace(0, 1, 21):  # nothing is in the way
            data.qpos[address] = low + share * (high - low)
            mujoco.mj_forward(model, data)
            assert all(contact.dist > -1e-4 for contact in data.contact), model.joint(joint).name
        data.qpos[address] = half = low + 0.5 * (high - low)
        mujoco.mj_step(model, data, 500)
        if model.jnt_stiffness[joint] > 0:
            assert data.qpos[address] == pytest.approx(low, abs=5e-4)
        else:
            assert data.qpos[address] == pytest.approx(half, abs=0.01 * (high - low))
            handles = [
                geom
                for geom in range(model.ngeom)
                if model.geom_bodyid[geom] == model.jnt_bodyid[joint]
                and any(word in model.geom(geom).name for word in ("handle", "knob"))
            ]
            assert handles, f"{model.joint(joint).name} has no handle"
