#include "robocell/robot/floating_base.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/math/pose.h"
#include "robocell/math/rotation.h"
#include "robocell/mujoco/forward.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

constexpr double kSeconds = 1;
constexpr double kMostDrop = 0.05;             // m; legs give way a little
constexpr double kMostTilt = 20 * M_PI / 180;  // rad
constexpr double kDegreesPerRadian = 180 / M_PI;

double TiltBetween(const Pose& from, const Pose& to) {
  const Eigen::Vector3d up = from.rotation().transpose() * Eigen::Vector3d::UnitZ();
  return std::acos(std::clamp((to.rotation() * up).z(), -1.0, 1.0));
}

Pose PoseOfBody(const mjData* data, int body) {
  return Pose::FromWxyz(data->xpos + 3 * static_cast<ptrdiff_t>(body),
                        data->xquat + 4 * static_cast<ptrdiff_t>(body));
}

}  // namespace

std::string WhyBaseFalls(const Scene& scene, const RobotRecord& robot) {
  if (robot.base.kind != BaseKind::kFree) return "";
  const mjModel* m = scene.model();
  const int body = FindId(m, mjOBJ_BODY, robot.base_body);
  if (body < 0 || m->body_jntnum[body] == 0) return "";
  const DataPtr data = MakeData(m);
  Pose before, after;
  Guarded("whether a floating base stands", data.get(), [&] {
    mj_resetDataKeyframe(m, data.get(), FindId(m, mjOBJ_KEY, "home"));
    mj_forward(m, data.get());
    before = PoseOfBody(data.get(), body);
    const int steps = static_cast<int>(std::lround(kSeconds / m->opt.timestep));
    for (int i = 0; i < steps; ++i) mj_step(m, data.get());
    mj_kinematics(m, data.get());
    after = PoseOfBody(data.get(), body);
  });
  const double drop = before.translation().z() - after.translation().z();
  const double tilt = TiltBetween(before, after);
  if (drop <= kMostDrop && tilt <= kMostTilt) return "";
  const std::string joint = ElementName(m, mjOBJ_JOINT, m->body_jntadr[body]);
  return fmt::format(
      "its base floats on the free joint of '{}' and {} in the first second, because nothing holds "
      "it up. Delete that joint in the robot file to fix the base where the scene puts it (`edits: "
      "[{{delete: {{joint: '{}'}}}}]`), give it something to stand on, or command what holds it up",
      robot.base_body.substr(robot.prefix.size()),
      drop > kMostDrop ? fmt::format("falls {:.2f} m", drop)
                       : fmt::format("tips over by {:.0f} degrees", tilt * kDegreesPerRadian),
      joint.substr(robot.prefix.size()));
}

}  // namespace robocell::internal
