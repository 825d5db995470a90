"""Standard output and standard error of a command, when those who read them go away.

    forgive_readers()  # from here on `robocell report DATASET | head -1` is no failure

What nobody can read is dropped: neither the command's work nor its exit code depends on it. What
cannot be written for another reason, as to a file on a full disk, is an OSError as ever.
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
    """From now on everything that is written to the file goes nowhere, what is buffered too."""
    with contextlib.suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, file.fileno())
        os.close(nowhere)


def reader_is_gone(error: OSError, file: TextIO) -> bool:
    """Whether a write failed because nobody is there any more: of a pipe, socket or terminal."""
    if error.errno not in GONE:
        return False
    try:
        return not stat.S_ISREG(os.fstat(file.fileno()).st_mode)
    except (OSError, ValueError):
        return False


class Forgiving:
    """A stream whose `write` and `flush` drop what nobody can read; all else is the stream's.

    Args:
        file: The stream.
        forgives: Whether an error may be passed over, `reader_is_gone` or more.

    Attributes:
        itself: The stream.
    """

    def __init__(self, file: TextIO, forgives: Callable[[OSError, TextIO], bool]) -> None:
        self.itself = file
        self._forgives = forgives

    def write(self, text: str) -> int:
        """As the stream's."""
        try:
            return self.itself.write(text)
        except OSError as error:
            self._leave_or_raise(error)
            return len(text)

    def flush(self) -> None:
        """As the stream's."""
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

    Standard error may fail in any way: there is nobody to tell it to.
    """
    sys.stdout = _forgiving(sys.stdout, reader_is_gone)
    sys.stderr = _forgiving(sys.stderr, lambda error, file: True)


def unforgiving(file: TextIO) -> TextIO:
    """The stream itself, which raises what a `Forgiving` one passes over."""
    return file.itself if isinstance(file, Forgiving) else file


def _forgiving(file: Any, forgives: Callable[[OSError, TextIO], bool]) -> Any:
    """None stays: Python has no stream where the descriptor was closed."""
    return file if file is None or isinstance(file, Forgiving) else Forgiving(file, forgives)
