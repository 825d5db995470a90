#include "robocell/spec/group_controls.h"

#include <fmt/format.h>

#include <algorithm>

#include "robocell/base/suggestions.h"

namespace robocell::internal {
namespace {

// A controller of arms that no field of a robot file chooses.
constexpr std::string_view kDifferentialIk = "differential_ik";

bool IsBuiltIn(std::string_view controller) {
  const std::vector<std::string> names = ValueNames<ControlKind>();
  return controller == kDifferentialIk ||
         std::find(names.begin(), names.end(), controller) != names.end();
}

}  // namespace

std::vector<ControlKind> ControlsOf(MoveGroupKind group) {
  switch (group) {
    case MoveGroupKind::kArm: {
      std::vector<ControlKind> all;
      for (const auto& [kind, name] : EnumNames<ControlKind>::kNames) all.push_back(kind);
      return all;
    }
    case MoveGroupKind::kGripper:
      return {ControlKind::kJointPosition};
    case MoveGroupKind::kBase:
    case MoveGroupKind::kGeneric:
      break;
  }
  return {ControlKind::kJointPosition, ControlKind::kRelativeJointPosition};
}

const char* WithArticle(MoveGroupKind group) {
  switch (group) {
    case MoveGroupKind::kArm:
      return "an arm";
    case MoveGroupKind::kGripper:
      return "a gripper";
    case MoveGroupKind::kBase:
      return "a base";
    case MoveGroupKind::kGeneric:
      break;
  }
  return "a generic group";
}

std::string WhyNotControlledBy(MoveGroupKind group, std::string_view controller) {
  if (group == MoveGroupKind::kArm || !IsBuiltIn(controller)) return "";
  std::vector<std::string> names;
  for (const ControlKind kind : ControlsOf(group)) names.emplace_back(ToString(kind));
  if (std::find(names.begin(), names.end(), controller) != names.end()) return "";
  return fmt::format("{} cannot have the controller '{}'. It can have: {}{}", WithArticle(group),
                     controller, ListNames(names),
                     group == MoveGroupKind::kGripper ? ", which takes its opening" : "");
}

}  // namespace robocell::internal
