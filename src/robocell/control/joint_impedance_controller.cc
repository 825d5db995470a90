#include "robocell/control/joint_impedance_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/kinematics/link_answer.h"
#include "robocell/robot/joint_torque_controller.h"

namespace robocell {
namespace {

// The default stiffness: joints swing at this frequency, rad/s; light ones faster, so that they are
// no softer than a share of the strongest, but not faster than control at usual rates can damp.
constexpr double kFrequency = 2 * M_PI * 3, kLeastShare = 0.1, kFastest = 100;

[[maybe_unused]] const bool kJointImpedanceRegistered = [] {
  RegisterController(
      "joint_impedance",
      [](MoveGroup& group) -> std::unique_ptr<Controller> {
        return std::make_unique<JointImpedanceController>(
            internal::RequireArm(group, "joint_impedance"));
      },
      CtrlMode::kTorque);
  return true;
}();

}  // namespace

std::vector<double> MiddleInertia(const Chain& chain) {
  JointVector middle(chain.n_joints());
  for (int i = 0; i < middle.size(); ++i) {
    const ChainJoint& joint = chain.joints()[i];
    const bool bounded = std::isfinite(joint.lower) && std::isfinite(joint.upper);
    middle[i] = bounded ? (joint.lower + joint.upper) / 2 : 0;
  }
  Eigen::MatrixXd mass(chain.n_joints(), chain.n_joints());
  chain.MassMatrix(middle, mass);
  std::vector<double> inertia;
  for (int i = 0; i < chain.n_joints(); ++i) inertia.push_back(mass(i, i));
  return inertia;
}

std::vector<double> PositiveGains(std::string_view place, std::string_view what,
                                  std::span<const double> values, int expected) {
  if (values.size() != 1 && values.size() != static_cast<size_t>(expected)) {
    throw ArgumentError(fmt::format("{}: {} has {}; give {}", place, what,
                                    Counted(std::ssize(values), "value"),
                                    expected == 1 ? "1" : fmt::format("1 or {}", expected)));
  }
  for (const double value : values) {
    if (std::isfinite(value) && value >= 0) continue;
    throw ArgumentError(
        fmt::format("{}: {} cannot be {}; it must be 0 or more, and finite", place, what, value));
  }
  if (values.size() == 1) return std::vector<double>(static_cast<size_t>(expected), values[0]);
  return {values.begin(), values.end()};
}

JointImpedanceController::JointImpedanceController(ArmGroup& arm)
    : arm_(arm),
      inertia_(MiddleInertia(arm.chain())),
      damping_(arm.nv()),
      target_(arm.joint_pos()) {
  const double least = kLeastShare * *std::max_element(inertia_.begin(), inertia_.end());
  for (const double inertia : inertia_) {
    stiffness_.push_back(std::min(std::max(inertia, least) * kFrequency * kFrequency,
                                  inertia * kFastest * kFastest));
  }
  ComputeDamping();
}

void JointImpedanceController::SetTarget(std::span<const double> q) {
  RequireValues([&] { return arm_.place(); }, "joint", q, target_size(), arm_.joint_names());
  std::copy(q.begin(), q.end(), target_.begin());
}

void JointImpedanceController::SetStiffness(std::span<const double> stiffness) {
  stiffness_ = PositiveGains(arm_.place(), "stiffness", stiffness, arm_.nv());
  ComputeDamping();
}

void JointImpedanceController::SetDampingRatio(double ratio) {
  damping_ratio_ = PositiveGains(arm_.place(), "damping_ratio", {&ratio, 1}, 1)[0];
  ComputeDamping();
}

void JointImpedanceController::ComputeDamping() {
  for (size_t i = 0; i < damping_.size(); ++i)
    damping_[i] = 2 * damping_ratio_ * std::sqrt(stiffness_[i] * inertia_[i]);
}

// The controller compensates gravity itself.
bool JointImpedanceController::GetSteadyTarget(std::span<const double> q, std::span<const double> v,
                                               std::span<const double> /*gravity*/,
                                               std::span<const double> resistance,
                                               std::span<double> out) const {
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = q[i] + (damping_[i] * v[i] + resistance[i]) / stiffness_[i];
  return std::all_of(out.begin(), out.end(), [](double x) { return std::isfinite(x); });
}

void JointImpedanceController::Compute(std::span<double> ctrl) {
  double q[kMaxChainJoints], qd[kMaxChainJoints];
  const size_t n = target_.size();
  arm_.GetJointPos({q, n});
  arm_.GetJointVel({qd, n});
  const Eigen::Vector3d gravity = arm_.gravity_in_base();
  internal::LinkAnswer links;
  internal::ComputeChain(arm_.chain(), internal::LinkPart::kMotion,
                         {.q = q, .qd = qd, .gravity = gravity.data()},
                         &links);  // gravity and Coriolis
  double* torque = links.torques;
  for (size_t i = 0; i < n; ++i)
    torque[i] += stiffness_[i] * (target_[i] - q[i]) - damping_[i] * qd[i];
  arm_.CtrlForJointTorque({torque, n}, ctrl);
}

}  // namespace robocell
