"""`python -m robocell`, and the command `robocell`."""

from __future__ import annotations

import signal


def run() -> None:
    """Loads the command line and runs it.

    Ctrl-C while it is being loaded ends the process at once and without a traceback: nothing has
    been begun.
    """
    heard = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if heard:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from robocell.cli import main

    if heard:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    main()


if __name__ == "__main__":
    run()
