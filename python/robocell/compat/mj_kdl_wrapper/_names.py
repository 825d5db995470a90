"""Values and functions that have other names here."""

from __future__ import annotations

import robocell
from robocell._arguments import with_hints


class Condim:
    """Kinds of friction at contacts."""

    Tangential = robocell.scene.Condim.TANGENTIAL
    Torsional = robocell.scene.Condim.TORSIONAL
    Rolling = robocell.scene.Condim.ROLLING


@with_hints
def scene_object_site_name(scene_object: robocell.SceneObject, site: str) -> str:
    """Returns the scene's name for a site of an object's model."""
    if not isinstance(scene_object, robocell.SceneObject):
        raise TypeError(
            f"scene_object_site_name: expected a SceneObject, got {scene_object!r}; for a name "
            f"there is robocell.scene.scene_object_element_name"
        )
    for what, name in (("the object has no name", scene_object.name), ("site is empty", site)):
        if not name:
            raise robocell.ArgumentError(
                f"scene_object_site_name: {what}, and names are made of both"
            )
    return robocell.scene.scene_object_element_name(scene_object.name, site)
