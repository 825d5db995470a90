"""What an MP4 file says about its video: codec, size, number of frames, key frames; its packets.

Facts take the index of the file alone, a few kilobytes, without a decoder. Files with several
tracks are refused: neither episodes nor exports have them.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from robocell._core import IoError

# Boxes that contain boxes, on the way to the sample table.
PARENTS = (b"moov", b"trak", b"mdia", b"minf", b"stbl")
START = b"\0\0\0\1"  # of a NAL unit in Annex B
SAMPLE_ENTRY_BYTES = 78  # of a video, before its own boxes
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
        is_reordered: Whether frames are stored in another order than shown.
        setup: What a decoder must be given before the first frame. Videos with the same setup can
            follow each other in one file.
    """

    codec: str
    width: int
    height: int
    frames: int
    key_frames: tuple[int, ...]
    is_reordered: bool
    setup: bytes

    @classmethod
    def read(cls, path: Path) -> Mp4:
        """Reads the index of a file.

        Raises:
            IoError: It cannot be read, or is no MP4 file with one video.
        """
        try:
            with path.open("rb") as file:
                index = _index(file)
        except OSError as error:
            raise IoError(f"cannot read '{path}': {error.strerror}") from error
        try:
            return cls._of(dict(_boxes(index)))
        except (KeyError, IndexError, struct.error) as error:
            raise IoError(
                f"'{path}' is no MP4 file with one video: its index is damaged"
            ) from error

    @classmethod
    def _of(cls, boxes: dict[bytes, bytes]) -> Mp4:
        (frames,) = struct.unpack_from(">I", boxes[b"stsz"], 8)
        entry = boxes[b"stsd"][8:]
        codec = entry[4:8]
        width, height = struct.unpack_from(">HH", entry, 32)
        keys = tuple(range(frames))
        if b"stss" in boxes:
            (count,) = struct.unpack_from(">I", boxes[b"stss"], 4)
            keys = tuple(each - 1 for each in struct.unpack_from(f">{count}I", boxes[b"stss"], 8))
        return cls(
            CODECS.get(codec, codec.decode("ascii", "replace")),
            width,
            height,
            frames,
            keys,
            b"ctts" in boxes,
            _setup(entry[8 + SAMPLE_ENTRY_BYTES :]),
        )

    @property
    def longest_interval(self) -> int:
        """The most frames that a decoder has to decode for one."""
        ends = (*self.key_frames[1:], self.frames)
        return max((end - key for key, end in zip(self.key_frames, ends, strict=True)), default=0)


def packets(path: Path) -> Iterator[bytes]:
    """Yields the frames of an H.264 file as they are stored, each complete for a decoder's stream.

    NAL units begin with a start code (Annex B), and those of key frames with the decoder's setup.

    Raises:
        IoError: The file cannot be read, or is damaged.
    """
    video = Mp4.read(path)
    with path.open("rb") as file:
        boxes = dict(_boxes(_index(file)))
        try:
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


def _index(file: object) -> bytes:
    """Returns the content of the box moov."""
    read, seek = file.read, file.seek  # type: ignore[attr-defined]
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


def _boxes(content: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Yields the boxes inside, also those inside `PARENTS`."""
    at = 0
    while at + 8 <= len(content):
        size, kind = struct.unpack_from(">I4s", content, at)
        if size < 8:
            return
        inner = content[at + 8 : at + size]
        yield kind, inner
        if kind in PARENTS:
            yield from _boxes(inner)
        at += size


def _setup(content: bytes) -> bytes:
    """Returns the decoder's setup: the box avcC, hvcC or av1C."""
    return next((box for kind, box in _boxes(content) if kind in (b"avcC", b"hvcC", b"av1C")), b"")
