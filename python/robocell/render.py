"""Cameras, pictures and videos.

    renderer = robocell.render.Renderer(scene)
    view = robocell.render.OrbitCamera(lookat=(0, 0, 0.3), distance=1.5)
    image = renderer.render(view, 160, 120)["rgb"]

docs/render.md describes them.
"""

from robocell._core import (
    CameraConfig,
    CameraSpec,
    CameraSystemConfig,
    FreeCamera,
    OrbitCamera,
    Renderer,
    RendererConfig,
    RenderQuality,
    TrackingCamera,
    VideoRecorder,
    VideoResolution,
    write_png,
)

__all__ = [
    "CameraConfig",
    "CameraSpec",
    "CameraSystemConfig",
    "FreeCamera",
    "OrbitCamera",
    "RenderQuality",
    "Renderer",
    "RendererConfig",
    "TrackingCamera",
    "VideoRecorder",
    "VideoResolution",
    "write_png",
]
