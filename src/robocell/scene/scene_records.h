// Private to scene: the records of a CompiledScene as JSON, without what the spec says itself.
// Heavy header: for .cc files only.
#pragma once

#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/scene/compiled_scene.h"

namespace robocell {

nlohmann::json ToJson(const std::vector<RobotRecord>& robots);
nlohmann::json ToJson(const std::vector<ObjectRecord>& objects);
// The spec is the one that the records were made from.
std::vector<RobotRecord> RobotsFromJson(const SceneSpec& spec, const nlohmann::json& robots);
std::vector<ObjectRecord> ObjectsFromJson(const nlohmann::json& objects);

}  // namespace robocell
