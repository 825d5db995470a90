#include "robocell/scene/compile_problem.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <string_view>
#include <vector>

#include "robocell/mujoco/names.h"
#include "robocell/scene/spec_tree.h"

namespace robocell {
namespace {

// Kinds that the engine's compiler complains about by name.
constexpr mjtObj kKinds[] = {mjOBJ_BODY,     mjOBJ_JOINT,  mjOBJ_GEOM,     mjOBJ_SITE,
                             mjOBJ_CAMERA,   mjOBJ_LIGHT,  mjOBJ_MESH,     mjOBJ_TEXTURE,
                             mjOBJ_MATERIAL, mjOBJ_TENDON, mjOBJ_EQUALITY, mjOBJ_ACTUATOR,
                             mjOBJ_SENSOR};

// What stands between two texts; "" when one of them is missing.
std::string Between(std::string_view text, std::string_view before, std::string_view after) {
  const size_t begin = text.find(before);
  if (begin == std::string_view::npos) return "";
  const size_t end = text.find(after, begin + before.size());
  if (end == std::string_view::npos) return "";
  return std::string(text.substr(begin + before.size(), end - begin - before.size()));
}

// What to do about the engine's complaint; "" when nothing more can be said.
std::string NextStep(const std::string& complaint, mjtObj kind, const std::string& name,
                     bool is_robot) {
  if (kind != mjOBJ_BODY || complaint.find("mass and inertia") == std::string::npos) return "";
  const std::string edit = fmt::format(
      " (in the robot's file, for example: edits: [{{geom: {{body: {}, index: 0}}, mass: 0.05}}])",
      name);
  return fmt::format(
      ". A body that moves needs a mass: give one of its geoms a `mass`{} or the body an "
      "<inertial>",
      is_robot ? edit : "");
}

}  // namespace

std::optional<std::string> CompileProblem(const std::string& text, const Part& part,
                                          const std::string& prefix) {
  const std::string full_name = Between(text, "Element name '", "'");
  if (full_name.size() <= prefix.size() || !full_name.starts_with(prefix)) return std::nullopt;
  const std::string name = full_name.substr(prefix.size());
  std::vector<mjtObj> kinds;
  for (const mjtObj kind : kKinds) {
    if (FindSpecElement(part.spec.get(), kind, name)) kinds.push_back(kind);
  }
  if (kinds.empty()) return std::nullopt;
  const std::string complaint = Between(text, "Error: ", "\n");
  const bool is_certain = kinds.size() == 1;  // the engine tells the name only
  return fmt::format("{}: {} '{}': {}{}", part.file, is_certain ? KindName(kinds[0]) : "element",
                     name, complaint,
                     NextStep(complaint, kinds[0], name, part.place.starts_with("robot ")));
}

}  // namespace robocell
