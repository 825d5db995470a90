"""What an MP4 file says about its video: codec, size, number of frames, key frames; its packets.

Facts take the index of the file, a few kilobytes, and the first bytes of H.264 key frames; no
decoder. Files may have sound and other tracks: the facts are those of the first video.
"""

from __future__ import annotations

import functools
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from robocell._core import IoError
from robocell._stored_files import open_stored, version_of

VIDEO = b"vide"  # handler of a track
# Boxes that contain boxes, on the way to the sample table.
PARENTS = (b"moov", b"trak", b"mdia", b"minf", b"stbl")
START = b"\0\0\0\1"  # of a NAL unit in Annex B
SAMPLE_ENTRY_BYTES = 78  # of a video, before its own boxes
IDR, SEI = 5, 6  # kinds of NAL units
RECOVERY_POINT = 6  # kind of a message in an SEI unit
CODECS = {b"avc1": "h264", b"hvc1": "hevc", b"hev1": "hevc", b"av01": "av1"}


@dataclass(frozen=True)
class Mp4:
    """The video of a file.

    Attributes:
        codec: "h264", "hevc", "av1", or the four letters of another one.
        width: In pixels.
        height: In pixels.
        frames: Number of frames.
        key_frames: Indices of the frames that a decoder can begin with.
        has_false_keys: Whether the index calls more frames key frames. Tools that copy H.264 mark
            every I frame in this way.
        tracks: Number of videos in the file; the facts are those of the first.
        is_reordered: Whether frames are stored in another order than shown.
        setup: What a decoder must be given before the first frame. Videos with the same setup can
            follow each other in one file.
    """

    codec: str
    width: int
    height: int
    frames: int
    key_frames: tuple[int, ...]
    has_false_keys: bool
    tracks: int
    is_reordered: bool
    setup: bytes

    @classmethod
    def read(cls, path: Path) -> Mp4:
        """Reads the index of a file.

        Raises:
            IoError: It cannot be read, or is no MP4 file with one video.
        """
        try:
            return _read(path, version_of(path))
        except IoError:
            raise
        except OSError as error:
            raise IoError(f"cannot read '{path}': {error.strerror}") from error

    @classmethod
    def _of(cls, tracks: list[dict[bytes, bytes]], file: IO[bytes]) -> Mp4:
        boxes = tracks[0]
        (frames,) = struct.unpack_from(">I", boxes[b"stsz"], 8)
        entry = boxes[b"stsd"][8:]
        codec = entry[4:8]
        width, height = struct.unpack_from(">HH", entry, 32)
        marked = tuple(range(frames))
        if b"stss" in boxes:
            (count,) = struct.unpack_from(">I", boxes[b"stss"], 4)
            marked = tuple(each - 1 for each in struct.unpack_from(f">{count}I", boxes[b"stss"], 8))
        keys = _decodable(marked, boxes, file) if codec == b"avc1" else marked
        return cls(
            CODECS.get(codec, codec.decode("ascii", "replace")),
            width,
            height,
            frames,
            keys or marked[:1],
            keys != marked,
            len(tracks),
            b"ctts" in boxes,
            _setup(entry[8 + SAMPLE_ENTRY_BYTES :]),
        )

    @property
    def longest_interval(self) -> int:
        """The most frames that a decoder has to decode for one."""
        ends = (*self.key_frames[1:], self.frames)
        return max((end - key for key, end in zip(self.key_frames, ends, strict=True)), default=0)


@functools.lru_cache(maxsize=16)
def _read(path: Path, version: tuple[int, ...]) -> Mp4:
    """Returns the facts of a file; those of a file that did not change are read once."""
    with open_stored(path) as file:
        try:
            return Mp4._of(_video_tracks(_index(file)), file)
        except (KeyError, IndexError, StopIteration, OverflowError, struct.error) as error:
            raise IoError(
                f"'{path}' is no MP4 file with a video, or its index is damaged"
            ) from error


def packets(path: Path) -> Iterator[bytes]:
    """Yields the frames of an H.264 file as they are stored, each complete for a decoder's stream.

    NAL units begin with a start code (Annex B), and those of key frames with the decoder's setup.

    Raises:
        IoError: The file cannot be read, or is damaged.
    """
    video = Mp4.read(path)
    with open_stored(path) as file:
        try:
            boxes = _video_tracks(_index(file))[0]
            setup, length_bytes = _annex_b_setup(_boxes_of_entry(boxes))
            places = list(_places(boxes))
        except (KeyError, IndexError, struct.error) as error:
            raise IoError(
                f"'{path}' is no H.264 file with one video: its index is damaged"
            ) from error
        keys = frozenset(video.key_frames)
        for frame, (offset, size) in enumerate(places):
            file.seek(offset)
            stored = file.read(size)
            if len(stored) < size:
                raise IoError(f"'{path}': frame {frame} is missing: the file is cut off")
            units = b"".join(START + unit for unit in _units(stored, length_bytes))
            yield (setup if frame in keys else b"") + units


def _video_tracks(index: bytes) -> list[dict[bytes, bytes]]:
    """Returns the boxes of each video in the content of the box moov."""
    tracks = [dict(_boxes(track)) for kind, track in _boxes(index, ()) if kind == b"trak"]
    return [track for track in tracks if track.get(b"hdlr", b"")[8:12] == VIDEO]


def _decodable(
    marked: tuple[int, ...], boxes: dict[bytes, bytes], file: IO[bytes]
) -> tuple[int, ...]:
    """Returns the H.264 frames that a decoder can begin with, of those that are marked so."""
    length_bytes = (_boxes_of_entry(boxes)[4] & 3) + 1
    places, wanted = _places(boxes), set(marked)
    return tuple(
        frame
        for frame, (offset, size) in enumerate(places)
        if frame in wanted and _is_entry(file, offset, offset + size, length_bytes)
    )


def _is_entry(file: IO[bytes], at: int, end: int, length_bytes: int) -> bool:
    """Returns True for a frame with an IDR picture or a recovery point."""
    while at + length_bytes < end:
        file.seek(at)
        head = file.read(length_bytes + 1)
        if len(head) <= length_bytes:
            return False
        size, kind = int.from_bytes(head[:length_bytes], "big"), head[-1] & 31
        if kind == IDR:
            return True
        if kind == SEI and RECOVERY_POINT in _messages(file.read(min(size, end - at) - 1)):
            return True
        if size == 0 or 0 < kind < IDR:  # damage, or another picture
            return False
        at += length_bytes + size
    return False


def _messages(sei: bytes) -> Iterator[int]:
    """Yields the kinds of the messages in an SEI unit."""
    at = 0
    while at + 2 < len(sei):  # the last byte ends the unit
        numbers = []
        for _ in range(2):  # kind and size, each with a byte 255 for every 255
            number = 0
            while at < len(sei) and sei[at] == 255:
                number, at = number + 255, at + 1
            if at == len(sei):
                return
            numbers.append(number + sei[at])
            at += 1
        yield numbers[0]
        at += numbers[1]


def _boxes_of_entry(boxes: dict[bytes, bytes]) -> bytes:
    """Returns the box avcC."""
    entry = boxes[b"stsd"][16 + SAMPLE_ENTRY_BYTES :]
    return next(box for kind, box in _boxes(entry) if kind == b"avcC")


def _annex_b_setup(avcc: bytes) -> tuple[bytes, int]:
    """Returns the parameter sets with start codes, and the bytes of a unit's length."""
    sets, at = [], 5
    for mask in (31, 255):  # sequence parameter sets, then picture parameter sets
        count = avcc[at] & mask
        at += 1
        for _ in range(count):
            (size,) = struct.unpack_from(">H", avcc, at)
            sets.append(START + avcc[at + 2 : at + 2 + size])
            at += 2 + size
    return b"".join(sets), (avcc[4] & 3) + 1


def _units(stored: bytes, length_bytes: int) -> Iterator[bytes]:
    at = 0
    while at + length_bytes <= len(stored):
        size = int.from_bytes(stored[at : at + length_bytes], "big")
        at += length_bytes
        yield stored[at : at + size]
        at += size


def _places(boxes: dict[bytes, bytes]) -> Iterator[tuple[int, int]]:
    """Yields the offset and size of each frame."""
    (same, frames) = struct.unpack_from(">II", boxes[b"stsz"], 4)
    sizes = [same] * frames if same else list(struct.unpack_from(f">{frames}I", boxes[b"stsz"], 12))
    wide = b"co64" in boxes
    table = boxes[b"co64" if wide else b"stco"]
    (chunks,) = struct.unpack_from(">I", table, 4)
    offsets = struct.unpack_from(f">{chunks}{'Q' if wide else 'I'}", table, 8)
    (runs,) = struct.unpack_from(">I", boxes[b"stsc"], 4)
    first = [struct.unpack_from(">III", boxes[b"stsc"], 8 + 12 * run) for run in range(runs)]
    run = frame = 0
    for chunk, offset in enumerate(offsets, 1):
        if run + 1 < runs and first[run + 1][0] <= chunk:
            run += 1
        at = offset
        for _ in range(first[run][1]):
            yield at, sizes[frame]
            at += sizes[frame]
            frame += 1


def _index(file: IO[bytes]) -> bytes:
    """Returns the content of the box moov."""
    read, seek = file.read, file.seek
    while len(header := read(8)) == 8:
        size, kind = struct.unpack(">I4s", header)
        used = 8
        if size == 1:
            (size,) = struct.unpack(">Q", read(8))
            used = 16
        if kind == b"moov":
            return bytes(read(size - used))
        if size < used:
            break
        seek(size - used, 1)
    return b""


def _boxes(content: bytes, parents: tuple[bytes, ...] = PARENTS) -> Iterator[tuple[bytes, bytes]]:
    """Yields the boxes inside, also those inside `parents`."""
    at = 0
    while at + 8 <= len(content):
        size, kind = struct.unpack_from(">I4s", content, at)
        if size < 8:
            return
        inner = content[at + 8 : at + size]
        yield kind, inner
        if kind in parents:
            yield from _boxes(inner, parents)
        at += size


def _setup(content: bytes) -> bytes:
    """Returns the decoder's setup: the box avcC, hvcC or av1C."""
    return next((box for kind, box in _boxes(content) if kind in (b"avcC", b"hvcC", b"av1C")), b"")
