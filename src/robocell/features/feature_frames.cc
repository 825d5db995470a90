#include "robocell/features/feature_frames.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

struct ElementKind {
  std::string_view word;
  mjtObj type;
};
constexpr std::array kElementKinds = {
    ElementKind{"body", mjOBJ_BODY}, ElementKind{"geom", mjOBJ_GEOM},
    ElementKind{"site", mjOBJ_SITE}, ElementKind{"camera", mjOBJ_CAMERA}};

std::string TextOf(const ElementKind& kind, std::string_view name) {
  return std::string(kind.word) + " '" + std::string(name) + "'";
}

}  // namespace

std::string WhyNoFrame(const Scene& scene, const std::string& frame) {
  if (frame.empty()) return "";
  std::vector<std::string> frames = {"world", "root frame", "shared base frame"};
  for (const RobotRecord& robot : scene.compiled()->robots()) {
    frames.push_back("base of " + robot.name);
    frames.push_back("TCP of " + robot.name);
  }
  if (std::ranges::find(frames, frame) != frames.end()) return "";
  for (const ElementKind& kind : kElementKinds) {
    if (!frame.starts_with(std::string(kind.word) + " ")) continue;
    std::vector<std::string> names = ElementNames(scene.model(), kind.type);
    std::erase(names, "");
    for (std::string& name : names) name = TextOf(kind, name);
    if (std::ranges::find(names, frame) != names.end()) return "";
    return NoSuchName("", "frame", frame, names);
  }
  for (const ObjectRecord& object : scene.compiled()->objects())
    frames.push_back(TextOf(kElementKinds[0], object.root_body));
  return NoSuchName("", "frame", frame, frames);
}

}  // namespace robocell::internal
