"""Log levels as an enumeration."""

from __future__ import annotations

import enum

import robocell
from robocell._arguments import with_hints


class LogLevel(enum.Enum):
    """A level shows itself and everything more severe."""

    INFO = "info"
    WARN = "warn"
    ERROR = "error"
    NONE = "none"


@with_hints
def set_log_level(level: LogLevel) -> None:
    """Sets the log level of the process."""
    if not isinstance(level, LogLevel):
        levels = ", ".join(str(each) for each in LogLevel)
        raise TypeError(f"set_log_level: expected one of {levels}; got {level!r}")
    robocell.log.set_log_level(level.value)


def get_log_level() -> LogLevel:
    """Returns the present level, or the nearest of these to one that only robocell has."""
    level = robocell.log.log_level()
    return LogLevel(level) if level in {each.value for each in LogLevel} else LogLevel.INFO
