// Private to scene: a robot with its edits, attachments, cameras and overrides, first made as a
// model of its own (names without the robot's prefix), then put into the scene on its base.
#pragma once

#include <optional>

#include "robocell/scene/compiled_scene.h"
#include "robocell/scene/control_modes.h"
#include "robocell/scene/part.h"
#include "robocell/scene/placement.h"

namespace robocell::internal {

struct RobotPart {
  Part part;
  mjsBody* top = nullptr;  // the body of the part's world that is attached
  RobotRecord record;
  std::vector<Limb> limbs;  // with names of the part
};

// How problems of the robot of that name are headed.
std::string RobotPlace(const std::string& name);

// What the spec alone says of a robot of that name; names in the model come when it is loaded.
RobotRecord RecordOf(const RobotSpec& robot, const std::string& name);

// Null when there were problems. `locations` are those of the RobotSpec.
std::optional<RobotPart> LoadRobot(const RobotSpec& robot, const std::string& name,
                                   const Locations& locations, const SceneSpec& scene,
                                   CompileLog& log);

// A robot whose elements are in the model of `host` too; its own part has no spec.
std::optional<RobotPart> LoadRobotIn(RobotPart& host, const RobotSpec& robot,
                                     const std::string& name, const Locations& locations,
                                     const SceneSpec& scene, CompileLog& log);

void AttachRobot(const RobotSpec& robot, const RobotPart& loaded, const Placement& placement,
                 CompileLog& log);

// The robots' names: as given, else from the prefix, else robot, robot_1, ... Names used twice are
// problems.
std::vector<std::string> RobotNames(const List<RobotSpec>& robots, CompileLog& log);

// "<prefix>mocap_base" and the like; unset for a robot that hangs directly on what it is attached
// to.
std::optional<std::string> BaseBodyName(const BaseConfig& base, const std::string& prefix);

}  // namespace robocell::internal
