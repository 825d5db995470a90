"""Presets: names, sizes, units and polarity of policies of other code."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

import robocell as rc
from robocell._policy_presets import Preset, shipped_presets
from robocell._policy_presets.images import resize_with_pad

CAMERAS = ["wrist", "exo"]


def features(robots: dict[str, int], gripper: bool = True) -> list[Any]:
    """Features of a cell with these robots and so many joints."""
    found = [SimpleNamespace(name="time", role="observation", shape=(), names=[])]

    def add(name: str, role: str, *shape: int, names: tuple[str, ...] = ()) -> None:
        found.append(SimpleNamespace(name=name, role=role, shape=shape, names=list(names)))

    for robot, joints in robots.items():
        add(f"robots/{robot}/arm/qpos", "observation", joints)
        add(f"robots/{robot}/tcp_pose_in_base", "observation", 7)
        for suffix in ("", "_relative"):
            add(f"robots/{robot}/action/arm{suffix}", "action", joints)
        add(f"robots/{robot}/action/tcp_pose", "action", 7)
        add(f"robots/{robot}/action/tcp_displacement", "action", 6)
        if gripper:
            add(f"robots/{robot}/opening", "observation")
            add(f"robots/{robot}/hand/qpos", "observation", 2, names=("left", "right"))
            for suffix in ("", "_relative"):
                name = f"robots/{robot}/action/hand{suffix}"
                add(name, "action", 1, names=("opening",))
    return found


def row(robots: dict[str, int], cameras: list[str] = CAMERAS) -> dict[str, Any]:
    rng = np.random.default_rng(0)
    numbers: dict[str, Any] = {}
    for robot, joints in robots.items():
        numbers[f"robots/{robot}/arm/qpos"] = rng.uniform(-1, 1, joints)
        numbers[f"robots/{robot}/opening"] = np.array(0.25)
        numbers[f"robots/{robot}/hand/qpos"] = np.array([0.01, -0.01])
        pose = rc.Pose(translation=[0.4, 0.1, 0.3], rotvec=[0.1, -0.2, 0.3])
        numbers[f"robots/{robot}/tcp_pose_in_base"] = [*pose.translation, *pose.quaternion]
    for camera in cameras:
        numbers[camera] = rng.integers(256, size=(240, 320, 3), dtype=np.uint8)
    return numbers


def test_droid_has_the_names_sizes_and_units_of_openpi():
    bound = Preset.load("droid").bind(features({"fr3": 7}), CAMERAS)
    now = row({"fr3": 7})
    message = bound.message(now, "pick up the cube")
    assert set(message) == {
        "observation/exterior_image_1_left",
        "observation/wrist_image_left",
        "observation/joint_position",
        "observation/gripper_position",
        "prompt",
    }
    assert message["prompt"] == "pick up the cube"
    for name in ("observation/exterior_image_1_left", "observation/wrist_image_left"):
        assert (message[name].shape, message[name].dtype) == ((224, 224, 3), np.uint8)
        assert not message[name][:28].any(), "a bar: 320x240 is wider than high"
        assert message[name][28:196].any()
    np.testing.assert_allclose(message["observation/joint_position"], now["robots/fr3/arm/qpos"])
    assert message["observation/joint_position"].dtype == np.float32
    assert message["observation/gripper_position"].tolist() == [0.75], "1 is closed"

    actions = np.zeros((10, 8))
    actions[:, 0], actions[:, 1] = 0.5, 3.0  # beyond the range of velocities
    actions[:5, 7] = 0.4  # rather open
    actions[5:, 7] = 0.6  # rather closed
    columns = bound.columns(actions)
    arm, hand = columns["robots/fr3/action/arm_relative"], columns["robots/fr3/action/hand"]
    np.testing.assert_allclose(arm[:, :3], [[0.1, 0.2, 0]] * 10)
    assert hand.tolist() == [[1.0]] * 5 + [[0.0]] * 5
    assert bound.preset.horizon == 8
    assert bound.columns(actions[0])["robots/fr3/action/hand"].tolist() == [1.0]


def test_libero_sees_position_rotation_vector_and_fingers():
    bound = Preset.load("libero").bind(features({"panda": 7}), CAMERAS)
    state = bound.message(row({"panda": 7}), "open")["observation/state"]
    np.testing.assert_allclose(
        state, [0.4, 0.1, 0.3, 0.1, -0.2, 0.3, 0.01, -0.01], rtol=0, atol=1e-6
    )
    columns = bound.columns(np.array([1.0, 0, -0.5, 0, 2.0, 0, 1.0]))
    np.testing.assert_allclose(
        columns["robots/panda/action/tcp_displacement"], [0.05, 0, -0.025, 0, 0.5, 0]
    )
    assert columns["robots/panda/action/hand"].tolist() == [0.0], "1 closes"


def test_aloha_has_one_arm_after_the_other_and_nested_images():
    robots = {"left": 6, "right": 6}
    cameras = ["high", "left_wrist", "right_wrist"]
    bound = Preset.load("aloha").bind(features(robots), cameras)
    now = row(robots, cameras)
    message = bound.message(now, "fold")
    arms = [now[f"robots/{robot}/arm/qpos"] for robot in robots]
    np.testing.assert_allclose(
        message["state"], np.concatenate([arms[0], [0.25], arms[1], [0.25]]), atol=1e-6
    )
    assert set(message["images"]) == {"cam_high", "cam_left_wrist", "cam_right_wrist"}
    assert bound.cameras["images>cam_high"] == "high"
    assert message["images"]["cam_high"].shape == (3, 224, 224)
    columns = bound.columns(np.arange(28.0).reshape(2, 14) / 28)
    assert list(columns) == [
        f"robots/{robot}/action/{group}" for robot in robots for group in ("arm", "hand")
    ]
    np.testing.assert_allclose(columns["robots/right/action/arm"][1], np.arange(21, 27) / 28)


@pytest.mark.parametrize("name", shipped_presets())
def test_every_shipped_preset_turns_back_what_it_sends(name: str):
    robots = {"left": 6, "right": 6} if name == "aloha" else {"a": 7}
    cameras = ["high", "left_wrist", "right_wrist"] if name == "aloha" else CAMERAS
    preset = Preset.load(name)
    bound = preset.bind(features(robots), cameras)
    now = row(robots, cameras)
    seen, prompt = bound.row(bound.message(now, "go"))
    assert prompt == "go"
    for column, values in seen.items():
        if column not in cameras:
            np.testing.assert_allclose(np.ravel(now[column]), values, atol=1e-6)
        else:
            assert values.shape == (224, 224, 3)
    columns = {each.column: np.full((3, each.size), 0.02) for each in bound.actions}
    for column in columns:
        if column.endswith("/hand"):
            columns[column][:] = 1
    again = bound.columns(bound.reply(columns))
    assert again.keys() == columns.keys()
    for column, values in columns.items():
        np.testing.assert_allclose(again[column], values, atol=1e-6)


@pytest.mark.parametrize(
    ("size", "wanted"), [((240, 320), (224, 224)), ((180, 320), (224, 224)), ((64, 48), (100, 90))]
)
def test_images_are_scaled_and_padded_as_openpi_does(size: Any, wanted: Any):
    rng = np.random.default_rng(0)
    small = rng.integers(256, size=(size[0] // 8, size[1] // 8, 3), dtype=np.uint8)
    smooth = np.asarray(Image.fromarray(small).resize(size[::-1], Image.Resampling.BICUBIC))
    for image in (smooth, rng.integers(256, size=(*size, 3), dtype=np.uint8)):
        ratio = max(size[1] / wanted[1], size[0] / wanted[0])
        inner = (int(size[1] / ratio), int(size[0] / ratio))
        scaled = Image.fromarray(image).resize(inner, resample=Image.Resampling.BILINEAR)
        expected = Image.new("RGB", wanted[::-1], 0)
        expected.paste(scaled, ((wanted[1] - inner[0]) // 2, (wanted[0] - inner[1]) // 2))
        ours = resize_with_pad(image, *wanted)
        assert ours.dtype == np.uint8
        assert np.abs(ours.astype(int) - np.asarray(expected)).max() <= 1


def test_an_image_of_the_right_size_stays():
    image = np.random.default_rng(0).integers(256, size=(224, 224, 3), dtype=np.uint8)
    np.testing.assert_array_equal(resize_with_pad(image, 224, 224), image)


# ---- files ---------------------------------------------------------------------------------------


def loaded(tmp_path: Path, text: str) -> Preset:
    (tmp_path / "mine.yaml").write_text(text)
    return Preset.load(tmp_path / "mine.yaml")


def test_a_file_replaces_fields_of_a_shipped_preset(tmp_path: Path):
    text = "extends: droid\nimages: {top: exo}\nimage_size: null\nhorizon: null\nrate: 20\n"
    preset = loaded(tmp_path, text)
    droid = Preset.load("droid")
    assert preset.actions == droid.actions
    assert list(preset.images) == ["top"]
    assert (preset.horizon, preset.rate) == (None, 20)
    assert [file.name for file in preset.files] == ["mine.yaml", "droid.yaml"]
    image = np.zeros((240, 320, 3), np.uint8)
    bound = preset.bind(features({"a": 7}), CAMERAS)
    assert bound.message(row({"a": 7}) | {"exo": image}, "")["top"] is image, "without a size"


ACTIONS = 'actions: ["robots/{robot}/action/{arm}"]\n'


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[1, 2]", "is a table with the fields extends, observation"),
        ("a: [", "is no YAML"),
        ("extends: droit\n", "extends is a preset of robocell, aloha, droid, .* got 'droit'"),
        ("extends: [droid]\n", "extends is a preset of robocell"),
        (ACTIONS + "imagse: {}\n", "no field 'imagse'. Did you mean 'images'?"),
        ("prompt: p\n", r"actions is a list of columns, got None"),
        ("actions: []\n", r"actions is a list of columns, got \[\]"),
        ("actions: [3]\n", r"actions\[0\]: expected a column, or {column: ...}, got 3"),
        ("actions: [{column: x, tims: 2}]\n", r"actions\[0\]: no field 'tims'. Did you mean 'tim"),
        ("actions: [{column: x, times: 0}]\n", r"actions\[0\].times is not 0"),
        ("actions: [{column: x, times: fast}]\n", r"actions\[0\].times is a number, got 'fast'"),
        ("actions: [{column: x, times: .nan}]\n", r"times is a number, got nan"),
        ("actions: [{column: x, clip: [1, 0]}]\n", r"clip is \[lower, upper\], got \[1, 0\]"),
        ("actions: [{column: x, clip: [no, 1]}]\n", r"clip is a number, got False"),
        (ACTIONS + "gripper: {open: 1}\n", r"gripper is {open: 1, closed: 0}, got {'open': 1}"),
        (ACTIONS + "gripper: {open: 1, closed: 1}\n", "open and closed are two numbers, got 1 for"),
        (ACTIONS + "gripper: {open: 1, closed: 0, snapp: 1}\n", "no field 'snapp'. Did you mean"),
        (ACTIONS + "gripper: {open: yes, closed: 0}\n", "gripper.open is a number, got True"),
        (ACTIONS + "observation: [x]\n", "observation is a table of names"),
        (ACTIONS + "observation: {s: [{column: x, as: rpy}]}\n", r"no form 'rpy'. There are: pos"),
        (
            ACTIONS + "image_size: 224\n",
            "image_size is width and height, whole numbers up to 8192 such as .*; got 224",
        ),
        (ACTIONS + "image_size: [0, 5]\n", "image_size is width and height"),
        (ACTIONS + "channels_first: 1\n", "channels_first is true or false, got 1"),
        (ACTIONS + "images: {top: 3}\n", "images.top is an image stream, got 3"),
        (ACTIONS + "horizon: 0\n", "horizon is a number above 0, got 0"),
        (ACTIONS + "horizon: 2.5\n", "horizon is a whole number, got 2.5"),
        (ACTIONS + "rate: true\n", "rate is a number, got True"),
        (ACTIONS + "prompt: 3\n", "prompt is a text, got 3"),
    ],
)
def test_a_wrong_file_is_named_with_its_field(tmp_path: Path, text: str, said: str):
    with pytest.raises(rc.SpecError, match=said) as caught:
        loaded(tmp_path, text)
    assert "mine.yaml" in str(caught.value)


def test_presets_that_are_not_there_are_named(tmp_path: Path):
    with pytest.raises(
        rc.NotFoundError, match=r"no preset 'driod'. Did you mean 'droid'\? Presets"
    ):
        Preset.load("driod")
    with pytest.raises(rc.IoError, match=r"cannot read preset '.*none.yaml': No such file"):
        Preset.load(tmp_path / "none.yaml")


def test_what_a_cell_lacks_is_named(tmp_path: Path):
    droid = Preset.load("droid")
    with pytest.raises(rc.NotFoundError, match=r"images.observation/exterior_image_1_left: the"):
        droid.bind(features({"a": 7}), ["wrist"])
    with pytest.raises(rc.NotFoundError, match="without --no-cameras they are drawn"):
        droid.bind(features({"a": 7}), [])
    with pytest.raises(rc.NotFoundError, match=r"has no column 'robots/a/opening'"):
        droid.bind(features({"a": 7}, gripper=False), CAMERAS)
    with pytest.raises(rc.NotFoundError, match="actions: the cell has no robot"):
        loaded(tmp_path, ACTIONS).bind([], [])
    half = '{column: "robots/{robot}/action/tcp_pose", as: position}'
    whole = "robots/{robot}/action/tcp_pose"
    for listed in (half, f'{half}, "{whole}"', f"{half}, {half}", f'"{whole}", "{whole}"'):
        with pytest.raises(rc.SpecError, match=r"'robots/a/action/tcp_pose' stands there once, or"):
            loaded(tmp_path, f"actions: [{listed}]\n").bind(features({"a": 7}), [])
    text = ACTIONS + 'observation: {s: [{column: "robots/{robot}/{arm}/qpos", as: position}]}\n'
    with pytest.raises(
        rc.SpecError, match="has 5 numbers, and `as` is for poses and displacements"
    ):
        loaded(tmp_path, text).bind(features({"a": 5}), [])


def test_a_pose_may_be_a_position_and_a_rotation_vector(tmp_path: Path):
    column = "robots/{robot}/action/tcp_pose"
    text = (
        f'actions: [{{column: "{column}", as: rotation_vector}}, '
        f'{{column: "{column}", as: position}}]\n'
    )
    bound = loaded(tmp_path, text).bind(features({"a": 7}), [])
    chunk = np.random.default_rng(0).uniform(-1, 1, (4, 6))
    poses = bound.columns(chunk)["robots/a/action/tcp_pose"]
    for pose, row in zip(poses, chunk, strict=True):
        np.testing.assert_allclose(pose[:3], row[3:])
        np.testing.assert_allclose(rc.Pose(quaternion=pose[3:]).rotvec, row[:3], atol=1e-12)
    np.testing.assert_allclose(bound.reply({"robots/a/action/tcp_pose": poses}), chunk, atol=1e-6)
    assert bound.columns(chunk[0])["robots/a/action/tcp_pose"].shape == (7,)


def test_actions_and_observations_of_another_width_are_rejected():
    bound = Preset.load("droid").bind(features({"a": 7}), CAMERAS)
    for shape in ((7,), (10, 7), (2, 2, 8)):
        with pytest.raises(
            rc.ArgumentError, match=r"an action has 8 numbers: .*arm_relative \(7\)"
        ):
            bound.columns(np.zeros(shape))
    good = bound.message(row({"a": 7}), "go")
    for name, value, said in (
        ("observation/joint_position", np.zeros(6), "has 7 numbers, got 6"),
        ("observation/joint_position", np.full(7, np.nan), "got some that are not finite"),
        (
            "observation/wrist_image_left",
            np.zeros((9, 9, 3)),
            r"of uint8, got \(9, 9, 3\) of float",
        ),
        ("observation/wrist_image_left", np.zeros((9, 9), np.uint8), r"got \(9, 9\)"),
    ):
        with pytest.raises(rc.ArgumentError, match=said):
            bound.row(good | {name: value})
    del good["observation/joint_position"]
    with pytest.raises(rc.ArgumentError, match=r"has no 'observation/joint_position'. .*It has:"):
        bound.row(good)
    with pytest.raises(rc.ArgumentError, match=r"its actions are .*; the policy returned robots/a"):
        bound.reply({"robots/a/action/arm": np.zeros((1, 7))})
    columns = {each.column: np.zeros((2, each.size)) for each in bound.actions}
    with pytest.raises(
        rc.ArgumentError, match=r"hand' has 1 number; the policy returned .*\(2, 3\)"
    ):
        bound.reply(columns | {"robots/a/action/hand": np.zeros((2, 3))})
    for odd in ("fast", [[1], [2, 3]]):
        with pytest.raises(rc.ArgumentError, match="'observation/joint_position' is no array of"):
            bound.row({"observation/joint_position": odd})
