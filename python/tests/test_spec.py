"""Specs from Python: edited in place, elements that keep their identity, messages."""

import copy
import dataclasses
import fractions
import pathlib
import pickle
import shutil

import numpy as np
import pytest

import robocell as rc
from robocell import _core


def cube(name: str = "cube") -> rc.SceneObject:
    return rc.SceneObject(
        name=name, shape=rc.Shape.BOX, size=[0.02, 0.02, 0.02], rgba=[1, 0.5, 0, 1], mass=0.1,
        friction=[0.8, 0.02, 0.001],
    )  # fmt: skip


def arm_config() -> rc.RobotConfig:
    return rc.RobotConfig(
        name="arm",
        model="arm.xml",
        move_groups={"arm": {"kind": "arm", "joints": "joint1..joint3", "leaf": {"site": "tcp"}}},
        home={"arm": [0, 1, 2]},
    )


ALL = [v for v in vars(_core).values() if isinstance(v, type) and hasattr(v, "to_yaml")]


class TestValues:
    @pytest.mark.parametrize("cls", ALL)
    def test_defaults_survive_copies_pickles_and_yaml(self, cls):
        spec = cls()
        for other in (copy.copy(spec), copy.deepcopy(spec), pickle.loads(pickle.dumps(spec))):
            assert other == spec
            assert type(other) is cls
        assert repr(spec) == f"{cls.__name__}()"
        assert not spec.to_yaml().startswith("null")

    def test_a_copy_shares_nothing(self):
        spec = rc.SceneSpec(objects=[cube()], robots=[rc.RobotSpec(config=arm_config())])
        for other in (copy.copy(spec), copy.deepcopy(spec), pickle.loads(pickle.dumps(spec))):
            assert other == spec
            other.objects[0].size[0] = 7
            other.robots[0].config.home["arm"][0] = 7
            assert other != spec
            assert spec.objects[0].size[0] == 0.02
            assert spec.robots[0].config.home["arm"][0] == 0

    def test_a_subclass_is_copied_with_its_attributes(self):
        class Labelled(rc.SceneSpec):
            pass

        spec = Labelled(name="a")
        spec.label = "mine"
        other = copy.copy(spec)
        assert type(other) is Labelled
        assert (other.name, other.label) == ("a", "mine")

    def test_pickles_hold_text_only(self):
        assert all(isinstance(part, str) for part in arm_config().__getstate__())

    def test_pickles_are_built_in_any_folder(self, tmp_path, monkeypatch):
        shutil.copytree(pathlib.Path(rc.models.robot_file("rc7")).parent, tmp_path / "arms")
        (tmp_path / "cell.yaml").write_text("robots: {arm: arms/rc7.yaml}\nscene: room.xml\n")
        (tmp_path / "room.xml").write_text("<mujoco model='room'/>")
        (tmp_path / "elsewhere").mkdir()
        monkeypatch.chdir(tmp_path)
        loaded = rc.EnvConfig.load("cell.yaml")
        made = rc.EnvConfig(robots={"arm": "arms/rc7.yaml"}, scene="room.xml")
        pickled = [pickle.dumps(config) for config in (loaded, made)]
        monkeypatch.chdir(tmp_path / "elsewhere")
        for text in pickled:
            config = pickle.loads(text)
            assert config == loaded
            rc.Env(config).close()

    def test_repr_round_trips(self):
        spec = rc.SceneSpec(timestep=0.002, objects=[cube()], robots=[{"config": arm_config()}])
        assert eval(repr(spec), {**vars(rc.scene), **vars(rc.robots), **vars(rc.control)}) == spec

    def test_yaml_round_trips(self):
        spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=True, objects=[cube()])
        assert rc.SceneSpec.from_yaml(spec.to_yaml()) == spec

    def test_specs_are_equal_by_value_and_not_hashable(self):
        assert cube() == cube()
        assert cube() != cube("b")
        assert cube() != 3
        with pytest.raises(TypeError):
            hash(cube())

    def test_load_accepts_overrides(self):
        file = rc.models.robot_file("rc7")
        robot = rc.RobotConfig.load(pathlib.Path(file), ["home.arm[1]=0.5"])
        assert robot.home["arm"][1] == 0.5
        with pytest.raises(rc.SpecError, match=r"--set hme=1: hme: .*mean 'home'"):
            rc.RobotConfig.load(file, ["hme=1"])

    def test_accepts_numbers_of_all_types(self):
        spec = rc.SceneSpec(timestep=np.float32(0.5), add_floor=np.bool_(True))
        spec.options.iterations = np.int64(7)
        assert (spec.timestep, spec.add_floor, spec.options.iterations) == (0.5, True, 7)

    @pytest.mark.parametrize(
        "number",
        [
            *(0.5, np.float32(0.5), np.float64(0.5), np.array(0.5), np.array(0.5, np.float32)),
            *(1, np.int64(1), np.uint8(1), np.array(1), fractions.Fraction(1, 2)),
        ],
        ids=lambda number: f"{type(number).__name__} {number!r}",
    )
    def test_a_single_number_of_any_kind_is_a_list_of_one(self, number):
        for name in ("max_relative_movement", "max_target_lead"):
            config = rc.EnvConfig(**{name: number})
            assert getattr(config, name) == (float(number),)
            setattr(config, name, number)
            assert getattr(config, name) == (float(number),)

    @pytest.mark.parametrize(
        "wrong", [True, np.True_, 1j, np.complex64(1), "1", b"1", bytearray(b"1"), None]
    )
    def test_rejects_a_single_value_that_is_not_a_number(self, wrong):
        with pytest.raises((TypeError, ValueError), match="max_target_lead"):
            rc.EnvConfig(max_target_lead=wrong)

    def test_rejects_a_string_and_names_the_expected_type(self):
        told = "max_relative_movement must be a number or a list of numbers, got str"
        with pytest.raises(TypeError, match=told):
            rc.EnvConfig(max_relative_movement="0.05")

    def test_defaults_of_task_fields_can_be_numpy_values(self):
        @rc.register_task("corrected_numbers")
        class Numbers(rc.tasks.Task):
            @dataclasses.dataclass
            class Fields:
                whole: int = np.int64(3)
                real: float = np.float32(0.5)
                flag: bool = np.True_

            def __init__(self, fields):
                super().__init__()

            def judge(self, scene):
                return rc.tasks.TaskVerdict()

            def instruction(self):
                return "wait"

        config = rc.EnvConfig(task={"kind": "corrected_numbers"})
        assert (config.task.whole, config.task.real, config.task.flag) == (3, 0.5, True)


class TestPlaces:
    def test_elements_added_in_python_have_no_place_in_the_file(self):
        config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
        config.edits.append(rc.robots.Edit(joint="joint9", damping=1.0))
        spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False)
        spec.robots.append(rc.RobotSpec(name="q", config=config))
        with pytest.raises(rc.NotFoundError) as caught:
            rc.Scene.build(spec)
        place = f"scene 'scene' / robot 'q' / edits[{len(config.edits) - 1}]: the model: no joint"
        assert str(caught.value).startswith(place)

    def test_a_spec_reports_the_places_of_its_fields(self, tmp_path: pathlib.Path):
        path = tmp_path / "run.yaml"
        path.write_text(f"run: a\nrobot: {rc.models.robot_file('rc7')}\noutput: out\n")
        run = rc.RunConfig.load(path)
        assert run.location("output") == f"{path}:3:9"
        assert run.location("robot.home.arm[2]").startswith(rc.models.robot_file("rc7"))
        assert run.location("task.lift_height") == run.location(), "the part that is there"
        given = rc.RunConfig.load(path, ["output=there"])
        assert given.location("output") == "--set output=there"
        assert rc.RunConfig().location("output") == ""
