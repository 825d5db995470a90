"""Sources of a run's scenes, including your own, and annotations of the scenes.

    @register_scene_source("lab")
    class Lab(SceneSource):
        @dataclass
        class Fields:
            tables: int = 3

        def __init__(self, fields): ...
        def size(self): ...
        def make(self, index): ...

`scenes: {source: lab, tables: 2}` of a run file then works like `scenes: {source: tabletop}`.
"""

from __future__ import annotations

from robocell._core import (
    Articulation,
    ArticulationKind,
    Container,
    FilesScenes,
    FloorArea,
    HouseOptions,
    HousesScenes,
    HouseSummary,
    ObjectPlace,
    ObjectView,
    ObjectWords,
    Relation,
    Room,
    SceneAnnotations,
    SceneLight,
    SceneSource,
    SceneSourceSpec,
    SpatialRelation,
    Support,
    SupportFace,
    base_scene,
    derive_annotations,
    has_house,
    make_house,
    make_scene_source,
    object_view,
    points_in_mask,
    prepare_house_folder,
    referrals,
    scene_source_kinds,
)
from robocell.tasks import register_scene_source

__all__ = [
    "Articulation",
    "ArticulationKind",
    "Container",
    "FilesScenes",
    "FloorArea",
    "HouseOptions",
    "HouseSummary",
    "HousesScenes",
    "ObjectPlace",
    "ObjectView",
    "ObjectWords",
    "Relation",
    "Room",
    "SceneAnnotations",
    "SceneLight",
    "SceneSource",
    "SceneSourceSpec",
    "SpatialRelation",
    "Support",
    "SupportFace",
    "base_scene",
    "derive_annotations",
    "has_house",
    "make_house",
    "make_scene_source",
    "object_view",
    "points_in_mask",
    "prepare_house_folder",
    "referrals",
    "register_scene_source",
    "scene_source_kinds",
]
