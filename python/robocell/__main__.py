"""`python -m robocell`, and the command `robocell`."""

from __future__ import annotations

from robocell import _startup


def run() -> None:
    """Loads the command line and runs it; see `_startup` for Ctrl-C meanwhile."""
    _startup.be_quiet()
    from robocell.cli import main

    _startup.hear_again()
    main()


if __name__ == "__main__":
    run()
