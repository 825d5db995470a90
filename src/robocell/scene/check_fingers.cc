// A finger that hangs on joints must be moved by something.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/check_robot.h"
#include "robocell/scene/hold_ctrl.h"

namespace robocell {
namespace {

// The joints between the hand and a finger, the finger's first.
struct FingerJoints {
  std::vector<int> ids;
  int branch = -1;  // the child of the hand that the finger hangs on; -1: it is the hand

  bool has(int joint) const { return std::find(ids.begin(), ids.end(), joint) != ids.end(); }
};

FingerJoints JointsBetween(const mjModel* m, int hand, int finger) {
  FingerJoints joints;
  for (int body = finger; body != hand; body = m->body_parentid[body]) {
    for (int k = 0; k < m->body_jntnum[body]; ++k) joints.ids.push_back(m->body_jntadr[body] + k);
    joints.branch = body;
  }
  return joints;
}

bool TendonHas(const mjModel* m, int tendon, const FingerJoints& joints) {
  for (int w = m->tendon_adr[tendon]; w < m->tendon_adr[tendon] + m->tendon_num[tendon]; ++w) {
    if (m->wrap_type[w] == mjWRAP_JOINT && joints.has(m->wrap_objid[w])) return true;
  }
  return false;
}

// Whether one of the two things that an equality ties together is of the finger.
bool Ties(const mjModel* m, int equality, int id, const FingerJoints& joints) {
  if (id < 0) return false;
  switch (m->eq_type[equality]) {
    case mjEQ_JOINT:
      return joints.has(id);
    case mjEQ_TENDON:
      return TendonHas(m, id, joints);
    case mjEQ_CONNECT:
    case mjEQ_WELD: {
      const int body = BodyOf(m, static_cast<mjtObj>(m->eq_objtype[equality]), id);
      return IsInSubtree(m, body, joints.branch);
    }
    default:
      return true;  // flexible bodies: not known
  }
}

bool IsMoved(const mjModel* m, const mjData* d, const FingerJoints& joints) {
  std::vector<bool> dofs(static_cast<size_t>(m->nv));
  for (int dof = 0; dof < m->nv; ++dof) dofs[dof] = joints.has(m->dof_jntid[dof]);
  for (int a = 0; a < m->nactuator; ++a) {
    if (ActsOn(m, d, a, dofs)) return true;
  }
  for (int e = 0; e < m->neq; ++e) {
    if (!m->eq_active0[e]) continue;
    if (Ties(m, e, m->eq_obj1id[e], joints) || Ties(m, e, m->eq_obj2id[e], joints)) return true;
  }
  return std::any_of(joints.ids.begin(), joints.ids.end(),
                     [&](int joint) { return m->jnt_stiffness[joint] > 0; });
}

bool Collides(const mjModel* m, int geom) {
  if (m->geom_contype[geom] || m->geom_conaffinity[geom]) return true;
  for (int p = 0; p < m->npair; ++p) {
    if (m->pair_geom1[p] == geom || m->pair_geom2[p] == geom) return true;
  }
  return false;
}

// Whether a loop is closed in the finger: then its tip may hang on another branch of the hand.
bool IsLinkage(const mjModel* m, const FingerJoints& joints) {
  for (int e = 0; e < m->neq; ++e) {
    if (m->eq_type[e] != mjEQ_CONNECT && m->eq_type[e] != mjEQ_WELD) continue;
    if (Ties(m, e, m->eq_obj1id[e], joints) || Ties(m, e, m->eq_obj2id[e], joints)) return true;
  }
  return false;
}

// Whether the finger has a geom that can touch something.
bool CanTouch(const mjModel* m, int hand, int finger, const FingerJoints& joints) {
  const bool linkage = !joints.ids.empty() && IsLinkage(m, joints);
  const int root = linkage ? hand : joints.branch < 0 ? finger : joints.branch;
  for (int g = 0; g < m->ngeom; ++g) {
    if (IsInSubtree(m, m->geom_bodyid[g], root) && Collides(m, g)) return true;
  }
  return false;
}

}  // namespace

void CheckFingers(const mjModel* m, const mjData* d, const RobotRecord& robot,
                  const std::string& field, const std::array<int, 2>& fingers, Report& report) {
  const auto name = [&](mjtObj kind, int id) {
    return ElementName(m, kind, id).substr(robot.prefix.size());
  };
  const int hand = CommonAncestor(m, fingers[0], fingers[1]);
  for (int i = 0; i < 2; ++i) {
    const FingerJoints joints = JointsBetween(m, hand, fingers[i]);
    if (!CanTouch(m, hand, fingers[i], joints)) {
      report.Warn("robot '" + robot.name + "'",
                  fmt::format("{}: no geom of the finger '{}' collides (their contype and "
                              "conaffinity are 0), so it can hold nothing. In the model, give one "
                              "of them contype=\"1\" conaffinity=\"1\"",
                              field, name(mjOBJ_BODY, fingers[i])),
                  field);
    }
    if (joints.ids.empty() || IsMoved(m, d, joints)) continue;
    const FingerJoints others = JointsBetween(m, hand, fingers[1 - i]);
    const std::string other = others.ids.empty() ? "..." : name(mjOBJ_JOINT, others.ids[0]);
    const std::string joint = name(mjOBJ_JOINT, joints.ids[0]);
    report.Warn(
        "robot '" + robot.name + "'",
        fmt::format("{}: nothing moves the finger '{}': no actuator acts on its joint '{}' "
                    "and no equality ties it to the other finger. In the model, couple it "
                    "(<equality><joint joint1=\"{}\" joint2=\"{}\"/></equality>) or give it "
                    "an actuator",
                    field, name(mjOBJ_BODY, fingers[i]), joint, joint, other));
  }
}

}  // namespace robocell
