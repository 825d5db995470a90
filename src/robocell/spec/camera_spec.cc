#include "robocell/spec/camera_spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <Eigen/Geometry>

#include "robocell/base/suggestions.h"
#include "robocell/spec/validate.h"

namespace robocell {
namespace {

constexpr double kLeastDistance = 1e-9;  // metres between two points that give a direction

// Camera axes x right, y up, looking along -z, towards `target`; z of the parent is up.
Eigen::Matrix3d LookAt(const Eigen::Vector3d& from, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (from - target).normalized();
  Eigen::Vector3d x = Eigen::Vector3d::UnitZ().cross(z);
  if (x.norm() < 1e-9) x = Eigen::Vector3d::UnitX();  // looking straight up or down
  x.normalize();
  Eigen::Matrix3d rotation;
  rotation << x, z.cross(x), z;
  return rotation;
}

}  // namespace

Pose CameraSpec::pose() const {
  const Vec3 at = pos.value_or(Vec3{});
  if (look_at) return Pose(ToEigen(at), LookAt(ToEigen(at), ToEigen(*look_at)));
  return PlacementPose(at, euler, quat);
}

void CameraSpec::Validate(Problems& problems) const {
  ValidateNotEmpty(name, "name", "cameras are looked up by name", problems);
  const bool alone = mjcf_path.empty();
  if (alone && !pos) problems.AddAt("pos", "is required: where the camera is, [x, y, z] in metres");
  if (alone && !fovy)
    problems.AddAt("fovy", "is required: the vertical field of view in degrees, for example 45");
  ValidateFovy(fovy, problems);
  ValidatePlacement(euler, quat, problems);
  if (look_at && (euler != Vec3{} || quat != kIdentityQuat)) {
    problems.AddAt("look_at", "is set together with a rotation; keep one of them");
  }
  if (look_at && pos && (ToEigen(*look_at) - ToEigen(*pos)).norm() < kLeastDistance) {
    problems.AddAt("look_at",
                   "is the camera's own position, so there is nowhere to look; give a point in "
                   "front of the camera, or `euler` or `quat`");
  }
}

void CameraConfig::Validate(Problems& problems) const {
  if (!camera.empty() && !follow.empty())
    problems.AddAt("follow", "the stream has a camera; leave one of the two out");
  if (follow.empty())
    ValidateNotEmpty(camera, "camera", "which camera of the robot or scene the images come from",
                     problems);
  if (!rgb && !depth && !segmentation)
    problems.Add("takes no images: set rgb, depth or segmentation");
}

namespace {

// H.264 does not encode longer sides, and OpenGL draws none on common drivers.
constexpr int kLongestSide = 16384;

constexpr std::string_view kCorrectTheSize =
    "correct the stream's width and height, or `cameras.resolution`";

void ValidateNotTooLarge(const CameraSystemConfig& cameras, const CameraConfig& stream,
                         Problems& problems) {
  const int w = cameras.width(stream), h = cameras.height(stream);
  if (w <= kLongestSide && h <= kLongestSide) return;
  problems.Add(fmt::format("size {}x{} is too large: width and height can be at most {} pixels; {}",
                           w, h, kLongestSide, kCorrectTheSize));
}

}  // namespace

void RendererConfig::Validate(Problems& problems) const {
  const std::vector<std::string> backends = {"auto", "gl", "soft"};
  if (std::ranges::find(backends, backend) == backends.end())
    problems.AddAt("backend", NoSuchName("", "back end", backend, backends));
}

void CameraSystemConfig::Validate(Problems& problems) const {
  if (std::min(resolution[0], resolution[1]) <= 0) {
    problems.AddAt("resolution",
                   fmt::format("{} x {} pixels are not an image; both must be above 0",
                               resolution[0], resolution[1]));
  }
  for (size_t i = 0; i < streams.size(); ++i) {
    Problems::Scope list(problems, "streams");
    Problems::Scope item(problems, i);
    const CameraConfig& stream = streams[i];
    ValidateNotEmpty(stream.name, "name", "streams are recorded under their name", problems);
    for (size_t j = 0; j < i; ++j) {
      if (streams[j].name == stream.name)
        problems.AddAt("name", "'" + stream.name + "' is used twice");
    }
    const int w = width(stream), h = height(stream);
    if (w <= 0 || h <= 0) continue;  // a separate problem
    ValidateNotTooLarge(*this, stream, problems);
    if (stream.rgb && (w % 2 || h % 2)) {
      problems.Add(fmt::format(
          "size {}x{} cannot be encoded as video, which needs even numbers (of "
          "environments too: a dataset can have the same cameras); the nearest size is {}x{}; {}",
          w, h, w + w % 2, h + h % 2, kCorrectTheSize));
    }
  }
}

}  // namespace robocell
