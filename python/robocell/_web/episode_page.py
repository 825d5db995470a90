"""An episode for a page: poses in every row, columns to plot, phases, videos.

Poses come from simulating the recorded controls again, as `robocell replay` does. An episode that
does not allow that has its videos and plots alone.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robocell import _core
from robocell._core import Episode, Error
from robocell._notebook import instruction_of
from robocell._stored_files import is_stored, read_stored
from robocell._web.packed import Packed
from robocell._web.scene_geometry import body_poses, geometry_of
from robocell._web.soft_parts import SoftParts

MOST_PLOTTED = 16  # numbers of a row of a column; columns with more are left out
MOST_COLUMNS = 200
MOST_POINTS = 5_000_000  # of all rows; an episode with more is shown without its soft parts
NUMBERS = ("f", "i", "u", "b")


class EpisodePage:
    """An episode as a page shows it.

    Args:
        episode: The episode.

    Attributes:
        title: Its id and result.
        content: The packed numbers.
        geometry: The shapes; empty if the states cannot be found.
    """

    def __init__(self, episode: Episode) -> None:
        self._episode = episode
        result = "success" if episode.success else f"failure: {episode.end_reason}"
        self.title = f"{episode.id}, {result}"
        self.geometry = b""
        packed = Packed()
        poses, points, why = self._poses(packed)
        times = times_of(episode)
        self.content = packed.block(
            {
                "id": episode.id,
                "success": episode.success,
                "reason": episode.end_reason,
                "instruction": instruction_of(episode),
                "times": packed.add(times),
                "poses": poses,
                "points": points,
                "without_poses": why,
                "phases": phases_of(episode),
                "columns": self._columns(packed, len(times)),
                "cameras": [
                    name for name in episode.cameras if is_stored(episode.folder / f"{name}.mp4")
                ],
            }
        )

    def video(self, camera: str) -> bytes | None:
        """Returns the file with the images of a camera; None if there is none."""
        if camera not in self._episode.cameras:
            return None
        file = Path(self._episode.folder) / f"{camera}.mp4"
        return read_stored(file) if is_stored(file) else None

    def _poses(self, packed: Packed) -> tuple[dict[str, Any] | None, dict[str, Any] | None, str]:
        """Returns poses of bodies and points of soft parts in every row, or why there are none."""
        import mujoco  # not needed by other pages

        from robocell.export._states import replayed

        poses: list[NDArray[np.float32]] = []
        points: list[NDArray[np.float32]] = []
        soft = SoftParts()
        try:
            for scene in replayed(self._episode):
                model, data = scene.model, scene.data
                mujoco.mj_kinematics(model, data)  # the simulation goes on unchanged
                if not poses:
                    soft = SoftParts(model)
                    if soft.count * len(self._episode) > MOST_POINTS:
                        soft = SoftParts()
                if soft.count:
                    mujoco.mj_comPos(model, data)
                    mujoco.mj_flex(model, data)
                    mujoco.mj_tendon(model, data)
                if not poses:
                    self.geometry = geometry_of(scene, soft)
                poses.append(body_poses(scene))
                points.append(soft.points(data))
        except Error as error:
            self.geometry = b""
            return None, None, str(error)
        return packed.add(np.array(poses)), packed.add(np.array(points)), ""

    def _columns(self, packed: Packed, rows: int) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = []
        for name in self._episode.columns:
            column = self._episode.column(name)
            size = int(np.prod(column.row_shape, dtype=int))
            if (
                column.table != "steps"
                or column.rows != rows
                or not 1 <= size <= MOST_PLOTTED
                or np.dtype(column.dtype).kind not in NUMBERS
                or len(found) == MOST_COLUMNS
            ):
                continue
            values = np.asarray(column[:], np.float32).reshape(rows, size)
            found.append({"name": name, "units": column.units, "names": column.names})
            found[-1]["values"] = packed.add(np.nan_to_num(values, posinf=0, neginf=0))
        return found


def times_of(episode: Episode) -> np.ndarray:
    """Returns the time of every row since the first, s; the row's number without a time."""
    if "time" not in episode:
        return np.arange(len(episode), dtype=float)
    times: np.ndarray = episode["time"] - episode["time"][:1]
    return times


def phases_of(episode: Episode) -> list[dict[str, Any]]:
    """Returns the phases one after the other with their first rows; [] if none is recorded."""
    if "phase" not in episode:
        return []
    names = episode.column("phase").values
    found: list[dict[str, Any]] = []
    for row, value in enumerate(episode["phase"]):
        name = names[int(value)] if names else str(value)
        if not found or found[-1]["name"] != name:
            found.append({"name": name, "first": row})
    return found


def row_of(episode: _core.Episode) -> dict[str, Any]:
    """Returns what the list of a dataset says about an episode."""
    metadata: Any = episode.metadata or {}
    kinds = metadata.get("object_kinds") or metadata.get("objects") or []
    return {
        "id": episode.id,
        "success": episode.success,
        "reason": episode.end_reason,
        "rows": len(episode),
        "instruction": instruction_of(episode),
        "objects": [str(each) for each in kinds] if isinstance(kinds, list) else [],
    }
