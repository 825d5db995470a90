// Masses and inertias that no rigid body has, and servos that are too stiff for what they move: the
// simulation blows up with them, and what is noticed first is something else (fingers that never
// come to rest).
//
// A body of mass m and no more than kLongest metres long, of the densest metal, is thinnest as a
// rod: about its axis it has the inertia m^2 / (2 pi density length). A body whose mass lies within
// kWidest metres has at most the inertia m * kWidest^2.
//
// A servo of stiffness k and damping c on a joint that moves the inertia M, integrated in steps dt
// with implicit damping, is stable while k dt^2 < 4 M + 2 c dt: from there on it overshoots more
// with every step.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "robocell/base/units.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/actuator_kind.h"
#include "robocell/scene/check_robot.h"
#include "robocell/scene/compile_problem.h"

namespace robocell {
namespace {

constexpr double kDensest = 22600;       // kg/m^3, osmium
constexpr double kLongest = 2;           // metres
constexpr double kWidest = 5;            // metres
constexpr double kLeastShare = 0.1;      // of the least inertia: files round
constexpr double kUsualStiffness = 1e6;  // N/m or N m/rad; stiffer servos are typing errors

class InertiaCheck {
 public:
  InertiaCheck(const mjModel* model, const RobotRecord& robot, const Part& part, Report& report)
      : m_(model), robot_(robot), part_(part), report_(report) {}

  void Run() {
    const int base = FindId(m_, mjOBJ_BODY, robot_.base_body);
    if (base < 0) return;
    for (int body = base; body < m_->nbody; ++body) {
      if (IsInSubtree(m_, body, base) && m_->body_weldid[body] != 0) CheckBody(body);
    }
    for (int a = 0; a < m_->nactuator; ++a) {
      if (!ActsOnJoint(m_, a)) continue;
      const int joint = m_->actuator_trnid[2 * a];
      if (IsInSubtree(m_, m_->jnt_bodyid[joint], base)) CheckServo(a, joint);
    }
  }

 private:
  std::string Own(mjtObj kind, int id) const {
    const std::string name = ElementName(m_, kind, id);
    return name.starts_with(robot_.prefix) ? name.substr(robot_.prefix.size()) : name;
  }

  void CheckBody(int body) {
    const double mass = m_->body_mass[body];
    const mjtNum* inertia = m_->body_inertia + 3 * static_cast<ptrdiff_t>(body);
    if (mass <= 0 || m_->body_dofnum[body] == 0) return;  // counts with what it is fixed to
    const auto [least, most] = std::minmax_element(inertia, inertia + 3);
    const double thinnest = mass * mass / (2 * kPi * kDensest * kLongest);
    if (*least < kLeastShare * thinnest && *least >= 0 && !HasArmature(body)) {
      Warn(body, *least,
           fmt::format("of {:.3g} kg even a thin rod of {:g} m has {:.2g} kg m2 about its axis",
                       mass, kLongest, thinnest),
           "is too small");
    } else if (*most > mass * kWidest * kWidest && !IsWide(body)) {
      Warn(body, *most,
           fmt::format("{:.3g} kg within {:g} m of its centre of mass have at most {:.3g} kg m2",
                       mass, kWidest, mass * kWidest * kWidest),
           "is too large");
    }
  }

  // Of a part that is too large its size is what is wrong (check_scale.cc).
  bool IsWide(int body) const {
    const int first = m_->body_geomadr[body];
    for (int g = first; g >= 0 && g < first + m_->body_geomnum[body]; ++g) {
      if (m_->geom_rbound[g] > kWidest) return true;
    }
    return false;
  }

  // Rotors may be all that the joints of a light part move.
  bool HasArmature(int body) const {
    const int first = m_->body_dofadr[body];
    for (int dof = first; dof < first + m_->body_dofnum[body]; ++dof) {
      if (m_->dof_armature[dof] < kLeastArmature) return false;
    }
    return true;
  }

  void Warn(int body, double inertia, const std::string& bound, const char* what) {
    const std::string name = Own(mjOBJ_BODY, body);
    const std::string joint = Own(mjOBJ_JOINT, m_->body_jntadr[body]);
    const std::string armature =
        inertia > 1 || m_->body_dofnum[body] > 1
            ? ""
            : fmt::format(
                  "; or let the joint have the inertia of its rotor: edits: [{{joint: '{}', "
                  "armature: 0.01}}]",
                  joint);
    report_.WarnAt(
        part_.file, part_.place,
        fmt::format("the inertia {:.3g} kg m2 of body '{}' {}: {}. Correct its <inertial> "
                    "(kg and kg m2, not g or mm), or leave it out, so that its geoms give "
                    "it{}",
                    inertia, name, what, bound, armature));
  }

  // That which the integrator takes implicitly.
  double Damping(int actuator, int dof) const {
    const double gear = Gear(m_, actuator);
    const bool implicit =
        m_->opt.integrator == mjINT_IMPLICIT || m_->opt.integrator == mjINT_IMPLICITFAST;
    const double servo = -m_->actuator_biasprm[mjNBIAS * actuator + 2] * gear * gear;
    return m_->dof_damping[dof] + (implicit ? std::max(servo, 0.0) : 0);
  }

  // Force = gain * ctrl + ... - k * length, whatever is before it.
  void CheckServo(int actuator, int joint) {
    if (ActuatorForceKind(m_, actuator) != CtrlMode::kPosition) return;
    const int type = m_->jnt_type[joint];
    if (type != mjJNT_HINGE && type != mjJNT_SLIDE) return;
    const double gear = Gear(m_, actuator);
    const double stiffness = -m_->actuator_biasprm[mjNBIAS * actuator + 1] * gear * gear;
    const int dof = m_->jnt_dofadr[joint];
    const double moved = m_->dof_M0[dof], dt = m_->opt.timestep;
    const double most = (4 * moved + 2 * dt * Damping(actuator, dof)) / (dt * dt);
    if (stiffness <= most) return;
    const std::string name = Own(mjOBJ_ACTUATOR, actuator);
    const bool hinge = type == mjJNT_HINGE;
    const char* unit = hinge ? "kg m2" : "kg";
    const double limit = most / (gear * gear);
    const std::string remedy =
        stiffness > kUsualStiffness
            ? fmt::format("Give it a lower one: edits: [{{actuator: '{}', kp: {}}}]", name,
                          Rounded(limit / 10))
            : fmt::format(
                  "Are the masses and inertias that the joint moves right? If so, give it the "
                  "inertia of its rotor, edits: [{{joint: '{}', armature: {}}}], or the servo "
                  "a lower gain: edits: [{{actuator: '{}', kp: {}}}]",
                  Own(mjOBJ_JOINT, joint), Rounded(2.5 * stiffness * dt * dt), name,
                  Rounded(limit / 10));
    report_.WarnAt(
        PlaceInModel(part_, mjOBJ_ACTUATOR, name), part_.place,
        fmt::format("the gain {:.3g} of servo '{}' is too high for joint '{}', which moves "
                    "{:.3g} {}: with a timestep of {:g} s it blows up from {:.3g} on. {}",
                    -m_->actuator_biasprm[mjNBIAS * actuator + 1], name, Own(mjOBJ_JOINT, joint),
                    moved, unit, dt, limit, remedy));
  }

  // Down to one digit: "2000", "0.05".
  static std::string Rounded(double value) {
    const double digit = std::pow(10, std::floor(std::log10(value)));
    return fmt::format("{:g}", std::floor(value / digit) * digit);
  }

  static constexpr double kLeastArmature = 1e-4;

  const mjModel* m_;
  const RobotRecord& robot_;
  const Part& part_;
  Report& report_;
};

}  // namespace

void CheckInertia(const mjModel* model, const RobotRecord& robot, const Part& part,
                  Report& report) {
  InertiaCheck(model, robot, part, report).Run();
}

}  // namespace robocell
