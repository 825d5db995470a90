"""Ends a process in time, although a thread or an exit handler of a user's code goes on.

    code = main()
    end_in_time(code)
    sys.exit(code)

Python waits for threads that are no daemons, and for `atexit` handlers, without end.
"""

from __future__ import annotations

import contextlib
import os
import sys
import threading
import time
import traceback

# A worker's supervisor kills it after 10 s.
LONGEST_S = 5.0


def end_in_time(code: int, longest_s: float = LONGEST_S, *, quiet: bool = False) -> None:
    """Lets this process end with `code` in `longest_s` seconds at the latest.

    To be called when all work is done and written. Unless `quiet`, a warning on standard error
    names what had not ended.
    """
    arguments = (code, longest_s, quiet)
    threading.Thread(target=_end_late, args=arguments, name="end", daemon=True).start()


def code_of_exit(code: object) -> int:
    """Returns the exit code of a SystemExit, as Python does."""
    return code if isinstance(code, int) else int(code is not None)


def _end_late(code: int, longest_s: float, quiet: bool) -> None:
    time.sleep(longest_s)
    with contextlib.suppress(Exception):
        sys.stdout.flush()
    with contextlib.suppress(Exception):  # nobody may read any more
        if not quiet:
            sys.stderr.write(
                f"warning: {_what_goes_on()} {longest_s:g} s after all work was done; the process "
                "ends without it\n"
            )
        sys.stderr.flush()
    os._exit(code)


def _what_goes_on() -> str:
    """Returns "thread 'uploader' still ran (uploads.py:12, in send)"."""
    main = threading.main_thread()
    waited_for = [
        thread
        for thread in threading.enumerate()
        if not thread.daemon and thread is not main and thread is not threading.current_thread()
    ]
    if waited_for:
        names = " and ".join(f"'{thread.name}'" for thread in waited_for)
        place = _place_of(waited_for[0])
        plural = "s" if len(waited_for) > 1 else ""
        return f"thread{plural} {names} (not a daemon) still ran{place}"
    return f"an exit handler still ran{_place_of(main)}"


def _place_of(thread: threading.Thread) -> str:
    """Returns the place in a user's code where a thread is, "" elsewhere."""
    from pathlib import Path  # rarely needed, and the process may be short

    from robocell._own_code import is_own

    frame = sys._current_frames().get(thread.ident or 0)
    if frame is None:
        return ""
    own = [call for call in traceback.extract_stack(frame) if is_own(Path(call.filename))]
    if not own:
        return ""
    last = own[-1]
    return f" ({last.filename}:{last.lineno}, in {last.name})"
