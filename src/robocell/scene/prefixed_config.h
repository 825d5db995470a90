// Private to scene: a robot's configuration with the names that its elements have in a model of
// several robots.
#pragma once

#include <string>

#include "robocell/spec/robot_config.h"

namespace robocell {

// `prefix` in front of every name of an element: root body, groups, sites, geoms, sensors. Edits,
// attachments and cameras stay as they are.
RobotConfig WithPrefix(RobotConfig config, const std::string& prefix);

}  // namespace robocell
