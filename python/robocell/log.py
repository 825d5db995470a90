"""Log level and destination of robocell's messages.

    robocell.log.set_log_level("warn")
    robocell.log.set_log_sink(lambda level, text: print(level, text))

docs/conventions.md describes it.
"""

from robocell._core import (
    log_level,
    set_log_level,
    set_log_sink,
)

__all__ = [
    "log_level",
    "set_log_level",
    "set_log_sink",
]
