// Private to robot: makes the move groups of a robot from its record in the compiled scene. Errors
// say where the robot's configuration stands in its file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/kinematics/chain.h"
#include "robocell/robot/drives.h"
#include "robocell/robot/move_group.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/locations.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {

struct MadeGroup {
  std::shared_ptr<MoveGroup> group;
  std::optional<ChainTip> tip = {};  // where an arm's chain ends; unset for the other kinds
  std::string why_no_actuators = {};
  std::optional<Drives> drives = {};  // of an arm
  std::string own_controller = {};    // of a group that is driven by this kind alone, or ""
};

// The groups of RobotConfig.move_groups in their order, and a group "base" when none is configured.
// An arm that names no actuators is driven by those found on its joints, of one kind: position
// servos, velocity servos or motors (actuator_kind.h). Errors: those of the groups' constructors;
// ArgumentError for an arm that has them on some of its joints only. They begin with the group's
// place in the robot's file.
std::vector<MadeGroup> MakeGroups(const Scene& scene, const RobotRecord& robot);

// The base group of a robot whose configuration names none.
MadeGroup MakeImplicitBase(const Scene& scene, const RobotRecord& robot);

// An arm over the given joints, driven by the actuators found on them, likewise, for robots without
// a configuration. It gets none, and the log says why, unless each joint has one of the kind.
MadeGroup MakeAdHocArm(const Scene& scene, const RobotRecord& robot,
                       std::vector<std::string> joints, const ChainTip& tip);

// What `f` returns. What it throws begins with the place of `field` in the file, unless it has one.
template <class F>
auto Located(const RobotConfig& config, const std::string& field, F&& f) {
  const auto place = [&](const Error& error) {
    return WithPlace(config.locations.At(field), error.what());
  };
  try {
    return f();
  } catch (const ArgumentError& error) {
    throw ArgumentError(place(error));
  } catch (const NotFoundError& error) {
    throw NotFoundError(place(error));
  }
}

}  // namespace robocell::internal
