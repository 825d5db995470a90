"""What {robot} and a|b stand for, and the numbers of grippers, in mapping files and in presets."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from robocell import NotFoundError, SpecError
from robocell._placeholders import (
    Column,
    Gripper,
    Groups,
    camera_of,
    first_of,
    groups_of,
    openings_of,
)
from robocell._policy_presets import Preset
from robocell.export._mapping import Mapping

OPENINGS = ("opening",)


class Recorded:
    """As much of an episode of robots "right" and "left" as a mapping file looks at."""

    def __init__(self, robots: tuple[str, ...] = ("right", "left"), *, hands: bool = True) -> None:
        self.features: list[Any] = []
        for robot in robots:
            for group, names in (("arm", ("a", "b")), ("hand", OPENINGS))[: 1 + hands]:
                size = len(names)
                column = f"robots/{robot}/action/{group}"
                self._add(f"robots/{robot}/{group}/qpos", "observation", names[:size])
                self._add(f"robots/{robot}/{group}/target", "observation", names)
                self._add(column, "action", names)
                self._add(f"{column}_relative", "action", names)
        # Columns of an episode are sorted by their names; features are in the order of the run.
        self.columns = sorted(feature.name for feature in self.features)
        self.folder, self.cameras = "out/e0", []
        self.json: dict[str, Any] = {"cameras": {}}
        self.metadata = {"instruction": "go"}
        self.values = {
            name: np.full((3, len(self.column(name).names)), 0.1 * index)
            for index, name in enumerate(self.columns)
        }

    def _add(self, name: str, role: str, names: tuple[str, ...]) -> None:
        shape = (len(names),)
        self.features.append(SimpleNamespace(name=name, role=role, names=names, shape=shape))

    def column(self, name: str) -> Any:
        found = next(each for each in self.features if each.name == name)
        return SimpleNamespace(
            table="steps",
            names=found.names,
            row_shape=found.shape,
            units="1",
            frame="",
            dtype="float64",
            values=(),
        )

    def __getitem__(self, name: str) -> Any:
        return self.values[name]

    def __contains__(self, name: str) -> bool:
        return name in self.values


LISTED = (
    '["robots/{robot}/action/{arm}", "robots/{robot}/action/{gripper}", '
    '"robots/{robot}/action/{gripper}_relative"]'
)


def test_an_export_and_a_policy_have_the_same_robots_in_the_order_of_the_run(tmp_path: Path):
    episode: Any = Recorded()
    exported = tmp_path / "export.yaml"
    exported.write_text(f"features: {{action: {LISTED}}}\nimages: null\n")
    feature = Mapping.load(exported, preset=str(exported)).resolve(episode).features[0]
    acted = tmp_path / "policy.yaml"
    acted.write_text(f"actions: {LISTED}\n")
    bound = Preset.load(acted).bind(episode.features, [])
    assert [term.column for term in feature.terms] == [each.column for each in bound.actions]
    assert [each.column.split("/")[1] for each in bound.actions] == ["right"] * 3 + ["left"] * 3


def test_an_export_and_a_policy_have_the_same_numbers_of_grippers(tmp_path: Path):
    episode: Any = Recorded()
    polarity = "gripper: {open: -1, closed: 3}\n"
    exported = tmp_path / "export.yaml"
    exported.write_text(f"features: {{action: {LISTED}}}\nimages: null\n{polarity}")
    feature = Mapping.load(exported, preset=str(exported)).resolve(episode).features[0]
    acted = tmp_path / "policy.yaml"
    acted.write_text(f"actions: {LISTED}\n{polarity}")
    bound = Preset.load(acted).bind(episode.features, [])
    rows = feature.read(episode)
    opening = episode["robots/right/action/hand"][0, 0]
    change = episode["robots/right/action/hand_relative"][0, 0]
    np.testing.assert_allclose(rows[0, 2:4], [3 - 4 * opening, -4 * change], rtol=1e-6)
    columns = {each.column: episode[each.column] for each in bound.actions}
    np.testing.assert_allclose(bound.reply(columns), rows, rtol=1e-6)
    for name, values in bound.columns(rows).items():
        np.testing.assert_allclose(values, columns[name], atol=1e-6)


def test_a_difference_is_not_snapped():
    gripper = Gripper(open=0, closed=1, snap=True)
    np.testing.assert_array_equal(gripper.opening(np.array([0.2, 0.8])), [1, 0])
    np.testing.assert_allclose(gripper.opening(np.array([0.2]), is_difference=True), [-0.2])


def test_groups_are_in_the_order_of_their_actions():
    columns = [
        "robots/b/action/tcp_pose",
        "robots/b/action/wrist",
        "robots/b/action/arm",
        "robots/b/action/arm_relative",
        "robots/a/action/hand",
        "time",
    ]
    assert groups_of(columns, ["robots/a/action/hand"]) == {
        "b": Groups(("wrist", "arm")),
        "a": Groups((), ("hand",)),
    }


@pytest.mark.parametrize(
    ("entry", "found"),
    [("b", ["b"]), ("x|a", ["a"]), ("x*|?", []), ("a*", ["a", "ab"]), ("x?", []), ("x|b*?", ["b"])],
)
def test_the_first_alternative_that_fits_is_taken(entry: str, found: list[str]):
    assert first_of(entry, ["a", "ab", "b"]) == found


def test_only_a_name_alone_may_be_a_camera_that_is_taken():
    cameras = ["wrist", "exo"]
    assert camera_of("wrist", cameras, ["wrist"]) == "wrist"
    assert camera_of("wrist|*", cameras, ["wrist"]) == "exo"
    assert camera_of("*", cameras, cameras) is None


def resolved(tmp_path: Path, text: str, **recorded: Any) -> list[str]:
    """The names of the features that a preset of an export with this text makes."""
    file = tmp_path / "own.yaml"
    file.write_text(f"{text}\nimages: null\n")
    episode: Any = Recorded(**recorded)
    return [each.name for each in Mapping.load(preset=str(file)).resolve(episode).features]


@pytest.mark.parametrize(
    ("column", "message"),
    [
        ("robots/{robt}/{arm}/qpos", "no placeholder '{robt}' in 'robots/{robt}/{arm}/qpos'. Did "),
        ("robots/{robot}/{gripr}/qpos?", "Did you mean '{gripper}'? There are: {robot}, {arm}, "),
        ("robots/{robot/{arm}/qpos", "has a brace without its other one"),
        ("robots/robot}/qpos", "has a brace without its other one"),
        ("robots/left/{arm}/qpos", "has {arm} without {robot}"),
        ("robots/{robot}/{arm}/{gripper}?", "has {arm} and {gripper}"),
    ],
)
@pytest.mark.parametrize("good", ["", '"robots/{robot}/{arm}/qpos", '])
def test_placeholders_that_stand_for_nothing_are_rejected(
    tmp_path: Path, column: str, message: str, good: str
):
    acted = tmp_path / "policy.yaml"
    for text in (f'features: {{state: [{good}"{column}"]}}', f'actions: {{a: [{good}"{column}"]}}'):
        with pytest.raises(SpecError) as raised:
            resolved(tmp_path, text)
        assert message in str(raised.value)
    for text in (f'observation: {{s: [{good}"{column}"]}}', f'actions: [{good}"{column}"]'):
        acted.write_text(text)
        with pytest.raises(SpecError) as raised:
            Preset.load(acted)
        assert message in str(raised.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('features: {"q_{m}": ["time"]}', "no placeholder '{m}' in 'q_{m}'"),
        ('features: {"q_{n}_{arm}": ["time"]}', "has several of {n}, {group}, {arm}"),
        ('features: {}\nimages: {"c.{camra}": "*"}', "Did you mean '{camera}'?"),
        ('features: {}\nimages: {c: "{camera}?"}', "There are none here"),
    ],
)
def test_placeholders_of_names_and_cameras_are_checked(tmp_path: Path, text: str, message: str):
    file = tmp_path / "own.yaml"
    file.write_text(text)
    with pytest.raises(SpecError) as raised:
        Mapping.load(preset=str(file))
    assert message in str(raised.value)


def test_a_feature_without_columns_is_an_error_unless_it_may_be_left_out(tmp_path: Path):
    hands = '"robots/{robot}/{gripper}/qpos"'
    assert resolved(tmp_path, f"features: {{a: [{hands}]}}") == ["a"]
    with pytest.raises(NotFoundError) as raised:
        resolved(tmp_path, f"features: {{a: [{hands}]}}", hands=False)
    assert "features.a: episode 'out/e0' has no column for 'robots/{robot}/{gr" in str(raised.value)
    assert "Its columns: robots/left/action/arm" in str(raised.value)
    optional = hands.replace('qpos"', 'qpos?"')
    assert resolved(tmp_path, f"features: {{a: [{optional}]}}", hands=False) == []
    both = f'["robots/{{robot}}/{{arm}}/qpos", {hands}]'
    assert resolved(tmp_path, f"features: {{a: {both}}}", hands=False) == ["a"]


def test_an_empty_instruction_is_called_empty(tmp_path: Path):
    file = tmp_path / "own.yaml"
    file.write_text("images: null\n")
    episode: Any = Recorded()
    episode.metadata = {"instruction": ""}
    with pytest.raises(NotFoundError) as raised:
        Mapping.load(file).resolve(episode)
    assert "'instruction' of episode 'out/e0' is empty" in str(raised.value)
    assert "Did you mean" not in str(raised.value)


def recording(**columns: Column) -> dict[str, Column]:
    """Returns columns of robot 'a', with the first '_' of each name for '/'."""
    arm = {"arm_qpos": Column(6), "action_arm": Column(6)}
    return {f"robots/a/{n.replace('_', '/', 1)}": c for n, c in {**arm, **columns}.items()}


ONE = Column(1)
ANGLE = Column(1, units="rad")


@pytest.mark.parametrize(
    ("columns", "group"),
    [
        ({"opening": ONE, "action_hand": Column(1, ("opening",))}, "hand"),
        ({"opening": ONE, "action_gripper": ONE}, "gripper"),
        ({"opening": ONE, "action_hand": ONE, "hand_qpos": Column(2)}, "hand"),
        ({"opening": ONE, "action_rail": ANGLE, "action_hand": ONE}, "hand"),
        ({"opening": ONE, "action_rail": ONE, "rail_qpos": ONE, "action_hand": ONE}, "hand"),
        ({"action_gripper": Column(1, units="1"), "gripper_qpos": ONE}, "gripper"),
        ({"action_gripper": ANGLE}, None),
        ({"action_hand": ONE}, None),
        ({"opening": ONE, "action_hand": Column(16), "hand_qpos": Column(16)}, None),
    ],
)
def test_a_gripper_is_found_by_its_documented_columns(
    columns: dict[str, Column], group: str | None
):
    known = recording(**columns)
    found = openings_of(known)
    assert not found.unclear
    grippers = groups_of(known, found.columns)["a"].grippers
    assert grippers == ((group,) if group else ())


def test_columns_beside_the_command_of_a_gripper_are_openings_too():
    known = recording(action_gripper=ONE, action_gripper_relative=ONE, gripper_target=ONE)
    assert openings_of(known).columns == {
        "robots/a/action/gripper",
        "robots/a/action/gripper_relative",
        "robots/a/gripper/target",
    }


@pytest.mark.parametrize(
    "columns",
    [
        {"action_left": ONE, "action_right": ONE},
        {"action_rail": ONE, "rail_qpos": ONE},
    ],
)
def test_a_gripper_that_nothing_tells_apart_is_unclear(columns: dict[str, Column]):
    found = openings_of(recording(opening=ONE, **columns))
    commands = [f"robots/a/{n.replace('_', '/', 1)}" for n in columns if n.startswith("action")]
    assert found.unclear == {"a": tuple(commands)}
