"""The environment of a recorded episode, and what is missing when it cannot be made."""

from __future__ import annotations

from typing import Any

from robocell import _core
from robocell._core import Env, EnvConfig, Episode, IoError, NotFoundError, SpecError


def env_of_episode(episode: Episode, images: bool = False) -> Env:
    """Returns the environment that recorded an episode, in the scene that the dataset keeps.

    It opens no window and does not run in real time; without `images` it has no streams. Modules
    that register its task and features have to be imported before: a dataset imports none.

    Raises:
        ArgumentError: The episode is of a run or of a saved scene.
        NotFoundError: Its task or a feature is not registered; import its module first.
        SpecError: Their code is not the recorded one.
    """
    try:
        return _core.env_of_episode(episode, images)
    except (IoError, NotFoundError) as error:
        said = _unregistered(episode, error)
        if not said:
            raise
        whose = f"the environment that recorded '{episode.folder}'"
        raise NotFoundError(f"{whose}: {said}") from None


def _unregistered(episode: Episode, error: Exception) -> str:
    """Returns what kind nobody registered; "" if something else is wrong."""
    from robocell.dataset_run import unregistered_kinds

    if isinstance(error, NotFoundError):
        return unregistered_kinds(error, "")
    metadata: Any = episode.metadata
    try:
        EnvConfig.from_yaml(str(metadata["environment"]["config"]), "config")
    except SpecError as problem:
        return unregistered_kinds(problem, "config")
    except (KeyError, TypeError):  # somebody edited the episode
        pass
    return ""
