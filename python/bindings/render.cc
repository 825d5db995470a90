// Images of a scene.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <optional>

#include "arrays.h"
#include "bindings.h"
#include "cameras.h"
#include "handles.h"
#include "returned.h"
#include "scene_cycles.h"
#include "robocell/media/png.h"
#include "robocell/render/gl_context.h"
#include "robocell/render/graphics_advice.h"
#include "robocell/render/markers.h"
#include "robocell/render/scene_renderer.h"
#include "robocell/spec/render_quality.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

std::vector<Marker> FrameMarkers(const std::vector<std::pair<std::string, Pose>>& frames,
                                 double length) {
  std::vector<Marker> markers;
  for (const auto& [text, pose] : frames) AddFrame(markers, pose, length, text);
  return markers;
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
  const std::vector<Marker> markers = FrameMarkers(frames, frame_length);
  const RenderRequest request{
      .camera = ViewOf(self.scene().model(), camera, "scene '" + self.scene().name() + "'"),
      .width = width,
      .height = height,
      .markers = markers};
  RequireImageSize(width, height);
  const size_t h = static_cast<size_t>(height), w = static_cast<size_t>(width);
  const size_t shape[] = {h, w, 3};
  const auto image = [&]<class T>(bool wanted, size_t dimensions, std::span<T>& numbers) {
    if (!wanted) return nb::object();
    Unwritten made = NewUnwritten(nb::dtype<T>(), std::span(shape, dimensions));
    numbers = {static_cast<T*>(made.numbers), dimensions == 3 ? 3 * h * w : h * w};
    return std::move(made.array);
  };
  RenderOutputs outputs;
  const nb::object colour = image(rgb, 3, outputs.rgb), metres = image(depth, 2, outputs.depth),
                   bodies = image(segmentation, 2, outputs.segmentation);
  CameraModel model;
  {
    nb::gil_scoped_release release;
    model = self.Render(request, outputs);
  }
  nb::dict out;
  if (rgb) out["rgb"] = colour;
  if (depth) out["depth"] = metres;
  if (segmentation) out["segmentation"] = bodies;
  out["intrinsics"] = MatrixArray<3, 3>(model.intrinsics());
  out["extrinsics"] = MatrixArray<4, 4>(model.extrinsics());
  return out;
}

// Returns the Python code that converts an array of some type to bytes.
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

}  // namespace

void BindRender(nb::module_& m) {
  BindCameras(m);
  nb::class_<SceneRenderer> renderer(
      m, "Renderer",
      "Renders images of a scene: colour, depth in metres, body "
      "ids, with the camera of each image."
      "\n\nExamples:\n"
      "    >>> renderer = rc.render.Renderer(scene, backend=\"soft\")\n"
      "    >>> images = renderer.render(\"wrist_camera\", 160, 120, depth=True)\n"
      "    >>> images[\"rgb\"].shape, images[\"depth\"].dtype\n"
      "    ((120, 160, 3), dtype('float32'))",
      nb::type_slots(kHandleSlots<SceneRenderer>));
  GuardHandle<SceneRenderer>(
      renderer, [](const SceneRenderer& r, SceneClaims& claims) { claims.Add(r.scene()); },
      [](const SceneRenderer& r) { RequireOpen(r.scene(), "renderer"); });
  renderer
      .def(
          "__init__",
          [](SceneRenderer* self, const Scene& scene, bool shadows, int multisamples,
             bool reflections, int shadow_size, const std::string& gl, const std::string& backend,
             const std::optional<std::string>& quality, int threads) {
            RenderQuality chosen{.shadows = shadows,
                                 .reflections = reflections,
                                 .multisamples = multisamples,
                                 .shadow_size = shadow_size};
            if (quality) {
              if (shadows || reflections || multisamples != 0 ||
                  shadow_size != RenderQuality{}.shadow_size) {
                throw ArgumentError(
                    "Renderer(): give `quality` or single effects (`shadows`, `multisamples`, "
                    "`reflections`, `shadow_size`), not both");
              }
              chosen = NamedQuality(*quality);
            }
            new (self) SceneRenderer(
                scene, {.backend = backend, .gl = gl, .quality = chosen, .threads = threads});
          },
          "scene"_a, "shadows"_a = false, "multisamples"_a = 0, "reflections"_a = false,
          "shadow_size"_a = RenderQuality{}.shadow_size, "gl"_a = "auto", "backend"_a = "auto",
          "quality"_a = nb::none(), "threads"_a = 1, nb::call_guard<nb::gil_scoped_release>(),
          "`shadow_size`: side of the shadow map in pixels; large or close objects need more.\n"
          "`backend`: 'gl' (OpenGL), 'soft' (the processor alone), or 'auto': what the variable "
          "ROBOCELL_RENDERER names, else\n"
          "OpenGL where there is one. `quality`: 'fast', 'standard' or 'high' in the place of "
          "single effects. `threads`: how many threads\n"
          "draw one image with 'soft' (0: one for each core); for large images. The images are the "
          "same.")
      .def("render", &Render, "camera"_a.none(), "width"_a = 320, "height"_a = 240, "rgb"_a = true,
           "depth"_a = false, "segmentation"_a = false,
           "frames"_a = std::vector<std::pair<std::string, Pose>>{}, "frame_length"_a = 0.1,
           "Renders one view. Returns {rgb (H,W,3) uint8, depth (H,W) float32 metres with 0 for no "
           "hit, segmentation (H,W) int32 body ids with\n"
           "-1 for none, intrinsics (3,3), extrinsics (4,4) world -> camera in OpenCV axes}. "
           "`camera` is a name (''\n"
           "is a view of the whole model), an OrbitCamera, a FreeCamera or a TrackingCamera; "
           "`frames` are (text, pose in the world)\n"
           "drawn as axes.")
      .def_prop_ro("description", &SceneRenderer::description,
                   "The back end and its device, in words.");
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
      "Writes a colour image, uint8 (H, W, 3). Raises TypeError, with the conversion, for any "
      "other array.\n\nExamples:\n"
      "    >>> view = rc.render.OrbitCamera(distance=1.5)\n"
      "    >>> rc.render.write_png(\"view.png\", rc.render.Renderer(scene).render(view, 160, "
      "120)[\"rgb\"])");
  m.def(
      "describe_gl", [] { return DescribeGl(); }, nb::call_guard<nb::gil_scoped_release>(),
      "Returns the renderer of this machine: back end, device and version. Raises Error with all "
      "attempts if there is none.");
  m.def(
      "graphics_advice",
      [](const std::string& description, const std::string& root) {
        return GraphicsAdvice(description, ReadGraphicsFacts(root));
      },
      "description"_a, "root"_a = "/",
      "Returns advice if this machine has a graphics card but `description` (of describe_gl) names "
      "a software renderer; '' otherwise. `root` is the root folder of the machine's files.");
  BindVideo(m);
}

}  // namespace robocell::python
