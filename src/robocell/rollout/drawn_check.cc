#include "robocell/rollout/drawn_check.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/features/feature_source.h"
#include "robocell/robot/move_group.h"

namespace robocell::internal {

DrawnCheck::DrawnCheck(const Scene& scene, const FeatureSchema& observed) {
  const std::vector<Robot> robots = RobotsOf(scene);
  size_t at = 0;
  for (const Feature& feature : observed.features()) {
    for (const ObjectRecord& object : scene.compiled()->objects()) {
      if (feature.column.name != "objects/" + object.name + "/pose") continue;
      const int body = mj_name2id(scene.model(), mjOBJ_BODY, object.root_body.c_str());
      objects_.push_back({object.name, body, at});
    }
    for (const Robot& robot : robots) AddJoints(robot, feature, at);
    at += static_cast<size_t>(feature.size());
  }
}

// Adds those of an arm whose values are positions of joints, one each: a group of a user's own may
// have other values.
void DrawnCheck::AddJoints(const Robot& robot, const Feature& feature, size_t at) {
  const mjModel* model = robot.scene().model();
  for (const std::string& name : robot.group_names()) {
    if (feature.column.name != "robots/" + robot.name() + "/" + name + "/qpos") continue;
    const MoveGroup& group = robot.group(name);
    const std::vector<std::string>& joints = group.joint_names();
    const std::vector<double> now = group.joint_pos();
    if (group.kind() != MoveGroupKind::kArm || now.size() != joints.size()) return;
    for (size_t i = 0; i < joints.size(); ++i) {
      const int joint = mj_name2id(model, mjOBJ_JOINT, joints[i].c_str());
      if (joint < 0) continue;
      const int address = model->jnt_qposadr[joint];
      if (robot.scene().data()->qpos[address] == now[i])
        joints_.push_back({joints[i], address, at + i});
    }
  }
}

void DrawnCheck::Require(const std::string& episode, int64_t row, std::span<const double> observed,
                         StateDrawer& drawer) const {
  constexpr double kTolerance = 1e-9;  // m, rad, and 1 - |cos(angle / 2)|
  for (const Joint& joint : joints_) {
    const double drawn = drawer.DrawnPosition(joint.address), recorded = observed[joint.at];
    if (std::abs(drawn - recorded) <= kTolerance) continue;
    throw Error(
        fmt::format("episode '{}', row {}: joint '{}' is drawn at {:.9f} and recorded at {:.9f}; "
                    "the episode is "
                    "not kept",
                    episode, row, joint.name, drawn, recorded));
  }
  for (const Object& object : objects_) {
    const Pose drawn = drawer.DrawnPose(object.body);
    std::array<double, kPoseNumbers> numbers;
    PutPose(drawn, numbers);
    const std::span<const double> recorded = observed.subspan(object.at, kPoseNumbers);
    // A quaternion and its negative are the same rotation.
    const double turned =
        std::inner_product(numbers.begin() + 3, numbers.end(), recorded.begin() + 3, 0.0);
    const bool same = std::abs(numbers[0] - recorded[0]) <= kTolerance &&
                      std::abs(numbers[1] - recorded[1]) <= kTolerance &&
                      std::abs(numbers[2] - recorded[2]) <= kTolerance &&
                      std::abs(turned) >= 1 - kTolerance;
    if (same) continue;
    throw Error(fmt::format(
        "episode '{}', row {}: object '{}' is drawn at ({:.6f}, {:.6f}, {:.6f}) m and recorded "
        "at ({:.6f}, {:.6f}, {:.6f}) m, or turned otherwise; the episode is not kept",
        episode, row, object.name, numbers[0], numbers[1], numbers[2], recorded[0], recorded[1],
        recorded[2]));
  }
}

}  // namespace robocell::internal
