"""Specs from Python: edited in place, elements that keep their identity, messages."""

import collections.abc
import copy
import pathlib
import pickle
import re
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


LIST_STEPS = [
    lambda x, a, **_: x.append(a),
    lambda x, b, c, **_: x.extend([b, c]),
    lambda x, d, **_: x.insert(1, d),
    lambda x, c, **_: x.insert(-100, c),
    lambda x, a, **_: x.insert(100, a),
    lambda x, **_: x.reverse(),
    lambda x, **_: x.pop(),
    lambda x, **_: x.pop(1),
    lambda x, b, **_: x.remove(b),
    lambda x, b, **_: x.__setitem__(0, b),
    lambda x, d, **_: x.__setitem__(-1, d),
    lambda x, a, b, c, **_: x.__setitem__(slice(1, 2), [a, b, c]),
    lambda x, **_: x.__setitem__(slice(None, None, 2), x[::2]),
    lambda x, **_: x.__delitem__(0),
    lambda x, **_: x.__delitem__(slice(1, 3)),
    lambda x, c, d, **_: x.__iadd__([c, d]) and None,
]

ALL = [v for v in vars(_core).values() if isinstance(v, type) and hasattr(v, "to_yaml")]


class TestFields:
    def test_vectors_are_views_that_write_through(self):
        gripper = rc.AttachmentSpec()
        pos = gripper.pos
        gripper.pos[2] = 0.005
        gripper.euler[2] = 15
        pos[0] = 1
        assert gripper.pos.tolist() == [1, 0, 0.005]
        assert gripper.euler.tolist() == [0, 0, 15]
        gripper.pos += 1
        assert pos.tolist() == [2, 1, 1.005]

    def test_optional_vectors_are_views_once_set(self):
        spec = rc.SceneObject()
        assert spec.size is None
        spec.size = (1, 2, 3)
        spec.size[0] = 5
        assert spec.size.tolist() == [5, 2, 3]
        spec.size = None
        assert spec.size is None

    def test_views_outlive_their_spec(self):
        view = rc.SceneSpec().gravity
        assert view.tolist() == [0, 0, -9.81]
        numbers = arm_config().home["arm"]
        assert numbers.tolist() == [0, 1, 2]

    def test_nested_specs_are_edited_in_place(self):
        spec = rc.SceneSpec()
        options = spec.options
        options.impratio = 3
        spec.options.integrator = "euler"
        assert spec.options.impratio == 3
        assert options.integrator == rc.scene.Integrator.EULER

    def test_optional_specs_keep_the_object_that_was_put_in(self):
        config = arm_config()
        robot = rc.RobotSpec(config=config)
        assert robot.config is config
        config.reach = 1.0
        assert robot.config.reach == 1.0
        robot.config = None
        assert robot.config is None
        assert config.name == "arm"

    def test_what_cannot_be_edited_is_immutable(self):
        spec = rc.SceneSpec()
        assert spec.options.disable == ()
        spec.options.disable = ["contact"]
        assert spec.options.disable == ("contact",)
        with pytest.raises(AttributeError):
            rc.RobotSpec().attach_to.name = "x"

    def test_names_and_ranges(self):
        group = rc.robots.MoveGroupConfig(joints="joint1..joint7", actuators="servo")
        assert group.joints == tuple(f"joint{i}" for i in range(1, 8))
        assert group.actuators == ("servo",)
        group.joints = (name for name in ("a", "b"))
        assert group.joints == ("a", "b")
        assert rc.SceneSourceSpec(houses=range(4)).houses == (0, 1, 2, 3)

    def test_enums_are_taken_by_value_and_by_name(self):
        spec = cube()
        spec.shape = "sphere"
        assert spec.shape is rc.Shape.SPHERE
        assert spec.condim is None
        spec.condim = rc.scene.Condim.ROLLING
        assert spec.condim.value == 6
        assert [kind.name for kind in rc.AttachKind] == [
            "World", "Root", "SharedBase", "Body", "Site", "Frame", "RobotBase", "Attachment",
        ]  # fmt: skip

    def test_targets(self):
        spec = cube()
        assert spec.attach_to == rc.AttachTarget()
        spec.attach_to = rc.AttachTarget(rc.AttachKind.Site, "pinch_site")
        assert spec.attach_to.kind is rc.AttachKind.Site
        spec.attach_to = {"body": "table"}
        assert spec.attach_to == rc.AttachTarget("body", "table")
        assert hash(spec.attach_to) == hash(rc.AttachTarget("body", "table"))
        assert repr(spec.attach_to) == "AttachTarget(AttachKind.Body, 'table')"

    def test_elements(self):
        group = rc.robots.MoveGroupConfig(leaf={"geom": {"body": "finger", "index": 2}})
        assert group.leaf == rc.scene.ElementRef(
            kind=rc.scene.ElementKind.GEOM, body="finger", index=2
        )
        group.fingers = ["left", {"site": "right"}]
        assert group.fingers == (
            rc.scene.ElementRef("left"),
            rc.scene.ElementRef("right", kind="site"),
        )

    def test_paths_are_taken_as_text(self):
        assert rc.RobotSpec(path=pathlib.Path("a") / "b.xml").path == "a/b.xml"

    def test_gravity_z_is_the_third_component(self):
        spec = rc.SceneSpec()
        spec.gravity_z = -1.62
        assert spec.gravity[2] == spec.gravity_z == -1.62

    def test_a_runs_robot_is_a_config_or_a_file(self):
        file = rc.models.robot_file("rc7")
        run = rc.RunConfig(run="r", robot=file, output="o")
        assert run.robot.name == "rc7"
        run.robot.reach = 0.5
        assert run.robot.reach == 0.5
        run.robot = arm_config()
        assert run.robot.name == "arm"

    def test_every_field_is_documented(self):
        for cls in ALL:
            for name, value in vars(cls).items():
                if isinstance(value, property):
                    assert value.__doc__, f"{cls.__name__}.{name}"


class TestMessages:
    def test_an_unknown_field_suggests_the_nearest(self):
        with pytest.raises(TypeError, match=r"a SceneSpec: no field 'gravty'.*mean 'gravity'"):
            rc.SceneSpec(gravty=[0, 0, 0])
        with pytest.raises(TypeError, match=r"robots\[0\]: a RobotSpec: no field 'pth'"):
            rc.SceneSpec(robots=[{"pth": "a.xml"}])
        with pytest.raises(AttributeError):
            rc.SceneSpec().gravty = 1

    @pytest.mark.parametrize(
        ("field", "value", "message"),
        [
            ("robots", ["x"], r"robots\[0\] must be a RobotSpec, got str"),
            ("robots", [rc.RobotSpec(), None], r"robots\[1\] must be a RobotSpec, got None"),
            ("robots", rc.RobotSpec(), "robots must be a list of RobotSpec, got"),
            ("robots", "x", "robots must be a list of RobotSpec, got str"),
            ("robots", [{"attachments": [3]}], r"robots\[0\]\.attachments\[0\] must be an Attach"),
            ("timestep", "fast", "timestep must be a number, got str"),
            ("add_floor", 1, "add_floor must be True or False, got int"),
            ("name", 3, "name must be a text, got int"),
            ("name", None, "name must be a text, got None"),
            ("options", 3, "options must be a SimOptions, got int"),
            ("root_frame_to_world", [0, 0, 0], "root_frame_to_world must be a Pose, got list"),
        ],
    )
    def test_wrong_types_say_what_and_where(self, field, value, message):
        spec = rc.SceneSpec()
        with pytest.raises(TypeError, match=message):
            setattr(spec, field, value)
        assert spec == rc.SceneSpec()

    @pytest.mark.parametrize(
        ("field", "value", "message"),
        [
            ("gravity", [0, 0], "gravity must be 3 numbers, got 2"),
            ("options", {"integrator": "eulr"}, "options.integrator must be one of.*mean 'euler'"),
            ("options", {"iterations": 2**40}, "options.iterations must lie between"),
        ],
    )
    def test_wrong_values_say_what_and_where(self, field, value, message):
        with pytest.raises(rc.ArgumentError, match=message):
            setattr(rc.SceneSpec(), field, value)

    def test_validation_reports_everything(self):
        spec = rc.SceneSpec(timestep=-1, robots=[rc.RobotSpec()])
        with pytest.raises(rc.SpecError) as error:
            spec.validate("scene 'lab'")
        assert str(error.value).splitlines() == [
            "scene 'lab' is not valid, 4 problems:",
            "  timestep: -1 must be greater than 0",
            "  robots[0].path: is empty: give the robot's model file, or a config",
            "  add_floor: is required without a base scene: true or false",
            "  add_skybox: is required without a base scene: true or false",
        ]

    def test_yaml_errors_carry_the_place(self):
        with pytest.raises(rc.SpecError, match=r"lab\.yaml:2:1: timstep: .*mean 'timestep'"):
            rc.SceneSpec.from_yaml("name: lab\ntimstep: 1\n", "lab.yaml")


class TestLists:
    def test_an_element_stays_the_object_that_was_put_in(self):
        spec = rc.SceneSpec()
        robot = rc.RobotSpec(path="a.xml")
        spec.robots.append(robot)
        assert spec.robots[0] is robot
        for i in range(100):
            spec.robots.append(rc.RobotSpec(prefix=f"{i}_"))
        assert spec.robots[0] is robot
        robot.prefix = "left_"
        assert spec.robots[0].prefix == "left_"

    def test_subclasses_stay_what_they_are(self):
        class Labelled(rc.RobotSpec):
            label = "mine"

        spec = rc.SceneSpec(robots=[Labelled(path="a.xml")])
        assert type(spec.robots[0]) is Labelled
        assert spec.robots[0].label == "mine"

    def test_elements_made_in_c_plus_plus_keep_their_identity_while_held(self):
        spec = rc.SceneSpec.from_yaml(
            "timestep: 0.1\nadd_floor: true\nadd_skybox: true\nrobots: [{path: a.xml}]\n"
        )
        robot = spec.robots[0]
        assert spec.robots[0] is robot
        robot.prefix = "p_"
        del spec
        assert robot.prefix == "p_"

    def test_an_element_outlives_its_list(self):
        robots = rc.SceneSpec(robots=[{"path": "a.xml"}]).robots
        robot = robots[0]
        robots.clear()
        assert robot.path == "a.xml"
        assert len(robots) == 0

    def test_one_object_in_two_lists_is_one_object(self):
        robot = rc.RobotSpec(path="a.xml")
        a, b = rc.SceneSpec(robots=[robot]), rc.SceneSpec(robots=[robot])
        a.robots[0].prefix = "x_"
        assert b.robots[0].prefix == "x_"
        b.robots.append(a.robots[0])
        assert b.robots[1] is robot

    def test_it_does_everything_that_a_list_does(self):
        mine, other = rc.SceneSpec().objects, []
        for step in LIST_STEPS:
            items = {name: cube(name) for name in "abcd"}
            results = [step(objects, **items) for objects in (mine, other)]
            assert [o.name for o in mine] == [o.name for o in other]
            if isinstance(results[1], rc.SceneObject):
                assert results[0] is results[1]
            assert len(mine) == len(other)
            assert mine == other
            assert (cube("a") in mine) == (cube("a") in other)
            assert mine.count(cube("d")) == other.count(cube("d"))
            assert mine[1:] == other[1:]
        assert isinstance(mine, collections.abc.MutableSequence)
        assert mine.index(other[1]) == 1
        assert list(reversed(mine)) == other[::-1]

    def test_what_a_list_refuses(self):
        objects = rc.SceneSpec(objects=[cube()]).objects
        with pytest.raises(IndexError, match=r"objects\[3\] is out of range, it has 1 elements"):
            objects[3]
        with pytest.raises(ValueError, match="objects does not hold that SceneObject"):
            objects.remove(cube("other"))
        with pytest.raises(TypeError, match=r"objects\[1\] must be a SceneObject, got int"):
            objects.append(3)
        with pytest.raises(TypeError, match=r"objects\[1\] must be a SceneObject, got int"):
            objects[0:1] = [cube("a"), 3]
        with pytest.raises(TypeError, match=r"objects\[1\] must be a SceneObject"):
            objects.extend([cube("a"), "b"])
        assert [o.name for o in objects] == ["cube"]

    def test_augmented_assignment_keeps_the_elements(self):
        spec = rc.SceneSpec()
        first = cube("a")
        spec.objects += [first]
        spec.objects += [cube("b")]
        spec.objects = spec.objects
        assert spec.objects[0] is first
        assert len(spec.objects) == 2


class TestMaps:
    def test_values_stay_the_objects_that_were_put_in(self):
        config = rc.RobotConfig()
        group = rc.robots.MoveGroupConfig(kind="arm")
        config.move_groups["arm"] = group
        assert config.move_groups["arm"] is group
        config.move_groups["gripper"] = {"kind": "gripper"}
        assert list(config.move_groups) == ["arm", "gripper"]
        assert config.move_groups["gripper"].kind is rc.robots.MoveGroupKind.GRIPPER

    def test_numbers_are_edited_in_place(self):
        config = arm_config()
        config.home["arm"][1] = 0.5
        assert config.home["arm"].tolist() == [0, 0.5, 2]
        held = config.home["arm"]
        config.home["arm"] = [7]
        assert held.tolist() == [0, 0.5, 2]
        assert config.home["arm"].tolist() == [7]

    def test_it_does_everything_that_a_mapping_does(self):
        control = rc.RobotConfig(control={"a": "joint_position"}).control
        assert control["a"] is rc.control.ControlKind.JOINT_POSITION
        control.update({"b": rc.control.ControlKind.RELATIVE_JOINT_POSITION})
        assert control == dict(control.items())
        assert "b" in control
        assert 3 not in control
        assert control.get("c") is None
        assert control.pop("c", 5) == 5
        assert control.pop("a") is rc.control.ControlKind.JOINT_POSITION
        del control["b"]
        assert len(control) == 0
        assert isinstance(control, collections.abc.MutableMapping)

    def test_what_a_mapping_refuses(self):
        config = arm_config()
        with pytest.raises(KeyError, match=r"home: no key 'amr'.*Did you mean 'arm'"):
            config.home["amr"]
        with pytest.raises(TypeError, match=r"home.arm\[0\] must be a number, got str"):
            config.home = {"arm": ["x"]}
        with pytest.raises(TypeError, match=r"move_groups.x must be a MoveGroupConfig, got int"):
            config.move_groups["x"] = 3
        with pytest.raises(TypeError, match="home must be a mapping of names"):
            config.home = [1]
        with pytest.raises(TypeError, match="home must be a mapping of names to numbers, got int"):
            config.home = 3
        with pytest.raises(
            TypeError,
            match=r"control\.arm must be a ControlKind or one of joint_position, .*, got int",
        ):
            config.control = {"arm": 3}
        with pytest.raises(TypeError, match="move_groups must be keyed by names, got int"):
            config.move_groups[3] = {}
        assert config == arm_config()

    @pytest.mark.parametrize(
        ("given", "text"),
        [
            (3, " must be a mapping of names to mappings of names to EnvObject, got int"),
            ({"x": 3}, ".x must be a mapping of names to EnvObject, got int"),
            ({"x": {"cup": 3}}, ".x.cup must be an EnvObject, got int"),
            ({"x": {"cup": {"mass": "1"}}}, ".x.cup.mass must be a number, got str"),
            ({3: {}}, " must be keyed by names, got int"),
            ({"x": {3: {}}}, ".x must be keyed by names, got int"),
        ],
    )
    def test_what_a_mapping_of_mappings_refuses(self, given, text):
        config = rc.EnvConfig()
        with pytest.raises(TypeError, match=f"^robot_frame_objects{re.escape(text)}$"):
            config.robot_frame_objects = given

    def test_a_mapping_in_a_mapping_knows_its_name(self):
        config = rc.EnvConfig(robot_frame_objects={"left": {"cup": {}}})
        of_left = config.robot_frame_objects["left"]
        with pytest.raises(TypeError, match=r"^robot_frame_objects\.left\.mug must be an Env"):
            of_left["mug"] = 3
        with pytest.raises(KeyError, match=r"robot_frame_objects\.left: no key 'cpu'.*'cup'"):
            of_left["cpu"]


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

    def test_repr_gives_the_spec_back(self):
        spec = rc.SceneSpec(timestep=0.002, objects=[cube()], robots=[{"config": arm_config()}])
        assert eval(repr(spec), {**vars(rc.scene), **vars(rc.robots), **vars(rc.control)}) == spec

    def test_yaml_gives_the_spec_back(self):
        spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=True, objects=[cube()])
        assert rc.SceneSpec.from_yaml(spec.to_yaml()) == spec

    def test_specs_are_equal_by_value_and_not_hashable(self):
        assert cube() == cube()
        assert cube() != cube("b")
        assert cube() != 3
        with pytest.raises(TypeError):
            hash(cube())

    def test_load_takes_overrides(self):
        file = rc.models.robot_file("rc7")
        robot = rc.RobotConfig.load(pathlib.Path(file), ["home.arm[1]=0.5"])
        assert robot.home["arm"][1] == 0.5
        with pytest.raises(rc.SpecError, match=r"--set hme=1: hme: .*mean 'home'"):
            rc.RobotConfig.load(file, ["hme=1"])

    def test_numbers_of_all_kinds_are_taken(self):
        spec = rc.SceneSpec(timestep=np.float32(0.5), add_floor=np.bool_(True))
        spec.options.iterations = np.int64(7)
        assert (spec.timestep, spec.add_floor, spec.options.iterations) == (0.5, True, 7)


class TestPlaces:
    def test_what_was_added_in_python_has_no_place_in_the_file(self):
        config = rc.RobotConfig.load(rc.models.robot_file("rc7"))
        config.edits.append(rc.robots.Edit(joint="joint9", damping=1.0))
        spec = rc.SceneSpec(timestep=0.002, add_floor=True, add_skybox=False)
        spec.robots.append(rc.RobotSpec(name="q", config=config))
        with pytest.raises(rc.NotFoundError) as caught:
            rc.Scene.build(spec)
        place = f"scene 'scene' / robot 'q' / edits[{len(config.edits) - 1}]: the model: no joint"
        assert str(caught.value).startswith(place)

    def test_a_spec_says_where_its_fields_stood(self, tmp_path: pathlib.Path):
        path = tmp_path / "run.yaml"
        path.write_text(f"run: a\nrobot: {rc.models.robot_file('rc7')}\noutput: out\n")
        run = rc.RunConfig.load(path)
        assert run.location("output") == f"{path}:3:9"
        assert run.location("robot.home.arm[2]").startswith(rc.models.robot_file("rc7"))
        assert run.location("task.lift_height") == run.location(), "the part that is there"
        given = rc.RunConfig.load(path, ["output=there"])
        assert given.location("output") == "--set output=there"
        assert rc.RunConfig().location("output") == ""
