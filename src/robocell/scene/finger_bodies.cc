#include "robocell/scene/finger_bodies.h"

#include <vector>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/element_lookup.h"

namespace robocell::internal {
namespace {

std::optional<int> BodyOfFinger(const mjModel* m, const RobotRecord& robot, const ElementRef& ref) {
  try {
    const ElementId element = FindElement(m, robot, ref, {mjOBJ_GEOM, mjOBJ_BODY, mjOBJ_SITE});
    return BodyOf(m, element.kind, element.id);
  } catch (const NotFoundError&) {
    return std::nullopt;
  }
}

}  // namespace

std::optional<std::array<int, 2>> FingerBodies(const mjModel* m, const RobotRecord& robot,
                                               const MoveGroupConfig& gripper) {
  std::vector<std::optional<int>> ends;
  for (const ElementRef& finger : gripper.fingers) ends.push_back(BodyOfFinger(m, robot, finger));
  if (ends.empty()) {
    for (const std::string& name : gripper.joints) {
      const int joint = FindId(m, mjOBJ_JOINT, robot.prefix + name);
      ends.push_back(joint < 0 ? std::nullopt : std::optional(m->jnt_bodyid[joint]));
    }
  }
  if (ends.size() != 2 || !ends[0] || !ends[1]) return std::nullopt;
  return std::array{*ends[0], *ends[1]};
}

}  // namespace robocell::internal
