#include "robocell/scene/servo_stability.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/actuator_kind.h"

namespace robocell::internal {
namespace {

constexpr double kUsualStiffness = 1e6;  // N/m or N m/rad; stiffer servos are typing errors

class StabilityAnalysis {
 public:
  StabilityAnalysis(const mjModel* model, std::string_view prefix) : m_(model), prefix_(prefix) {}

  std::vector<UnstableServo> Run(int base) const {
    std::vector<UnstableServo> out;
    for (int a = 0; a < m_->nactuator; ++a) {
      if (ActuatorForceKind(m_, a) != CtrlMode::kPosition) continue;
      const std::optional<Load> load = LoadOf(a, base);
      if (!load || load->moved <= 0) continue;
      if (auto servo = Judge(a, *load)) out.push_back(std::move(*servo));
    }
    return out;
  }

  std::vector<std::string> Springs(int base) const {
    std::vector<std::string> out;
    for (int joint = 0; joint < m_->njnt; ++joint) {
      const double stiffness = m_->jnt_stiffness[joint];
      if (stiffness <= 0) continue;
      if (const auto load = LoadOfJoint(joint, base)) JudgeSpring(*load, stiffness, out);
    }
    for (int tendon = 0; tendon < m_->ntendon; ++tendon) {
      const double stiffness = m_->tendon_stiffness[tendon];
      if (stiffness <= 0) continue;
      if (const auto load = LoadOfTendon(tendon, base)) JudgeSpring(*load, stiffness, out);
    }
    return out;
  }

 private:
  // The load of an actuator, along its joint or tendon.
  struct Load {
    std::string what, unit;  // "joint 'hip'", "kg m2"
    std::string joint;       // whose armature would help; "" for several
    double moved = 0;        // kg m2 or kg
    double damping = 0;      // damping of joints and tendon
  };

  std::string Own(mjtObj kind, int id) const {
    const std::string name = ElementName(m_, kind, id);
    return name.starts_with(prefix_) ? name.substr(prefix_.size()) : name;
  }

  std::optional<Load> LoadOf(int actuator, int base) const {
    const int id = m_->actuator_trnid[2 * actuator];
    if (ActsOnJoint(m_, actuator)) return LoadOfJoint(id, base);
    if (m_->actuator_trntype[actuator] == mjTRN_TENDON) return LoadOfTendon(id, base);
    return std::nullopt;
  }

  std::optional<Load> LoadOfJoint(int joint, int base) const {
    const int type = m_->jnt_type[joint];
    if (!IsInSubtree(m_, m_->jnt_bodyid[joint], base)) return std::nullopt;
    if (type != mjJNT_HINGE && type != mjJNT_SLIDE) return std::nullopt;
    const std::string name = Own(mjOBJ_JOINT, joint);
    const int dof = m_->jnt_dofadr[joint];
    return Load{.what = "joint '" + name + "'",
                .unit = type == mjJNT_HINGE ? "kg m2" : "kg",
                .joint = name,
                .moved = m_->dof_M0[dof],
                .damping = m_->dof_damping[dof]};
  }

  // A fixed tendon of joints of one kind, as in a gripper.
  std::optional<Load> LoadOfTendon(int tendon, int base) const {
    if (m_->tendon_invweight0[tendon] <= 0) return std::nullopt;
    const double moved = 1 / m_->tendon_invweight0[tendon];
    int type = -1;
    double damping = m_->tendon_damping[tendon];
    const int first = m_->tendon_adr[tendon];
    for (int w = first; w < first + m_->tendon_num[tendon]; ++w) {
      if (m_->wrap_type[w] != mjWRAP_JOINT) return std::nullopt;
      const int joint = m_->wrap_objid[w];
      if (!IsInSubtree(m_, m_->jnt_bodyid[joint], base)) return std::nullopt;
      if (type >= 0 && m_->jnt_type[joint] != type) return std::nullopt;
      type = m_->jnt_type[joint];
      const int dof = m_->jnt_dofadr[joint];  // degree of freedom that the tendon turns
      const double speed = m_->wrap_prm[w] * moved / m_->dof_M0[dof];
      damping += m_->dof_damping[dof] * speed * speed;
    }
    if (type < 0) return std::nullopt;
    return Load{.what = "tendon '" + Own(mjOBJ_TENDON, tendon) + "'",
                .unit = type == mjJNT_HINGE ? "kg m2" : "kg",
                .joint = "",
                .moved = moved,
                .damping = damping};
  }

  // Returns the damping of the servo itself, as far as the integrator takes it implicitly.
  double ServoDamping(int actuator) const {
    const double gear = Gear(m_, actuator);
    const bool implicit =
        m_->opt.integrator == mjINT_IMPLICIT || m_->opt.integrator == mjINT_IMPLICITFAST;
    const double servo = -m_->actuator_biasprm[mjNBIAS * actuator + 2] * gear * gear;
    return implicit ? std::max(servo, 0.0) : 0;
  }

  // Applies to force = gain * ctrl + ... - k * length, whatever the other terms are.
  std::optional<UnstableServo> Judge(int actuator, const Load& load) const {
    const double gear = Gear(m_, actuator), dt = m_->opt.timestep;
    const double gain = -m_->actuator_biasprm[mjNBIAS * actuator + 1];
    const double stiffness = gain * gear * gear;
    const double damping = load.damping + ServoDamping(actuator);
    const double most = (4 * load.moved + 2 * dt * damping) / (dt * dt);
    if (stiffness <= most) return std::nullopt;
    const std::string name = Own(mjOBJ_ACTUATOR, actuator);
    const double limit = most / (gear * gear);
    const std::string lower =
        fmt::format("edits: [{{actuator: '{}', kp: {}}}]", name, RoundedGain(limit / 10));
    UnstableServo out{.actuator = actuator, .gain = gain, .limit = limit};
    out.too_high = fmt::format(
        "the gain {:.3g} of servo '{}' is too high for {}, which moves {:.3g} {}: with "
        "a timestep of {:g} s it blows up from {:.3g} on",
        gain, name, load.what, load.moved, load.unit, dt, limit);
    if (stiffness > kUsualStiffness || load.joint.empty()) {
      out.remedy = "Give it a lower one: " + lower;
    } else {
      out.remedy = fmt::format(
          "Are the masses and inertias that the joint moves right? If so, give it the inertia of "
          "its rotor, edits: [{{joint: '{}', armature: {}}}], or the servo a lower gain: {}",
          load.joint, RoundedGain(2.5 * stiffness * dt * dt), lower);
    }
    return out;
  }

  void JudgeSpring(const Load& load, double stiffness, std::vector<std::string>& out) const {
    const double dt = m_->opt.timestep;
    const double most = (4 * load.moved + 2 * dt * load.damping) / (dt * dt);
    if (load.moved <= 0 || stiffness <= most) return;
    out.push_back(fmt::format(
        "the stiffness {:.3g} of {} is too high for the {:.3g} {} that it moves: with a timestep "
        "of "
        "{:g} s it blows up from {:.3g} on. Give it a lower one in its model, stiffness=\"{}\"",
        stiffness, load.what, load.moved, load.unit, dt, most, RoundedGain(most / 10)));
  }

  const mjModel* m_;
  std::string_view prefix_;
};

}  // namespace

std::vector<UnstableServo> UnstableServos(const mjModel* model, int base_body,
                                          std::string_view prefix) {
  return StabilityAnalysis(model, prefix).Run(base_body);
}

std::vector<std::string> UnstableSprings(const mjModel* model, int base_body,
                                         std::string_view prefix) {
  return StabilityAnalysis(model, prefix).Springs(base_body);
}

std::string RoundedGain(double value) {
  const double digit = std::pow(10, std::floor(std::log10(value)));
  return fmt::format("{:g}", std::floor(value / digit) * digit);
}

}  // namespace robocell::internal
