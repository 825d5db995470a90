// Finds the elements of a robot that came with an attached tool. Advice depends on it: the edits of
// a robot's file change the robot's own model, before tools are attached.
#pragma once

#include <string>

#include "robocell/scene/compiled_scene.h"
#include "robocell/spec/attachment_spec.h"

namespace robocell::internal {

// Returns the tool with the longest prefix that `name` begins with (without the robot's prefix);
// null for the robot's own elements. Tools without a prefix are not found.
const AttachmentSpec* ToolOf(const List<AttachmentSpec>& tools, const std::string& name);

// The edit that adds a site to a body of a robot: "edits: [{add_site: tip, body: jaw, pos: [0, 0,
// 0.1]}] adds one", or where a tool's file needs it.
struct SiteAdvice {
  std::string text;
  std::string edit;  // the edit in it; "" for a tool
};
// `body`: its full name in the scene.
SiteAdvice HowToAddSite(const CompiledScene& scene, const RobotRecord& robot,
                        const std::string& body, const std::string& site, const std::string& pos);

}  // namespace robocell::internal
