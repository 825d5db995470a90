#include "robocell/scene/finger_bodies.h"

#include <algorithm>
#include <optional>
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

std::vector<int> FingerBodies(const mjModel* m, const RobotRecord& robot,
                              const MoveGroupConfig& gripper) {
  std::vector<std::optional<int>> ends;
  for (const ElementRef& finger : gripper.fingers) ends.push_back(BodyOfFinger(m, robot, finger));
  if (ends.empty()) {
    for (const std::string& name : gripper.joints) {
      const int joint = FindId(m, mjOBJ_JOINT, robot.prefix + name);
      ends.push_back(joint < 0 ? std::nullopt : std::optional(m->jnt_bodyid[joint]));
    }
  }
  const bool guessed = gripper.fingers.empty();
  if (guessed ? ends.size() != 2 : ends.size() < 2) return {};
  if (!std::ranges::all_of(ends, [](const std::optional<int>& end) { return end.has_value(); }))
    return {};
  std::vector<int> bodies;
  for (const std::optional<int> end : ends) bodies.push_back(*end);
  return bodies;
}

int HandOf(const mjModel* m, const std::vector<int>& fingers) {
  int hand = fingers.front();
  for (const int finger : fingers) hand = CommonAncestor(m, hand, finger);
  return hand;
}

std::vector<bool> DofsThatDriveFingers(const mjModel* m, int hand) {
  std::vector<bool> dofs(static_cast<size_t>(m->nv));
  const auto in_finger = [&](int body) { return body != hand && IsInSubtree(m, body, hand); };
  const auto mark = [&](int joint) { dofs[m->jnt_dofadr[joint]] = true; };
  for (int e = 0; e < m->neq; ++e) {
    const int ids[] = {m->eq_obj1id[e], m->eq_obj2id[e]};
    if (ids[0] < 0 || ids[1] < 0) continue;
    if (m->eq_type[e] == mjEQ_JOINT) {
      const bool first = in_finger(m->jnt_bodyid[ids[0]]),
                 second = in_finger(m->jnt_bodyid[ids[1]]);
      if (first != second) mark(ids[first ? 1 : 0]);
    } else if (m->eq_type[e] == mjEQ_CONNECT || m->eq_type[e] == mjEQ_WELD) {
      const mjtObj kind = static_cast<mjtObj>(m->eq_objtype[e]);
      const int a = BodyOf(m, kind, ids[0]), b = BodyOf(m, kind, ids[1]);
      if (in_finger(a) == in_finger(b)) continue;
      const int end = CommonAncestor(m, hand, in_finger(a) ? b : a);
      for (int body = hand; body > 0 && body != end; body = m->body_parentid[body]) {
        for (int k = 0; k < m->body_jntnum[body]; ++k) mark(m->body_jntadr[body] + k);
      }
    }
  }
  return dofs;
}

}  // namespace robocell::internal
