"""Standard output and standard error of a command whose readers may close them.

    forgive_readers()  # from here on `robocell report DATASET | head -1` does not fail

Output without a reader is dropped: neither the command's work nor its exit code depends on it.
Writing fails with OSError for any other reason, such as a full disk.
"""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import sys
from collections.abc import Callable
from typing import Any, TextIO

# A terminal that was closed gives EIO, one that no longer exists ENXIO.
GONE = (errno.EPIPE, errno.EIO, errno.ENXIO)


def leave(file: TextIO) -> None:
    """Discards everything written to the file from now on, including buffered data."""
    with contextlib.suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, file.fileno())
        os.close(nowhere)


def reader_is_gone(error: OSError, file: TextIO) -> bool:
    """Returns True if a write failed because a pipe, socket or terminal has no reader."""
    if error.errno not in GONE:
        return False
    try:
        return not stat.S_ISREG(os.fstat(file.fileno()).st_mode)
    except (OSError, ValueError):
        return False


class Forgiving:
    """Wraps a stream; `write` and `flush` drop output without a reader.

    Args:
        file: The stream.
        forgives: Returns True for errors to ignore: `reader_is_gone` or more.

    Attributes:
        itself: The wrapped stream.
    """

    def __init__(self, file: TextIO, forgives: Callable[[OSError, TextIO], bool]) -> None:
        self.itself = file
        self._forgives = forgives

    def write(self, text: str) -> int:
        """Writes like the stream."""
        try:
            return self.itself.write(text)
        except OSError as error:
            self._leave_or_raise(error)
            return len(text)

    def flush(self) -> None:
        """Flushes like the stream."""
        try:
            self.itself.flush()
        except OSError as error:
            self._leave_or_raise(error)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.itself, name)

    def _leave_or_raise(self, error: OSError) -> None:
        if not self._forgives(error, self.itself):
            raise error
        leave(self.itself)


def forgive_readers() -> None:
    """Lets both standard streams outlive their readers, until the process ends.

    Standard error ignores all errors, because they cannot be reported.
    """
    sys.stdout = _forgiving(sys.stdout, reader_is_gone)
    sys.stderr = _forgiving(sys.stderr, lambda error, file: True)


def unforgiving(file: TextIO) -> TextIO:
    """Returns the wrapped stream, which raises all errors."""
    return file.itself if isinstance(file, Forgiving) else file


def _forgiving(file: Any, forgives: Callable[[OSError, TextIO], bool]) -> Any:
    """Wraps a stream. None stays: Python has no stream for a closed descriptor."""
    return file if file is None or isinstance(file, Forgiving) else Forgiving(file, forgives)
