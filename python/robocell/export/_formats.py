"""The formats that a dataset can be exported to.

A format is a module with a function `write`, a table of features, and its entry here. `write` gets
a `Source`, a `Staging`, `Options` and a function that counts episodes, and returns `Written`.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from robocell._core import NotFoundError
from robocell._suggestions import did_you_mean


@dataclass(frozen=True)
class Format:
    """A format.

    Attributes:
        title: How messages and cards call it.
        module: The module of `robocell.export` that writes it.
        table: Its table of features, in the folder `tables`.
        is_lerobot: Whether it is a LeRobot dataset: videos, statistics, a whole number of frames
            per second. The others hold images as arrays.
        stores_times: Whether it stores the time of each row; the others store a rate.
        reserved: Arrays and groups of arrays that it writes itself.
        options: The options of `export_dataset` that only some formats have.
    """

    title: str
    module: str
    table: str
    is_lerobot: bool = False
    stores_times: bool = False
    reserved: tuple[str, ...] = ()
    options: tuple[str, ...] = ()

    @property
    def write(self) -> Callable[..., Written]:
        """The function that writes it; its packages are imported now."""
        written: Callable[..., Written] = importlib.import_module(
            f"robocell.export._{self.module}"
        ).write
        return written


@dataclass(frozen=True)
class Options:
    """How a format is written.

    Attributes:
        keyframe_interval: The most frames from one key frame to the next; None keeps those of the
            episodes.
        pack: Write files of single episodes first, and files of the size that readers want of them.
        action_horizon: Actions of a chunk, for the statistics of relative actions; None for that
            of GR00T's configurations.
    """

    keyframe_interval: int | None = None
    pack: bool = False
    action_horizon: int | None = None


@dataclass(frozen=True)
class Written:
    """What an export has done.

    Attributes:
        resumed: Number of episodes that an earlier, killed export had written.
        encoded: Reason for encoding again, by camera; cameras that were copied are missing.
        codecs: Codec of each camera; empty where images are arrays.
        notes: Sentences for the card, about this format.
        statistics: Of all features, where the format has them.
    """

    resumed: int
    encoded: dict[str, str]
    codecs: dict[str, str]
    notes: tuple[str, ...] = ()
    statistics: dict[str, Any] | None = None


def _lerobot(version: str, module: str, *options: str) -> Format:
    own = ("timestamp", "frame_index", "episode_index", "index", "task_index")
    return Format(
        f"LeRobot {version}",
        module,
        "lerobot.yaml",
        is_lerobot=True,
        reserved=own,
        options=("preset", "keyframe_interval", "rate", *options),
    )


FORMATS = {
    "lerobot-v3": _lerobot("v3.0", "lerobot_v3", "pack"),
    "lerobot-v2.1": _lerobot("v2.1", "lerobot_v21", "action_horizon"),
    "robomimic": Format(
        "robomimic HDF5",
        "robomimic",
        "robomimic.yaml",
        reserved=("actions_abs", "states", "next_obs"),
        options=("rate", "depth"),
    ),
    "zarr": Format(
        "Diffusion Policy zarr", "replay_buffer", "zarr.yaml", options=("rate", "depth")
    ),
    "umi": Format("UMI zarr", "umi", "umi.yaml", options=("rate",)),
    "aloha": Format("ALOHA HDF5", "aloha", "aloha.yaml", options=("rate",)),
    "molmospaces": Format(
        "MolmoSpaces HDF5",
        "molmospaces",
        "molmospaces.yaml",
        reserved=("fail", "obs_scene", "obs/sensor_data", "obs/sensor_param"),
        options=("rate",),
    ),
    "mcap": Format(
        "MCAP",
        "mcap_log",
        "mcap.yaml",
        stores_times=True,
        reserved=("joint_states", "tf", "events", "poses"),
        options=("depth",),
    ),
    "rerun": Format(
        "Rerun",
        "rerun_log",
        "rerun.yaml",
        stores_times=True,
        reserved=("world", "events"),
        options=("depth",),
    ),
}


def require_format(name: str) -> Format:
    """Returns a format; raises NotFoundError, with those that there are, for another name."""
    if name not in FORMATS:
        raise NotFoundError(
            f"no format '{name}'.{did_you_mean(name, FORMATS)} Formats: {', '.join(FORMATS)}. "
            "docs/data.md shows how to read episodes for another one"
        )
    return FORMATS[name]
