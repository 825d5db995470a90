#include "robocell/robot/controller.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/registry.h"
#include "robocell/robot/base_pose_controller.h"
#include "robocell/robot/joint_position_controller.h"
#include "robocell/robot/joint_torque_controller.h"
#include "robocell/robot/joint_velocity_controller.h"
#include "robocell/robot/wheeled_base.h"
#include "robocell/spec/group_controls.h"

namespace robocell {
namespace {

struct ControllerKind {
  ControllerFactory factory;
  CtrlMode mode = CtrlMode::kPosition;
};

Registry<ControllerKind>& RegisteredControllers() {
  static Registry<ControllerKind> registry(
      "controller",
      {{"base_pose", {internal::MakeBasePoseController}},
       {"joint_position", {MakeJointPositionController}},
       {"joint_velocity", {internal::MakeJointVelocityController, CtrlMode::kVelocity}},
       {"joint_torque", {internal::MakeJointTorqueController, CtrlMode::kTorque}},
       {"unicycle", {internal::MakeUnicycleController}}});
  return registry;
}

}  // namespace

const char* Describe(TargetKind kind) {
  switch (kind) {
    case TargetKind::kJointPositions:
      return "joint positions";
    case TargetKind::kJointSteps:
      return "steps of the joints";
    case TargetKind::kOpening:
      return "an opening";
    case TargetKind::kJointVelocities:
      return "joint velocities";
    case TargetKind::kJointTorques:
      return "joint torques";
    case TargetKind::kPose:
      return "a pose";
    case TargetKind::kTwist:
      return "a twist";
    case TargetKind::kBasePose:
      return "a pose of the base in the world";
  }
  return "?";
}

void ThrowBadValues(std::string_view place, std::string_view what, std::span<const double> values,
                    int expected, const std::vector<std::string>& names) {
  if (values.size() != static_cast<size_t>(expected)) {
    throw ArgumentError(fmt::format("{}: expected {} {} value{}, got {}", place, expected, what,
                                    expected == 1 ? "" : "s", values.size()));
  }
  size_t bad = 0;
  while (bad + 1 < values.size() && std::isfinite(values[bad])) ++bad;
  const bool named = names.size() == values.size();
  if (!named && values.size() > 1) {
    throw ArgumentError(fmt::format("{}: value {} of the {} is {}; all values must be finite",
                                    place, bad, what, values[bad]));
  }
  const std::string name = "'" + (named ? names[bad] : std::string(what)) + "'";
  throw ArgumentError(
      fmt::format("{}: the target of {} is {}; targets must be finite", place, name, values[bad]));
}

void RegisterController(const std::string& kind, ControllerFactory factory, CtrlMode mode) {
  if (!factory) throw ArgumentError("controller '" + kind + "' needs a function that makes it");
  RegisteredControllers().Register(kind, {std::move(factory), mode}, false);
}

void RequireControllable(const MoveGroup& group, const std::string& kind,
                         const std::string& place) {
  const std::string why = internal::WhyNotControlledBy(group.kind(), kind);
  if (!why.empty()) throw ArgumentError(place + ": " + why);
}

std::unique_ptr<Controller> MakeController(const std::string& kind, MoveGroup& group) {
  RequireControllable(group, kind, group.place());
  return RegisteredControllers().Find(kind, group.place()).factory(group);
}

CtrlMode ControllerMode(const std::string& kind, const std::string& place) {
  return RegisteredControllers().Find(kind, place).mode;
}

std::vector<std::string> ControllerKinds() { return RegisteredControllers().names(); }

}  // namespace robocell
