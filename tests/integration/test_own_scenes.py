"""Scene sources and samplers of a user's module, through the command line like built-in ones."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from commands import ROOT, generate, refusal, robocell_command

import robocell as rc

RC7 = ROOT / "models" / "robots" / "rc7" / "rc7.yaml"
MODULE = '''
"""Desks of several heights, and starts whose base stands near."""

from dataclasses import dataclass

import robocell as rc
from robocell.scenes import SceneAnnotations, SupportFace


@rc.scenes.register_scene_source("desks")
class Desks(rc.scenes.SceneSource):
    @dataclass
    class Fields:
        height: float = 0.4  # m
        known: bool = True

    def __init__(self, fields):
        super().__init__()
        self.height, self.known = fields.height, fields.known

    def size(self):
        return 2

    def make(self, index):
        spec = rc.SceneSpec(name="desk", add_floor=True, add_skybox=True)
        desk = rc.SceneObject(name="desk", shape=rc.Shape.BOX, size=[0.3, 0.4, self.top(index) / 2])
        desk.rgba, desk.mass, desk.friction = [0.6, 0.5, 0.4, 1], 10, [1, 0.02, 0.001]
        desk.pos, desk.fixed = [0, 0, self.top(index) / 2], True
        spec.objects.append(desk)
        return spec

    def top(self, index):
        return self.height + 0.05 * index

    def annotations(self, index):
        if not self.known:
            return None
        top = self.top(index)
        face = rc.scenes.Support(rc.Pose(translation=[0, 0, top]), 0.3, 0.4, thickness=top)
        return SceneAnnotations(supports=[SupportFace(face, body="desk", free_area=0.48)])


@rc.tasks.register_sampler("near")
class Near(rc.tasks.StartSampler):
    def choose_base_placement(self, request, rng):
        return rc.tasks.BasePlacement(0.35, -0.2)
'''


@pytest.fixture
def run_file(tmp_path: Path) -> Path:
    (tmp_path / "own_desks.py").write_text(MODULE)
    file = tmp_path / "desks.yaml"
    file.write_text(
        f"run: desks\nimports: [own_desks.py]\nrobot: {RC7}\n"
        "task: {kind: pick, objects: [box]}\n"
        "start: {base_distance: [0.3, 0.5], base_height_offset: -0.2}\n"
        "scenes: {source: desks, height: 0.45}\nsampler: near\noutput: unset\n"
    )
    return file


def files_of(folder: Path) -> dict[str, bytes]:
    return {file.parent.name: file.read_bytes() for file in sorted(folder.glob("s*/steps.h5"))}


@pytest.mark.proof
def test_a_run_in_custom_scenes_is_estimated(run_file: Path):
    assert robocell_command("generate", run_file, "--dry-run").returncode == 0


@pytest.mark.parametrize("per_scene", [1, pytest.param(2, marks=pytest.mark.proof)])
def test_episodes_are_generated_in_custom_scenes(run_file: Path, tmp_path: Path, per_scene: int):
    generate(run_file, tmp_path / "two", "--workers", 2, "--episodes", 2 * per_scene)
    generate(run_file, tmp_path / "one", "--workers", 1, "--episodes", per_scene)
    generate(run_file, tmp_path / "one", "--workers", 1, "--episodes", 2 * per_scene)  # it goes on
    two = files_of(tmp_path / "two")
    assert list(two) == [f"s000{s}_e000{e}" for s in range(2) for e in range(per_scene)]
    assert files_of(tmp_path / "one") == two
    for episode in rc.Dataset(tmp_path / "two"):
        top = 0.45 + 0.05 * int(episode.metadata["scene"])
        assert 0 < episode["objects/target/pose"][0][2] - top < 0.1
        assert episode.metadata["task"] == "pick"
        assert rc.data.verify_replay(episode).ok
    manifest = json.loads((tmp_path / "two" / "dataset.json").read_text())
    assert "code/own_desks.py" in manifest["files"]
    said = robocell_command("report", tmp_path / "two").stdout
    assert f"{2 * per_scene} episodes" in said


@pytest.mark.proof  # as code of tasks in test_own_tasks.py
def test_code_of_scenes_is_part_of_a_dataset(run_file: Path, tmp_path: Path):
    generate(run_file, tmp_path / "out", "--workers", 1, "--episodes", 1)
    module = run_file.with_name("own_desks.py")
    module.write_text(module.read_text().replace("0.05 * index", "0.06 * index"))
    said = refusal("generate", run_file, "--output", tmp_path / "out", "--episodes", "2")
    assert "code file own_desks.py: changed since then" in said
    module.unlink()
    assert robocell_command("verify", tmp_path / "out").returncode == 0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("height: 0.45", "heigth: 0.45", "Did you mean 'height'?"),
        ("source: desks", "source: desk", "Did you mean 'desks'?"),
        ("height: 0.45", "houses: [0, 2]", "2 is outside the 2 scenes of source 'desks'"),
        ("sampler: near", "sampler: nearr", "Did you mean 'near'?"),
        ("base_distance", "base_distanc", "Did you mean 'base_distance'?"),
        ("objects: [box]", "base_distance: [1, 2]", "start.base_distance"),
    ],
)
def test_errors_name_the_place_in_the_run_file(
    run_file: Path, tmp_path: Path, old: str, new: str, message: str
):
    run_file.write_text(run_file.read_text().replace(old, new))
    said = refusal("generate", run_file, "--output", tmp_path / "out")
    assert message in said
    assert "desks.yaml:" in said
    assert not (tmp_path / "out").exists()


def test_annotations_can_be_derived_from_geometry(run_file: Path, tmp_path: Path):
    words = ("--set", "scenes.known=false", "--workers", 1, "--episodes", 1)
    generate(run_file, tmp_path / "out", *words)
    (episode,) = rc.Dataset(tmp_path / "out")
    assert 0 < episode["objects/target/pose"][0][2] - 0.45 < 0.1


@pytest.mark.parametrize(
    ("line", "method"),
    [
        ('        spec = rc.SceneSpec(name="desk"', "make"),
        pytest.param(
            "        return rc.tasks.BasePlacement(0.35",
            "choose_base_placement",
            marks=pytest.mark.proof,
        ),
    ],
)
def test_an_exception_names_its_line(run_file: Path, tmp_path: Path, line: str, method: str):
    module = run_file.with_name("own_desks.py")
    text = module.read_text()
    module.write_text(text.replace(line, '        raise RuntimeError("out of wood")\n' + line))
    number = 1 + text[: text.index(line)].count("\n")
    result = robocell_command("generate", run_file, "--output", tmp_path / "out", "--episodes", "1")
    said = " ".join((result.stdout + result.stderr).split())
    assert result.returncode != 0
    assert "RuntimeError: out of wood" in said
    assert f"own_desks.py:{number}, in {method}" in said


@pytest.mark.proof
def test_a_start_requires_a_camera_that_sees_the_object(run_file: Path, tmp_path: Path):
    start = "start: {visible_from: [exo_camera], visible_share: 0.3, "
    run_file.write_text(run_file.read_text().replace("start: {", start))
    generate(run_file, tmp_path / "out", "--workers", 1, "--episodes", 2)
    run_file.write_text(run_file.read_text().replace("exo_camera", "exo_camra"))
    said = refusal("generate", run_file, "--output", tmp_path / "no", "--episodes", "2")
    assert "Did you mean 'exo_camera'?" in said


class Count(rc.scenes.SceneSource):
    """Two tables; what is odd about them is set from outside."""

    many: int | None = 2
    annotated: rc.scenes.SceneAnnotations | None = None
    random = False
    made = 0
    directory = "unset"

    def __init__(self, directory: str):
        super().__init__()
        Count.directory = directory

    def size(self) -> int | None:
        return Count.many

    def make(self, index: int) -> rc.SceneSpec:
        Count.made += 1
        base = "tabletop"
        spec = rc.SceneSpec(base=base, add_floor=True)
        if Count.random:
            spec.objects.append(rc.SceneObject(name=f"cube{Count.made}"))
        return spec

    def annotations(self, index: int) -> rc.scenes.SceneAnnotations | None:
        return Count.annotated


@pytest.fixture
def counted(tmp_path: Path) -> rc.RunConfig:
    rc.scenes.register_scene_source("count_of_test")(Count)
    Count.many, Count.annotated, Count.random = 2, None, False
    file = tmp_path / "count.yaml"
    file.write_text(
        f"run: count\nrobot: {RC7}\ntask: {{kind: pick, objects: [box]}}\n"
        "scenes: {source: count_of_test}\noutput: unset\n"
    )
    return rc.RunConfig.load(file)


def test_rejects_scene_numbers_out_of_range(counted: rc.RunConfig):
    for index in (5, -1, 2):
        with pytest.raises(rc.NotFoundError, match=f"no scene {index}; it has 2 \\(0 ... 1\\)"):
            rc.scenes.base_scene(counted, index)
    counted.scenes = {"source": "files", "files": ["a.xml", "b.xml"]}
    source = rc.scenes.make_scene_source(counted)
    for call in (source.make, source.annotations):
        with pytest.raises(rc.NotFoundError, match="no scene 5; it has 2"):
            call(5)


@pytest.mark.parametrize(
    ("many", "told"), [(-3, "says that it has -3 scenes"), (10**9, "a run takes 1000000 at most")]
)
def test_rejects_scene_counts_out_of_range(counted: rc.RunConfig, many: int, told: str):
    Count.many = many
    with pytest.raises(rc.SpecError, match=told) as error:
        rc.diagnose.check_run(counted)
    assert len(str(error.value)) < 500


def test_a_source_gets_the_folder_of_the_run_file(counted: rc.RunConfig, tmp_path: Path):
    rc.scenes.make_scene_source(counted)
    assert Path(Count.directory) == tmp_path


def test_rejects_scenes_that_differ_between_calls(counted: rc.RunConfig):
    Count.random = True
    with pytest.raises(rc.SpecError, match="gave another scene 0 when it was asked again"):
        rc.diagnose.check_run(counted)


def test_rejects_annotations_that_are_not_finite(counted: rc.RunConfig):
    room = rc.scenes.Room("kitchen", floor_height=float("nan"))
    Count.annotated = rc.scenes.SceneAnnotations(rooms=[room])
    told = r"annotations of scene 0: rooms\[0\].floor_height is nan; it must be finite"
    with pytest.raises(rc.SpecError, match=told):
        rc.diagnose.check_run(counted)
    with pytest.raises(rc.ArgumentError, match="the height of a base placement is inf"):
        rc.tasks.BasePlacement(0.4, float("inf"))
