// Finds masses and inertias that no rigid body has, and servos that are too stiff for their load
// (servo_stability.h): the simulation diverges with them, but the first visible symptom is another
// one (fingers that never come to rest).
//
// A body of mass m and at most kLongest metres long, of the densest metal, is thinnest as a rod:
// about its axis it has the inertia m^2 / (2 pi density length). A body whose mass lies within
// kWidest metres has at most the inertia m * kWidest^2. What is fixed together weighs at most what
// the densest metal would in the box around its geoms and joints.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>
#include <Eigen/Core>

#include "robocell/base/units.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/compile_problem.h"
#include "robocell/scene/inspection/robot_inspection.h"
#include "robocell/scene/servo_stability.h"

namespace robocell::internal {
namespace {

constexpr double kDensest = 22600;   // kg/m^3, osmium
constexpr double kLongest = 2;       // metres
constexpr double kWidest = 5;        // metres
constexpr double kLeastShare = 0.1;  // share of the least inertia: files round
constexpr double kThinnest = 0.05;   // metres; parts may be drawn smaller than they are

using Eigen::Vector3d;
using Matrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

class InertiaCheck {
 public:
  InertiaCheck(const CompiledRobot& robot, Findings& findings)
      : m_(robot.model),
        d_(robot.reference),
        robot_(robot.robot),
        part_(robot.part),
        findings_(findings) {}

  void Run() {
    const int base = FindId(m_, mjOBJ_BODY, robot_.base_body);
    if (base < 0) return;
    for (int body = base; body < m_->nbody; ++body) {
      if (!IsInSubtree(m_, body, base) || m_->body_weldid[body] == 0) continue;
      CheckBody(body);
      if (m_->body_weldid[body] == body) CheckDensity(body);
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

  // Checks what is fixed to a body, together.
  void CheckDensity(int body) {
    const Eigen::Map<const Matrix3> axes(d_->xmat + 9 * static_cast<ptrdiff_t>(body));
    const Vector3d origin(d_->xpos + 3 * static_cast<ptrdiff_t>(body));
    Vector3d low = Vector3d::Zero(), high = Vector3d::Zero();  // extent in the body's axes
    const auto take = [&](const Vector3d& at, const Vector3d& half) {
      const Vector3d middle = axes.transpose() * (at - origin);
      low = low.cwiseMin(middle - half);
      high = high.cwiseMax(middle + half);
    };
    double mass = 0;
    int heaviest = body;
    for (int b = body; b < m_->nbody; ++b) {
      const bool is_part = m_->body_weldid[b] == body;
      if (!is_part && m_->body_weldid[m_->body_parentid[b]] != body) continue;
      take(Vector3d(d_->xpos + 3 * static_cast<ptrdiff_t>(b)), Vector3d::Zero());  // a joint
      if (!is_part) continue;
      mass += m_->body_mass[b];
      if (m_->body_mass[b] > m_->body_mass[heaviest]) heaviest = b;
    }
    bool has_geoms = false;
    for (int g = 0; g < m_->ngeom; ++g) {
      if (m_->body_weldid[m_->geom_bodyid[g]] != body) continue;
      has_geoms = true;
      const Eigen::Map<const Matrix3> turn(d_->geom_xmat + 9 * static_cast<ptrdiff_t>(g));
      const mjtNum* box = m_->geom_aabb + 6 * static_cast<ptrdiff_t>(g);
      const Matrix3 in_body = axes.transpose() * turn;
      take(Vector3d(d_->geom_xpos + 3 * static_cast<ptrdiff_t>(g)) + turn * Vector3d(box),
           in_body.cwiseAbs() * Vector3d(box + 3));
    }
    const double most = kDensest * (high - low).cwiseMax(kThinnest).prod();
    if (!has_geoms || mass <= most) return;
    const std::string name = Own(mjOBJ_BODY, heaviest);
    findings_.WarnAt(
        part_.file, fmt::format("the mass {:.3g} kg of body '{}' is too large: made of the densest "
                                "metal, its rigid parts would weigh {:.2g} kg. Correct it "
                                "(kg, not g), in the model or by edits: [{{body: '{}', mass: KG}}]",
                                m_->body_mass[heaviest], name, most, name));
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
  const mjData* d_;
  const RobotRecord& robot_;
  const Part& part_;
  Findings& findings_;
};

}  // namespace

void CheckInertia(const CompiledRobot& robot, Findings& findings) {
  InertiaCheck(robot, findings).Run();
}

}  // namespace robocell::internal
