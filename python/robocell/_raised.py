"""Says where a user's code raised an exception: messages name the line, not robocell's own.

except Exception as error:
    print(place_of(error))  # ValueError: no cubes (tasks.py:12, in judge)
"""

from __future__ import annotations

import inspect
import re
import sysconfig
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import TypeGuard

from robocell._core import Error, IoError
from robocell._own_code import is_own

LONGEST_MESSAGE = 300  # characters of a hook's error; the place comes after it


def is_of_users(error: BaseException) -> bool:
    """Returns True if the traceback contains a user's code."""
    return bool(_frames_of_users(error))


def is_of_own_code(error: BaseException) -> bool:
    """Returns True if the traceback contains a user's own sources, not only installed packages."""
    return bool(_own_frames(error))


def own_trace(error: BaseException) -> str:
    """Returns the traceback of an error, or of its cause, through a user's own sources alone."""
    frames = _own_frames(error)
    while not frames and error.__cause__ is not None:
        error = error.__cause__
        frames = _own_frames(error)
    return "".join(traceback.format_list(frames)).rstrip()


class LostPolicyError(IoError):
    """A policy of another process is gone: the evaluation stops, and can be continued."""


class UnmadePolicyError(Error):
    """A policy cannot be made, so that no rollout can be either."""


# The core passes these on as they are: a policy that is not there did not fail.
NO_POLICY = (LostPolicyError, UnmadePolicyError)


# At the end of a message: (tasks.py:12, in judge).
_PLACE = re.compile(r" \(([^()]+:\d+, in [^()]+)\)$")


def ends_with_place(text: str) -> bool:
    """Returns True if a message ends with a place in a user's code: '(tasks.py:12, in judge)'."""
    return _PLACE.search(text) is not None


def message_and_place(error: BaseException) -> tuple[str, str]:
    """Returns ('ValueError: text', 'tasks.py:12, in judge') for the error of a hook.

    The message is one line of at most LONGEST_MESSAGE characters, without the class for robocell's
    own errors. The place is "" if no line of a user's code raised.
    """
    text = text_with_place(error) if isinstance(error, Error) else place_of(error)
    text = " ".join(text.split())
    found = _PLACE.search(text)
    message = text[: found.start()] if found else text
    return _cut(message), found[1] if found else ""


def _cut(message: str) -> str:
    """Cuts a long message: a list of names at its end after a name, other text after a word."""
    if len(message) <= LONGEST_MESSAGE:
        return message
    head, comma, _ = message[: LONGEST_MESSAGE + 2].rpartition(", ")
    rest = message[len(head) + len(comma) :]
    if comma and ": " in head and not re.search(r"[.:?] ", rest):
        names, _, more = re.sub(r" and (\d+) more$", r"\n\1", rest).partition("\n")
        return f"{head} and {names.count(', ') + 1 + int(more or 0)} more"
    head = message[: LONGEST_MESSAGE + 1].rpartition(" ")[0]
    return f"{head if len(head) > LONGEST_MESSAGE // 2 else message[:LONGEST_MESSAGE]} ..."


# A list of names: those of a row differ from one start to the next.
_NAMES = re.compile(r" It has: [^()]*(?=$| \()")


def without_names(text: str) -> str:
    """Returns an error of a hook without the names that there are: one text for one mistake."""
    return _NAMES.sub("", text)


def text_of_hook(error: BaseException) -> str:
    """Returns 'ValueError: text (tasks.py:12, in judge)', as the error of a hook says it."""
    message, place = message_and_place(error)
    return f"{message} ({place})" if place else message


def text_of_method(error: BaseException, method: Callable[..., object]) -> str:
    """Returns the text of an error of a hook; one about its return value has the hook's place."""
    text = text_of_hook(error)
    if ends_with_place(text):
        return text
    own = inspect.unwrap(method)
    code = getattr(getattr(own, "__func__", own), "__code__", None)
    if code is None or not is_own(Path(code.co_filename)):
        return text
    return f"{text} ({code.co_filename}:{code.co_firstlineno}, in {code.co_name})"


def trace_of(error: BaseException) -> str:
    """Returns the traceback, as Python prints it."""
    return "".join(traceback.format_exception(error)).rstrip()


def text_with_place(error: BaseException) -> str:
    """Returns the error text for a user, with the place in their own code, if any."""
    if not is_of_own_code(error):
        return text_of(error)
    if not isinstance(error, Error):
        return place_of(error)
    place = where(error)
    return text_of(error) if place in text_of(error) else f"{text_of(error)}{place}"


def place_of(error: BaseException) -> str:
    """Returns 'ValueError: text (tasks.py:12, in judge)', with the place in a user's code."""
    text = error.msg if _has_file(error) else text_of(error)
    colon = ": " if text else ""
    return f"{type(error).__name__}{colon}{text}{where(error)}"


def text_of(error: BaseException) -> str:
    """Returns the error's text, even if its class fails to format it."""
    try:
        return str(error)
    except Exception:
        return "(its text cannot be made)"


def where(error: BaseException) -> str:
    """Returns ' (tasks.py:12, in judge)', the place in a user's code that raised; '' if none."""
    if _has_file(error):
        return f" ({error.filename}:{error.lineno})"
    frames = _frames_of_users(error)
    if not frames:
        return ""
    last = frames[-1]
    return f" ({last.filename}:{last.lineno}, in {last.name})"


def _has_file(error: BaseException) -> TypeGuard[SyntaxError]:
    """Returns True if the error is about a source file that could not be parsed, not a string."""
    return (
        isinstance(error, SyntaxError)
        and bool(error.filename)
        and not str(error.filename).startswith("<")
    )


def _frames_of_users(error: BaseException) -> list[traceback.FrameSummary]:
    """Returns the frames in a user's own sources; those of installed packages without any.

    A user's code is often in the middle: robocell calls it, and it calls NumPy, which raises.
    """
    own = _own_frames(error)
    return own or [f for f in _frames(error) if _is_of_installed_package(Path(f.filename))]


def _own_frames(error: BaseException) -> list[traceback.FrameSummary]:
    return [frame for frame in _frames(error) if is_own(Path(frame.filename))]


def _frames(error: BaseException) -> list[traceback.FrameSummary]:
    """Returns the frames that are in files."""
    frames = traceback.extract_tb(error.__traceback__)
    return [frame for frame in frames if not frame.filename.startswith("<")]


def _is_of_installed_package(file: Path) -> bool:
    """Returns True if a source belongs neither to robocell nor to Python's own library."""
    file = file.resolve()
    if file.is_relative_to(Path(__file__).resolve().parent):
        return False
    library = Path(sysconfig.get_path("stdlib")).resolve()
    packages = {"site-packages", "dist-packages"}
    return not file.is_relative_to(library) or bool(packages & set(file.parts))
