"""Houses as scenes: read from files in the layout of procthor-10k, generated, and built in."""

from __future__ import annotations

import json
import shutil
import struct
import zlib
from pathlib import Path

import mujoco
import numpy as np
import pytest
import typer
from figures import note
from PIL import Image

import robocell as rc
from command_line import robocell_command, write_run
from house_promises import HouseFindings, check_house, free_bodies, load, sum_of
from robocell.scenes import HouseOptions, HousesScenes, make_house, prepare_house_folder

ROOT = Path(__file__).parents[2]
FIXTURES = ROOT / "tests/houses"
SET = FIXTURES / "scenes/procthor-10k-train"


def run_of(**fields: object) -> rc.RunConfig:
    run = rc.RunConfig.load(ROOT / "examples/demo.yaml")
    run.cameras.streams.clear()
    run.start.visible_from = []
    run.scenes = rc.scenes.SceneSourceSpec(source="houses", **fields)
    return run


def source_of(**fields: object) -> rc.scenes.SceneSource:
    return rc.scenes.make_scene_source(run_of(**fields))


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """A copy of the fixtures that a test may damage."""
    folder = tmp_path / "set"
    shutil.copytree(SET, folder)
    return folder


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("ROBOCELL_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.delenv("ROBOCELL_SCENE_PATH", raising=False)
    return tmp_path / "cache"


def model_of(source: rc.scenes.SceneSource, index: int) -> mujoco.MjModel:
    spec = source.make(index)
    spec.timestep = 0.002
    return rc.Scene.build(spec).model


# --- houses from files ---


def test_a_house_is_the_model_that_stock_mujoco_reads():
    source = source_of(root=str(SET), ceiling=False)
    ours, theirs = (
        model_of(source, 0),
        mujoco.MjModel.from_xml_path(str(SET / "train_0.xml")),
    )
    assert ours.nbody == theirs.nbody
    for body in range(ours.nbody):
        assert ours.body(body).name == theirs.body(body).name
        np.testing.assert_array_equal(ours.body_pos[body], theirs.body_pos[body])
    assert any("|" in ours.body(body).name for body in range(ours.nbody))


def test_the_variant_with_a_ceiling_is_the_default():
    names = [
        [model.body(body).name for body in range(model.nbody)]
        for model in (
            model_of(source_of(root=str(SET)), 0),
            model_of(source_of(root=str(SET), ceiling=False), 0),
        )
    ]
    assert "ceiling|0" in names[0]
    assert "ceiling|0" not in names[1]


def test_a_named_set_is_found_below_the_scene_path(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("ROBOCELL_SCENE_PATH", f"/nowhere:{FIXTURES}")
    assert source_of(dataset="procthor-10k").size() == 4
    assert source_of(dataset="procthor-10k", split="train").size() == 4
    with pytest.raises(
        rc.NotFoundError, match=r"split 'val'.*procthor-10k-val.*ROBOCELL_SCENE_PATH"
    ):
        source_of(dataset="procthor-10k", split="val")
    with pytest.raises(
        rc.NotFoundError, match=r"dataset 'ithor'.*Folders there: procthor-10k-train"
    ):
        source_of(dataset="ithor")


def test_a_set_that_is_nowhere_says_how_to_point_to_it():
    with pytest.raises(
        rc.NotFoundError,
        match=r"ROBOCELL_SCENE_PATH is not set.*Set ROBOCELL_SCENE_PATH to the folder",
    ):
        source_of(dataset="procthor-10k")
    with pytest.raises(rc.ArgumentError, match="name of a set"):
        source_of(dataset="../procthor-10k")
    with pytest.raises(rc.NotFoundError, match="`root`"):
        source_of(root="/nowhere")


def test_annotations_come_from_map_and_metadata():
    known = source_of(root=str(SET)).annotations(0)
    words = {
        entry.object: (entry.category, list(entry.words), entry.room) for entry in known.objects
    }
    assert words["Mug|2|2"] == ("Mug", ["mug"], "room|2")
    assert words["DiningTable|2|0|1"] == ("DiningTable", ["dining table"], "room|2")
    assert "GarbageCan|3|9" not in words  # not in the model
    assert [room.name for room in known.rooms] == ["room|2", "room|3"]
    outline = np.array(known.rooms[1].outline)
    np.testing.assert_allclose([outline.min(0), outline.max(0)], [[4.05, 0], [7, 3]], atol=0.03)
    assert [joint.joint for joint in known.articulations] == ["SideTable|3|1|drawer_slide"]
    assert known.articulations[0].handle_geoms == ["drawer_handle"]


def pixels(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Free pixels of a map, and the matrix from world to pixels, read with PIL."""
    image = Image.open(path)
    return np.array(image)[..., 0] > 0, np.array(json.loads(image.info["world_to_map"]))


def corners(area: rc.scenes.FloorArea, inset: float) -> np.ndarray:
    x, y = area.half_x - inset, area.half_y - inset
    points = np.array([[i * x, j * y, 0] for i in (-1, 0, 1) for j in (-1, 0, 1)])
    return points @ area.frame_to_world.rotation.T + area.frame_to_world.translation


@pytest.mark.parametrize("index", [0])
def test_free_floor_is_free_in_the_map(index: int):
    known = source_of(root=str(SET)).annotations(index)
    free, to_map = pixels(SET / f"train_{index}_map.png")
    assert known.free_floor
    for area in known.free_floor:
        at = np.c_[corners(area, 0.02), np.ones(9)] @ to_map.T
        row, column = np.round(at).astype(int).T
        assert free[row, column].all(), area
    total = sum(4 * area.half_x * area.half_y for area in known.free_floor)
    assert total > 0.75 * free.sum() / 50**2


def test_supports_are_the_free_parts_of_furniture():
    known = source_of(root=str(SET)).annotations(0)
    table = next(face for face in known.supports if face.body == "DiningTable|2|0|1")
    model = model_of(source_of(root=str(SET)), 0)
    for name in ("Mug|2|2", "bowl_0123456789abcdef0123456789abcdef_1_0_2"):
        at = table.face.frame_to_world.inverse().transform(model.body(name).pos)
        assert abs(at[0]) > table.face.half_x or abs(at[1]) > table.face.half_y
    assert table.face.frame_to_world.translation[2] == pytest.approx(0.75)
    assert table.room == "room|2"
    assert all(0.15 < face.face.frame_to_world.translation[2] < 1.6 for face in known.supports)


def test_a_house_without_map_and_metadata_uses_its_geometry():
    known = source_of(root=str(SET)).annotations(3)
    assert not known.rooms
    assert not known.objects
    assert sum(4 * area.half_x * area.half_y for area in known.free_floor) > 8
    assert [face.body for face in known.supports] == ["Desk|0|1"]


def test_impossible_inertias_are_balanced():
    with pytest.raises(ValueError, match="inertia"):
        mujoco.MjModel.from_xml_path(str(SET / "train_3.xml"))
    model = model_of(source_of(root=str(SET)), 3)
    for body in range(1, model.nbody):
        if model.body_dofnum[body] == 0:
            continue
        a, b, c = sorted(model.body_inertia[body])
        assert a > 0
        assert c <= a + b
    assert model.body("Statue|0|2").mass == pytest.approx(0.4)


def test_houses_without_their_assets_are_left_out_by_name(copy: Path):
    (copy / "train_0_assets/Bowl_1.obj").unlink()
    source = source_of(root=str(copy))
    assert "Bowl_1.obj" in source.why_not(0)
    with pytest.raises(rc.SpecError, match=r"house 0 .* missing: Bowl_1.obj"):
        source.make(0)
    assert source.why_not(1) == "no such house"
    assert source.why_not(3) == ""


def test_blacklists_leave_out_houses_and_objects(copy: Path):
    (copy / "blacklist.txt").write_text("3  # falls over\nBowl_1\n")
    source = source_of(root=str(copy))
    assert source.why_not(3) == "blacklisted"
    model = model_of(source, 0)
    names = {model.body(body).name for body in range(model.nbody)}
    assert "Mug|2|2" in names
    assert "bowl_0123456789abcdef0123456789abcdef_1_0_2" not in names
    mug = model_of(source_of(root=str(SET), without=["Mug|2|2"]), 0)
    assert "Mug|2|2" not in {mug.body(body).name for body in range(mug.nbody)}


def test_files_outside_of_the_set_are_refused(copy: Path, tmp_path: Path):
    secret = tmp_path / "secret.obj"
    secret.write_text((copy / "train_0_assets/Bowl_1.obj").read_text())
    text = (copy / "train_0_ceiling.xml").read_text()
    for name in (str(secret), "../../secret.obj"):
        (copy / "train_0_ceiling.xml").write_text(text.replace("Bowl_1.obj", name))
        assert "outside of" in source_of(root=str(copy)).why_not(0)


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("train_0_map.png", b"no picture", "map"),
        ("train_0_metadata.json", b"[1, 2", "metadata"),
        ("train_0_metadata.json", b'{"objects": {"a": 1, "Mug|2|2": {"category": 7}}}', ""),
        ("train_0_metadata.json", b"[" * 100_000, "metadata"),
        ("train_0_ceiling.xml", b"<mujoco><worldbody>", "XML"),
        (
            "train_0_ceiling.xml",  # it can be read, but not compiled: the body weighs nothing
            b"<mujoco><worldbody><body name='a'><freejoint/></body></worldbody></mujoco>",
            "mass and inertia",
        ),
    ],
)
def test_damaged_files_leave_a_house_or_a_reason(
    copy: Path, name: str, content: bytes, reason: str
):
    (copy / name).write_bytes(content)
    source = source_of(root=str(copy))
    if name.endswith("xml"):
        assert reason in source.why_not(0)
    else:
        known = source.annotations(0)
        assert known.free_floor
        assert known.supports
        if "json" in name and reason:
            assert not known.objects


def test_a_map_that_contradicts_itself_is_not_used(copy: Path):
    image = Image.open(copy / "train_0_map.png")
    from PIL.PngImagePlugin import PngInfo

    texts = PngInfo()
    for key, value in image.info.items():
        texts.add_text(key, "100.0" if key == "px_per_m" else str(value))
    image.save(copy / "train_0_map.png", pnginfo=texts)
    assert not source_of(root=str(copy)).annotations(0).rooms  # derived from the geometry


def adam7(pixels: np.ndarray, texts: dict[str, str]) -> bytes:
    """An interlaced PNG, which PIL does not write."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        return (
            struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
        )

    passes = [(0, 0, 8, 8), (0, 4, 8, 8), (4, 0, 8, 4), (0, 2, 4, 4), (2, 0, 4, 2), (0, 1, 2, 2)]
    rows = b"".join(
        b"\0" + row.tobytes()
        for i, j, down, right in [*passes, (1, 0, 2, 1)]
        for row in pixels[i::down, j::right]
        if row.size
    )
    height, width = pixels.shape[:2]
    return b"".join(
        [
            b"\x89PNG\r\n\x1a\n",
            chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 1)),
            *(chunk(b"tEXt", f"{key}\0{text}".encode("latin1")) for key, text in texts.items()),
            chunk(b"IDAT", zlib.compress(rows)),
            chunk(b"IEND", b""),
        ]
    )


def test_interlaced_maps_are_read(copy: Path):
    file = copy / "train_0_map.png"
    before = source_of(root=str(copy)).annotations(0)
    image = Image.open(file)
    texts = {key: value for key, value in image.info.items() if isinstance(value, str)}
    file.write_bytes(adam7(np.array(image.convert("RGB")), texts))
    np.testing.assert_array_equal(np.array(Image.open(file)), np.array(image.convert("RGB")))
    after = source_of(root=str(copy)).annotations(0)
    assert [room.name for room in after.rooms] == [room.name for room in before.rooms]
    assert [(area.half_x, area.half_y) for area in after.free_floor] == [
        (area.half_x, area.half_y) for area in before.free_floor
    ]


@pytest.mark.parametrize(
    "content",
    [
        # A header that announces 4 gigapixels, and no pixels.
        b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\xff\xff\0\0\xff\xff\x08\x02\0\0\0\0\0\0\0",
        adam7(np.zeros((1, 1, 3), np.uint8), {"px_per_m": "NaN", "world_to_map": "[[NaN]]"}),
        b"",
    ],
)
def test_hostile_maps_are_replaced_by_the_geometry(copy: Path, content: bytes):
    (copy / "train_0_map.png").write_bytes(content)
    known = source_of(root=str(copy)).annotations(0)
    assert not known.rooms
    assert known.free_floor


@pytest.mark.parametrize(
    "entry",
    [
        '{"room_id": 1e999}',
        '{"room_id": NaN}',
        '{"room_id": -1e300, "category": "' + "x" * 100_000 + '"}',
        '{"category": "\\ud800", "children": [[[]]], "name_map": {"bodies": 1}}',
    ],
)
def test_hostile_metadata_leaves_a_house(copy: Path, entry: str):
    file = copy / "train_0_metadata.json"
    file.write_text('{"objects": {"Mug|2|2": ' + entry + "}}")
    known = source_of(root=str(copy)).annotations(0)
    assert known.free_floor
    assert len(known.objects) <= 1


def test_assets_may_be_links(copy: Path, tmp_path: Path):
    """Tools that download assets on demand link to their caches."""
    cached = tmp_path / "cached.obj"
    bowl = copy / "train_0_assets/Bowl_1.obj"
    bowl.rename(cached)
    bowl.symlink_to(cached)
    assert source_of(root=str(copy)).why_not(0) == ""
    bowl.unlink()
    bowl.symlink_to(tmp_path / "nothing.obj")
    assert "missing: Bowl_1.obj" in source_of(root=str(copy), without=["Mug_2"]).why_not(0)


@pytest.mark.proof
def test_numbers_without_a_house_are_passed_over(copy: Path):
    """Unless the run names them."""
    (copy / "train_0_assets/Bowl_1.obj").unlink()
    scenes = {"source": "houses", "root": str(copy)}
    result = robocell_command("generate", write_run(copy.parent, scenes=scenes), "--dry-run")
    text = result.stdout + result.stderr
    assert "1 of 2 scenes is left out: 0 (1 of its assets is missing" in text
    file = write_run(copy.parent, scenes={**scenes, "houses": [1, 3]})
    text = robocell_command("generate", file, "--dry-run").stderr
    assert "1 of 2 scenes is left out: 1 (no such house)" in text


@pytest.mark.proof
def test_runs_leave_unusable_houses_out(copy: Path):
    (copy / "train_0_assets/Bowl_1.obj").unlink()
    scenes = {"source": "houses", "root": str(copy), "houses": [0, 3]}
    file = write_run(copy.parent, scenes=scenes, episodes_per_scene=1)
    result = robocell_command("generate", file, "--dry-run")
    text = result.stdout + result.stderr
    assert "1 of 2 scenes is left out: 0 (1 of its assets is missing: Bowl_1.obj)" in text
    assert "episodes: 1 planned" in text


# --- generated houses ---

OPTIONS = HouseOptions(seed=5, rooms=(2, 3), most_objects=14)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("houses")
    prepare_house_folder(folder, OPTIONS)
    for index in range(2):
        make_house(folder, OPTIONS, index)
    return folder


@pytest.mark.parametrize("index", [0, 1])
@pytest.mark.parametrize("variant", ["", "_ceiling"])
def test_generated_houses_keep_their_promises(made: Path, index: int, variant: str):
    assert not check_house(made / f"train_{index}{variant}.xml", 1.0).broken


@pytest.mark.soak
def test_a_hundred_generated_houses_keep_their_promises(tmp_path: Path):
    options = HouseOptions(seed=11)
    prepare_house_folder(tmp_path, options)
    found: list[HouseFindings] = []
    for index in range(100):
        make_house(tmp_path, options, index)
        found.append(check_house(tmp_path / f"train_{index}.xml", 10.0))
    note("houses", **sum_of(found))
    assert not {index: each.broken for index, each in enumerate(found) if each.broken}


def test_the_same_seed_gives_the_same_bytes(made: Path, tmp_path: Path):
    prepare_house_folder(tmp_path, OPTIONS)
    make_house(tmp_path, OPTIONS, 1)
    for file in sorted(tmp_path.rglob("*")):
        if file.is_file():
            assert file.read_bytes() == (made / file.relative_to(tmp_path)).read_bytes(), file
    other = HouseOptions(seed=6, rooms=(2, 3), most_objects=14)
    with pytest.raises(rc.ArgumentError, match="other options"):
        prepare_house_folder(made, other)


def test_generated_houses_are_scenes_with_rooms_and_words(made: Path):
    source = source_of(root=str(made))
    assert source.size() == 2
    known = source.annotations(0)
    model, data = load(made / "train_0.xml")
    assert {room.category for room in known.rooms} >= {"kitchen"}
    words = {entry.object: entry for entry in known.objects}
    for body in free_bodies(model):
        assert words[model.body(body).name].words
        assert words[model.body(body).name].room
    assert {joint.joint for joint in known.articulations} == {
        model.joint(j).name
        for j in range(model.njnt)
        if model.jnt_type[j] != mujoco.mjtJoint.mjJNT_FREE
    }
    assert all(joint.handle_geoms for joint in known.articulations)
    assert known.supports
    # Nothing stands on the free floor, which lies under the rooms, not on the roof over them.
    assert all(abs(room.floor_height) < 1e-3 for room in known.rooms)
    for area in known.free_floor:
        assert abs(area.frame_to_world.translation[2]) < 1e-3
        for point in corners(area, 0.05):
            geom = np.zeros(1, np.int32)
            distance = mujoco.mj_ray(model, data, [*point[:2], 1.2], [0, 0, -1], None, 1, -1, geom)
            assert distance == pytest.approx(1.2, abs=1e-3), model.geom(geom[0]).name


def test_no_words_of_a_house_mean_two_of_its_objects(made: Path):
    source = source_of(root=str(made))
    said: dict[str, str] = {}
    for index in range(2):
        spec = source.make(index)
        spec.timestep = 0.002
        scene = rc.Scene.build(spec)
        known = source.annotations(index)
        viewer = rc.Pose(translation=[1, 1, 0])
        for each in known.objects:
            for way in rc.scenes.referrals(scene, each.object, annotations=known, viewer=viewer):
                assert said.setdefault(f"{index} {way}", each.object) == each.object, way
    assert len(said) > 20


@pytest.mark.proof
def test_episodes_replay_when_the_houses_have_moved(made: Path, tmp_path: Path, own_cache: Path):
    """Also those in a house that was changed: its copy is in the cache, its textures are not."""
    houses = tmp_path / "houses"
    shutil.copytree(made, houses)
    model, _ = load(houses / "train_0.xml")
    without = [model.body(free_bodies(model)[0]).name]
    scenes = {"source": "houses", "root": str(houses), "houses": [0], "without": without}
    file = write_run(
        tmp_path,
        scenes=scenes,
        episodes_per_scene=1,
        cameras={"streams": []},
    )
    assert robocell_command("generate", file).returncode == 0
    houses.rename(tmp_path / "moved")
    shutil.rmtree(own_cache)
    out = tmp_path / "out"
    assert robocell_command("replay", out).returncode == 0
    assert robocell_command("verify", out).returncode == 0
    # Continuing needs the houses, and says so.
    again = robocell_command("generate", file)
    assert again.returncode != 0
    assert f"Looked for train_0.xml and the like in: {houses}" in " ".join(again.stderr.split())
    assert "Give the folder that has the .xml files as `root`" in " ".join(again.stderr.split())


def test_the_command_makes_houses_once(tmp_path: Path):
    arguments = ("make-houses", "-n", "1", "--seed", "5", "--rooms", "2", "2", "--objects", "6")
    first = robocell_command(*arguments, tmp_path / "out").stdout
    assert "houses:    1 made" in first
    again = robocell_command(*arguments, tmp_path / "out").stdout
    assert "houses:    0 made, 1 there already" in again
    assert (tmp_path / "out/train_0_ceiling.xml").is_file()


def test_a_house_that_fails_does_not_stop_the_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    from robocell._cli import make_houses as command

    real = command.make_house

    def failing(folder: Path, options: HouseOptions, index: int) -> object:
        if index == 1:
            raise rc.SpecError("house 'train_1' is too small")
        return real(folder, options, index)

    monkeypatch.setattr(command, "make_house", failing)
    with pytest.raises(typer.Exit) as end:
        command.make_houses(tmp_path / "out", count=3, rooms=(1, 1), objects=2, workers=1)
    assert end.value.exit_code == 1
    said = capsys.readouterr()
    assert "houses:    2 made" in said.out
    assert "1 house could not be made: 1 (house 'train_1' is too small)" in said.err
    assert (tmp_path / "out/train_2.xml").is_file()


# --- built-in houses ---


def test_twenty_houses_are_built_in(own_cache: Path):
    source = source_of()
    assert source.size() == 20
    spec = source.make(0)
    assert Path(spec.base).is_relative_to(own_cache)
    assert not check_house(Path(spec.base), 0.5).broken
    with pytest.raises(rc.NotFoundError, match="no scene 20"):
        source.make(20)


def test_a_pick_starts_in_a_house():
    run = run_of(houses=[0])
    run.start.base_distance = [0.3, 0.6]
    sampler = rc.tasks.StartSampler(run)
    known = source_of().annotations(0)
    refusals = []
    for attempt in range(60):
        request = rc.tasks.SampleRequest(scene=0, episode=0, attempt=attempt)
        start = sampler.sample(request, rc.tasks.Rng.stream(3, f"attempt {attempt}"))
        if isinstance(start, rc.tasks.Refusal):
            refusals.append(start.reason)
            continue
        at = start.base_in_world.translation
        on = [area.frame_to_world.inverse().transform(at) for area in known.free_floor]
        assert any(
            abs(point[0]) <= area.half_x and abs(point[1]) <= area.half_y
            for point, area in zip(on, known.free_floor, strict=True)
        )
        return
    raise AssertionError(refusals)


def test_fields_of_houses_are_part_of_a_run_file():
    run = run_of(dataset="procthor-10k", split="val", houses=[3, *range(7, 21)], without=["Mug_2"])
    again = rc.RunConfig.from_yaml(run.to_yaml())
    assert again.scenes == run.scenes
    assert again.scenes.dataset == "procthor-10k"
    assert HousesScenes().ceiling
    with pytest.raises(rc.SpecError, match="split"):
        rc.RunConfig.from_yaml(run_of(split="val").to_yaml())
