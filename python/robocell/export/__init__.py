"""Exports datasets to the formats of training stacks.

    robocell.export.export_dataset("out/pick_v1", "out/pick_v1_lerobot", format="lerobot-v3")

The result is complete or absent under its name. docs/export.md describes formats and mappings.
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from robocell import __version__
from robocell._core import ArgumentError, Dataset, IoError
from robocell.export._formats import FORMATS, Options, require_format

__all__ = ["FORMATS", "Exported", "export_dataset"]


@dataclass(frozen=True)
class Exported:
    """The result of an export.

    Attributes:
        folder: Where it is.
        episodes: Number of episodes.
        frames: Number of rows.
        cameras: Number of cameras.
        rate: Rows per second of the episodes; their mean where `is_even` is False.
        fps: The whole number of frames per second that is nearest; LeRobot datasets count it.
        encoded: Why the videos of a camera were encoded again; copied cameras are missing.
        left_out: What the episodes have and the result does not contain.
        resumed: Number of episodes that an earlier, killed export had written.
        is_even: Whether all rows are `1 / rate` apart; only formats that store times have others.
    """

    folder: Path
    episodes: int
    frames: int
    cameras: int
    rate: float
    fps: int
    encoded: dict[str, str]
    left_out: tuple[str, ...]
    resumed: int
    is_even: bool = True


def export_dataset(
    dataset: Dataset | str | os.PathLike[str],
    out: str | os.PathLike[str],
    format: str = "lerobot-v3",
    *,
    actions: str | None = None,
    preset: str | os.PathLike[str] | None = None,
    mapping: str | os.PathLike[str] | None = None,
    cameras: Sequence[str] | None = None,
    episodes: Sequence[str] | None = None,
    successes_only: bool = False,
    keyframe_interval: int | None = None,
    pack: bool = False,
    action_horizon: int | None = None,
    rate: float | str | None = None,
    depth: bool = False,
    command: str = "",
    on_episodes: Callable[[int, int], None] | None = None,
) -> Exported:
    """Exports episodes of a dataset.

    Memory does not grow with the dataset. An export that was killed continues where it was when it
    is asked for again.

    Args:
        dataset: A dataset, one of its slices, or a folder.
        out: The folder to make; it must not exist.
        format: A key of `FORMATS`.
        actions: What the actions are: "joints", "joints_relative", "tcp_pose",
            "tcp_displacement", or columns of the episodes, separated by commas. Default: that of
            the mapping, "joints".
        preset: Names, image size and numbers of another dataset, for LeRobot formats: "droid",
            "libero", "aloha", or a YAML file.
        mapping: YAML file with entries that replace those of the built-in mapping.
        cameras: The cameras; default: that of the mapping, all.
        episodes: Ids, places or ranges of places such as "0:100"; default: all.
        successes_only: Leave out the episodes that failed.
        keyframe_interval: Encode videos again whose key frames are further apart.
        pack: Write a file for each episode first, and large files of them, for "lerobot-v3": a
            killed export loses one episode, and sizes are measured. It needs twice the space.
        action_horizon: Actions of a chunk in GR00T's configuration, for `meta/relative_stats.json`
            of "lerobot-v2.1"; default: 16.
        rate: Rows per second that episodes are brought to: 15, "12.5" or "100/7". Each row has the
            state, the command and the images of the nearest recorded row before; videos are
            encoded again. Default: the rate of the episodes.
        depth: Export the depth of the cameras too, for "robomimic", "zarr", "mcap" and "rerun".
        command: What the card says about how the result was made.
        on_episodes: Is called with the number of episodes that are written, and of all.

    Returns:
        What was exported.

    Raises:
        NotFoundError: There is no such format, column, camera or episode.
        ArgumentError: There are no episodes, they differ, their rows are not evenly spaced, `out`
            exists, or the format has no such option.
        SpecError: The mapping is not one.
        IoError: Reading or writing failed.
        ModuleNotFoundError: A package that the format needs is missing.

    Examples:
        >>> rc.export.export_dataset(dataset, "out/demo_lerobot").fps
        15
    """
    form = require_format(format)
    numbers = {"keyframe_interval": keyframe_interval, "action_horizon": action_horizon}
    for option, number in numbers.items():
        if number is not None and number < 1:
            raise ArgumentError(f"{option} is {number}; at least 1")
    given_options = {"preset": preset, "pack": pack or None, "rate": rate, **numbers}
    given_options["depth"] = depth or None
    for option, value in given_options.items():
        if value is not None and option not in form.options:
            fitting = [name for name, each in FORMATS.items() if option in each.options]
            raise ArgumentError(
                f"format '{format}' takes no {option}. Formats that do: {', '.join(fitting)}"
            )
    from robocell._staging import staging
    from robocell.export._card import card, episodes_json
    from robocell.export._mapping import Mapping
    from robocell.export._resampled import rate_from
    from robocell.export._source import choose, gather

    wanted = None if rate is None else rate_from(rate)
    if wanted is not None and form.is_lerobot and wanted.denominator != 1:
        raise ArgumentError(
            f"rate is {rate}: {form.title} needs a whole number, such as {max(1, round(wanted))}"
        )
    write = form.write
    opened = dataset if isinstance(dataset, Dataset) else Dataset(os.fspath(dataset))
    # The parent is resolved, not the path itself: the result may not be a link.
    given = Path(out)
    target = given.parent.resolve() / given.name
    if target.is_relative_to(opened.folder.resolve()):
        raise ArgumentError(
            f"'{given}' is inside the dataset '{opened.folder}'. Choose a folder beside it"
        )
    table = Mapping.load(
        Path(mapping) if mapping is not None else None,
        actions,
        table=form.table,
        preset=os.fspath(preset) if preset is not None else None,
        reserved=form.reserved,
    )
    if cameras is not None:
        table = table.only_cameras(cameras)
    source = gather(
        opened,
        choose(opened, episodes, successes_only),
        table,
        stores_times=form.stores_times,
        rate=wanted,
        depth=depth,
        holds_depth="depth" in form.options,
    )
    options = Options(keyframe_interval, pack, action_horizon)
    request = {
        "robocell": __version__,
        "format": format,
        "dataset": str(opened.folder.resolve()),
        "items": [asdict(item) for item in source.items],
        "features": [asdict(feature) for feature in source.resolved.features],
        "images": source.resolved.images,
        "image_size": source.image_size,
        "options": asdict(options),
        "rate": str(wanted),
        "depth": [camera.name for camera in source.depths],
    }
    whole = len(source.items)
    words = ["robocell", "export", opened.folder, given, "--format", format]
    words += ["--preset", preset] if preset is not None else []

    try:
        with staging(target, request) as place:

            def report(done: int) -> None:
                place.has_episodes = True
                if on_episodes is not None:
                    on_episodes(done, whole)

            placed = replace(source, scratch=place.scratch("resampled"))
            written = write(placed, place, options, report)
            text = card(
                source,
                form,
                written,
                title=target.name,
                command=command or shlex.join(map(str, words)),
            )
            place.path("README.md").write_text(text)
            place.path("meta/robocell/episodes.json").write_text(episodes_json(source))
            place.commit()
    except IoError:
        raise
    except OSError as error:
        raise IoError(
            f"cannot export to '{given}': {error.strerror or error}. What is written stays in "
            f"'{target.parent / f'.{target.name}.partial'}'; the same export continues there"
        ) from error
    return Exported(
        folder=given,
        episodes=whole,
        frames=source.rows,
        cameras=len(source.cameras),
        rate=float(source.rate),
        fps=source.fps,
        encoded=written.encoded,
        left_out=source.left_out,
        resumed=written.resumed,
        is_even=source.is_even,
    )
