"""Videos of episodes one after the other in one file, at a new frame rate, without a new encoding.

Frame k of the result is at k / fps, exactly, in a time base of 512 ticks per frame. The encoded
frames are copied where the sources allow it; else they are encoded again.
"""

from __future__ import annotations

import functools
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from fractions import Fraction
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from robocell._core import IoError, ffmpeg_input
from robocell.export._mp4 import Mp4

TICKS = 512  # per frame
COPIED = ("h264", "hevc", "av1")
ENCODED = (
    "-c:v",
    "libx264",
    "-preset",
    "veryfast",
    "-crf",
    "18",
    "-bf",
    "0",
    "-pix_fmt",
    "yuv420p",
)
# Damaged frames, and those larger than any camera's, are errors.
STRICT = ("-xerror", "-err_detect", "explode", "-max_pixels", str(8192**2))
STRICT_AV1 = "libaom-av1"
# Key frames are those of the file's index. ffmpeg's parser calls every I frame of H.264 one, also
# those that a decoder cannot begin with.
AS_MARKED = ("-fflags", "+noparse")
# A list may name files, and the parts of files that are the videos of a packed dataset.
LISTED = ("-protocol_whitelist", "file,subfile")
LONGEST_MESSAGE = 500  # bytes of what ffmpeg says
LARGEST_SIDE = 150  # pixels of the images that statistics look at
# Robocell's own reader scales in this way, so statistics are those of its frames.
FLAGS = "flags=bicubic+accurate_rnd+full_chroma_int+bitexact"
EXACT = ("-vf", f"scale={FLAGS}")
BLOCK_BYTES = 16 << 20  # of images in memory


Size = tuple[int, int]  # width and height


def reason_to_encode(
    sources: Sequence[Mp4], keyframe_interval: int | None = None, size: Size | None = None
) -> str:
    """Returns why the frames cannot be copied into one file, or "".

    Args:
        sources: The videos.
        keyframe_interval: The most frames from one key frame to the next; None for any.
        size: The size to bring the images to; None to keep it.
    """
    first = sources[0]
    if size is not None:
        return f"images of {first.width}x{first.height} are brought to {size[0]}x{size[1]}"
    if first.codec not in COPIED:
        return f"codec {first.codec}"
    if any(each.codec != first.codec or each.setup != first.setup for each in sources):
        return "episodes were encoded with different settings"
    if any(each.has_false_keys for each in sources):
        return "frames are marked as key frames that a decoder cannot begin with"
    if any(each.is_reordered for each in sources):
        return "frames are stored in another order than shown"
    longest = max(each.longest_interval for each in sources)
    if keyframe_interval is not None and longest > keyframe_interval:
        return f"key frames are {longest} frames apart"
    return ""


def join(
    sources: Sequence[Path],
    out: Path,
    fps: int,
    encode: bool,
    keyframe_interval: int | None = None,
    size: Size | None = None,
    repeats: int = 0,
) -> Mp4:
    """Writes all frames of several videos to one file.

    Args:
        sources: MP4 files of the same size.
        out: The file to write.
        fps: Frame rate of the result, whatever those of the sources are.
        encode: Encode again, instead of copying.
        keyframe_interval: Frames from one key frame to the next, when encoding.
        size: The size to bring the images to, when encoding; None to keep it.
        repeats: How often the last frame is repeated, when encoding.

    Raises:
        IoError: ffmpeg is missing or failed.
    """
    base = fps * TICKS
    with tempfile.NamedTemporaryFile("w", suffix=".txt") as listing:
        for source in sources:
            quoted = ffmpeg_input(source.absolute()).replace("'", "'\\''")
            print(f"file '{quoted}'", file=listing)
        listing.flush()
        arguments = ["-y", *(() if encode else AS_MARKED), "-f", "concat", "-safe", "0", *LISTED]
        arguments += ["-i", f"file:{listing.name}", "-an"]
        if encode:
            longer = f"tpad=stop={repeats}:stop_mode=clone," if repeats else ""
            timed = f"{_fitted(size)}{longer}settb=1/{fps},setpts=N"
            arguments += ["-vf", timed, "-fps_mode", "passthrough", *ENCODED]
            arguments += ["-enc_time_base", f"1/{fps}", "-g", str(keyframe_interval or 30)]
            # Every source begins with a key frame, and so does its part of the result.
            arguments += ["-force_key_frames", "source", "-threads", "1", "-flags", "+bitexact"]
        else:
            arguments += ["-c", "copy"]
        # Packets are in the order of the frames: neither copied nor encoded ones are reordered.
        setts = f"setts=time_base=1/{base}:pts=N*{TICKS}:dts=N*{TICKS}:duration={TICKS}"
        arguments += ["-bsf:v", setts]
        arguments += ["-video_track_timescale", str(base), "-map_metadata", "-1"]
        arguments += ["-fflags", "+bitexact", "-movflags", "+faststart", "-f", "mp4", f"file:{out}"]
        with _ffmpeg(arguments, f"write '{out}'", subprocess.DEVNULL):
            pass
    return Mp4.read(out)


def cut(
    source: Path, facts: Mp4, first: int, frames: int, fps: Fraction, out: Path, rate: Fraction
) -> Mp4:
    """Writes some frames of a video to a file of their own.

    They are copied if the first is a key frame, else encoded again. All are decoded in any case,
    so that a copy has no damaged frame.

    Args:
        source: An MP4 file.
        facts: What is in it.
        first: Index of the first frame.
        frames: Number of frames.
        fps: Frame rate of the source.
        out: The file to write.
        rate: Frame rate of the result.

    Raises:
        IoError: ffmpeg is missing or failed, or a frame cannot be decoded.
    """
    is_copy = facts.codec == "h264" and not facts.is_reordered and first in facts.key_frames
    # A copy begins at the key frame at this time or before, an encoding at the next frame after.
    start = (first + (Fraction(1, 4) if is_copy else -Fraction(1, 4))) / fps
    arguments = ["-y", *STRICT, *(["-ss", f"{float(start):.6f}"] if first else [])]
    arguments += [*_strict_decoder(facts.codec), *(AS_MARKED if is_copy else ())]
    arguments += ["-f", "mov", "-i", ffmpeg_input(source)]
    if is_copy:
        arguments += ["-an", "-frames:v", str(frames), "-f", "null", "-"]
    arguments += ["-an", "-frames:v", str(frames)]
    if is_copy:
        arguments += ["-c", "copy"]
    else:
        arguments += ["-vf", f"settb={1 / rate},setpts=N", "-fps_mode", "passthrough", *ENCODED]
        arguments += ["-enc_time_base", f"{1 / rate}", "-g", "30", "-threads", "1"]
    task = f"cut '{source}' into '{out}'"
    with _ffmpeg([*arguments, *_written(rate, out)], task, subprocess.DEVNULL):
        pass
    return Mp4.read(out)


def _strict_decoder(codec: str) -> list[str]:
    """Returns arguments for the decoder that notices damage; AV1 has several.

    libdav1d, which ffmpeg prefers, shows half of all damaged frames as if they were in order;
    libaom notices what it cannot decode.
    """
    return ["-c:v", STRICT_AV1] if codec == "av1" and _has_decoder(STRICT_AV1) else []


@functools.cache
def _has_decoder(name: str) -> bool:
    """Returns whether ffmpeg has a decoder."""
    with _ffmpeg(["-decoders"], "list its decoders", subprocess.PIPE) as output:
        assert output is not None
        return f" {name} ".encode() in output.read()


def encode(
    frames: Iterable[bytes], source: Sequence[str], rate: Fraction, out: Path, what: str
) -> Mp4:
    """Encodes images to a file.

    Args:
        frames: Bytes of the images, one after the other.
        source: Arguments of ffmpeg that say what the bytes are.
        rate: Frame rate of the result.
        out: The file to write.
        what: Where the images come from, for messages.

    Raises:
        IoError: ffmpeg is missing or failed.
    """
    arguments = ["-y", *STRICT, *source, "-i", "pipe:0", "-an"]
    arguments += ["-vf", f"settb={1 / rate},setpts=N", "-fps_mode", "passthrough", *ENCODED]
    arguments += ["-enc_time_base", f"{1 / rate}", "-g", "30", "-threads", "1"]
    arguments += _written(rate, out)
    with _ffmpeg(arguments, f"encode {what}", subprocess.DEVNULL, frames):
        pass
    return Mp4.read(out)


def resample(source: Path, frames: Sequence[int], rate: Fraction, out: Path) -> Mp4:
    """Encodes frames of a video to a file, each as often as it is named.

    Args:
        source: The video.
        frames: Numbers of frames, in ascending order.
        rate: Frame rate of the result.
        out: The file to write.

    Raises:
        IoError: ffmpeg is missing or failed, or a frame cannot be decoded.
    """
    facts = Mp4.read(source)
    if frames and frames[-1] >= facts.frames:
        raise IoError(
            f"'{source}' has {facts.frames} frames, and frame {frames[-1]} is needed: it is "
            "damaged. `robocell verify --decode-videos DATASET` finds such videos"
        )

    def chosen() -> Iterator[bytes]:
        first = place = 0
        for block in images(source, facts):
            while place < len(frames) and frames[place] < first + len(block):
                yield block[frames[place] - first].tobytes()
                place += 1
            first += len(block)

    size = f"{facts.width}x{facts.height}"
    raw = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-video_size", size, "-framerate", str(rate))
    return encode(chosen(), raw, rate, out, f"'{source}' at {float(rate):g} frames per second")


def _written(rate: Fraction, out: Path) -> list[str]:
    """Returns arguments for a file whose frame k is at k / rate, with the same bytes every time."""
    ticks = f"{rate.denominator * TICKS}"
    setts = f"setts=time_base=1/{rate.numerator * TICKS}:pts=N*{ticks}:dts=N*{ticks}"
    return [
        *("-flags", "+bitexact", "-bsf:v", f"{setts}:duration={ticks}"),
        *("-video_track_timescale", str(rate.numerator * TICKS), "-map_metadata", "-1"),
        *("-fflags", "+bitexact", "-movflags", "+faststart", "-f", "mp4", f"file:{out}"),
    ]


def require_frames(path: Path, video: Mp4, rows: int) -> None:
    """Raises IoError unless a video that was written has a frame for each row."""
    if video.frames != rows:
        raise IoError(
            f"'{path}' has {video.frames} frames for {rows} rows: a video of an episode is damaged."
            " `robocell verify --decode-videos DATASET` finds it"
        )


def require_decodable(video: Path, facts: Mp4) -> None:
    """Raises IoError if a frame of a video is damaged."""
    arguments = [*STRICT, *_strict_decoder(facts.codec), "-i", ffmpeg_input(video)]
    arguments += ["-map", "0:v:0", "-f", "null", "-"]
    with _ffmpeg(arguments, f"decode '{video}'", subprocess.DEVNULL):
        pass


def images(video: Path, facts: Mp4, size: Size | None = None) -> Iterator[NDArray[np.uint8]]:
    """Yields all frames of a video in blocks (frames, height, width, 3).

    Args:
        video: The file.
        facts: What is in it.
        size: The size to bring the images to; None to keep it.

    Raises:
        IoError: A frame cannot be decoded.
    """
    width, height = size or (facts.width, facts.height)
    one = width * height * 3
    scaled = f"{_fitted(size)}scale={FLAGS}" if size else EXACT[1]
    arguments = ["-threads", "1", "-i", ffmpeg_input(video), "-an", "-vf", scaled]
    arguments += ["-fps_mode", "passthrough", "-f", "rawvideo", "-pix_fmt", "rgb24", "pipe:1"]
    done = 0
    with _ffmpeg(arguments, f"decode '{video}'", subprocess.PIPE) as output:
        assert output is not None
        while done < facts.frames:
            wanted = min(max(1, BLOCK_BYTES // one), facts.frames - done)
            pixels = output.read(wanted * one)
            if len(pixels) < wanted * one:
                raise IoError(f"'{video}': frame {done + len(pixels) // one} cannot be decoded")
            yield np.frombuffer(pixels, np.uint8).reshape(wanted, height, width, 3)
            done += wanted


def _fitted(size: Size | None) -> str:
    """Returns filters that bring images to a size: scaled as a whole, black at the borders."""
    if size is None:
        return ""
    box = f"w={size[0]}:h={size[1]}"
    # Padding is done in RGB: in yuv420p a border begins at even pixels only.
    return (
        f"scale={box}:force_original_aspect_ratio=decrease:{FLAGS},format=rgb24,"
        f"pad={box}:x=(ow-iw)/2:y=(oh-ih)/2:color=black,"
    )


def key_images(video: Path, facts: Mp4) -> Iterator[tuple[int, NDArray[np.uint8]]]:
    """Yields the key frames of a video: the index of the frame, and every n-th pixel of it.

    Raises:
        IoError: A key frame cannot be decoded.
    """
    step = max(1, -(-max(facts.width, facts.height) // LARGEST_SIDE))
    size = facts.width * facts.height * 3
    arguments = ["-skip_frame", "nokey", "-threads", "1", "-i", ffmpeg_input(video), "-an"]
    arguments += [
        "-fps_mode",
        "passthrough",
        *EXACT,
        "-f",
        "rawvideo",
        "-pix_fmt",
        "rgb24",
        "pipe:1",
    ]
    with _ffmpeg(arguments, f"decode '{video}'", subprocess.PIPE) as output:
        assert output is not None
        for index in facts.key_frames:
            pixels = output.read(size)
            if len(pixels) < size:
                raise IoError(f"'{video}': frame {index} cannot be decoded")
            image = np.frombuffer(pixels, np.uint8).reshape(facts.height, facts.width, 3)
            yield index, image[::step, ::step]


@contextmanager
def _ffmpeg(
    arguments: Sequence[str], task: str, output: int, given: Iterable[bytes] | None = None
) -> Iterator[IO[bytes] | None]:
    """Runs ffmpeg while the block reads its output; its failure raises IoError with its words.

    It is given `given` before the block; its output must then go nowhere.
    """
    program = os.environ.get("ROBOCELL_FFMPEG") or shutil.which("ffmpeg")
    if program is None:
        raise IoError(
            f"cannot {task}: there is no ffmpeg on PATH. Install it (apt-get install ffmpeg), or "
            "name one in ROBOCELL_FFMPEG"
        )
    command = [program, "-hide_banner", "-nostdin", "-loglevel", "error", *arguments]
    with tempfile.TemporaryFile() as words:
        try:
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL if given is None else subprocess.PIPE,
                stdout=output,
                stderr=words,
            )
        except OSError as error:
            raise IoError(f"cannot {task}: cannot run '{program}': {error.strerror}") from error
        try:
            with process:
                if process.stdin is not None:
                    with suppress(BrokenPipeError):  # it ended early, and says why
                        for each in given or ():
                            process.stdin.write(each)
                        process.stdin.close()
                yield process.stdout
        except BaseException:
            process.kill()
            process.wait()
            raise
        if process.returncode != 0:
            words.seek(0)
            message = words.read(LONGEST_MESSAGE).decode(errors="replace").strip()
            message = message or f"code {process.returncode}"
            raise IoError(f"cannot {task}: ffmpeg: {message}")
