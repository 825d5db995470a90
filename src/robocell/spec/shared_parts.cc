#include "robocell/spec/shared_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "robocell/base/suggestions.h"

namespace robocell::internal {
namespace {

using Names = std::vector<std::string>;

size_t PlaceIn(const Names& names, const std::string& name) {
  return static_cast<size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

Names InBoth(const Names& early, const Names& late) {
  Names both;
  for (const std::string& name : late) {
    if (PlaceIn(early, name) < early.size()) both.push_back(name);
  }
  return both;
}

std::string Field(const GroupParts& group, const char* list, const Names& names,
                  const std::string& first) {
  return fmt::format("move_groups.{}.{}[{}]", group.name, list, PlaceIn(names, first));
}

std::string Group(const GroupParts& group, bool by_joints) {
  return "move_groups." + group.name + (by_joints ? " (it drives its joints)" : "");
}

std::string Say(const char* kind, const Names& shared, const char* how, const std::string& early,
                const std::string& late, const std::string& why) {
  const bool one = shared.size() == 1;
  return fmt::format("{} {} {} {} by {} and {}{}; leave {} out of one", kind,
                     one ? "'" + shared[0] + "'" : ListNames(shared), one ? "is" : "are", how,
                     early, late, why, one ? "it" : "them");
}

std::optional<SharedParts> SharedActuators(const GroupParts& early, const GroupParts& late) {
  const Names shared = InBoth(early.actuators, late.actuators);
  if (shared.empty() || !(early.names_actuators || late.names_actuators)) return std::nullopt;
  const GroupParts& names = late.names_actuators ? late : early;
  return SharedParts{
      Field(names, "actuators", names.actuators, shared[0]),
      Say(shared.size() == 1 ? "actuator" : "actuators", shared, "commanded",
          Group(early, !early.names_actuators), Group(late, !late.names_actuators), "")};
}

std::optional<SharedParts> SharedJoints(const GroupParts& early, const GroupParts& late) {
  const Names shared = InBoth(early.joints, late.joints);
  if (shared.empty() || early.actuators.empty() || late.actuators.empty()) return std::nullopt;
  return SharedParts{Field(late, "joints", late.joints, shared[0]),
                     Say(shared.size() == 1 ? "joint" : "joints", shared, "listed",
                         Group(early, false), Group(late, false), ", which both have actuators")};
}

}  // namespace

std::vector<SharedParts> FindSharedParts(const std::vector<GroupParts>& groups) {
  std::vector<SharedParts> found;
  for (size_t i = 0; i < groups.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      auto shared = SharedActuators(groups[j], groups[i]);
      if (!shared) shared = SharedJoints(groups[j], groups[i]);
      if (shared) found.push_back(std::move(*shared));
    }
  }
  return found;
}

}  // namespace robocell::internal
