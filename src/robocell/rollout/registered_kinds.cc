#include "robocell/rollout/registered_kinds.h"

#include <fmt/format.h>

#include <yaml-cpp/yaml.h>

#include "robocell/base/suggestions.h"
#include "robocell/features/own_features.h"
#include "robocell/spec/scene_source_spec.h"
#include "robocell/spec/task_spec.h"

namespace robocell::internal {
namespace {

// Adds a line if the part names a kind that is not in its registry.
void AddUnknownKind(const YAML::Node& root, const char* part, const KindRegistry& registry,
                    std::vector<std::string>& lines) {
  const YAML::Node fields = root[part];
  if (!fields.IsDefined() || !fields.IsMap()) return;
  const YAML::Node kind = fields[registry.key()];
  if (!kind.IsDefined() || !kind.IsScalar() || registry.Has(kind.Scalar())) return;
  lines.push_back(fmt::format("{}.{}: {} {}", part, registry.key(),
                              NoSuchName("", registry.noun(), kind.Scalar(), registry.kinds()),
                              WhereToNameIt(registry.noun())));
}

// Names with a / and the time are features of the cell.
void AddUnknownFeatures(const YAML::Node& root, std::vector<std::string>& lines) {
  const YAML::Node features = root["features"];
  if (!features.IsDefined() || !features.IsSequence()) return;
  std::string missing_all;
  for (const YAML::Node& feature : features) {
    if (!feature.IsScalar()) continue;
    const std::string name = feature.Scalar();
    if (name.find('/') != std::string::npos || name == "time" || IsOwnFeature(name)) continue;
    const std::vector<std::string> known = OwnFeatures();
    const std::string missing = known.empty() ? "no registered feature '" + name + "'."
                                              : NoSuchName("", "registered feature", name, known);
    missing_all += missing + " ";
  }
  if (!missing_all.empty())
    lines.push_back(fmt::format("features: {}{}", missing_all, WhereToNameIt("feature")));
}

}  // namespace

std::string WhereToNameIt(const std::string& noun) {
  return fmt::format(
      "A {} of your own is in a module, and a dataset imports none by itself: name it with "
      "--import "
      "my_tasks.py on the command line, or with imports=['my_tasks.py'] in Python; a program "
      "registers it first",
      noun);
}

std::vector<std::string> UnregisteredKinds(const std::string& yaml) {
  std::vector<std::string> lines;
  try {
    const YAML::Node root = YAML::Load(yaml);
    if (!root.IsMap()) return {};
    AddUnknownKind(root, "task", TaskKindRegistry(), lines);
    AddUnknownKind(root, "scenes", SceneSourceRegistry(), lines);
    AddUnknownFeatures(root, lines);
  } catch (const YAML::Exception&) {
    return {};
  }
  return lines;
}

}  // namespace robocell::internal
