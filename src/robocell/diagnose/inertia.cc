// Finds masses and inertias that no rigid body has, and servos that are too stiff for their load
// (servo_stability.h): the simulation diverges with them, but the first visible symptom is another
// one (fingers that never come to rest).
//
// A body of mass m and at most kLongest metres long, of the densest metal, is thinnest as a rod:
// about its axis it has the inertia m^2 / (2 pi density length). A body whose mass lies within
// kWidest metres has at most the inertia m * kWidest^2.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "robocell/base/units.h"
#include "robocell/diagnose/checks.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/compile_problem.h"
#include "robocell/scene/servo_stability.h"

namespace robocell::internal {
namespace {

constexpr double kDensest = 22600;   // kg/m^3, osmium
constexpr double kLongest = 2;       // metres
constexpr double kWidest = 5;        // metres
constexpr double kLeastShare = 0.1;  // of the least inertia: files round

class InertiaCheck {
 public:
  InertiaCheck(const CompiledRobot& robot, Findings& findings)
      : m_(robot.model), robot_(robot.robot), part_(robot.part), findings_(findings) {}

  void Run() {
    const int base = FindId(m_, mjOBJ_BODY, robot_.base_body);
    if (base < 0) return;
    for (int body = base; body < m_->nbody; ++body) {
      if (IsInSubtree(m_, body, base) && m_->body_weldid[body] != 0) CheckBody(body);
    }
    LookAtGains(UnstableServos(m_, base, robot_.prefix));
    for (const std::string& spring : UnstableSprings(m_, base, robot_.prefix))
      findings_.WarnAt(part_.file, spring);
  }

 private:
  std::string Own(mjtObj kind, int id) const {
    const std::string name = ElementName(m_, kind, id);
    return name.starts_with(robot_.prefix) ? name.substr(robot_.prefix.size()) : name;
  }

  void CheckBody(int body) {
    const double mass = m_->body_mass[body];
    const mjtNum* inertia = m_->body_inertia + 3 * static_cast<ptrdiff_t>(body);
    if (mass <= 0 || m_->body_dofnum[body] == 0) return;  // counts with the body it is fixed to
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

  // The problem of a part that is too large is its size (scale.cc).
  bool IsWide(int body) const {
    const int first = m_->body_geomadr[body];
    for (int g = first; g >= 0 && g < first + m_->body_geomnum[body]; ++g) {
      if (m_->geom_rbound[g] > kWidest) return true;
    }
    return false;
  }

  // Rotors may be the only load of the joints of a light part.
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
    findings_.WarnAt(
        part_.file,
        fmt::format("the inertia {:.3g} kg m2 of body '{}' {}: {}. Correct its <inertial> "
                    "(kg and kg m2, not g or mm), or leave it out, so that its geoms give "
                    "it{}",
                    inertia, name, what, bound, armature));
  }

  // All servos with the robot file's `stiffness` give one finding, at that field.
  void LookAtGains(const std::vector<UnstableServo>& unstable) {
    const std::optional<double>& stiffness = robot_.config.stiffness;
    const UnstableServo* weakest = nullptr;
    for (const UnstableServo& servo : unstable) {
      if (stiffness && servo.gain == *stiffness) {
        if (!weakest || servo.limit < weakest->limit) weakest = &servo;
        continue;
      }
      findings_.WarnAt(PlaceInModel(part_, mjOBJ_ACTUATOR, Own(mjOBJ_ACTUATOR, servo.actuator)),
                       servo.text());
    }
    if (!weakest) return;
    findings_.Warn("stiffness", fmt::format("stiffness: {}. Write a lower one: `stiffness: {}`",
                                            weakest->too_high, RoundedGain(weakest->limit / 10)));
  }

  static constexpr double kLeastArmature = 1e-4;

  const mjModel* m_;
  const RobotRecord& robot_;
  const Part& part_;
  Findings& findings_;
};

}  // namespace

void CheckInertia(const CompiledRobot& robot, Findings& findings) {
  InertiaCheck(robot, findings).Run();
}

}  // namespace robocell::internal
