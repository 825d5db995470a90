"""Single frames of episodes: the right ones, in any order, by few decoders. ffmpeg is the judge."""

from __future__ import annotations

import gc
import multiprocessing
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import robocell
from read_back import SIZE, CountedFfmpeg, children, decoded, frames_by_ffmpeg, read_back_dataset

STREAMS = ["wrist", "wrist.depth", "wrist.segmentation", "exo"]


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return robocell.Dataset(read_back_dataset(tmp_path_factory))


@pytest.fixture(autouse=True)
def no_decoders_before() -> Iterator[None]:
    robocell.data.release_idle_files()
    yield
    robocell.data.release_idle_files()


@pytest.mark.parametrize("stream", STREAMS)
def test_frames_match_ffmpeg(dataset: robocell.Dataset, stream: str):
    for episode in dataset:
        expected = frames_by_ffmpeg(episode, stream)
        assert len(expected) == len(episode)
        np.testing.assert_array_equal(episode.frames(stream), expected)
        for i in range(len(episode)):
            image = episode.frame(stream, i)
            assert image.dtype == expected.dtype
            np.testing.assert_array_equal(image, expected[i], str(i))


def test_colours_match_other_readers(dataset: robocell.Dataset):
    """Their conversion rounds otherwise."""
    episode = dataset[0]
    theirs = decoded(episode.folder / "exo.mp4").astype(int)
    ours = np.stack([episode.frame("exo", i) for i in range(len(episode))])
    assert ours.shape == (len(episode), SIZE[1], SIZE[0], 3)
    assert np.abs(ours - theirs).mean() < 1.5
    assert np.abs(ours - theirs).max() < 30


@pytest.mark.parametrize("seed", range(6))
def test_frames_in_any_order_are_the_same(dataset: robocell.Dataset, seed: int):
    """Walks of many kinds: jumps, runs forward and back, several streams and episodes in turn."""
    rng = np.random.default_rng(seed)
    expected = {(e, s): frames_by_ffmpeg(dataset[e], s) for e in range(3) for s in STREAMS}
    episode, stream, at = 0, "wrist", 0
    for _ in range(60):
        move = rng.integers(6)
        if move == 0:
            episode, stream = int(rng.integers(3)), str(rng.choice(STREAMS))
        frames = expected[episode, stream]
        if move == 1:
            at = int(rng.integers(len(frames)))
        elif move == 2:
            at -= int(rng.integers(1, 4))
        elif move == 3:
            at += int(rng.integers(1, 30))
        else:
            at += 1
        at %= len(frames)
        shown = at - len(frames) if rng.random() < 0.2 else at
        image = dataset[episode].frame(stream, shown)
        np.testing.assert_array_equal(image, frames[at], f"{episode} {stream} {at}")


def test_a_camera_and_kind_select_the_stream(dataset: robocell.Dataset):
    episode = dataset[0]
    assert episode.streams == STREAMS
    for kind in ("depth", "segmentation"):
        image = episode.frame("wrist", 7, kind)
        np.testing.assert_array_equal(image, episode.frame(f"wrist.{kind}", 7))
        np.testing.assert_array_equal(image, episode.frames("wrist", kind)[7])
    np.testing.assert_array_equal(episode.frame("wrist", 7, "rgb"), episode.frame("wrist", 7))
    metres = episode.frame("wrist", 7, "depth") / 1000
    assert 0.05 < metres[metres > 0].min() < metres.max() <= 65.535


def test_negative_indices_count_from_the_end(dataset: robocell.Dataset):
    episode = dataset[0]
    count = len(episode)
    expected = frames_by_ffmpeg(episode, "exo")
    np.testing.assert_array_equal(episode.frame("exo", -1), expected[-1])
    np.testing.assert_array_equal(episode.frame("exo", -count), expected[0])
    np.testing.assert_array_equal(episode.frame("exo", np.int64(3)), expected[3])
    for index in (count, -count - 1, 10**12):
        text = f"{episode.id}': no frame {index} of 'exo', it has {count} frames"
        with pytest.raises(IndexError, match=text):
            episode.frame("exo", index)


def test_unknown_camera_and_stream_errors_suggest_the_nearest(dataset: robocell.Dataset):
    episode = dataset[0]
    for name, meant in (("wirst", "wrist"), ("wrist.dept", "wrist.depth")):
        with pytest.raises(robocell.NotFoundError, match=f"Did you mean '{meant}'"):
            episode.frame(name, 0)
    with pytest.raises(robocell.NotFoundError, match=r"no camera 'exoo'.*Did you mean 'exo'"):
        episode.frame("exoo", 0, "rgb")
    with pytest.raises(robocell.NotFoundError, match="Did you mean 'depth'"):
        episode.frame("wrist", 0, "dept")
    with pytest.raises(robocell.NotFoundError, match="Cameras with depth: wrist"):
        episode.frame("exo", 0, "depth")


def test_frames_in_their_order_start_ffmpeg_once(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    ffmpeg = CountedFfmpeg(tmp_path, monkeypatch)
    for i in range(len(dataset[0])):
        dataset[0].frame("wrist", i)  # another object for the episode each time
    assert ffmpeg.starts == 1
    for i in range(0, len(dataset[1]), 5):
        for stream in STREAMS:  # in turn
            dataset[1].frame(stream, i)
    assert ffmpeg.starts == 1 + len(STREAMS)


def test_a_window_that_slides_starts_ffmpeg_once(
    dataset: robocell.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    ffmpeg = CountedFfmpeg(tmp_path, monkeypatch)
    for i in range(2, len(dataset[0])):
        for k in (i - 2, i - 1, i):
            dataset[0].frame("exo", k)
    assert ffmpeg.starts == 1
    for i in range(4, len(dataset[1])):
        for k in (i - 4, i):
            dataset[1].frame("exo", k)
    assert ffmpeg.starts == 2


def test_the_number_of_decoders_is_bounded_and_close_ends_them(dataset: robocell.Dataset):
    robocell.data.release_idle_files()
    before = set(children())
    for _ in range(3):
        for episode in dataset:
            for stream in STREAMS:
                episode.frame(stream, 2)
    del episode
    gc.collect()
    # The decoders of both kinds of videos, and the process that waits to become the next one.
    assert 1 <= len(set(children()) - before) <= 17
    robocell.data.release_idle_files()
    assert set(children()) == before


def test_a_replaced_video_is_read_again(dataset: robocell.Dataset, tmp_path: Path):
    folder = tmp_path / dataset.ids[0]
    shutil.copytree(dataset[0].folder, folder)
    episode = robocell.data.Episode(folder)
    episode.frame("exo", 3)
    shutil.copy(folder / "wrist.mp4", tmp_path / "other.mp4")
    (tmp_path / "other.mp4").rename(folder / "exo.mp4")
    expected = frames_by_ffmpeg(episode, "wrist")
    np.testing.assert_array_equal(episode.frame("exo", 4), expected[4])


def test_a_cut_video_is_an_error_each_time(dataset: robocell.Dataset, tmp_path: Path):
    folder = tmp_path / dataset.ids[0]
    shutil.copytree(dataset[0].folder, folder)
    episode = robocell.data.Episode(folder)
    whole = (folder / "wrist.depth.mov").read_bytes()
    (folder / "wrist.depth.mov").write_bytes(whole[: len(whole) // 2])
    for _ in range(2):
        with pytest.raises(robocell.IoError, match=r"wrist\.depth\.mov"):
            episode.frame("wrist", 3, "depth")
    (folder / "wrist.depth.mov").write_bytes(whole)
    expected = frames_by_ffmpeg(episode, "wrist.depth")
    np.testing.assert_array_equal(episode.frame("wrist", 3, "depth"), expected[3])


def read_some(episode: robocell.data.Episode, first: int) -> list[bytes]:
    """What a process reads; the column as well."""
    frames = [episode.frame("wrist", i).tobytes() for i in range(first, first + 12)]
    return [*frames, episode["robots/rc7/arm/qpos"].tobytes()]


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_other_processes_continue_reading(dataset: robocell.Dataset, method: str):
    """While this one goes on: nobody gets the other's frames."""
    episode = dataset[0]
    expected = read_some(episode, 2)
    episode.frame("wrist", 2)  # a decoder in the middle, an open file
    with multiprocessing.get_context(method).Pool(2) as pool:
        theirs = pool.starmap_async(read_some, [(episode, 2), (dataset[0], 2), (episode, 2)])
        for _ in range(5):
            assert read_some(episode, 2) == expected
        assert theirs.get(timeout=120) == [expected] * 3


def test_rows_have_the_frame_of_their_number(dataset: robocell.Dataset):
    """A generated camera has one frame for each row."""
    episode = dataset[0]
    np.testing.assert_array_equal(episode.frames_of_rows("exo"), np.arange(len(episode)))
    of_ticks = episode.frames_of_rows("exo", "control")
    time, ticks = episode["time"], episode["control/time"]
    expected = [np.flatnonzero(time <= tick + 1e-6)[-1] for tick in ticks]
    np.testing.assert_array_equal(of_ticks, expected)
    with pytest.raises(robocell.NotFoundError, match="Did you mean 'control'"):
        episode.frames_of_rows("exo", "contrl")


def test_columns_are_accessed_as_in_a_mapping(dataset: robocell.Dataset):
    episode = dataset[0]
    assert all(name in episode for name in episode.columns)
    assert "no such column" not in episode
    assert 3 not in episode
    assert None not in episode
