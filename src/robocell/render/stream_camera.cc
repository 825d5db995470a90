#include "robocell/render/stream_camera.h"

#include <fmt/format.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

// Returns the name without the prefix of the camera's robot.
std::string AsWritten(const Scene& scene, const std::string& camera) {
  for (const RobotRecord& robot : scene.compiled()->robots()) {
    if (camera.starts_with(robot.prefix)) return camera.substr(robot.prefix.size());
  }
  return camera;
}

// Returns the place of a stream for errors; "" for a camera that no stream names.
std::string PlaceOf(const CameraConfig& stream) {
  return stream.name.empty() ? "" : "stream '" + stream.name + "'";
}

}  // namespace

std::string FindCameraName(const Scene& scene, const CameraConfig& stream) {
  std::vector<std::string> cameras = scene.camera_names();
  const auto has = [&](const std::string& name) {
    return std::find(cameras.begin(), cameras.end(), name) != cameras.end();
  };
  if (has(stream.camera)) return stream.camera;
  std::vector<std::string> of_robots;
  for (const RobotRecord& robot : scene.compiled()->robots()) {
    if (has(robot.prefix + stream.camera)) of_robots.push_back(robot.prefix + stream.camera);
  }
  if (of_robots.size() == 1) return of_robots.front();
  if (!of_robots.empty()) {
    throw ArgumentError(fmt::format("{}camera '{}' is one of {}; write the full name",
                                    stream.name.empty() ? "" : PlaceOf(stream) + ": ",
                                    stream.camera, ListNames(of_robots)));
  }
  for (std::string& camera : cameras) camera = AsWritten(scene, camera);
  throw NotFoundError(NoSuchName(PlaceOf(stream), "camera", stream.camera, cameras));
}

int FollowedBody(const Scene& scene, const CameraConfig& stream) {
  const mjModel* m = scene.model();
  if (const int body = FindId(m, mjOBJ_BODY, stream.follow); body >= 0) return body;
  std::vector<std::string> known;
  for (const ObjectRecord& object : scene.compiled()->objects()) {
    if (object.name == stream.follow) return RequireId(m, mjOBJ_BODY, object.root_body, "");
    known.push_back(object.name);
  }
  for (const std::string& body : scene.body_names()) {
    if (std::ranges::find(known, body) == known.end()) known.push_back(body);
  }
  throw NotFoundError(NoSuchName(PlaceOf(stream), "object or body", stream.follow, known));
}

CameraView ViewOfStream(const Scene& scene, const CameraConfig& stream) {
  const mjModel* m = scene.model();
  const std::string place = PlaceOf(stream);
  if (!stream.follow.empty()) return TrackingCamera{.body = FollowedBody(scene, stream)};
  if (stream.camera == "Free" && FindId(m, mjOBJ_CAMERA, stream.camera) < 0) return InitialView(m);
  return NamedCamera(m, FindCameraName(scene, stream), place);
}

}  // namespace robocell::internal
