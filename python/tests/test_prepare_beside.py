"""Tasks prepare a scene that has objects: they read them, leave them, and may share names."""

from __future__ import annotations

from pathlib import Path

import pytest

import robocell as rc


def box(name: str, half: float, **fields: object) -> rc.SceneObject:
    made = rc.SceneObject(name=name, shape=rc.Shape.BOX, size=[half] * 3)
    made.rgba, made.mass, made.friction = [1, 0, 0, 1], 0.08, [1, 0.02, 0.001]
    for field, value in fields.items():
        setattr(made, field, value)
    return made


class Bench(rc.scenes.SceneSource):
    def size(self):
        return None

    def make(self, index):
        spec = rc.SceneSpec(add_floor=True, add_skybox=True)
        spec.objects.append(box("bench", 0.02, size=[0.4, 0.6, 0.02], pos=[0, 0, 0.6], fixed=True))
        spec.objects.append(box("box", 0.03, pos=[0.3, 0.5, 0.65], fixed=True))
        return spec


class Put(rc.tasks.Task):
    kind = "target"

    def prepare(self, spec, rng):
        spec.objects.append(box("target", 0.02))

    def kind_of(self, name):
        return self.kind

    def judge(self, scene):
        return rc.tasks.TaskVerdict(1.0, True)

    def instruction(self):
        return "look"

    def objects(self):
        return ["target"]

    def base_range(self):
        return rc.tasks.BaseRange(distance=[0.3, 0.4], height_offset=-0.25)


def prepared(task: type[rc.tasks.Task], folder: Path) -> rc.RunConfig:
    """The run of a task on the bench, whose dataset is prepared."""
    rc.scenes.register_scene_source("bench_of_test")(Bench)
    rc.register_task("put_of_test")(task)
    run = rc.RunConfig.load(Path(__file__).parents[2] / "examples" / "demo.yaml")
    run.cameras.streams.clear()
    run.scenes = {"source": "bench_of_test"}
    run.task = {"kind": "put_of_test"}
    run.expert, run.output = "pick", str(folder / "out")
    rc.generate.prepare_dataset(run)
    return run


def test_a_task_reads_the_objects_of_the_scene(tmp_path: Path):
    heights: list[float] = []

    class Reads(Put):
        def prepare(self, spec, rng):
            heights.append(next(each for each in spec.objects if each.name == "bench").pos[2])
            super().prepare(spec, rng)

    run = prepared(Reads, tmp_path)
    env = rc.envs.RunEnv(run)
    env.reset(0)
    bench = env.scene.body_pose("bench").translation
    assert heights[-1] == pytest.approx(bench[2])


@pytest.mark.parametrize("kind", ["box", "a/b c", "x: y"])
def test_any_text_is_a_kind_also_the_name_of_an_object(kind: str, tmp_path: Path):
    class OfKind(Put):
        def kind_of(self, name):
            return kind

    env = rc.envs.RunEnv(prepared(OfKind, tmp_path))
    env.reset(0)
    assert env.object_kinds == [kind]


def test_a_pick_of_a_kind_called_like_an_object_of_the_scene(tmp_path: Path):
    rc.scenes.register_scene_source("bench_of_test")(Bench)
    run = rc.RunConfig.load(Path(__file__).parents[2] / "examples" / "demo.yaml")
    run.cameras.streams.clear()
    run.scenes = {"source": "bench_of_test"}
    run.task = {"kind": "pick", "objects": ["box"]}
    run.output = str(tmp_path / "out")
    rc.generate.prepare_dataset(run)
    env = rc.envs.RunEnv(run)
    env.reset(0)
    assert env.object_kinds == ["box"]
    assert "bench" in env.scene.body_names()


def test_no_kind_is_an_error_of_kind_of(tmp_path: Path):
    class OfNone(Put):
        def kind_of(self, name):
            return ""

    text = r"kind_of\(\) returned \"\" for object 'target'; .*:\d+, in kind_of"
    with pytest.raises(rc.Error, match=text):
        prepared(OfNone, tmp_path)


def test_objects_of_the_scene_stay_where_they_are(tmp_path: Path):
    class Inserts(Put):
        def prepare(self, spec, rng):
            spec.objects.insert(0, box("target", 0.02))

    text = (
        r"moved or removed object 'bench' .*append others.*test_prepare_beside.py:\d+, in prepare"
    )
    with pytest.raises(rc.Error, match=text):
        prepared(Inserts, tmp_path)
