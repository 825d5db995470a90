"""`robocell add-object`: models of users become kinds of the catalogue."""

from __future__ import annotations

import random
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

import robocell as rc
from robocell._adding import convex, meshes
from robocell._adding.convex import convex_parts
from robocell._adding.errors import AddObjectError
from robocell._adding.hulls import hull_of, volume_of
from robocell._adding.meshes import read_shape
from robocell._adding.mjcf import copy_model
from robocell._adding.winding import faces_to_turn
from robocell._cli import load
from robocell.gym import pick_cube_config

MUTANTS = 20  # of each format


def box(half: tuple[float, float, float]) -> trimesh.Trimesh:
    return trimesh.creation.box(extents=2 * np.array(half))


def corner() -> trimesh.Trimesh:
    """An L of two boxes with one closed surface: no convex shape."""
    outline = [(0, 0), (0.08, 0), (0.08, 0.03), (0.03, 0.03), (0.03, 0.08), (0, 0.08)]
    n = len(outline)
    vertices = np.array([(x, y, z) for z in (0, 0.04) for x, y in outline])
    cap = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    faces = [(c, b, a) for a, b, c in cap] + [(a + n, b + n, c + n) for a, b, c in cap]
    for k in range(n):
        j = (k + 1) % n
        faces += [(k, j, n + j), (k, n + j, n + k)]
    return trimesh.Trimesh(vertices, faces, process=False)


@pytest.fixture
def add(tmp_path, monkeypatch):
    """Runs the command in this process; returns the exit code and all that it prints."""
    monkeypatch.setenv("ROBOCELL_MODEL_PATH", str(tmp_path / "mine"))
    monkeypatch.setenv("COLUMNS", "200")

    def run(*arguments: object, code: int = 0) -> str:
        words = ["add-object", *map(str, arguments)]
        result = CliRunner().invoke(load(words), words)
        assert result.exit_code == code, (result.output, result.exception)
        return result.output

    return run


def saved(mesh: trimesh.Trimesh, path: Path) -> Path:
    path.parent.mkdir(exist_ok=True, parents=True)
    mesh.export(path)
    return path


@pytest.mark.parametrize("suffix", [".obj", ".stl", ".glb"])
def test_a_mesh_of_any_format_becomes_the_same_shape(tmp_path, suffix):
    mesh = box((0.03, 0.02, 0.01))
    mesh.apply_translation([1, 2, 3])
    shape = read_shape(saved(mesh, tmp_path / f"brick{suffix}"), up="z")
    assert shape.is_watertight
    assert shape.volume == pytest.approx(0.06 * 0.04 * 0.02, rel=1e-5)
    points = shape.points()
    np.testing.assert_allclose(points.max(0), [0.03, 0.02, 0.01], atol=1e-6)
    np.testing.assert_allclose(points.min(0), [-0.03, -0.02, -0.01], atol=1e-6)


def test_a_glb_stands_on_its_y_axis(tmp_path):
    shape = read_shape(saved(box((0.01, 0.03, 0.02)), tmp_path / "tall.glb"))
    np.testing.assert_allclose(shape.points().max(0), [0.01, 0.02, 0.03], atol=1e-6)


def test_hulls_have_the_volume_of_their_points():
    points = np.random.default_rng(1).normal(size=(200, 3)) * [0.02, 0.03, 0.05]
    expected = trimesh.Trimesh(points).convex_hull  # Qhull's, by scipy
    hull = hull_of(points, "points")
    inside = trimesh.Trimesh(*hull, process=False)
    assert inside.is_watertight
    assert inside.volume == pytest.approx(volume_of(hull), rel=1e-9)
    assert len(hull[0]) <= 64
    assert 0.85 * expected.volume < volume_of(hull) <= expected.volume * 1.0001
    assert volume_of(hull_of(points, "points", most=-1)) == pytest.approx(expected.volume, rel=1e-5)


@pytest.mark.parametrize("suffix", [".obj", ".stl", ".glb"])
@pytest.mark.parametrize("turned", ["some", "all"])
def test_faces_are_turned_outwards(tmp_path, suffix, turned):
    mesh = corner()
    rng = np.random.default_rng(5)
    flipped = rng.uniform(size=len(mesh.faces)) < (0.3 if turned == "some" else 1)
    assert flipped.any()
    faces = np.where(flipped[:, None], mesh.faces[:, ::-1], mesh.faces)
    path = saved(trimesh.Trimesh(mesh.vertices, faces, process=False), tmp_path / f"l{suffix}")
    shape = read_shape(path, up="z")
    assert shape.is_watertight
    assert shape.volume == pytest.approx(mesh.volume, rel=1e-5)
    (part,) = shape.parts
    drawn = trimesh.Trimesh(part.vertices, part.faces)
    assert drawn.is_volume
    assert drawn.volume == pytest.approx(mesh.volume, rel=1e-5), "renderers see it from outside"


def test_a_cavity_stays_one_and_a_solid_inside_out_is_turned():
    hollow, inner, beside = box((0.05,) * 3), box((0.02,) * 3), box((0.01,) * 3)
    inner.invert()
    beside.invert()
    beside.apply_translation([0.2, 0, 0])
    mesh = trimesh.util.concatenate([hollow, inner, beside])
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    turn = faces_to_turn(vertices, faces)
    assert turn is not None
    assert turn.tolist() == [False] * 24 + [True] * 12
    opposite = faces_to_turn(vertices, faces[:, ::-1])
    assert opposite is not None
    assert opposite.tolist() == (~turn).tolist(), "all of it inside out"


def test_a_surface_without_an_outside_encloses_nothing():
    # A Klein bottle of 8 x 8 squares: closed, and one-sided.
    n = 8
    at = lambda i, j: (i % n) * n + (j % n if i < n else -j % n)  # noqa: E731
    faces = []
    for i in range(n):
        for j in range(n):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            faces += [(a, b, c), (a, c, d)]
    vertices = np.random.default_rng(2).normal(size=(n * n, 3))
    assert trimesh.Trimesh(vertices, faces, process=False).is_watertight
    assert faces_to_turn(vertices, np.array(faces)) is None


def test_copies_of_a_mesh_count_before_they_are_made(tmp_path, monkeypatch):
    scene = trimesh.Scene()
    cube = box((0.01,) * 3)
    for i in range(20):
        turn = np.eye(4)
        turn[0, 3] = 0.03 * i
        scene.add_geometry(cube, geom_name="cube", node_name=f"copy_{i}", transform=turn)
    path = tmp_path / "row.glb"
    scene.export(path)
    assert len(read_shape(path).parts) == 20
    monkeypatch.setattr(meshes, "MOST_TRIANGLES", 200)
    monkeypatch.setattr(trimesh.Scene, "dump", lambda *_: pytest.fail("copies are made"))
    with pytest.raises(AddObjectError, match=r"row.glb: has 240 triangles, and at most 200"):
        read_shape(path)


def test_a_shape_that_is_not_convex_is_split_into_its_parts(tmp_path):
    shape = read_shape(saved(corner(), tmp_path / "corner.obj"))
    assert shape.is_watertight
    whole = convex_parts(shape, "corner", split=False)
    parts = convex_parts(shape, "corner")
    assert (len(whole), len(parts)) == (1, 2)
    assert sum(map(volume_of, parts)) == pytest.approx(shape.volume, rel=0.06)
    assert volume_of(whole[0]) > 1.2 * shape.volume


def test_the_end_of_coacd_is_an_error_that_names_the_file(tmp_path, monkeypatch):
    shape = read_shape(saved(corner(), tmp_path / "corner.obj"))
    monkeypatch.setattr(convex, "CODE", "import os; os.abort()")
    with pytest.raises(AddObjectError, match=r"my.obj: CoACD found no convex parts.*--one-hull"):
        convex_parts(shape, "my.obj")
    monkeypatch.setattr(convex, "CODE", "raise RuntimeError('no manifold')")
    with pytest.raises(AddObjectError, match="no manifold"):
        convex_parts(shape, "my.obj")
    monkeypatch.setattr(convex, "CODE", "import time; time.sleep(60)")
    monkeypatch.setattr(convex, "LIMIT_S", 0.2)
    with pytest.raises(AddObjectError, match=r"within 0.2 s. Simplify the mesh"):
        convex_parts(shape, "my.obj")


@pytest.mark.proof  # CoACD closes the holes with a fine mesh first
def test_coacd_splits_a_mesh_with_holes(tmp_path):
    mesh = corner()
    mesh.update_faces(np.arange(2, len(mesh.faces)))
    shape = read_shape(saved(mesh, tmp_path / "open.obj"))
    assert not shape.is_watertight
    parts = convex_parts(shape, "open.obj")
    assert 1 <= len(parts) <= convex.MOST_PARTS
    points = np.vstack([vertices for vertices, _ in parts])
    np.testing.assert_allclose(np.ptp(points, axis=0), [0.08, 0.08, 0.04], atol=0.004)


def test_an_added_object_is_drawn_like_any_kind(add, tmp_path):
    brick = saved(box((0.03, 0.02, 0.015)), tmp_path / "My Brick.stl")
    told = add(brick, "--density", 1000, "--category", "bricks", "--colour", "red",
               "--synonym", "red brick", "--material", "clay")  # fmt: skip
    assert "my_brick" in told
    assert "60 x 40 x 30" in told
    assert "as it is" in told
    assert "ROBOCELL_MODEL_PATH" not in told, "it is set"
    folder = tmp_path / "mine" / "objects" / "my_brick"
    assert (folder / "my_brick.png").read_bytes().startswith(b"\x89PNG")
    model = mujoco.MjModel.from_xml_path(str(folder / "my_brick.xml"))
    assert model.body("my_brick").mass[0] == pytest.approx(1000 * 0.06 * 0.04 * 0.03, rel=1e-3)
    assert rc.models.resolve("my_brick") == str(folder / "my_brick.xml")
    assert "my_brick" in rc.tasks.object_kinds()
    assert "my_brick" not in rc.tasks.default_object_kinds()
    assert rc.tasks.object_kinds_of(["bricks"]) == ["my_brick"]
    info = rc.tasks.object_info("my_brick")
    assert (info["colour"], info["material"], info["synonyms"]) == ("red", "clay", ["red brick"])
    np.testing.assert_allclose(info["size"], [0.06, 0.04, 0.03], atol=1e-4)
    rng = rc.tasks.Rng.stream(0, "object")
    assert rc.tasks.make_object("my_brick", "target", rng).mjcf_path == "my_brick"
    spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False)
    spec.objects.append(rc.SceneObject(name="b", mjcf_path="my_brick", pos=[0, 0, 0.02]))
    scene = rc.Scene.build(spec)
    assert scene.step_n(300).ok
    assert scene.data.joint(0).qpos[2] == pytest.approx(0.015, abs=1e-3)

    assert "there is an object 'my_brick'" in add(brick, code=2)
    add(brick, "--replace", "--mass", 0.2)
    model = mujoco.MjModel.from_xml_path(str(folder / "my_brick.xml"))
    assert model.body("my_brick").mass[0] == pytest.approx(0.2, rel=1e-4)


def test_a_model_comes_with_its_files_and_a_dry_run_writes_nothing(add, tmp_path):
    given = tmp_path / "given"
    saved(box((0.02, 0.02, 0.02)), given / "meshes" / "cube.stl")
    (given / "cube.xml").write_text(
        "<mujoco><compiler meshdir='meshes'/><asset><mesh name='c' file='cube.stl'/></asset>"
        "<worldbody><body name='cube'><freejoint/><geom type='mesh' mesh='c' mass='0.1'/></body>"
        "</worldbody></mujoco>"
    )
    assert "cube" in add(given, "--dry-run")
    assert not (tmp_path / "mine").exists()
    assert "40 x 40 x 40" in add(given)
    folder = tmp_path / "mine" / "objects" / "cube"
    assert sorted(str(p.relative_to(folder)) for p in folder.rglob("*.*")) == [
        "cube.png",
        "cube.xml",
        "meshes/cube.stl",
        "object.yaml",
    ]
    assert (folder / "cube.xml").read_text() == (given / "cube.xml").read_text()
    assert "--mass is for mesh files" in add(given, "--mass", 1, "--replace", code=2)


TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
BODY = "<worldbody><body name='b'><geom type='{}' {}='k'/></body></worldbody>"


@pytest.mark.parametrize(
    ("model", "files"),
    [
        (
            "<compiler meshdir='m'/><asset><hfield name='k' file='h.png' size='1 1 1 .1'/></asset>"
            "<worldbody><body name='b'><geom size='.1'/></body></worldbody>",
            ["m/h.png"],
        ),
        (
            "<compiler assetdir='m' texturedir='t'/><asset><mesh name='k' file='k.obj'/>"
            "<texture name='t' type='2d' file='t.png'/></asset>" + BODY.format("mesh", "mesh"),
            ["m/k.obj", "t/t.png"],
        ),
        (
            "<compiler strippath='true' meshdir='m'/><asset><mesh name='k' file='a/b/k.obj'/>"
            "</asset>" + BODY.format("mesh", "mesh"),
            ["m/k.obj"],
        ),
        (
            "<compiler meshdir='m'/><worldbody><body name='b'><geom size='.1'/>"
            "<flexcomp name='f' type='mesh' file='k.obj' dim='2' rigid='true'/></body></worldbody>",
            ["m/k.obj"],
        ),
        (
            "<compiler meshdir='m'/><asset><model name='s' file='sub/s.xml'/></asset><worldbody>"
            "<body name='b'><geom size='.1'/><attach model='s' body='b' prefix='p'/></body>"
            "</worldbody>",
            ["sub/s.xml", "sub/n/k.obj"],
        ),
        ("<!-- a -- b --><include file='sub/one.xml'/>", ["sub/one.xml", "sub/two.xml"]),
    ],
    ids=["hfield", "texture", "strippath", "flexcomp", "attached", "includes"],
)
def test_a_copy_of_a_model_has_the_files_that_mujoco_reads(tmp_path, model, files):
    given, copied = tmp_path / "given", tmp_path / "copied"
    copied.mkdir()
    image = np.zeros((4, 4, 3), np.uint8)
    image[1:3, 1:3] = 200
    attached = "<mujoco><compiler meshdir='n'/><asset><mesh name='k' file='k.obj'/></asset>"
    texts = {
        "k.obj": TETRAHEDRON,
        "s.xml": attached + BODY.format("mesh", "mesh") + "</mujoco>",
        "one.xml": "<mujoco><include file='two.xml'/></mujoco>",
        "two.xml": "<mujoco><worldbody><body><geom size='.1'/></body></worldbody></mujoco>",
    }
    for file in files:
        path = given / file
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".png":
            rc.render.write_png(path, image)
        else:
            path.write_text(texts[path.name])
    (given / "a.xml").write_text(f"<mujoco>{model}</mujoco>")
    mujoco.MjModel.from_xml_path(str(given / "a.xml"))
    copy_model(given / "a.xml", copied, "mine")
    made = sorted(str(p.relative_to(copied)) for p in copied.rglob("*.*"))
    assert made == sorted(["mine.xml", *files])
    mujoco.MjModel.from_xml_path(str(copied / "mine.xml"))


def test_faults_of_models_are_about_the_users_file(add, tmp_path):
    body = "<worldbody><body name='b'>{}<geom size='.1'/></body></worldbody>"
    texts = {
        "dashes": "<mujoco><!-- a -- b -->" + body.format("") + "</mujoco>",
        "hinge": "<mujoco>" + body.format("<joint name='j' type='hinge'/>") + "</mujoco>",
        "two": "<mujoco>" + body.format("") + "</mujoco><more/>",
        "ghost": "<mujoco>" + body.format("").replace("size=", "contype='0' conaffinity='0' size=")
        + "</mujoco>",
        "out": "<mujoco><asset><mesh name='k' file='../k.obj'/></asset>"
        + BODY.format("mesh", "mesh") + "</mujoco>",
    }  # fmt: skip
    (tmp_path / "k.obj").write_text(TETRAHEDRON)
    folder = tmp_path / "given"
    folder.mkdir()
    for name, text in texts.items():
        (folder / f"{name}.xml").write_text(text)
    told = " ".join(add(folder, code=1).split())
    assert "4 objects rejected" in told, "and the others are added"
    assert (tmp_path / "mine" / "objects" / "dashes" / "dashes.xml").is_file()
    assert f"{folder / 'hinge.xml'}: its outermost body 'b' has the joint 'j'" in told
    assert f"{folder / 'two.xml'} is no valid XML without its comments" in told
    assert f"{folder / 'ghost.xml'}: none of its geoms collides" in told
    assert f"{folder / 'out.xml'}: names the file '../k.obj', which is not in its folder" in told
    assert ".adding-" not in told
    for option in ("--density", "--friction"):
        assert f"{option} is for mesh files" in add(folder / "dashes.xml", option, 1, code=2)


def test_models_need_no_extra_and_a_failed_replacement_keeps_the_entry(add, tmp_path, monkeypatch):
    for module in ("coacd", "trimesh"):
        monkeypatch.setitem(sys.modules, module, None)
    path = tmp_path / "ball.xml"
    text = "<mujoco><worldbody><body><geom size='.1'/></body></worldbody></mujoco>"
    path.write_text(text)
    add(path)
    rename = Path.rename

    def fails(self: Path, target: Path) -> Path:
        if self.name == "ball" and ".adding-" in str(self):
            raise OSError("no space left")
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", fails)
    path.write_text(text.replace(".1", ".2"))
    assert "cannot be written: no space left" in " ".join(add(path, "--replace", code=1).split())
    objects = tmp_path / "mine" / "objects"
    assert [entry.name for entry in objects.iterdir()] == ["ball"]
    assert (objects / "ball" / "ball.xml").read_text() == text


def test_a_mesh_with_holes_needs_no_scipy(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy", None)
    mesh = box((0.03, 0.02, 0.01))
    mesh.update_faces(np.arange(2, len(mesh.faces)))
    shape = read_shape(saved(mesh, tmp_path / "open.obj"))
    assert shape.volume == pytest.approx(8 * 0.03 * 0.02 * 0.01, rel=1e-5)


def test_mistakes_are_named_with_the_next_step(add, tmp_path, monkeypatch):
    cube = box((20, 20, 20))
    large = saved(cube, tmp_path / "large.stl")
    assert "is 40 m large, and lengths are in metres. Is it in millimetres?" in add(large, code=1)
    assert "40 x 40 x 40" in add(large, "--scale", 0.001, "--dry-run")
    assert "Give --scale" in add(large, "--scale", 1e-6, code=1)
    assert "--scale is 0; it is a number above 0" in add(large, "--scale", 0, code=2)
    assert "no file" in add(tmp_path / "none.obj", code=2)
    assert "has no model" in add(saved(cube, tmp_path / "a" / "b" / "c.stl").parent.parent, code=2)
    assert "'mug' is a built-in model" in add(large, "--name", "mug", code=2)
    assert "'fruit' is a category" in add(large, "--name", "fruit", code=2)
    assert "starts with a letter" in add(large, "--name", "3d", code=2)
    assert "is no single word" in add(large, "--category", "my things", code=2)
    flat = trimesh.Trimesh([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]], [[0, 1, 2]])
    assert "is flat" in add(saved(flat, tmp_path / "flat.obj"), code=1)
    (tmp_path / "empty.obj").write_text("")
    assert "is empty" in add(tmp_path / "empty.obj", code=1)
    (tmp_path / "two.xml").write_text(
        "<mujoco><worldbody><body><geom size='.1'/></body><body><geom size='.1'/></body>"
        "</worldbody></mujoco>"
    )
    assert "has 2 bodies in its worldbody" in add(tmp_path / "two.xml", code=1)
    (tmp_path / "bad.xml").write_text("<mujoco><worldbod/></mujoco>")
    assert "MuJoCo cannot load it" in add(tmp_path / "bad.xml", code=1)
    monkeypatch.delenv("ROBOCELL_MODEL_PATH")
    assert "no folder for objects: give --into FOLDER" in add(large, code=2)
    assert not (tmp_path / "mine" / "objects").exists() or not list(
        (tmp_path / "mine" / "objects").iterdir()
    )


def test_an_object_that_is_not_watertight_is_reported(add, tmp_path):
    mesh = box((0.03, 0.03, 0.03))
    mesh.update_faces(np.arange(2, len(mesh.faces)))  # without its lid
    told = " ".join(add(saved(mesh, tmp_path / "open.obj"), "--one-hull", "--dry-run").split())
    assert "is not watertight: its mass is that of its convex hull; give --mass" in told
    assert "no" in told.split()


def test_what_tips_over_is_told(add, tmp_path):
    leaning = box((0.01, 0.01, 0.04))
    leaning.vertices[:, 0] += leaning.vertices[:, 2]
    assert "turned by" in add(saved(leaning, tmp_path / "leaning.obj"), "--dry-run")


@pytest.mark.parametrize("suffix", [".obj", ".stl", ".glb"])
def test_a_broken_file_is_read_or_named(tmp_path, suffix):
    """Bytes are flipped, cut out and repeated: each file is a shape or one of our errors."""
    good = saved(corner(), tmp_path / f"good{suffix}").read_bytes()
    rng = random.Random(7)
    read = 0
    for i in range(MUTANTS):
        data = bytearray(good)
        for _ in range(rng.randint(1, 6)):
            at = rng.randrange(len(data))
            match rng.randrange(4):
                case 0:
                    data[at] = rng.randrange(256)
                case 1:
                    del data[at : at + rng.randint(1, 40)]
                case 2:
                    data[at:at] = data[at : at + rng.randint(1, 60)]
                case 3:
                    data[at : at + 2] = rng.choice([b"-9", b"\xff\xff", b"e9", b"\n\n"])
        path = tmp_path / f"mutant_{i}{suffix}"
        path.write_bytes(data)
        problem = ""
        try:
            shape = read_shape(path)
            hulls = convex_parts(shape, str(path), split=False)
        except AddObjectError as error:
            problem = str(error)
        if problem:
            assert str(path) in problem
            continue
        read += 1
        assert np.all(np.isfinite(shape.points()))
        assert volume_of(hulls[0]) > 0
    assert read > 0, "some changes do no harm"


def test_runs_draw_an_added_object_by_its_category(add, tmp_path):
    brick = saved(box((0.03, 0.02, 0.02)), tmp_path / "my_brick.obj")
    add(brick, "--category", "bricks", "--mass", 0.1)
    run = rc.RunConfig.load(Path(__file__).parents[2] / "examples" / "demo.yaml")
    run.cameras.streams.clear()
    run.task = {"kind": "pick", "objects": ["bricks"]}
    run.output, run.episodes = str(tmp_path / "out"), 1
    rc.generate.prepare_dataset(run)
    (item,) = rc.generate.make_plan(run)
    result = rc.generate.Runner(run).run(item)
    assert result.success, result.failures
    assert result.object_kind == "my_brick"
    env = rc.envs.RunEnv(run)
    env.reset(0)
    assert env.object_kinds == ["my_brick"]


def test_an_environment_has_an_added_object(add, tmp_path):
    add(saved(box((0.03, 0.02, 0.02)), tmp_path / "my_brick.obj"), "--mass", 0.1)
    env = rc.Env(pick_cube_config(task={"kind": "pick", "objects": ["my_brick", "mug"]}))
    env.reset(seed=0)
    assert {"target_my_brick", "target_mug"} <= {
        each.name for each in env.scene.copy_spec().objects
    }
