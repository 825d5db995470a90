"""Lists and mappings of specs do what Python's own do, and keep the objects that are put in."""

import collections.abc
import re

import pytest

import robocell as rc


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


class TestLists:
    def test_list_elements_keep_their_identity(self):
        spec = rc.SceneSpec()
        robot = rc.RobotSpec(path="a.xml")
        spec.robots.append(robot)
        assert spec.robots[0] is robot
        for i in range(100):
            spec.robots.append(rc.RobotSpec(prefix=f"{i}_"))
        assert spec.robots[0] is robot
        robot.prefix = "left_"
        assert spec.robots[0].prefix == "left_"

    def test_elements_keep_their_subclass(self):
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

    def test_supports_all_list_operations(self):
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

    def test_a_list_rejects_invalid_elements(self):
        objects = rc.SceneSpec(objects=[cube()]).objects
        with pytest.raises(IndexError, match=r"objects\[3\] is out of range, it has 1 element"):
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
    def test_mapping_values_keep_their_identity(self):
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

    def test_supports_all_mapping_operations(self):
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

    def test_a_mapping_rejects_invalid_keys_and_values(self):
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
    def test_a_mapping_of_mappings_rejects_invalid_values(self, given, text):
        config = rc.EnvConfig()
        with pytest.raises(TypeError, match=f"^robot_frame_objects{re.escape(text)}$"):
            config.robot_frame_objects = given

    def test_errors_of_a_nested_mapping_have_its_name(self):
        config = rc.EnvConfig(robot_frame_objects={"left": {"cup": {}}})
        of_left = config.robot_frame_objects["left"]
        with pytest.raises(TypeError, match=r"^robot_frame_objects\.left\.mug must be an Env"):
            of_left["mug"] = 3
        with pytest.raises(KeyError, match=r"robot_frame_objects\.left: no key 'cpu'.*'cup'"):
            of_left["cpu"]
