#include "robocell/robot/controller.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <mutex>

#include "robocell/base/error.h"
#include "robocell/base/names.h"
#include "robocell/robot/joint_position_controller.h"

namespace robocell {
namespace {

struct Registry {
  std::mutex mutex;
  std::map<std::string, ControllerFactory> factories;
};

Registry& TheRegistry() {
  static Registry registry{.factories = {{"joint_position", MakeJointPositionController}}};
  return registry;
}

std::vector<std::string> Kinds(const Registry& registry) {
  std::vector<std::string> kinds;
  for (const auto& [kind, factory] : registry.factories) kinds.push_back(kind);
  return kinds;
}

}  // namespace

void ThrowBadValues(std::string_view place, std::string_view what, std::span<const double> values,
                    int expected, const std::vector<std::string>& names) {
  if (values.size() != static_cast<size_t>(expected)) {
    throw ArgumentError(fmt::format("{}: expected {} {} value{}, got {}", place, expected, what,
                                    expected == 1 ? "" : "s", values.size()));
  }
  size_t bad = 0;
  while (bad + 1 < values.size() && std::isfinite(values[bad])) ++bad;
  const std::string name = names.size() == values.size() ? "'" + names[bad] + "'"
                           : values.size() == 1          ? fmt::format("'{}'", what)
                                                         : fmt::format("value {}", bad);
  throw ArgumentError(
      fmt::format("{}: the target of {} is {}; targets must be finite", place, name, values[bad]));
}

void RegisterController(const std::string& kind, ControllerFactory factory) {
  if (!factory) throw ArgumentError("controller '" + kind + "' needs a function that makes it");
  Registry& registry = TheRegistry();
  std::lock_guard lock(registry.mutex);
  if (!registry.factories.emplace(kind, std::move(factory)).second) {
    throw ArgumentError("controller '" + kind + "' is registered already; choose another name");
  }
}

std::unique_ptr<Controller> MakeController(const std::string& kind, MoveGroup& group) {
  ControllerFactory factory;
  {
    Registry& registry = TheRegistry();
    std::lock_guard lock(registry.mutex);
    const auto it = registry.factories.find(kind);
    if (it == registry.factories.end()) {
      throw NotFoundError(NoSuchName(group.place(), "controller", kind, Kinds(registry)));
    }
    factory = it->second;
  }
  return factory(group);
}

std::vector<std::string> ControllerKinds() {
  Registry& registry = TheRegistry();
  std::lock_guard lock(registry.mutex);
  return Kinds(registry);
}

}  // namespace robocell
