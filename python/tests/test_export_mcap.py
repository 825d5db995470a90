"""Exports to MCAP, read with the reader of MCAP's own package, and held against the episodes."""

from __future__ import annotations

import json
import subprocess
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from numpy.typing import NDArray

import robocell
from command_line import refused, robocell_command
from exported import hashes, psnr, three_episodes
from read_back import EXACT
from robocell.export import _mcap_log, export_dataset

ROBOT = "robots/rc7"
Topics = dict[str, list[tuple[int, Any]]]  # time and content of each message


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return three_episodes(tmp_path_factory)


@pytest.fixture(scope="module")
def exported(dataset: robocell.Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("mcap") / "out"
    result = export_dataset(dataset, out, "mcap", episodes=["0"])
    assert (result.episodes, result.encoded) == (1, {})
    return out


@pytest.fixture(scope="module")
def topics(dataset: robocell.Dataset, exported: Path) -> Topics:
    return read(exported / f"{dataset[0].id}.mcap")


def read(file: Path) -> Topics:
    """All messages, in the order of the file."""
    found: Topics = defaultdict(list)
    last = 0
    with file.open("rb") as stream:
        decoders = DecoderFactory()
        for schema, channel, message in make_reader(stream, validate_crcs=True).iter_messages():
            assert schema is not None
            assert message.log_time >= last, "messages are in the order of their times"
            last = message.log_time
            decode: Any = json.loads
            if channel.message_encoding == "protobuf":
                assert schema.name.startswith("foxglove.")
                decode = decoders.decoder_for(channel.message_encoding, schema)
            else:
                assert (channel.message_encoding, schema.encoding) == ("json", "jsonschema")
                fields = json.loads(schema.data)["properties"]
                assert set(json.loads(message.data)) == set(fields), channel.topic
            assert message.sequence == len(found[channel.topic])
            found[channel.topic].append((message.log_time, decode(message.data)))
    return found


def times(episode: robocell.data.Episode, column: str = "time") -> list[int]:
    return [round(each * 1e9) for each in episode[column]]


def test_every_column_with_few_numbers_is_a_topic(dataset: robocell.Dataset, topics: Topics):
    episode = dataset[0]
    matrices = {"cameras/wrist/extrinsics", "cameras/exo/extrinsics"}
    own = {name for name in episode.columns if episode.column(name).table}
    assert {name for name in own - matrices if not name.endswith("time")} <= {
        topic[1:] for topic in topics
    }
    for name in (f"{ROBOT}/arm/qpos", f"{ROBOT}/action/tcp_displacement", "reward", "success"):
        column = episode.column(name)
        messages = topics[f"/{name}"]
        assert [time for time, _ in messages] == times(episode)
        fields = list(column.names) or ["value"]
        values = np.array([[content[field] for field in fields] for _, content in messages])
        assert np.array_equal(values.reshape(episode[name].shape), episode[name]), name
    controls = topics["/control/ctrl"]
    assert [time for time, _ in controls] == times(episode, "control/time")
    phases = [content["name"] for _, content in topics["/phase"]]
    names = episode.column("phase").values
    assert phases == [names[index] for index in episode["phase"]]


def test_joint_states_have_all_joints(dataset: robocell.Dataset, topics: Topics):
    episode = dataset[0]
    messages = topics["/joint_states"]
    assert [time for time, _ in messages] == times(episode)
    arm, fingers = (episode.column(f"{ROBOT}/{group}/qpos") for group in ("arm", "gripper"))
    expected = [f"rc7/{name}" for name in (*arm.names, *fingers.names)]
    for row, (time, content) in enumerate(messages):
        assert content.timestamp.ToNanoseconds() == time
        assert [joint.name for joint in content.joints] == expected
        positions = [joint.position for joint in content.joints]
        assert positions == [*arm[row], *fingers[row]]
        assert content.joints[0].velocity == episode[f"{ROBOT}/arm/qvel"][row, 0]


def pose_of(content: Any, rotation: str, position: str) -> NDArray[np.float64]:
    at, turn = getattr(content, position), getattr(content, rotation)
    return np.array([at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w])


def test_frames_are_those_of_the_columns(dataset: robocell.Dataset, topics: Topics):
    episode = dataset[0]
    for row, (_, content) in enumerate(topics["/tf"]):
        frames = {each.child_frame_id: each for each in content.transforms}
        assert {each.parent_frame_id for each in content.transforms} == {"world"}
        assert set(frames) == {
            "base of rc7",
            "TCP of rc7",
            "objects/target",
            "cameras/wrist",
            "cameras/exo",
        }
        for frame, column in (("TCP of rc7", f"{ROBOT}/tcp_pose"), ("objects/target",) * 2):
            name = column if column != frame else "objects/target/pose"
            own = pose_of(frames[frame], "rotation", "translation")
            assert np.array_equal(own, episode[name][row])
        camera = pose_of(frames["cameras/wrist"], "rotation", "translation")
        into = robocell.Pose(translation=camera[:3], quaternion=camera[3:]).inverse().matrix
        assert np.allclose(into, episode["cameras/wrist/extrinsics"][row], atol=1e-9)


def test_poses_are_in_frames_that_the_transforms_have(dataset: robocell.Dataset, topics: Topics):
    known = {"world"} | {each.child_frame_id for each in topics["/tf"][0][1].transforms}
    names = [topic for topic in topics if topic.startswith("/poses/")]
    assert f"/poses/{ROBOT}/action/tcp_pose" in names
    for topic in names:
        assert {content.frame_id for _, content in topics[topic]} <= known
        column = dataset[0][topic.removeprefix("/poses/")]
        found = [pose_of(each.pose, "orientation", "position") for _, each in topics[topic]]
        assert np.array_equal(found, column[np.isfinite(column).all(axis=1)])


def nal_kinds(data: bytes) -> list[int]:
    """The kinds of the NAL units of a frame; all have start codes of four bytes."""
    assert data.startswith(b"\0\0\0\1")
    return [unit[0] & 31 for unit in data.split(b"\0\0\0\1")[1:]]


def test_frames_of_videos_decode_to_those_of_the_episode(
    dataset: robocell.Dataset, topics: Topics, tmp_path: Path
):
    episode = dataset[0]
    for camera in ("wrist", "exo"):
        messages = topics[f"/cameras/{camera}/video"]
        assert [time for time, _ in messages] == times(episode)
        assert {content.format for _, content in messages} == {"h264"}
        assert {content.frame_id for _, content in messages} == {f"cameras/{camera}"}
        for row, (_, content) in enumerate(messages):
            kinds = nal_kinds(content.data)
            assert sum(kind in (1, 5) for kind in kinds) == 1, f"one picture in frame {row}"
            assert (7 in kinds and 8 in kinds) == (5 in kinds), "a key frame has the setup"
        raw = tmp_path / f"{camera}.h264"
        raw.write_bytes(b"".join(content.data for _, content in messages))
        command = ["ffmpeg", "-v", "error", "-f", "h264", "-i", str(raw), *EXACT]
        command += ["-fps_mode", "passthrough", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
        said = subprocess.run(command, capture_output=True, check=True)
        assert not said.stderr
        frames = np.frombuffer(said.stdout, np.uint8).reshape(-1, 48, 64, 3)
        assert psnr(frames, episode.frames(camera)) > 60


def test_calibrations_are_those_of_the_episode(dataset: robocell.Dataset, topics: Topics):
    [(time, content)] = topics["/cameras/wrist/calibration"]
    assert time == 0
    assert (content.width, content.height) == (64, 48)
    assert np.array_equal(np.reshape(content.K, (3, 3)), dataset[0]["cameras/wrist/intrinsics"])
    assert np.array_equal(np.reshape(content.P, (3, 4))[:, :3], np.reshape(content.K, (3, 3)))


def test_events_tell_instruction_phases_and_end(dataset: robocell.Dataset, topics: Topics):
    episode = dataset[0]
    events = [(content.name, content.message) for _, content in topics["/events"]]
    assert events[0] == ("instruction", episode.metadata["instruction"])
    assert events[-1][0] == "end"
    names = episode.column("phase").values
    phases = episode["phase"]
    starts = [0, *(np.flatnonzero(np.diff(phases)) + 1)]
    assert events[1:-1] == [("phase", f"phase: {names[phases[row]]}") for row in starts]
    assert topics["/events"][2][0] == times(episode)[starts[1]]


def test_metadata_names_the_episode(dataset: robocell.Dataset, exported: Path):
    episode = dataset[0]
    with (exported / f"{dataset.ids[0]}.mcap").open("rb") as file:
        [record] = make_reader(file).iter_metadata()
    assert record.name == "robocell"
    assert record.metadata["id"] == dataset.ids[0]
    assert record.metadata["task"] == episode.metadata["instruction"]
    assert json.loads(record.metadata["success"]) is episode.success


def test_the_command_writes_the_same_bytes_again(
    dataset: robocell.Dataset, exported: Path, tmp_path: Path
):
    out = tmp_path / "out"
    result = robocell_command("export", dataset.folder, out, "--format", "mcap", "--episodes", "0")
    assert result.returncode == 0, result.stderr
    assert result.stdout.startswith("MCAP: 1 episode, ")
    name = f"{dataset[0].id}.mcap"
    assert hashes(out)[name] == hashes(exported)[name]


def test_an_interrupted_export_continues(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    out = tmp_path / "out"
    write = _mcap_log._write_episode

    def full(*arguments: Any) -> Any:
        if arguments[1].id == dataset.ids[1]:
            raise OSError(28, "No space left on device")
        return write(*arguments)

    monkeypatch.setattr(_mcap_log, "_write_episode", full)
    with pytest.raises(robocell.IoError, match="No space left on device"):
        export_dataset(dataset, out, "mcap", episodes=["0", "1"], cameras=[])
    assert not out.exists()
    monkeypatch.undo()
    assert export_dataset(dataset, out, "mcap", episodes=["0", "1"], cameras=[]).resumed == 1
    assert sorted(each.name for each in out.glob("*.mcap")) == [
        f"{name}.mcap" for name in dataset.ids[:2]
    ]


def test_features_of_a_mapping_are_topics_beside(dataset: robocell.Dataset, tmp_path: Path):
    mapping = tmp_path / "mapping.yaml"
    mapping.write_text('features: {state: ["robots/{robot}/{arm}/qpos"]}\n')
    out = tmp_path / "out"
    export_dataset(dataset, out, "mcap", episodes=["0"], cameras=[], mapping=mapping)
    found = read(out / f"{dataset[0].id}.mcap")
    assert found["/state"][3][1]["joint1"] == pytest.approx(dataset[0][f"{ROBOT}/arm/qpos"][3, 0])
    assert "/cameras/wrist/video" not in found
    mapping.write_text('features: {reward: ["robots/{robot}/{arm}/qpos"]}\n')
    said = refused(
        "export", dataset.folder, tmp_path / "b", "--format", "mcap", "--mapping", mapping
    )
    assert "has a column 'reward', whose topic is written anyway" in said


def test_larger_images_are_encoded_again_without_calibration(
    dataset: robocell.Dataset, tmp_path: Path
):
    mapping = tmp_path / "mapping.yaml"
    mapping.write_text("image_size: [128, 128]\n")
    out = tmp_path / "out"
    result = export_dataset(dataset, out, "mcap", episodes=["0"], cameras=["exo"], mapping=mapping)
    assert result.encoded == {"cameras/exo": "images of 64x48 are brought to 128x128"}
    found = read(out / f"{dataset[0].id}.mcap")
    assert len(found["/cameras/exo/video"]) == len(dataset[0])
    assert "/cameras/exo/calibration" not in found
