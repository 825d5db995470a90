// Cameras: CameraSpec places a camera, CameraConfig is a stream of its images. Placement uses
// MuJoCo's camera axes: x right, y up, looking along -z.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell {

// A camera that is added to the scene: one with a given lens, or a model that contains a camera and
// its surroundings (`mjcf_path`), whose root body then stands at the pose.
struct CameraSpec {
  std::string name = {};
  std::string mjcf_path = {};
  std::optional<Vec3> pos = {};
  std::optional<double> fovy = {};
  Vec3 euler = {};
  Vec4 quat = kIdentityQuat;
  std::optional<Vec3> look_at = {};
  AttachTarget attach_to = {};

  static constexpr const char* kTypeName = "CameraSpec";
  template <class V>
  static void Fields(V&& v) {
    v("name", &CameraSpec::name, "Name of the camera in the scene.");
    v("mjcf_path", &CameraSpec::mjcf_path,
      "Model with one camera and its housing, instead of a camera alone: path, `menagerie:...` or "
      "built-in name. Its camera gets `name`, and everything else the prefix `name_`.");
    v("pos", &CameraSpec::pos, "Position in the parent, metres; required without a model.");
    v("fovy", &CameraSpec::fovy,
      "Vertical field of view, degrees; required without a model, else that of its camera.",
      Bound::kPositive);
    v("euler", &CameraSpec::euler, "Orientation in the parent, degrees, extrinsic xyz.");
    v("quat", &CameraSpec::quat,
      "Orientation in the parent, quaternion xyzw (in YAML also quat_wxyz).");
    v("look_at", &CameraSpec::look_at,
      "Point in the parent to look at, metres, with the parent's z up; instead of a rotation.");
    v("attach_to", &CameraSpec::attach_to, "Parent of the camera.");
  }
  // Returns the pose in the parent. Requires a valid spec.
  Pose pose() const;
  std::string Label() const { return LabelOf("camera", name); }
  void Validate(Problems& problems) const;
};

// A stream of images from a camera of the scene.
struct CameraConfig {
  std::string name = {};
  std::string camera = {};
  std::string follow = {};
  std::optional<int> width = {};
  std::optional<int> height = {};
  double rate = 0;
  bool rgb = true;
  bool depth = false;
  bool segmentation = false;

  static constexpr const char* kTypeName = "CameraConfig";
  template <class V>
  static void Fields(V&& v) {
    v("name", &CameraConfig::name, "Name of the stream in observations and records.");
    v("camera", &CameraConfig::camera,
      "Name of a camera of the robot (without its prefix) or of the scene. `Free` is the viewer's "
      "first view of the whole model, unless a camera has that name.");
    v("follow", &CameraConfig::follow,
      "Body of the scene that the view follows from 2 m away and 45 degrees above; instead of "
      "`camera`.");
    v("width", &CameraConfig::width, "Pixels. Unset: the camera system's resolution.",
      Bound::kPositive);
    v("height", &CameraConfig::height, "Pixels. Unset: the camera system's resolution.",
      Bound::kPositive);
    v("rate", &CameraConfig::rate, "Frames per second; 0 takes one with every observation.",
      Bound::kNonNegative);
    v("rgb", &CameraConfig::rgb, "Take colour images.");
    v("depth", &CameraConfig::depth, "Take depth images.");
    v("segmentation", &CameraConfig::segmentation, "Take body-id images.");
  }
  std::string Label() const { return LabelOf("stream", name); }
  void Validate(Problems& problems) const;
};

// The quality of images. Every costly effect is off by default, and records store the quality that
// was used.
struct RenderQuality {
  bool shadows = false;
  bool reflections = false;
  int multisamples = 0;
  int shadow_size = 1024;

  static constexpr const char* kTypeName = "RenderQuality";
  template <class V>
  static void Fields(V&& v) {
    v("shadows", &RenderQuality::shadows, "Render shadows.");
    v("reflections", &RenderQuality::reflections, "Render reflections.");
    v("multisamples", &RenderQuality::multisamples,
      "Samples per pixel against jagged edges; 0 is off.", Bound::kNonNegative);
    v("shadow_size", &RenderQuality::shadow_size, "Side of the shadow map, pixels.",
      Bound::kPositive);
  }
};

// The back end that renders images, and its quality. In YAML a word stands for the back end, and
// one of the names of render_quality.h for a quality: {backend: soft, quality: standard}.
struct RendererConfig {
  std::string backend = "auto";
  RenderQuality quality = {};

  static constexpr const char* kTypeName = "RendererConfig";
  template <class V>
  static void Fields(V&& v) {
    v("backend", &RendererConfig::backend,
      "The back end: `soft` (the processor; the same bytes on every machine), `gl` (OpenGL) or "
      "`auto`, which takes the one in ROBOCELL_RENDERER, else gl if the machine has it. A dataset "
      "that was begun with `auto` keeps its back end.");
    v("quality", &RendererConfig::quality,
      "Quality of images: `fast`, `standard`, `high`, or single fields.");
  }
  void Validate(Problems& problems) const;
};

// The streams of a run and their common size.
struct CameraSystemConfig {
  std::array<int, 2> resolution = {320, 240};
  List<CameraConfig> streams = {};
  bool draw = true;
  RendererConfig renderer = {};

  static constexpr const char* kTypeName = "CameraSystemConfig";
  template <class V>
  static void Fields(V&& v) {
    v("resolution", &CameraSystemConfig::resolution, "Width and height in pixels.",
      Bound::kPositive);
    v("streams", &CameraSystemConfig::streams, "The image streams.");
    v("draw", &CameraSystemConfig::draw,
      "Render the streams. Without, there are no images, but `start.visible_from` still knows the "
      "streams: episodes begin alike.");
    v("renderer", &CameraSystemConfig::renderer,
      "The back end that renders the images, and its quality.");
  }
  // Returns the streams that are rendered.
  const List<CameraConfig>& drawn() const {
    static const List<CameraConfig> kNone;
    return draw ? streams : kNone;
  }
  int width(const CameraConfig& stream) const { return stream.width.value_or(resolution[0]); }
  int height(const CameraConfig& stream) const { return stream.height.value_or(resolution[1]); }
  void Validate(Problems& problems) const;
};

}  // namespace robocell
