// Private to scene: adds a robot with its edits, attachments, cameras and overrides. It is first
// made as a separate model (names without the robot's prefix), then put into the scene on its
// base.
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
  std::vector<Limb> limbs;  // limbs, with names of the part
};

// Returns the heading of problems of the named robot.
std::string RobotPlace(const std::string& name);

// Returns the record of a named robot as far as the spec defines it; names in the model follow when
// it is loaded.
RobotRecord RecordOf(const RobotSpec& robot, const std::string& name);

// Returns null if there were problems. `locations` are those of the RobotSpec.
std::optional<RobotPart> LoadRobot(const RobotSpec& robot, const std::string& name,
                                   const Locations& locations, const SceneSpec& scene,
                                   CompileLog& log);

// Loads a robot whose elements are in the model of `host`; its own part has no spec.
std::optional<RobotPart> LoadRobotIn(RobotPart& host, const RobotSpec& robot,
                                     const std::string& name, const Locations& locations,
                                     const SceneSpec& scene, CompileLog& log);

void AttachRobot(const RobotSpec& robot, RobotPart& loaded, const Placement& placement,
                 CompileLog& log);

// Returns the robots' names: as given, else from the prefix, else robot, robot_1, ... Duplicates
// are problems.
std::vector<std::string> RobotNames(const List<RobotSpec>& robots, CompileLog& log);

// Returns "<prefix>mocap_base" and the like; unset for a robot that is directly attached.
std::optional<std::string> BaseBodyName(const BaseConfig& base, const std::string& prefix);

}  // namespace robocell::internal
