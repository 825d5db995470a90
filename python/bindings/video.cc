// Videos of a scene.
#include <filesystem>
#include <memory>
#include <string>

#include "cameras.h"
#include "handles.h"
#include "robocell/base/error.h"
#include "robocell/render/video_recorder.h"
#include "robocell/scene/scene.h"

namespace robocell::python {

namespace nb = nanobind;
using namespace nb::literals;

namespace {

// A recorder that follows its scene: whatever it is asked for, it is asked of the present model.
class SceneRecorder {
 public:
  SceneRecorder(const Scene& scene, const std::filesystem::path& path, VideoSize size, int fps)
      : scene_(scene),
        recorder_(scene.model(), path,
                  {.width = size.width, .height = size.height, .fps_num = fps}),
        generation_(scene.generation()) {}

  const Scene& scene() const { return scene_; }
  // The recorder as it is: what was recorded can be ended and counted after the scene was closed.
  VideoRecorder& recorder() { return recorder_; }
  const VideoRecorder& recorder() const { return recorder_; }
  VideoRecorder& Follow() {
    if (scene_.generation() != generation_) recorder_.SetModel(scene_.model());
    generation_ = scene_.generation();
    return recorder_;
  }
  // For a change of the camera: the one in use may be gone from the present model.
  VideoRecorder& FollowToChange() {
    const nb::gil_scoped_release release;
    try {
      return Follow();
    } catch (const NotFoundError&) {
      return recorder_;  // which has the present model
    }
  }
  void Use(nb::handle camera) {
    FollowToChange();
    if (nb::isinstance<nb::str>(camera)) {
      recorder_.UseCamera(nb::cast<std::string>(camera));
    } else {
      recorder_.UseCamera(
          ViewOf(scene_.model(), camera, "video '" + recorder_.path().string() + "'"));
    }
  }

 private:
  Scene scene_;
  VideoRecorder recorder_;
  uint64_t generation_;
};

}  // namespace

void BindVideo(nb::module_& m) {
  nb::enum_<VideoResolution>(m, "VideoResolution", "Common sizes.")
      .value("R360p", VideoResolution::kR360p)
      .value("R480p", VideoResolution::kR480p)
      .value("R720p", VideoResolution::kR720p)
      .value("R1080p", VideoResolution::kR1080p)
      .value("R2K", VideoResolution::kR2K)
      .value("R4K", VideoResolution::kR4K);
  nb::class_<SceneRecorder> recorder(
      m, "VideoRecorder",
      "Records a scene as an mp4 of exact length, without a display: one frame for each "
      "record_frame(). The camera is free\n"
      "until another one is chosen, and shows the whole model until it is set. Cameras, and the "
      "bodies that they track, are\n"
      "found again by name when objects were added or removed.");
  GuardHandle<SceneRecorder>(
      recorder, [](const SceneRecorder& r, SceneClaims& claims) { claims.Add(r.scene()); },
      [](const SceneRecorder& r) { RequireOpen(r.scene(), "video recorder"); },
      {.always = {"__enter__"}, .closed = {"finish", "frames", "__exit__"}});
  recorder
      .def(
          "__init__",
          [](SceneRecorder* self, const Scene& scene, const std::filesystem::path& path, int width,
             int height, int fps) {
            new (self) SceneRecorder(scene, path, {width, height}, fps);
          },
          "scene"_a, "path"_a, "width"_a = 1280, "height"_a = 720, "fps"_a = 60,
          nb::call_guard<nb::gil_scoped_release>(), "Even sizes, in pixels.")
      .def_static(
          "open_preset",
          [](const Scene& scene, const std::filesystem::path& path, VideoResolution resolution,
             int fps) {
            return std::make_unique<SceneRecorder>(scene, path, SizeOf(resolution), fps);
          },
          "scene"_a, "path"_a, "resolution"_a = VideoResolution::kR720p, "fps"_a = 60,
          nb::call_guard<nb::gil_scoped_release>())
      .def("use_camera", &SceneRecorder::Use, "camera"_a.none(),
           nb::sig("def use_camera(self, camera: str | OrbitCamera | FreeCamera | TrackingCamera)"
                   " -> None"),
           "A camera of the scene by name ('' is the free camera, where set_free_camera left it), "
           "or any other one. NotFoundError\n"
           "with the names that there are.")
      .def(
          "set_free_camera",
          [](SceneRecorder& r, double distance, double azimuth, double elevation,
             nb::handle lookat) {
            const Eigen::Vector3d point = ToPoint(lookat);
            r.FollowToChange().SetFreeCamera(distance, azimuth, elevation, point);
          },
          "distance"_a, "azimuth"_a, "elevation"_a, "lookat"_a,
          "The free camera, from now on: looks at a point in the world; metres and degrees, as in "
          "MuJoCo's viewer.")
      .def(
          "set_tracking_camera",
          [](SceneRecorder& r, const std::string& body, double distance, double azimuth,
             double elevation) {
            r.FollowToChange().SetTrackingCamera(body, distance, azimuth, elevation);
          },
          "body"_a, "distance"_a = 2.0, "azimuth"_a = 90.0, "elevation"_a = -45.0,
          "Follows a body and what hangs from it (the centre of their mass), from the same "
          "direction.")
      .def(
          "record_frame", [](SceneRecorder& r) { r.Follow().RecordFrame(r.scene().data()); },
          nb::call_guard<nb::gil_scoped_release>(), "The scene as it is now becomes one frame.")
      .def(
          "finish", [](SceneRecorder& r) { r.recorder().Finish(); },
          nb::call_guard<nb::gil_scoped_release>(), "Ends the file; without it there is none.")
      .def_prop_ro("frames", [](const SceneRecorder& r) { return r.recorder().frames(); })
      .def(
          "__enter__", [](nb::object self) { return self; },
          nb::sig("def __enter__(self) -> VideoRecorder"))
      .def(
          "__exit__",
          [](SceneRecorder& r, nb::handle type, nb::handle, nb::handle) {
            if (!type.is_none()) return;
            nb::gil_scoped_release release;
            r.recorder().Finish();
          },
          "type"_a = nb::none(), "value"_a = nb::none(), "traceback"_a = nb::none());
}

}  // namespace robocell::python
