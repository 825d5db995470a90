// Private to robot: makes the move groups of a robot from its record in the compiled scene. Errors
// give the place in the robot's file.
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
  std::optional<ChainTip> tip = {};  // the end of an arm's chain; unset for the other kinds
  std::string why_no_actuators = {};
  std::optional<Drives> drives = {};  // drives of an arm
  std::string own_controller = {};    // the group's only possible controller, or ""
};

// Makes the groups of RobotConfig.move_groups in order, and a group "base" if none is configured.
// An arm that names no actuators is driven by those found on its joints, of one kind: position
// servos, velocity servos or motors (actuator_kind.h). Throws the errors of the groups'
// constructors, and ArgumentError for an arm with such actuators on only some of its joints. Errors
// begin with the group's place in the robot's file.
std::vector<MadeGroup> MakeGroups(const Scene& scene, const RobotRecord& robot);

// Makes the base group of a robot whose configuration names none.
MadeGroup MakeImplicitBase(const Scene& scene, const RobotRecord& robot);

// Makes an arm over the given joints, driven by the actuators found on them in the same way, for a
// robot without a configuration. Unless each joint has one of the kind, it gets none, and the log
// gives the reason.
MadeGroup MakeAdHocArm(const Scene& scene, const RobotRecord& robot,
                       std::vector<std::string> joints, const ChainTip& tip);

// Returns the result of `f`. Its exceptions get the place of `field` in the file, unless they have
// one.
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
