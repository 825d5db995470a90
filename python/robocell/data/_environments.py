"""The environment of a recorded episode."""

from __future__ import annotations

from robocell import _core
from robocell._core import Env, Episode


def env_of_episode(episode: Episode, images: bool = False) -> Env:
    """Returns the environment that recorded an episode, in the scene that the dataset keeps.

    It opens no window and does not run in real time; without `images` it has no streams. Import the
    modules that register its task and features first: a dataset imports none.

    Raises:
        ArgumentError: The episode is of a run or of a saved scene.
        NotFoundError: Its task or a feature is not registered; import its module first.
        SpecError: Their code differs from the recorded one.
    """
    return _core.env_of_episode(episode, images)
