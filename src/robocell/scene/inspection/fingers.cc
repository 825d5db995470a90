// A finger on joints needs an actuator that is strong enough to hold an object, and a geom that can
// touch it.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <Eigen/Geometry>

#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/finger_bodies.h"
#include "robocell/scene/hold_ctrl.h"
#include "robocell/scene/inspection/robot_inspection.h"

namespace robocell::internal {
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

// Returns true if one of the two elements that an equality ties together belongs to the finger.
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
      return true;  // flexible bodies: unknown
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

// Returns true if the finger contains a closed loop: then its tip may hang on another branch of the
// hand.
bool IsLinkage(const mjModel* m, const FingerJoints& joints) {
  for (int e = 0; e < m->neq; ++e) {
    if (m->eq_type[e] != mjEQ_CONNECT && m->eq_type[e] != mjEQ_WELD) continue;
    if (Ties(m, e, m->eq_obj1id[e], joints) || Ties(m, e, m->eq_obj2id[e], joints)) return true;
  }
  return false;
}

// Returns true if the finger has a geom that can touch something.
bool CanTouch(const mjModel* m, int hand, int finger, const FingerJoints& joints) {
  const bool linkage = !joints.ids.empty() && IsLinkage(m, joints);
  const int root = linkage ? hand : joints.branch < 0 ? finger : joints.branch;
  for (int g = 0; g < m->ngeom; ++g) {
    if (IsInSubtree(m, m->geom_bodyid[g], root) && Collides(m, g)) return true;
  }
  return false;
}

// Returns the largest force of an actuator: its forcerange, or the difference between the ends of
// its ctrlrange if that is smaller. Unset without a bound.
std::optional<double> MostForce(const mjModel* m, int a) {
  std::optional<double> most;
  if (m->actuator_forcelimited[a]) {
    const mjtNum* range = m->actuator_forcerange + 2 * a;
    most = std::max(std::abs(range[0]), std::abs(range[1]));
  }
  const int input = m->actuator_ctrladr[a];
  const bool fixed =
      m->actuator_gaintype[a] == mjGAIN_FIXED && m->actuator_dyntype[a] == mjDYN_NONE;
  if (fixed && m->actuator_ctrlnum[a] > 0 && m->actuator_ctrllimited[input]) {
    const mjtNum* range = m->actuator_ctrlrange + 2 * input;
    const double between = std::abs(m->actuator_gainprm[mjNGAIN * a]) * (range[1] - range[0]);
    most = std::min(most.value_or(between), between);
  }
  return most;
}

// Returns the force that holds the bodies on a degree of freedom against gravity from the side, N
// or N m. Unset for those of balls and free bodies.
std::optional<double> Weight(const mjModel* m, const mjData* d, int dof) {
  constexpr double kGravity = 9.81;  // the scene may have none
  const int joint = m->dof_jntid[dof], body = m->dof_bodyid[dof];
  const double weight = kGravity * m->body_subtreemass[body];
  if (m->jnt_type[joint] == mjJNT_SLIDE) return weight;
  if (m->jnt_type[joint] != mjJNT_HINGE) return std::nullopt;
  const Eigen::Map<const Eigen::Vector3d> com(d->subtree_com + 3 * body),
      anchor(d->xanchor + 3 * joint), axis(d->xaxis + 3 * joint);
  return weight * axis.cross(com - anchor).norm();
}

// Reports actuators of a gripper whose total force is less than the weight of its fingers.
void CheckForces(const CompiledRobot& of, const std::string& field,
                 const std::vector<std::string>& actuators, Findings& findings) {
  const mjModel* m = of.model;
  const mjData* d = of.reference;
  const RobotRecord& robot = of.robot;
  std::map<int, double> forces;  // forces by degree of freedom, N or N m
  double pushed = 0;
  for (const std::string& name : actuators) {
    const int a = FindId(m, mjOBJ_ACTUATOR, robot.prefix + name);
    const std::optional<double> most = a < 0 ? std::nullopt : MostForce(m, a);
    if (!most) return;
    pushed = std::max(pushed, *most);
    const int output = m->actuator_outadr[a];
    for (int i = d->moment_rowadr[output]; i < d->moment_rowadr[output] + d->moment_rownnz[output];
         ++i) {
      if (d->actuator_moment[i] != 0)
        forces[d->moment_colind[i]] += *most * std::abs(d->actuator_moment[i]);
    }
  }
  if (forces.empty()) return;
  int weakest = -1;
  for (const auto& [dof, force] : forces) {
    const std::optional<double> weight = Weight(m, d, dof);
    if (!weight || force >= *weight) return;
    weakest = dof;
  }
  const bool slide = m->jnt_type[m->dof_jntid[weakest]] == mjJNT_SLIDE;
  findings.Warn(
      field,
      fmt::format("{}: {} may push with {:.3g} at most, which is {:.3g} {} at joint '{}', and what "
                  "hangs on it takes {:.3g} to lift: the gripper can hold nothing. Raise the "
                  "forcerange, or the gains where that is not the limit (edits: [{{actuator: '{}', "
                  "forcerange: [-F, F]}}])",
                  field, ListNames(actuators), pushed, forces[weakest], slide ? "N" : "N m",
                  ElementName(m, mjOBJ_JOINT, m->dof_jntid[weakest]).substr(robot.prefix.size()),
                  *Weight(m, d, weakest), actuators.front()));
}

// Reports fingers that nothing holds between open and closed, because the controls of all their
// actuators are forces or speeds and no spring pushes back.
void CheckOpenings(const CompiledRobot& of, const std::string& group,
                   const std::vector<std::string>& actuators, const std::vector<int>& fingers,
                   Findings& findings) {
  const mjModel* m = of.model;
  std::optional<CtrlMode> kind;
  for (const std::string& name : actuators) {
    const int a = FindId(m, mjOBJ_ACTUATOR, of.robot.prefix + name);
    const auto next = a < 0 ? std::nullopt : ActuatorForceKind(m, a);
    if (!next || *next == CtrlMode::kPosition) return;
    kind = next;
  }
  if (!kind) return;
  const int hand = HandOf(m, fingers);
  for (const int finger : fingers) {
    const FingerJoints joints = JointsBetween(m, hand, finger);
    for (const int joint : joints.ids) {
      if (m->jnt_stiffness[joint] > 0) return;
    }
    for (int tendon = 0; tendon < m->ntendon; ++tendon) {
      if (m->tendon_stiffness[tendon] > 0 && TendonHas(m, tendon, joints)) return;
    }
  }
  findings.Note(fmt::format(
      "gripper '{}' only opens and closes: {} {}, whose control is a {}, and nothing holds its "
      "fingers in between. Actions that are openings (`binary_gripper: false` in an environment) "
      "need a position servo",
      group, ListNames(actuators),
      actuators.size() == 1 ? std::string("is a ") + ActuatorWord(*kind)
                            : fmt::format("are {}s", ActuatorWord(*kind)),
      *kind == CtrlMode::kTorque ? "force" : "speed"));
}

// Reports each finger that nothing moves, or that has nothing to touch with.
void CheckMotion(const CompiledRobot& of, const std::string& field, const std::vector<int>& fingers,
                 Findings& findings) {
  const mjModel* m = of.model;
  const mjData* d = of.reference;
  const RobotRecord& robot = of.robot;
  const auto name = [&](mjtObj kind, int id) {
    return ElementName(m, kind, id).substr(robot.prefix.size());
  };
  const int hand = HandOf(m, fingers);
  for (size_t i = 0; i < fingers.size(); ++i) {
    const FingerJoints joints = JointsBetween(m, hand, fingers[i]);
    if (!CanTouch(m, hand, fingers[i], joints)) {
      findings.Warn(
          field, fmt::format("{}: no geom of the finger '{}' collides (their contype and "
                             "conaffinity are 0), so it can hold nothing. In the model, give one "
                             "of them contype=\"1\" conaffinity=\"1\"",
                             field, name(mjOBJ_BODY, fingers[i])));
    }
    if (joints.ids.empty() || IsMoved(m, d, joints)) continue;
    const FingerJoints others = JointsBetween(m, hand, fingers[(i + 1) % fingers.size()]);
    const std::string other = others.ids.empty() ? "..." : name(mjOBJ_JOINT, others.ids[0]);
    const std::string joint = name(mjOBJ_JOINT, joints.ids[0]);
    findings.WarnAt(
        "", fmt::format("{}: nothing moves the finger '{}': no actuator acts on its joint '{}' "
                        "and no equality ties it to the other finger. In the model, couple it "
                        "(<equality><joint joint1=\"{}\" joint2=\"{}\"/></equality>) or give it "
                        "an actuator",
                        field, name(mjOBJ_BODY, fingers[i]), joint, joint, other));
  }
}

}  // namespace

void CheckFingers(const CompiledRobot& robot, Findings& findings) {
  for (const auto& [name, group] : robot.robot.config.move_groups.entries()) {
    if (group->kind != MoveGroupKind::kGripper) continue;
    const std::vector<int> fingers = FingerBodies(robot.model, robot.robot, *group);
    if (fingers.empty() || std::ranges::count(fingers, fingers[0]) > 1) continue;
    const std::string field = "move_groups." + name;
    CheckMotion(robot, field + (group->fingers.empty() ? ".joints" : ".fingers"), fingers,
                findings);
    CheckForces(robot, field + ".actuators", group->actuators.names, findings);
    CheckOpenings(robot, name, group->actuators.names, fingers, findings);
  }
}

}  // namespace robocell::internal
