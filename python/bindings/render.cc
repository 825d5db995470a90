// Images and videos of a scene.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <memory>

#include "arrays.h"
#include "bindings.h"
#include "closed_handles.h"
#include "returned.h"
#include "robocell/media/png.h"
#include "robocell/render/gl_context.h"
#include "robocell/render/markers.h"
#include "robocell/render/renderer.h"
#include "robocell/render/video_recorder.h"
#include "robocell/scene/scene.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace robocell::python {
namespace {

// A renderer that follows its scene: the model is uploaded again when the scene was rebuilt.
struct SceneRenderer {
  Scene scene;
  std::unique_ptr<Renderer> renderer;
  uint64_t generation = 0;

  SceneRenderer(const Scene& s, const RenderQuality& quality, const std::string& gl)
      : scene(s), renderer(MakeRenderer({.gl = gl, .quality = quality})) {
    renderer->SetModel(scene.model());
    generation = scene.generation();
  }
  void Follow() {
    if (scene.generation() == generation) return;
    renderer->SetModel(scene.model());
    generation = scene.generation();
  }
};

std::vector<Marker> FrameMarkers(const std::vector<std::pair<std::string, Pose>>& frames,
                                 double length) {
  std::vector<Marker> markers;
  for (const auto& [text, pose] : frames) AddFrame(markers, pose, length, text);
  return markers;
}

CameraView ViewOf(const Scene& scene, nb::handle camera) {
  if (nb::isinstance<OrbitCamera>(camera)) return nb::cast<OrbitCamera>(camera);
  if (nb::isinstance<FreeCamera>(camera)) return nb::cast<FreeCamera>(camera);
  if (nb::isinstance<nb::str>(camera)) {
    return NamedCamera(scene.model(), nb::cast<std::string>(camera),
                       "scene '" + scene.name() + "'");
  }
  throw nb::type_error(("render: `camera` must be the name of a camera, an OrbitCamera or a "
                        "FreeCamera, got " +
                        ShortRepr(camera))
                           .c_str());
}

template <int R, int C>
nb::object MatrixArray(const Eigen::Matrix<double, R, C>& m) {
  std::vector<double> flat;
  for (int r = 0; r < R; ++r) {
    for (int c = 0; c < C; ++c) flat.push_back(m(r, c));
  }
  return NewArray<double>(flat, {R, C});
}

nb::dict Render(SceneRenderer& self, nb::handle camera, int width, int height, bool rgb, bool depth,
                bool segmentation, const std::vector<std::pair<std::string, Pose>>& frames,
                double frame_length) {
  self.Follow();
  const std::vector<Marker> markers = FrameMarkers(frames, frame_length);
  const RenderRequest request{
      .camera = ViewOf(self.scene, camera), .width = width, .height = height, .markers = markers};
  CheckImageSize(width, height);
  const size_t h = static_cast<size_t>(height), w = static_cast<size_t>(width);
  std::vector<uint8_t> colour(rgb ? 3 * w * h : 0);
  std::vector<float> metres(depth ? w * h : 0);
  std::vector<int32_t> bodies(segmentation ? w * h : 0);
  CameraModel model;
  {
    nb::gil_scoped_release release;
    model = self.renderer->Render(self.scene.data(), request,
                                  {.rgb = colour, .depth = metres, .segmentation = bodies});
  }
  nb::dict out;
  if (rgb) out["rgb"] = NewArray<uint8_t>(colour, {h, w, 3});
  if (depth) out["depth"] = NewArray<float>(metres, {h, w});
  if (segmentation) out["segmentation"] = NewArray<int32_t>(bodies, {h, w});
  out["intrinsics"] = MatrixArray<3, 3>(model.intrinsics());
  out["extrinsics"] = MatrixArray<4, 4>(model.extrinsics());
  return out;
}

// What makes an array of some type one of bytes, in Python.
const char* BytesHint(std::string_view dtype) {
  if (dtype.starts_with("float")) return "; of values 0 ... 1: (x * 255).astype(np.uint8)";
  if (dtype == "bool") return ": x.astype(np.uint8) * 255";
  return ", of values 0 ... 255: x.astype(np.uint8)";
}

RgbImage ToImage(nb::handle value) {
  using Image = nb::ndarray<const uint8_t, nb::shape<-1, -1, 3>, nb::device::cpu>;
  Image given;
  if (!nb::try_cast(value, given, /*convert=*/false)) {
    std::string text = "write_png: `rgb` must be a uint8 array of shape (height, width, 3), got ";
    if (nb::hasattr(value, "dtype") && nb::hasattr(value, "shape")) {
      const auto dtype = nb::cast<std::string>(nb::str(nb::object(value.attr("dtype"))));
      text +=
          dtype + " of shape " + nb::cast<std::string>(nb::str(nb::object(value.attr("shape"))));
      if (dtype != "uint8") text += BytesHint(dtype);
    } else {
      text += ShortRepr(value);
    }
    throw nb::type_error(text.c_str());
  }
  RgbImage image{static_cast<int>(given.shape(1)), static_cast<int>(given.shape(0)), {}};
  image.pixels.reserve(given.size());
  const auto at = given.view();
  for (size_t row = 0; row < given.shape(0); ++row) {
    for (size_t column = 0; column < given.shape(1); ++column) {
      for (size_t c = 0; c < 3; ++c) image.pixels.push_back(at(row, column, c));
    }
  }
  return image;
}

// A recorder that follows its scene and ends its file when a `with` block ends without an error.
struct SceneRecorder {
  Scene scene;
  VideoRecorder recorder;
  uint64_t generation;

  SceneRecorder(const Scene& s, const std::filesystem::path& path, int width, int height, int fps)
      : scene(s),
        recorder(s.model(), path, {.width = width, .height = height, .fps_num = fps}),
        generation(s.generation()) {}
  void RecordFrame() {
    if (scene.generation() != generation) recorder.SetModel(scene.model());
    generation = scene.generation();
    recorder.RecordFrame(scene.data());
  }
};

void BindCameras(nb::module_& m) {
  nb::class_<OrbitCamera>(
      m, "OrbitCamera",
      "Looks at a point: degrees and metres; azimuth 90 looks along +y, negative elevation down.")
      .def(
          "__init__",
          [](OrbitCamera* self, nb::handle lookat, double distance, double azimuth,
             double elevation, double fovy) {
            const std::vector<double> p = ToDoubles(lookat, "lookat");
            if (p.size() != 3)
              throw ArgumentError("lookat: expected 3 numbers, got " + std::to_string(p.size()));
            new (self) OrbitCamera{{p[0], p[1], p[2]}, distance, azimuth, elevation, fovy};
          },
          "lookat"_a = nb::make_tuple(0.0, 0.0, 0.0), "distance"_a = 2.0, "azimuth"_a = 90.0,
          "elevation"_a = -45.0, "fovy"_a = 45.0);
  nb::class_<FreeCamera>(m, "FreeCamera",
                         "A camera anywhere: pose in the world in MuJoCo's camera axes, vertical "
                         "field of view in degrees.")
      .def(
          "__init__",
          [](FreeCamera* self, const Pose& pose, double fovy) {
            new (self) FreeCamera{pose, fovy};
          },
          "camera_in_world"_a, "fovy"_a = 45.0);
}

void BindVideo(nb::module_& m) {
  nb::enum_<VideoResolution>(m, "VideoResolution", "Common sizes.")
      .value("R360p", VideoResolution::kR360p)
      .value("R480p", VideoResolution::kR480p)
      .value("R720p", VideoResolution::kR720p)
      .value("R1080p", VideoResolution::kR1080p)
      .value("R2K", VideoResolution::kR2K)
      .value("R4K", VideoResolution::kR4K);
  nb::class_<SceneRecorder> recorder(
      m, "VideoRecorder", "Records a scene as an mp4 of exact length, without a display.");
  // What was recorded can be ended and counted.
  GuardHandle<SceneRecorder>(recorder,
                             [](const SceneRecorder& r) { RequireOpen(r.scene, "video recorder"); },
                             {"finish", "frames", "__enter__", "__exit__"});
  recorder
      .def(
          "__init__",
          [](SceneRecorder* self, const Scene& scene, const std::filesystem::path& path, int width,
             int height, int fps) { new (self) SceneRecorder(scene, path, width, height, fps); },
          "scene"_a, "path"_a, "width"_a = 1280, "height"_a = 720, "fps"_a = 60,
          nb::call_guard<nb::gil_scoped_release>())
      .def_static(
          "open_preset",
          [](const Scene& scene, const std::filesystem::path& path, VideoResolution resolution,
             int fps) {
            const VideoSize size = SizeOf(resolution);
            return std::make_unique<SceneRecorder>(scene, path, size.width, size.height, fps);
          },
          "scene"_a, "path"_a, "resolution"_a = VideoResolution::kR720p, "fps"_a = 60,
          nb::call_guard<nb::gil_scoped_release>())
      .def(
          "use_camera",
          [](SceneRecorder& r, const std::string& name) { r.recorder.UseCamera(name); }, "name"_a)
      .def(
          "set_free_camera",
          [](SceneRecorder& r, double distance, double azimuth, double elevation,
             nb::handle lookat) {
            const std::vector<double> p = ToDoubles(lookat, "lookat");
            if (p.size() != 3)
              throw ArgumentError("lookat: expected 3 numbers, got " + std::to_string(p.size()));
            r.recorder.SetFreeCamera(distance, azimuth, elevation, {p[0], p[1], p[2]});
          },
          "distance"_a, "azimuth"_a, "elevation"_a, "lookat"_a)
      .def("record_frame", &SceneRecorder::RecordFrame, nb::call_guard<nb::gil_scoped_release>())
      .def(
          "finish", [](SceneRecorder& r) { r.recorder.Finish(); },
          nb::call_guard<nb::gil_scoped_release>(), "Ends the file; without it there is none.")
      .def_prop_ro("frames", [](const SceneRecorder& r) { return r.recorder.frames(); })
      .def(
          "__enter__", [](nb::object self) { return self; },
          nb::sig("def __enter__(self) -> VideoRecorder"))
      .def(
          "__exit__",
          [](SceneRecorder& r, nb::handle type, nb::handle, nb::handle) {
            if (!type.is_none()) return;
            nb::gil_scoped_release release;
            r.recorder.Finish();
          },
          "type"_a = nb::none(), "value"_a = nb::none(), "traceback"_a = nb::none());
}

}  // namespace

void BindRender(nb::module_& m) {
  BindCameras(m);
  nb::class_<SceneRenderer> renderer(
      m, "Renderer",
      "Images of a scene: colour, depth in metres, body ids; with the camera that they were drawn "
      "with.");
  GuardHandle<SceneRenderer>(renderer,
                             [](const SceneRenderer& r) { RequireOpen(r.scene, "renderer"); });
  renderer
      .def(
          "__init__",
          [](SceneRenderer* self, const Scene& scene, bool shadows, int multisamples,
             bool reflections, int shadow_size, const std::string& gl) {
            const RenderQuality quality{.shadows = shadows,
                                        .reflections = reflections,
                                        .multisamples = multisamples,
                                        .shadow_size = shadow_size};
            new (self) SceneRenderer(scene, quality, gl);
          },
          "scene"_a, "shadows"_a = false, "multisamples"_a = 0, "reflections"_a = false,
          "shadow_size"_a = RenderQuality{}.shadow_size, "gl"_a = "auto",
          nb::call_guard<nb::gil_scoped_release>(),
          "`shadow_size`: side of the shadow map in pixels; what is large or seen from near needs "
          "more.")
      .def("render", &Render, "camera"_a.none(), "width"_a = 320, "height"_a = 240, "rgb"_a = true,
           "depth"_a = false, "segmentation"_a = false,
           "frames"_a = std::vector<std::pair<std::string, Pose>>{}, "frame_length"_a = 0.1,
           "One view as {rgb (H,W,3) uint8, depth (H,W) float32 metres with 0 for no hit, "
           "segmentation (H,W) int32 body ids with\n"
           "-1 for none, intrinsics (3,3), extrinsics (4,4) world -> camera in OpenCV axes}. "
           "`camera` is a name, an OrbitCamera\n"
           "or a FreeCamera; `frames` are (text, pose in the world) drawn as axes.")
      .def_prop_ro("description", [](const SceneRenderer& r) { return r.renderer->description(); });
  m.def(
      "write_png",
      [](const std::filesystem::path& path, nb::handle rgb) {
        const RgbImage image = ToImage(rgb);
        const nb::gil_scoped_release release;
        WritePng(path, image);
      },
      "path"_a, "rgb"_a.none(),
      nb::sig("def write_png(path: str | os.PathLike, rgb: numpy.typing.NDArray[numpy.uint8]) -> "
              "None"),
      "Writes a colour image, uint8 (H, W, 3). TypeError for any other array, and what makes one "
      "of it.");
  m.def(
      "describe_gl", [] { return DescribeGl(); }, nb::call_guard<nb::gil_scoped_release>(),
      "What draws on this machine. Raises an Error that names everything that was tried when "
      "nothing "
      "does.");
  BindVideo(m);
}

}  // namespace robocell::python
