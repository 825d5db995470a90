// Private to scene: whether everything that a robot's configuration names is in the compiled model,
// and fits.
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <string>
#include <vector>

#include "robocell/scene/compiled_scene.h"
#include "robocell/scene/part.h"
#include "robocell/scene/report.h"

namespace robocell {

void CheckRobot(const mjModel* model, const RobotRecord& robot, Report& report);

// check_groups.cc: an arm's joints are those from the root to its leaf, in this order; a gripper's
// actuators do not move the whole hand. Missing elements are skipped: CheckRobot reports them.
void CheckGroups(const mjModel* model, const std::vector<RobotRecord>& robots, Report& report);

// A warning for each finger (body) that hangs on joints which nothing moves (no actuator, equality
// or spring), or that has nothing to touch with. `data` has the actuators' moments.
void CheckFingers(const mjModel* model, const mjData* data, const RobotRecord& robot,
                  const std::string& field, const std::array<int, 2>& fingers, Report& report);

// A warning for actuators of a gripper that push less, all together, than its fingers weigh.
void CheckFingerForces(const mjModel* model, const mjData* data, const RobotRecord& robot,
                       const std::string& field, const std::vector<std::string>& actuators,
                       Report& report);

// A TCP given twice, as the leaf of the arm and as attachment_site * tcp_offset, must be the same.
void CheckToolPoints(const mjModel* model, const std::vector<RobotRecord>& robots, Report& report);

// check_ranges.cc: warnings for ranges that contradict each other or the equalities between their
// joints, or that look like degrees where
// radians are meant: joints, actuators, home_noise. `part` is the robot's own model; the home key
// is filled.
void CheckRanges(const mjModel* model, int home_key, const RobotRecord& robot, const Part& part,
                 Report& report);

// check_servos.cc: warnings for servos of an arm that cannot send it home, or hardly anywhere; a
// note for those that stop before their joints do.
void CheckServos(const mjModel* model, int home_key, const RobotRecord& robot, const Part& part,
                 Report& report);

// check_tendons.cc: a note for each spatial tendon with an armature that is led across a joint of
// an arm, for chains leave it out.
void CheckTendons(const mjModel* model, const RobotRecord& robot, Report& report);

// check_scale.cc: a warning for a robot that moves parts as large as houses: in other units.
void CheckScale(const mjModel* model, const RobotRecord& robot, Report& report);

// check_inertia.cc: a warning for each body that a robot moves whose mass and inertia no rigid body
// has, and for each servo so stiff that the timestep cannot follow it.
void CheckInertia(const mjModel* model, const RobotRecord& robot, const Part& part, Report& report);

// check_pedestals.cc: a warning for each robot that stands beside its pedestal, above it or in it.
void CheckPedestals(const mjModel* model, const std::vector<RobotRecord>& robots, Report& report);

// check_camera_places.cc: a warning for each camera that a robot's configuration adds or moves and
// that is far away from the robot at home.
void CheckCameraPlaces(const mjModel* model, int home_key, const std::vector<RobotRecord>& robots,
                       Report& report);

}  // namespace robocell
