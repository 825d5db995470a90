// Private to scene: the base of a robot. A base body `<prefix><kind>_base` is made for mocap, free,
// planar and driven bases and for every pedestal; its origin is the pedestal's bottom, the robot's
// root hangs at the pedestal's top.
//   mocap   a mocap body of the world
//   free    with the free joint <prefix>base_free
//   planar  with the joints <prefix>base_x, <prefix>base_y, <prefix>base_yaw; nothing drives them. A
//           model that moves in the plane by itself, by such joints or on wheels, is not changed
//   driven  with the free joint <prefix>base_free, welded (<prefix>base_weld) to the mocap body
//           <prefix>base_target, which has no geoms and starts at the base
#pragma once

#include "robocell/scene/add_robot.h"

namespace robocell::internal {

// Fills base body, pedestal height and the effective kind of base into the record.
void SettleBase(RobotPart& robot, CompileLog& log);

// Makes the weld of a driven base soft enough for the engine to be stable with its timestep.
void FitWeld(mjSpec* scene, const RobotRecord& robot);

// Adds the base body to the scene and returns the placement of the robot's root. Unset after a
// problem.
std::optional<Placement> AddBase(const RobotSpec& robot, const RobotPart& loaded,
                                 const Placement& placement, CompileLog& log);

}  // namespace robocell::internal
