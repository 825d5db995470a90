// Reports each spatial tendon with an armature that crosses a joint of an arm: chains leave it out.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/inspection/robot_inspection.h"

namespace robocell::internal {
namespace {

// Returns true if sites and geoms guide a tendon past bodies on both sides of a joint.
bool IsLedAcross(const mjModel* m, int tendon, int joint) {
  bool beyond = false, before = false;
  for (int w = m->tendon_adr[tendon]; w < m->tendon_adr[tendon] + m->tendon_num[tendon]; ++w) {
    if (m->wrap_type[w] == mjWRAP_JOINT) return false;  // a fixed one
    const int body = BodyOfWrap(m, w);
    if (body >= 0) (IsInSubtree(m, body, m->jnt_bodyid[joint]) ? beyond : before) = true;
  }
  return beyond && before;
}

// Returns the joints of its arms; for a robot without groups all of its joints.
std::vector<int> JointsOfChains(const mjModel* m, const RobotRecord& robot) {
  std::vector<int> joints;
  for (const auto& [name, group] : robot.config.move_groups.entries()) {
    if (group->kind != MoveGroupKind::kArm) continue;
    for (const std::string& joint : group->joints)
      joints.push_back(FindId(m, mjOBJ_JOINT, robot.prefix + joint));
  }
  std::erase(joints, -1);
  const int base = FindId(m, mjOBJ_BODY, robot.base_body);
  for (int j = 0; j < m->njnt && base >= 0 && robot.config.move_groups.empty(); ++j) {
    if (IsInSubtree(m, m->jnt_bodyid[j], base)) joints.push_back(j);
  }
  return joints;
}

}  // namespace

void CheckTendons(const CompiledRobot& robot, Findings& findings) {
  const mjModel* m = robot.model;
  const std::vector<int> joints = JointsOfChains(m, robot.robot);
  for (int tendon = 0; tendon < m->ntendon; ++tendon) {
    const double armature = TendonArmature(m, tendon);
    const auto across = [&](int joint) { return IsLedAcross(m, tendon, joint); };
    if (armature == 0 || std::none_of(joints.begin(), joints.end(), across)) continue;
    findings.Note(
        fmt::format("the armature of tendon '{}', {:.3g} kg with that of actuators, is left out of "
                    "chain dynamics (mass matrix, inverse dynamics): what a spatial tendon adds to "
                    "the joints changes with the pose. Impedance control, which asks the engine, "
                    "has it",
                    ElementName(m, mjOBJ_TENDON, tendon), armature));
  }
}

}  // namespace robocell::internal
