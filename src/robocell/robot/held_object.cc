#include "robocell/robot/held_object.h"

#include <fmt/format.h>

#include "robocell/base/log.h"
#include "robocell/robot/robot.h"

namespace robocell {
namespace {

// The name of the object that it holds, of those that the scene knows.
std::string ObjectHeldBy(const Scene& scene, const GripperGroup& gripper) {
  for (const ObjectRecord& object : scene.compiled()->objects()) {
    if (object.free_joint && gripper.is_grasping(object.root_body)) return "'" + object.name + "'";
  }
  return "something";
}

}  // namespace

std::string HeldByRobot(const Scene& scene, const std::string& robot) {
  if (!scene.FindObserver("robot:" + robot)) return "";
  const Robot made = Robot::Of(scene, robot);
  for (const std::string& name : made.group_names()) {
    const auto* gripper = dynamic_cast<const GripperGroup*>(&made.group(name));
    if (gripper && gripper->is_grasping())
      return fmt::format("gripper '{}' holds {}", name, ObjectHeldBy(scene, *gripper));
  }
  return "";
}

void LeavesObject::Warn(const Scene& scene, const std::string& robot, const std::string& place,
                        BaseKind base) {
  if (told_) return;
  const std::string held = HeldByRobot(scene, robot);
  if (held.empty()) return;
  told_ = true;
  const std::string give =
      base == BaseKind::kDriven ? "" : "give the robot `base: {kind: driven}` and ";
  LogWarn(
      fmt::format("{}: it is put elsewhere while {}, which stays behind: setting a pose carries "
                  "nothing. To carry it, {}set the base's target (said once)",
                  place, held, give));
}

}  // namespace robocell
