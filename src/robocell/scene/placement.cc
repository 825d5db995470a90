#include "robocell/scene/placement.h"

#include <fmt/format.h>

#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
namespace {

std::optional<Placement> OnElement(mjtObj kind, const std::string& name, const Pose& pose,
                                   mjSpec* spec, const std::string& place, CompileLog& log) {
  mjsElement* element = FindSpecElement(spec, kind, name);
  if (!element) {
    const char* word = kind == mjOBJ_FRAME ? "frame" : KindName(kind);
    log.Missing(place, "attach_to: " + NoSuchName("", word, name, SpecNames(spec, kind)),
                "attach_to");
    return std::nullopt;
  }
  if (kind == mjOBJ_BODY) return Placement{mjs_asBody(element), pose};
  return Placement{mjs_getParent(element), PoseInParent(element) * pose};
}

const RobotFrames* FindRobot(const AttachTarget& target, const RobotFrameMap& robots,
                             const std::string& place, CompileLog& log) {
  if (const auto it = robots.find(target.name); it != robots.end()) return &it->second;
  std::vector<std::string> names;
  for (const auto& [name, frames] : robots) names.push_back(name);
  log.Missing(place, "attach_to: " + NoSuchName("the scene", "robot", target.name, names),
              "attach_to");
  return nullptr;
}

}  // namespace

mjtObj ElementKindOf(AttachKind kind) {
  switch (kind) {
    case AttachKind::kBody:
      return mjOBJ_BODY;
    case AttachKind::kSite:
      return mjOBJ_SITE;
    case AttachKind::kFrame:
      return mjOBJ_FRAME;
    default:
      return mjOBJ_UNKNOWN;
  }
}

std::string DescribeTarget(const AttachTarget& target) {
  switch (target.kind) {
    case AttachKind::kWorld:
      return "the world";
    case AttachKind::kRoot:
      return "the root frame";
    case AttachKind::kSharedBase:
      return "the shared base frame";
    case AttachKind::kRobotBase:
      return fmt::format("the base of robot '{}'", target.name);
    case AttachKind::kAttachment:
      return fmt::format("the attachment site of robot '{}'", target.name);
    default:
      return fmt::format("{} '{}'", ToString(target.kind), target.name);
  }
}

std::optional<Placement> Place(const AttachTarget& target, const Pose& pose, mjSpec* spec,
                               const SceneSpec& scene, const RobotFrameMap& robots,
                               const std::string& place, CompileLog& log) {
  switch (target.kind) {
    case AttachKind::kWorld:
      return Placement{WorldBody(spec), pose};
    case AttachKind::kRoot:
      return Placement{WorldBody(spec), RootFrameToWorld(scene) * pose};
    case AttachKind::kSharedBase:
      return Placement{WorldBody(spec), SharedBaseFrameToWorld(scene) * pose};
    case AttachKind::kRobotBase: {
      const RobotFrames* robot = FindRobot(target, robots, place, log);
      if (!robot) return std::nullopt;
      return OnElement(mjOBJ_BODY, robot->root_body, pose, spec, place, log);
    }
    case AttachKind::kAttachment: {
      const RobotFrames* robot = FindRobot(target, robots, place, log);
      if (!robot) return std::nullopt;
      if (robot->attachment_site)
        return OnElement(mjOBJ_SITE, *robot->attachment_site, pose, spec, place, log);
      log.Problem(place,
                  fmt::format("attach_to: robot '{}' has no attachment_site in its configuration",
                              target.name),
                  "attach_to");
      return std::nullopt;
    }
    default:
      return OnElement(ElementKindOf(target.kind), target.name, pose, spec, place, log);
  }
}

std::optional<Placement> PlaceInWorld(const Placement& placement, const AttachTarget& target,
                                      const std::string& why, const std::string& place,
                                      CompileLog& log) {
  if (!IsStatic(placement.parent)) {
    log.Problem(place,
                fmt::format("{} hangs on the world, but is attached to {}, which can move", why,
                            DescribeTarget(target)),
                "attach_to");
    return std::nullopt;
  }
  mjSpec* spec = mjs_getSpec(placement.parent->element);
  return Placement{WorldBody(spec), PoseInWorld(placement.parent->element) * placement.pose};
}

}  // namespace robocell::internal
