#include "robocell/spec/start_camera.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "robocell/spec/validate.h"

namespace robocell {
namespace {

constexpr double kLeastLength = 1e-9;  // metres between two points that give a direction
constexpr double kMostFovy = 179;      // degrees

}  // namespace

void StartCamera::Validate(Problems& problems) const {
  ValidatePlacement(euler, quat, problems);
  ValidateFovy(fovy, problems);
  const bool has_rotation = euler != Vec3{} || quat != kIdentityQuat;
  const bool has_pose = pos || look_at || has_rotation || !mount.empty();
  if (!around.empty() && (has_pose || !camera.empty()))
    problems.AddAt("around", "is set together with a camera, a mount or a pose; keep one of them");
  if (!camera.empty() && has_pose)
    problems.AddAt("camera", "is set together with a mount or a pose; keep one of them");
  if (!mount.empty() && !pos)
    problems.AddAt("pos", "is required with a mount: where the camera is in it, metres");
  if (mount.empty() && !pos && (look_at || has_rotation))
    problems.AddAt("pos", "is required with a rotation or a `look_at`");
  if (look_at && has_rotation)
    problems.AddAt("look_at", "is set together with a rotation; keep one of them");
  if (look_at && pos && (ToEigen(*look_at) - ToEigen(*pos)).norm() < kLeastLength)
    problems.AddAt("look_at", "is the camera's own position, so there is nowhere to look");
  if (ToEigen(up).norm() < kLeastLength)
    problems.AddAt("up", "is no direction; give a vector such as [0, 0, 1]");
  ValidateRange(distance, "distance", problems);
  ValidateRange(height, "height", problems);
  ValidateRange(azimuth, "azimuth", problems);
  if (!around.empty() && distance[0] == 0 && height[0] <= 0 && height[1] >= 0)
    problems.AddAt("distance", "begins at 0, where the camera could stand in what it looks at");
  if (!IsCopy()) {
    const double own = fovy.value_or(kFovy);
    if (own - fovy_noise <= 0 || own + fovy_noise > kMostFovy)
      problems.AddAt("fovy_noise",
                     fmt::format("{:g} degrees around {:g} leave the range of a field of view",
                                 fovy_noise, own));
  }
  if (rotation_noise > 180)
    problems.AddAt("rotation_noise", "is more than 180 degrees, which is any rotation");
}

}  // namespace robocell
