"""The viewer: a window that shows a scene and lets the user act on it; pages for notebooks.

    viewer = robocell.viewer.open(robot, "arm")
    while viewer.step():
        robot.update()
    viewer.close()

docs/viewer.md describes the panels, the mouse and the keys, and pages in a browser. `show` makes a
page of a scene or an episode that stands alone.
"""

from robocell._core import Viewer
from robocell._notebook import show

open = Viewer.open

__all__ = ["Viewer", "open", "show"]
