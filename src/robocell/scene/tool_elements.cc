#include "robocell/scene/tool_elements.h"

#include <fmt/format.h>

#include <filesystem>

namespace robocell::internal {
namespace {

const AttachmentSpec* LongerPrefix(const AttachmentSpec* a, const AttachmentSpec* b) {
  if (!a || !b) return a ? a : b;
  return a->prefix.size() < b->prefix.size() ? b : a;
}

// Tools are listed in the robot's file and in the scene's.
const AttachmentSpec* ToolOfRobot(const CompiledScene& scene, const RobotRecord& robot,
                                  const std::string& name) {
  const AttachmentSpec* tool = ToolOf(robot.config.attachments, name);
  for (size_t i = 0; i < scene.robots().size(); ++i) {
    if (scene.robots()[i].name == robot.name && i < scene.spec().robots.size())
      tool = LongerPrefix(tool, ToolOf(scene.spec().robots[i].attachments, name));
  }
  return tool;
}

}  // namespace

const AttachmentSpec* ToolOf(const List<AttachmentSpec>& tools, const std::string& name) {
  const AttachmentSpec* found = nullptr;
  for (const AttachmentSpec& tool : tools) {
    if (!tool.prefix.empty() && name.starts_with(tool.prefix)) found = LongerPrefix(found, &tool);
  }
  return found;
}

SiteAdvice HowToAddSite(const CompiledScene& scene, const RobotRecord& robot,
                        const std::string& body, const std::string& site, const std::string& pos) {
  const std::string own = body.starts_with(robot.prefix) ? body.substr(robot.prefix.size()) : body;
  if (const AttachmentSpec* tool = ToolOfRobot(scene, robot, own)) {
    return {fmt::format("add one, at {}, to body '{}' in the file of the tool, {}", pos,
                        own.substr(tool->prefix.size()),
                        std::filesystem::path(tool->mjcf_path).filename().string()),
            ""};
  }
  const std::string edit = fmt::format("{{add_site: {}, body: {}, pos: {}}}", site, own, pos);
  return {fmt::format("edits: [{}] adds one", edit), edit};
}

}  // namespace robocell::internal
