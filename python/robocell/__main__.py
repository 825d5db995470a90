"""`python -m robocell`, and the command `robocell`."""

from __future__ import annotations

import sys

from robocell import _startup
from robocell._ending import code_of_exit, end_in_time

# A user's own threads and exit handlers, such as uploads, have this long after the command's work.
END_S = 10.0


def run() -> None:
    """Loads the command line and runs it; see `_startup` for Ctrl-C meanwhile."""
    _startup.be_quiet()
    from robocell._cli import load, main

    app = load(sys.argv[1:])
    _startup.hear_again()
    code = 1  # of an error that `main` does not report
    try:
        main(app)
        code = 0
    except SystemExit as end:
        code = code_of_exit(end.code)
        raise
    finally:
        end_in_time(code, END_S)


if __name__ == "__main__":
    run()
