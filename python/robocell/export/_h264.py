"""Videos of episodes as H.264, for logs: copied where they are, encoded again otherwise."""

from __future__ import annotations

from pathlib import Path

from robocell.export._mp4 import Mp4
from robocell.export._source import Camera, Item, Source
from robocell.export._videos import join, reason_to_encode, require_frames


def h264(source: Source, item: Item, camera: Camera, scratch: Path) -> tuple[Path, str]:
    """Returns a video whose frames can be copied, and why it is not that of the episode, or ""."""
    own = source.video(item, camera)
    facts = Mp4.read(own)
    size = source.resized(camera)
    reason = reason_to_encode([facts], size=size)
    if not reason and facts.codec != "h264":
        reason = f"codec {facts.codec}"
    if not reason:
        require_frames(own, facts, item.rows)
        return own, ""
    made = join([own], scratch, source.fps, True, size=size)
    require_frames(scratch, made, item.rows)
    return scratch, reason
