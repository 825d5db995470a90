#include "robocell/scene/control_modes.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/joint_followers.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

// Returns the common kind; unset if they are of several kinds.
std::optional<CtrlMode> KindOfAll(const std::vector<std::optional<CtrlMode>>& kinds) {
  if (kinds.empty() ||
      std::adjacent_find(kinds.begin(), kinds.end(), std::not_equal_to<>()) != kinds.end())
    return std::nullopt;
  return kinds.front();
}

// --- Which joints belong together ----------------------------------------------------------------

// Names of the actuators of a kind by the joints they act on; the first one of each joint.
using ByJoint = std::map<std::string, std::string>;

ByJoint ActuatorsByJoint(const mjSpec* spec, CtrlMode kind) {
  ByJoint names;
  for (const JointActuator& actuator : JointActuators(spec)) {
    if (actuator.kind == kind) names.emplace(actuator.joint, actuator.name);
  }
  return names;
}

// Follows a tree of bodies; where it branches into several with actuators of the kind, new limbs
// begin.
class SerialStretches {
 public:
  SerialStretches(CtrlMode kind, ByJoint actuators)
      : kind_(kind), actuators_(std::move(actuators)) {}

  std::vector<Limb> Find(mjsBody* world) {
    Follow(world, Begin());
    std::erase_if(limbs_, [](const Limb& limb) { return limb.joints.empty(); });
    return std::move(limbs_);
  }

 private:
  size_t Begin() {
    limbs_.push_back({.name = "arm", .initial = kind_});
    return limbs_.size() - 1;
  }

  std::vector<std::string> DrivenJoints(mjsBody* body, bool whole_subtree) const {
    std::vector<std::string> joints;
    for (mjsElement* joint : BodyElements(body, mjOBJ_JOINT, whole_subtree)) {
      if (actuators_.contains(SpecName(joint))) joints.push_back(SpecName(joint));
    }
    return joints;
  }

  void Follow(mjsBody* body, size_t limb) {
    for (const std::string& joint : DrivenJoints(body, false)) {
      limbs_[limb].joints.push_back(joint);
      limbs_[limb].actuators.push_back(actuators_.at(joint));
    }
    std::vector<mjsBody*> branches;
    for (mjsElement* child : BodyElements(body, mjOBJ_BODY)) {
      if (!DrivenJoints(mjs_asBody(child), true).empty()) branches.push_back(mjs_asBody(child));
    }
    for (mjsBody* branch : branches) Follow(branch, branches.size() == 1 ? limb : Begin());
  }

  CtrlMode kind_;
  ByJoint actuators_;
  std::vector<Limb> limbs_;
};

// Returns the common kind of all actuators of a limb; unset if they are of several kinds, or if one
// is missing (which is reported when the model is compiled and all missing names are known).
std::optional<CtrlMode> NativeMode(const mjSpec* spec, const Limb& limb) {
  for (const std::string& joint : limb.joints) {
    if (!FindSpecElement(spec, mjOBJ_JOINT, joint)) return std::nullopt;
  }
  std::vector<std::optional<CtrlMode>> kinds;
  for (const std::string& name : limb.actuators) {
    mjsElement* element = FindSpecElement(spec, mjOBJ_ACTUATOR, name);
    if (!element) return std::nullopt;
    const mjsActuator* actuator = mjs_asActuator(element);
    kinds.push_back(ActsOnJoint(actuator) ? ActuatorKind(actuator) : std::nullopt);
  }
  return KindOfAll(kinds);
}

// --- Adding actuators ----------------------------------------------------------------------------

bool IsLimited(int limited, const double* range) {
  return limited == mjLIMITED_TRUE || (limited == mjLIMITED_AUTO && range[0] < range[1]);
}

// An actuator pushes no harder than the one that it replaces. The limit of a motor may be that of
// its force or of its control.
void LimitForce(const mjsActuator* authored, mjsActuator* actuator) {
  actuator->forcelimited = authored->forcelimited;
  std::copy_n(authored->forcerange, 2, actuator->forcerange);
  const bool is_motor = authored->biastype == mjBIAS_NONE;
  if (!is_motor || !IsLimited(authored->ctrllimited, authored->ctrlrange)) return;
  const double scale = authored->gainprm[0];
  const auto [low, high] =
      std::minmax({scale * authored->ctrlrange[0], scale * authored->ctrlrange[1]});
  const bool also = IsLimited(authored->forcelimited, authored->forcerange);
  const double* range = authored->forcerange;
  const auto within = [&](double force) {  // no std::clamp: the engine has not checked it yet
    return also ? std::min(std::max(force, range[0]), range[1]) : force;
  };
  actuator->forcerange[0] = within(low);
  actuator->forcerange[1] = within(high);
  actuator->forcelimited = mjLIMITED_TRUE;
}

// Adds an actuator on the joint of `authored`, with its gear and force limit.
void AddActuator(const mjsActuator* authored, const std::string& joint, CtrlMode mode, mjSpec* spec,
                 const std::string& place) {
  const std::string name = ModeActuatorName(joint, mode);
  if (FindSpecElement(spec, mjOBJ_ACTUATOR, name)) {
    throw SpecError(fmt::format(
        "{}: the control mode {} brings an actuator '{}' for joint '{}', and the model has one of "
        "that name. Rename it in the model, or set control_modes without {}",
        place, ToString(mode), name, joint, ToString(mode)));
  }
  mjsActuator* actuator = mjs_addActuator(spec, nullptr);
  SetSpecName(actuator->element, name, place);
  if (mode == CtrlMode::kTorque) {
    mjs_setToMotor(actuator);
  } else {
    mjs_setToVelocity(actuator, 1);  // FillVelocityGains sets a better value
  }
  actuator->trntype = mjTRN_JOINT;
  mjs_setString(actuator->target, joint.c_str());
  std::copy_n(authored->gear, 6, actuator->gear);
  LimitForce(authored, actuator);
  actuator->ctrllimited = mjLIMITED_FALSE;
  std::fill_n(actuator->ctrlrange, 2, 0.0);
  actuator->actlimited = mjLIMITED_FALSE;
  std::fill_n(actuator->damping, mjNPOLY + 1, 0.0);
  actuator->armature = 0;
}

// Adds the actuators of the declared modes that the model lacks.
void AddModes(const RobotSpec& robot, const std::string& place, mjSpec* spec, Limb& limb) {
  limb.modes = {limb.native};
  for (const CtrlMode mode : {CtrlMode::kVelocity, CtrlMode::kTorque}) {
    if (mode == limb.native || !robot.can_switch_to(mode)) continue;
    for (size_t i = 0; i < limb.joints.size(); ++i) {
      mjsElement* authored = FindSpecElement(spec, mjOBJ_ACTUATOR, limb.actuators[i]);
      AddActuator(mjs_asActuator(authored), limb.joints[i], mode, spec, place);
    }
    limb.modes.push_back(mode);
  }
}

bool Has(const Limb& limb, CtrlMode mode) {
  return std::find(limb.modes.begin(), limb.modes.end(), mode) != limb.modes.end();
}

void WarnOfMissingModes(const RobotSpec& robot, const std::set<CtrlMode>& had,
                        const std::string& place, CompileLog& log) {
  if (!robot.control_modes) return;
  for (const CtrlMode mode : *robot.control_modes) {
    if (had.contains(mode)) continue;
    log.Warn(place,
             fmt::format("control_modes has {}, but no arm of it has actuators that these can be "
                         "added to: position servos, velocity servos or motors, one on each "
                         "joint",
                         ToString(mode)),
             "control_modes");
  }
}

void ValidateInitialMode(const std::string& place, Limb& limb, CompileLog& log) {
  if (Has(limb, limb.initial)) return;
  if (limb.initial != CtrlMode::kPosition) {  // controllers check position themselves
    const std::string field = "control." + limb.name;
    log.Problem(place,
                fmt::format("{}: its controller needs the control mode {}, which the robot does "
                            "not declare; add it to control_modes in the scene",
                            field, ToString(limb.initial)),
                field);
  }
  limb.initial = limb.native;
}

// --- Groups --------------------------------------------------------------------------------------

std::vector<std::string> ActuatorsOf(const RobotLimbs& robot, const Limb& limb, CtrlMode mode) {
  std::vector<std::string> names;
  for (size_t i = 0; i < limb.joints.size(); ++i) {
    names.push_back(robot.prefix + (mode == limb.native ? limb.actuators[i]
                                                        : ModeActuatorName(limb.joints[i], mode)));
  }
  return names;
}

int GroupsNeeded(const RobotLimbs& robot) {
  size_t needed = 0;
  for (const Limb& limb : robot.limbs) needed += limb.modes.size();
  return static_cast<int>(needed);
}

class GroupNumbers {
 public:
  GroupNumbers(mjSpec* spec, const std::vector<RobotLimbs>& robots) : spec_(spec) {
    std::set<std::string> ours;
    for (const RobotLimbs& robot : robots) {
      for (const Limb& limb : robot.limbs) {
        for (const CtrlMode mode : limb.modes) {
          for (const std::string& name : ActuatorsOf(robot, limb, mode)) ours.insert(name);
        }
      }
    }
    for (mjsElement* element : SpecElements(spec, mjOBJ_ACTUATOR)) {
      if (!ours.contains(SpecName(element))) taken_.insert(mjs_asActuator(element)->group);
    }
    Skip();
  }

  int left() const {
    int left = 0;
    for (int group = next_; group <= kLastActuatorGroup; ++group)
      left += taken_.contains(group) ? 0 : 1;
    return left;
  }

  // Assigns the actuators to the next group.
  void Assign(const std::vector<std::string>& actuators, bool enabled) {
    for (const std::string& name : actuators) {
      if (mjsElement* element = FindSpecElement(spec_, mjOBJ_ACTUATOR, name))
        mjs_asActuator(element)->group = next_;
    }
    if (!enabled) spec_->option.disableactuator |= 1 << next_;
    ++next_;
    Skip();
  }

 private:
  void Skip() {
    while (taken_.contains(next_)) ++next_;
  }

  mjSpec* spec_;
  std::set<int> taken_;
  int next_ = 1;  // 0 is the default of all actuators
};

// --- Other actuators on the same joints ---------------------------------------------------------

// The degrees of freedom of a limb and of the joints that follow its own, and the actuator group of
// the native actuator of each one or its leader.
struct LimbDofs {
  std::vector<bool> own;     // nv
  std::map<int, int> group;  // by degree of freedom
};

LimbDofs FindDofs(const mjModel* m, const RobotLimbs& robot, const Limb& limb) {
  LimbDofs dofs{.own = std::vector<bool>(m->nv, false)};
  std::vector<int> joints;
  for (size_t i = 0; i < limb.joints.size(); ++i) {
    const int joint = FindId(m, mjOBJ_JOINT, robot.prefix + limb.joints[i]);
    const int actuator = FindId(m, mjOBJ_ACTUATOR, robot.prefix + limb.actuators[i]);
    if (joint < 0 || actuator < 0) continue;
    const int dof = m->jnt_dofadr[joint];
    dofs.own[dof] = true;
    dofs.group[dof] = m->actuator_group[actuator];
    joints.push_back(joint);
  }
  for (const JointFollower& follower : FollowersOf(m, joints)) {
    const int dof = m->jnt_dofadr[follower.joint];
    dofs.own[dof] = true;
    dofs.group[dof] = dofs.group.at(m->jnt_dofadr[joints[follower.leader]]);
  }
  return dofs;
}

// Returns the degrees of freedom that an actuator acts on.
std::vector<int> DofsOf(const mjModel* m, const mjData* data, int actuator) {
  std::vector<int> dofs;
  const int first = m->actuator_outadr[actuator], end = first + m->actuator_outnum[actuator];
  for (int output = first; output < end; ++output) {
    const int row = data->moment_rowadr[output];
    for (int i = row; i < row + data->moment_rownnz[output]; ++i) {
      if (data->actuator_moment[i] != 0) dofs.push_back(data->moment_colind[i]);
    }
  }
  return dofs;
}

std::string JointOf(const mjModel* m, int dof) {
  return ElementName(m, mjOBJ_JOINT, m->dof_jntid[dof]);
}

void SwitchBesides(mjSpec* spec, mjModel* m, const mjData* data, const RobotLimbs& robot,
                   const Limb& limb, const std::set<int>& assigned, CompileLog& log) {
  const LimbDofs limb_dofs = FindDofs(m, robot, limb);
  for (int a = 0; a < m->nactuator; ++a) {
    if (assigned.contains(a) || ActuatorForceKind(m, a) == CtrlMode::kTorque) continue;
    const std::vector<int> dofs = DofsOf(m, data, a);
    const auto is_own = [&](int dof) { return bool(limb_dofs.own[dof]); };
    const auto inside = std::find_if(dofs.begin(), dofs.end(), is_own);
    if (inside == dofs.end()) continue;
    const auto outside = std::find_if_not(dofs.begin(), dofs.end(), is_own);
    if (outside != dofs.end()) {
      log.Note(robot.place,
               fmt::format("actuator '{}' acts on joint '{}' of arm '{}' and also on '{}', so that "
                           "it stays on in all control modes of the arm",
                           ElementName(m, mjOBJ_ACTUATOR, a), JointOf(m, *inside), limb.name,
                           JointOf(m, *outside)));
      continue;
    }
    m->actuator_group[a] = limb_dofs.group.at(*inside);
    const std::string name = ElementName(m, mjOBJ_ACTUATOR, a);
    if (mjsElement* element = FindSpecElement(spec, mjOBJ_ACTUATOR, name))
      mjs_asActuator(element)->group = m->actuator_group[a];
  }
}

// --- Gains ---------------------------------------------------------------------------------------

class VelocityGains {
 public:
  VelocityGains(const mjModel* m, int home_key) : m_(m), home_key_(home_key) {}

  // Returns the gain of the velocity servo on the joint of an authored actuator, with its gear: the
  // joint is braked with the gear squared times this, N m s/rad or N s/m.
  double Beside(int authored) {
    const double stiffness = -m_->actuator_biasprm[mjNBIAS * authored + 1];
    const double gear = std::abs(Gear(m_, authored));
    const double braking =
        -m_->actuator_biasprm[mjNBIAS * authored + 2] + PairBraking(authored) / (gear * gear);
    if (braking > 0) return braking;
    const int dof = m_->jnt_dofadr[m_->actuator_trnid[2 * authored]];
    if (stiffness > 0) return 2 * std::sqrt(stiffness / m_->dof_invweight0[dof]) / gear;
    return InertiaAtHome(dof) / (kVelocityTime * gear * gear);
  }

 private:
  // Returns how the velocity servos on the joint of a position servo brake it (PD pairs), N m s/rad
  // or N s/m.
  double PairBraking(int authored) const {
    if (ActuatorKind(m_, authored) != CtrlMode::kPosition) return 0;
    const int joint = m_->actuator_trnid[2 * authored];
    double braking = 0;
    for (int a = 0; a < m_->nactuator; ++a) {
      if (!ActsOnJoint(m_, a) || m_->actuator_trnid[2 * a] != joint) continue;
      // Those that were added share their gains with this one and are not filled in yet.
      if (m_->actuator_group[a] != m_->actuator_group[authored]) continue;
      if (ActuatorKind(m_, a) != CtrlMode::kVelocity) continue;
      braking += Gear(m_, a) * Gear(m_, a) * m_->actuator_gainprm[mjNGAIN * a];
    }
    return braking;
  }

  double InertiaAtHome(int dof) {
    if (!data_) data_ = DataAtHome();
    return data_->M[m_->M_rowadr[dof] + m_->M_rownnz[dof] - 1];  // the diagonal is last in a row
  }

  DataPtr DataAtHome() const {
    DataPtr data = MakeData(m_);
    Guarded("gains of velocity servos", data.get(), [&] {
      if (home_key_ >= 0) mj_resetDataKeyframe(m_, data.get(), home_key_);
      mj_fwdPosition(m_, data.get());
    });
    return data;
  }

  const mjModel* m_;
  int home_key_;
  DataPtr data_;  // made on demand: few arms have motors
};

void ReportTooMany(const RobotLimbs& robot, int needed, int left, CompileLog& log) {
  const std::string message =
      fmt::format("its arms need {} actuator groups for their control modes and {} of {} are left",
                  needed, left, kLastActuatorGroup);
  if (robot.declared) {
    log.Problem(robot.place, message + "; declare fewer control_modes", "control_modes");
  } else {
    log.Note(robot.place, message +
                              ", so they cannot be switched. Set control_modes of robots that "
                              "need no torque to [position]");
  }
}

}  // namespace

std::string ModeActuatorName(const std::string& joint, CtrlMode mode) {
  return joint + "_" + ToString(mode);
}

std::optional<CtrlMode> NativeMode(const mjModel* m, const std::vector<std::string>& actuators) {
  std::vector<std::optional<CtrlMode>> kinds;
  for (const std::string& name : actuators) {
    const int id = FindId(m, mjOBJ_ACTUATOR, name);
    const bool acts = id >= 0 && (ActsOnJoint(m, id) || m->actuator_trntype[id] == mjTRN_TENDON);
    kinds.push_back(acts ? ActuatorKind(m, id) : std::nullopt);
  }
  return KindOfAll(kinds);
}

std::vector<std::string> ArmActuators(const MoveGroupConfig& arm, const mjSpec* spec) {
  if (!arm.actuators.empty()) return arm.actuators.names;
  std::vector<std::string> actuators = FindArmDrive(arm.joints.names, JointActuators(spec)).names;
  std::erase(actuators, "");
  return actuators;
}

std::vector<Limb> ConfiguredLimbs(const RobotConfig& config, const mjSpec* spec) {
  std::vector<Limb> limbs;
  for (const auto& [name, group] : config.move_groups.entries()) {
    if (group->kind != MoveGroupKind::kArm || group->joints.empty()) continue;
    Limb limb{.name = name, .joints = group->joints.names, .actuators = ArmActuators(*group, spec)};
    if (const ControlKind* control = config.control.find(name)) limb.initial = ModeOf(*control);
    if (limb.actuators.size() == limb.joints.size()) limbs.push_back(std::move(limb));
  }
  return limbs;
}

std::vector<Limb> SerialLimbs(mjSpec* spec, bool declared) {
  std::vector<Limb> limbs;
  std::set<std::string> driven;
  for (const CtrlMode kind : {CtrlMode::kPosition, CtrlMode::kVelocity, CtrlMode::kTorque}) {
    if (kind != CtrlMode::kPosition && !declared) break;
    ByJoint actuators = ActuatorsByJoint(spec, kind);
    std::erase_if(actuators, [&](const auto& entry) { return driven.contains(entry.first); });
    for (const auto& [joint, name] : actuators) driven.insert(joint);
    for (Limb& limb : SerialStretches(kind, std::move(actuators)).Find(WorldBody(spec))) {
      limb.may_end_in_finger = limb.joints.size() > 2;  // a single joint would not be an arm
      limbs.push_back(std::move(limb));
    }
  }
  return limbs;
}

std::vector<Limb> AddModeActuators(const RobotSpec& robot, std::vector<Limb> limbs,
                                   const std::string& place, mjSpec* spec, CompileLog& log) {
  std::vector<Limb> switched;
  std::set<CtrlMode> had = {CtrlMode::kPosition};  // checked where it is requested
  for (Limb& limb : limbs) {
    const auto native = NativeMode(spec, limb);
    if (!native) continue;
    limb.native = *native;
    AddModes(robot, place, spec, limb);
    ValidateInitialMode(place, limb, log);
    had.insert(limb.modes.begin(), limb.modes.end());
    if (limb.modes.size() > 1) switched.push_back(std::move(limb));
  }
  WarnOfMissingModes(robot, had, place, log);
  return switched;
}

void AssignActuatorGroups(mjSpec* spec, const std::vector<RobotLimbs>& robots, CompileLog& log) {
  GroupNumbers groups(spec, robots);
  int spare = groups.left();
  for (const RobotLimbs& robot : robots) spare -= GroupsNeeded(robot);
  for (const RobotLimbs& robot : robots) {
    const int needed = GroupsNeeded(robot);
    if (needed > groups.left()) {
      ReportTooMany(robot, needed, groups.left(), log);
      continue;
    }
    for (const Limb& limb : robot.limbs) {
      const auto more = static_cast<int>(limb.modes.size());
      const bool last_apart = limb.may_end_in_finger && more <= spare;
      if (last_apart) spare -= more;
      for (const CtrlMode mode : limb.modes) {
        std::vector<std::string> actuators = ActuatorsOf(robot, limb, mode);
        const bool enabled = mode == limb.initial;
        if (last_apart) {
          groups.Assign({actuators.back()}, enabled);
          actuators.pop_back();
        }
        groups.Assign(actuators, enabled);
      }
    }
  }
}

void SwitchBesides(mjSpec* spec, mjModel* m, const mjData* data,
                   const std::vector<RobotLimbs>& robots, CompileLog& log) {
  std::set<int> assigned;
  for (const RobotLimbs& robot : robots) {
    for (const Limb& limb : robot.limbs) {
      for (const CtrlMode mode : limb.modes) {
        for (const std::string& name : ActuatorsOf(robot, limb, mode))
          assigned.insert(FindId(m, mjOBJ_ACTUATOR, name));
      }
    }
  }
  for (const RobotLimbs& robot : robots) {
    for (const Limb& limb : robot.limbs) {
      if (limb.modes.size() > 1) SwitchBesides(spec, m, data, robot, limb, assigned, log);
    }
  }
}

void FillVelocityGains(mjModel* m, int home_key, const std::vector<RobotLimbs>& robots) {
  VelocityGains gains(m, home_key);
  for (const RobotLimbs& robot : robots) {
    for (const Limb& limb : robot.limbs) {
      if (!Has(limb, CtrlMode::kVelocity) || limb.native == CtrlMode::kVelocity) continue;
      for (size_t i = 0; i < limb.joints.size(); ++i) {
        const int authored = FindId(m, mjOBJ_ACTUATOR, robot.prefix + limb.actuators[i]);
        const int added =
            FindId(m, mjOBJ_ACTUATOR,
                   robot.prefix + ModeActuatorName(limb.joints[i], CtrlMode::kVelocity));
        if (authored < 0 || added < 0) continue;
        const double gain = gains.Beside(authored);
        m->actuator_gainprm[mjNGAIN * added] = gain;
        m->actuator_biasprm[mjNBIAS * added + 2] = -gain;
      }
    }
  }
}

}  // namespace robocell::internal
