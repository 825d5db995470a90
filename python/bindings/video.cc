// Videos of a scene.
#include <filesystem>
#include <memory>
#include <string>

#include "cameras.h"
#include "handles.h"
#include "scene_cycles.h"
#include "robocell/media/ffmpeg.h"
#include "robocell/render/scene_recorder.h"

namespace robocell::python {

namespace nb = nanobind;
using namespace nb::literals;

namespace {

void UseCamera(SceneRecorder& self, nb::handle camera) {
  if (nb::isinstance<nb::str>(camera)) {
    const auto name = nb::cast<std::string>(camera);
    const nb::gil_scoped_release release;
    self.UseCamera(name);
    return;
  }
  const CameraView view =
      ViewOf(self.scene().model(), camera, "video '" + self.path().string() + "'");
  const nb::gil_scoped_release release;
  self.UseCamera(view);
}

}  // namespace

void BindVideo(nb::module_& m) {
  m.def("ffmpeg_answer", &FfmpegAnswer, nb::call_guard<nb::gil_scoped_release>(),
        "Returns the version that ffmpeg reported, as ROBOCELL_FFMPEG_ANSWER for the processes "
        "that this one starts; '' if ffmpeg has not been asked.");
  nb::enum_<VideoResolution>(m, "VideoResolution", "Common sizes of videos.")
      .value("R360p", VideoResolution::kR360p, "640 x 360 px.")
      .value("R480p", VideoResolution::kR480p, "854 x 480 px.")
      .value("R720p", VideoResolution::kR720p, "1280 x 720 px.")
      .value("R1080p", VideoResolution::kR1080p, "1920 x 1080 px.")
      .value("R2K", VideoResolution::kR2K, "2560 x 1440 px.")
      .value("R4K", VideoResolution::kR4K, "3840 x 2160 px.");
  nb::class_<SceneRecorder> recorder(
      m, "VideoRecorder",
      "Records a scene as an mp4 of exact length, without a display: one frame for each "
      "record_frame(). The camera is free until another one is chosen, and shows the whole model "
      "until it is set. Cameras, and the bodies that they track, are found again by name after "
      "objects were added or removed."
      "\n\nExamples:\n"
      "    >>> with rc.render.VideoRecorder(scene, \"arm.mp4\", 320, 240, fps=25) as video:\n"
      "    ...     for _ in range(10):\n"
      "    ...         result = scene.step_n(20)\n"
      "    ...         video.record_frame()\n"
      "    >>> video.frames\n"
      "    10",
      nb::type_slots(kHandleSlots<SceneRecorder>));
  GuardHandle<SceneRecorder>(
      recorder, [](const SceneRecorder& r, SceneClaims& claims) { claims.Add(r.scene()); },
      [](const SceneRecorder& r) { RequireOpen(r.scene(), "video recorder"); },
      {.always = {"__enter__"}, .closed = {"finish", "frames", "__exit__"}});
  recorder
      .def(
          "__init__",
          [](SceneRecorder* self, const Scene& scene, const std::filesystem::path& path, int width,
             int height, int fps) {
            new (self)
                SceneRecorder(scene, path, {.width = width, .height = height, .fps_num = fps});
          },
          "scene"_a, "path"_a, "width"_a = 1280, "height"_a = 720, "fps"_a = 60,
          nb::call_guard<nb::gil_scoped_release>(),
          "width and height: even sizes in pixels. fps: frames per second.")
      .def_static(
          "open_preset",
          [](const Scene& scene, const std::filesystem::path& path, VideoResolution resolution,
             int fps) {
            const VideoSize size = SizeOf(resolution);
            return std::make_unique<SceneRecorder>(
                scene, path,
                VideoRecorderOptions{.width = size.width, .height = size.height, .fps_num = fps});
          },
          "scene"_a, "path"_a, "resolution"_a = VideoResolution::kR720p, "fps"_a = 60,
          nb::call_guard<nb::gil_scoped_release>(),
          "Makes a recorder of a usual size: R720p is 1280 x 720 pixels. fps: frames per second.")
      .def("camera_names", &SceneRecorder::camera_names,
           "Names that use_camera accepts: 'Current', 'Free', 'Tracking', then the cameras of "
           "robots and objects, then those of SceneSpec.cameras.")
      .def("use_camera", &UseCamera, "camera"_a.none(),
           nb::sig("def use_camera(self, camera: str | OrbitCamera | FreeCamera | TrackingCamera)"
                   " -> None"),
           "Selects a camera by one of camera_names(), or any other camera. 'Free' and '' are the "
           "free camera where set_free_camera left it, 'Tracking' is the camera of "
           "set_tracking_camera (ArgumentError before that), 'Current' changes nothing. Raises "
           "NotFoundError with the available names.")
      .def(
          "set_free_camera",
          [](SceneRecorder& r, double distance, double azimuth, double elevation,
             nb::handle lookat) {
            const Eigen::Vector3d point = ToPoint(lookat);
            const nb::gil_scoped_release release;
            r.SetFreeCamera(distance, azimuth, elevation, point);
          },
          "distance"_a, "azimuth"_a, "elevation"_a, "lookat"_a,
          "Uses the free camera from now on. It looks at the point `lookat` in the world; metres "
          "and degrees, as in MuJoCo's viewer.")
      .def("set_tracking_camera", &SceneRecorder::SetTrackingCamera, "body"_a, "distance"_a = 2.0,
           "azimuth"_a = 90.0, "elevation"_a = -45.0, nb::call_guard<nb::gil_scoped_release>(),
           "Follows the centre of mass of a body and everything attached to it, from a constant "
           "direction.")
      .def("record_frame", &SceneRecorder::RecordFrame, nb::call_guard<nb::gil_scoped_release>(),
           "Records the present state of the scene as one frame.")
      .def("finish", &SceneRecorder::Finish, nb::call_guard<nb::gil_scoped_release>(),
           "Completes the file. Without this call there is no file.")
      .def_prop_ro("frames", &SceneRecorder::frames, "Number of frames recorded.")
      .def(
          "__enter__", [](nb::object self) { return self; },
          nb::sig("def __enter__(self) -> VideoRecorder"))
      .def(
          "__exit__",
          [](SceneRecorder& r, nb::handle type, nb::handle, nb::handle) {
            if (!type.is_none()) return;
            const nb::gil_scoped_release release;
            r.Finish();
          },
          "type"_a = nb::none(), "value"_a = nb::none(), "traceback"_a = nb::none());
}

}  // namespace robocell::python
