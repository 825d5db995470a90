"""Every format holds one mixed dataset: two robots, three tasks, two cameras with depth.

`make soak` lets the readers of other projects read the same dataset (test_real_readers.py).
"""

from __future__ import annotations

from pathlib import Path

import pytest

import robocell
from exported import INSTALLED
from mixed import CAMERAS, ROBOTS, mixed_dataset, of_robot
from robocell.export import FORMATS, export_dataset
from robocell.importer import import_dataset

pytestmark = pytest.mark.proof


@pytest.fixture(scope="module")
def mixed(tmp_path_factory: pytest.TempPathFactory) -> robocell.Dataset:
    return mixed_dataset(tmp_path_factory)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("format", INSTALLED)
def test_every_format_takes_the_mixed_dataset(
    mixed: robocell.Dataset, tmp_path: Path, format: str, robot: str
):
    names = of_robot(mixed, robot)
    holds_depth = "depth" in FORMATS[format].options
    result = export_dataset(mixed, tmp_path / "out", format, episodes=names, depth=holds_depth)
    assert (result.episodes, result.cameras) == (len(names), 2)
    lost = set() if holds_depth else {f"depth of {camera}" for camera in CAMERAS}
    assert set(result.left_out) == lost
    card = (tmp_path / "out" / "README.md").read_text()
    for name in names:
        assert mixed[name].metadata["instruction"] in card
    if format in ("lerobot-v3", "lerobot-v2.1", "robomimic", "aloha", "zarr"):
        given = {"rate": 10} if format in ("aloha", "zarr") else {}
        back = import_dataset(tmp_path / "out", tmp_path / "back", **given)
        assert (back.episodes, back.rows) == (len(names), result.frames)
        assert robocell.data.verify(tmp_path / "back", decode_videos=True).ok


@pytest.mark.parametrize("format", [name for name in INSTALLED if not FORMATS[name].stores_times])
def test_robots_with_other_joints_are_not_in_one_dataset(
    mixed: robocell.Dataset, tmp_path: Path, format: str
):
    with pytest.raises(robocell.ArgumentError, match="cannot be in one dataset with"):
        export_dataset(mixed, tmp_path / "out", format)
    assert not list(tmp_path.iterdir())
