"""The viewer: a window that shows a scene and lets the user act on it.

    viewer = robocell.viewer.open(robot, "arm")
    while viewer.step():
        robot.update()
    viewer.close()

docs/viewer.md describes the panels, the mouse and the keys.
"""

from robocell._core import Viewer

open = Viewer.open

__all__ = ["Viewer", "open"]
