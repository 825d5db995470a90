"""The command of a process of our own.

    subprocess.run([*own_process("robocell.generate.work"), "--", "run.yaml"])

`python -m` would look for modules in the working folder first, so that somebody's `robocell.py` or
`json.py` there were taken for ours.
"""

from __future__ import annotations

import sys
from pathlib import Path

import robocell

# The folder that holds this package is usually known already; not when it was the working folder.
RUN = (
    "import sys; from runpy import run_module; _, folder = sys.argv.pop(0), sys.argv.pop(0); "
    "folder in sys.path or sys.path.insert(0, folder); "
    "run_module(sys.argv[0], run_name='__main__', alter_sys=True)"
)


def own_process(module: str) -> list[str]:
    """Runs a module of this package; its arguments are to follow."""
    return [sys.executable, "-P", "-c", RUN, str(Path(robocell.__file__).parents[1]), module]
