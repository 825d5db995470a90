"""`python -m robocell`, and the command `robocell`."""

from __future__ import annotations

import sys

from robocell import _startup


def run() -> None:
    """Loads the command line and runs it; see `_startup` for Ctrl-C meanwhile."""
    _startup.be_quiet()
    from robocell.cli import load, main

    app = load(sys.argv[1:])
    _startup.hear_again()
    main(app)


if __name__ == "__main__":
    run()
