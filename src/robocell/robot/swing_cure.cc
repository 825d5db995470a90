#include "robocell/robot/swing_cure.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/mujoco/step.h"
#include "robocell/scene/actuator_kind.h"

namespace robocell::internal {
namespace {

constexpr const char* kContext = "trying what calms a servo";
constexpr double kSeconds = 1, kWatchedSeconds = 0.3;
constexpr double kRestSpeed = 0.05;                // rad/s or m/s
constexpr int kLeastTurns = 4;                     // changes of direction while it is watched
constexpr double kTimesteps[] = {0.5, 0.25, 0.1};  // shares of the model's
constexpr double kGains[] = {0.5, 0.2, 0.1, 0.05};
// Inertia that is added, in shares of kv * timestep + kp * timestep^2 of the joint's servo, and
// damping, in shares of the inertia that the joint moves per timestep.
constexpr double kArmatures[] = {0.25, 0.5, 1, 2, 4};
constexpr double kDampings[] = {0.02, 0.1, 0.5};

// Rounds up to two digits.
double Rounded(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::ceil(value / unit) * unit;
}

// The motion of one joint while it is watched.
struct Motion {
  double lower = 0, upper = 0, last = 0;
  int turns = 0;

  void Add(double speed) {
    if (speed * last < 0) ++turns;
    if (speed != 0) last = speed;
    lower = std::min(lower, speed);
    upper = std::max(upper, speed);
  }
  bool swings() const { return lower < -kRestSpeed && upper > kRestSpeed && turns >= kLeastTurns; }
};

std::vector<int> Swinging(const mjModel* m, const SwingTrial& trial) {
  const DataPtr data = CopyData(trial.model, trial.start);
  mjData* d = data.get();
  const int steps = static_cast<int>(std::ceil(kSeconds / m->opt.timestep));
  const int watched = static_cast<int>(std::ceil(kWatchedSeconds / m->opt.timestep));
  std::vector<Motion> motions(trial.joints.size());
  for (int k = 0; k < steps; ++k) {
    if (!Step(m, d, 1, kContext).ok()) return trial.joints;
    if (k < steps - watched) continue;
    for (size_t i = 0; i < motions.size(); ++i)
      motions[i].Add(d->qvel[m->jnt_dofadr[trial.joints[i]]]);
  }
  std::vector<int> swinging;
  for (size_t i = 0; i < motions.size(); ++i) {
    if (motions[i].swings()) swinging.push_back(trial.joints[i]);
  }
  return swinging;
}

class CureSearch {
 public:
  explicit CureSearch(const SwingTrial& trial)
      : trial_(trial), swinging_(Swinging(trial.model, trial)) {}

  SwingCure Run() {
    SwingCure cure;
    if (swinging_.empty()) return cure;
    cure.edits = EditsThatHelp();
    for (const double share : kTimesteps) {
      const ModelPtr copy = CopyModel(trial_.model);
      copy->opt.timestep = trial_.model->opt.timestep * share;
      if (!IsCalm(copy.get())) continue;
      cure.timestep = copy->opt.timestep;
      break;
    }
    return cure;
  }

 private:
  using Change = std::function<std::string(mjModel*, int joint, double share)>;

  bool IsCalm(const mjModel* m) const { return Swinging(m, trial_).empty(); }

  // Makes changes of growing size on all swinging joints until one of them helps.
  std::vector<std::string> EditsThatHelp() const {
    const auto armature = [this](mjModel* m, int joint, double share) {
      return AddArmature(m, joint, share);
    };
    const auto damping = [this](mjModel* m, int joint, double share) {
      return AddDamping(m, joint, share);
    };
    const auto gains = [this](mjModel* m, int joint, double share) {
      return LowerGains(m, joint, share);
    };
    std::vector<std::string> edits = FirstThatHelps(kArmatures, armature);
    if (edits.empty()) edits = FirstThatHelps(kDampings, damping);
    if (edits.empty()) edits = FirstThatHelps(kGains, gains);
    return edits;
  }

  std::vector<std::string> FirstThatHelps(std::span<const double> shares,
                                          const Change& change) const {
    for (const double share : shares) {
      const ModelPtr copy = CopyModel(trial_.model);
      std::vector<std::string> edits;
      for (const int joint : swinging_) {
        std::string edit = change(copy.get(), joint, share);
        if (!edit.empty()) edits.push_back(std::move(edit));
      }
      if (!edits.empty() && IsCalm(copy.get())) return edits;
    }
    return {};
  }

  std::string Own(mjtObj kind, int id) const {
    const std::string name = ElementName(trial_.model, kind, id);
    return name.starts_with(trial_.prefix) ? name.substr(trial_.prefix.size()) : name;
  }

  // Returns the position servos that act on a joint alone.
  std::vector<int> ServosOn(int joint) const {
    const mjModel* m = trial_.model;
    std::vector<int> servos;
    for (int a = 0; a < m->nactuator; ++a) {
      if (ActsOnJoint(m, a) && m->actuator_trnid[2 * a] == joint &&
          ActuatorForceKind(m, a) == CtrlMode::kPosition)
        servos.push_back(a);
    }
    return servos;
  }

  std::string AddArmature(mjModel* m, int joint, double share) const {
    double stiff = 0;  // kg m2 or kg
    for (const int a : ServosOn(joint)) {
      const double gear = Gear(m, a), dt = m->opt.timestep;
      const mjtNum* bias = m->actuator_biasprm + mjNBIAS * a;
      stiff += gear * gear * dt * (-bias[2] - bias[1] * dt);
    }
    const int dof = m->jnt_dofadr[joint];
    if (stiff <= 0) stiff = m->dof_M0[dof];
    if (stiff <= 0) return "";
    const double armature = Rounded(m->dof_armature[dof] + share * stiff);
    m->dof_M0[dof] += armature - m->dof_armature[dof];  // which the engine takes for simple bodies
    m->dof_armature[dof] = armature;
    return fmt::format("{{joint: '{}', armature: {:g}}}", Own(mjOBJ_JOINT, joint), armature);
  }

  std::string AddDamping(mjModel* m, int joint, double share) const {
    const int dof = m->jnt_dofadr[joint];
    const double more = share * m->dof_M0[dof] / m->opt.timestep;
    if (more <= 0) return "";
    const double damping = Rounded(m->dof_damping[dof] + more);
    m->dof_damping[dof] = damping;
    return fmt::format("{{joint: '{}', damping: {:g}}}", Own(mjOBJ_JOINT, joint), damping);
  }

  // Lowers the stiffness and, by the same share, the damping of the servos.
  std::string LowerGains(mjModel* m, int joint, double share) const {
    std::vector<std::string> edits;
    for (const int a : ServosOn(joint)) {
      mjtNum* bias = m->actuator_biasprm + mjNBIAS * a;
      const double kp = -bias[1], lower = Rounded(share * kp);
      m->actuator_gainprm[mjNGAIN * a] *= lower / kp;
      bias[0] *= lower / kp;
      bias[1] = -lower;
      std::string edit = fmt::format("{{actuator: '{}', kp: {:g}", Own(mjOBJ_ACTUATOR, a), lower);
      if (bias[2] < 0) {
        bias[2] = -Rounded(-share * bias[2]);
        edit += fmt::format(", kv: {:g}", -bias[2]);
      }
      edits.push_back(edit + "}");
    }
    return fmt::format("{}", fmt::join(edits, ", "));
  }

  const SwingTrial& trial_;
  const std::vector<int> swinging_;
};

}  // namespace

std::vector<int> SwingingJoints(const SwingTrial& trial) { return Swinging(trial.model, trial); }

SwingCure FindSwingCure(const SwingTrial& trial) { return CureSearch(trial).Run(); }

std::string SwingCure::Text() const {
  if (!found()) return "No armature, damping, lower gain or smaller timestep that was tried helped";
  const std::string smaller = fmt::format("a timestep of {:g} s", timestep);
  if (edits.empty()) return "In a trial " + smaller + " brought it to rest";
  return fmt::format("In a trial `edits: [{}]` brought it to rest{}", fmt::join(edits, ", "),
                     timestep > 0 ? ", and so did " + smaller : "");
}

}  // namespace robocell::internal
