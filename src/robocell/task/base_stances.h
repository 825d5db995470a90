// BaseStances: where a robot's base can stand in a scene as it is now: the free part of its
// configuration space, for its present posture. Every geom of the robot counts at the heading that
// is asked for, and doors count all over their range.
//
//   BaseStances stances(robot, 0.01, doors);
//   const std::vector<bool> free = stances.AreFree(bases);   // poses of robot.base()
//
// The boxes around the geoms are compared first, and the engine's distances where boxes meet: what
// is free here passes ValidateBaseClearance and ValidateDoorSwings (base_placement.h,
// door_swings.h), and what is not is refused there. One thread at a time.
#pragma once

#include <span>
#include <vector>
#include <Eigen/Geometry>

#include "robocell/base/rng.h"
#include "robocell/math/pose.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/scenes/support.h"
#include "robocell/spec/start_config.h"
#include "robocell/task/base_placement.h"

namespace robocell::internal {

// Returns poses for the robot's base all around the target (base_placement.h, ProposeBasePose, which
// takes one of them at random). A planar base stays in its plane, whatever the height.
std::vector<Pose> BasesAround(const Robot& robot, const Support& support,
                              const Pose& target_in_world, const BasePlacement& placement,
                              const StartConfig& start, Rng& rng);

// Puts the robot's base there. The servos of a planar base, which would drive it back, hold it there.
void PutBase(const Robot& robot, const Pose& base_in_world);

class BaseStances {
 public:
  // Reads the poses of the scene, which are up to date; after changes of the scene, make another.
  // `clearance`: metres between the robot and everything else.
  BaseStances(const Robot& robot, double clearance, const std::vector<Articulation>& doors = {});

  // Returns, for poses of the robot's base in the world, whether the robot is free there. The
  // scene's state and poses stay as they are.
  std::vector<bool> AreFree(std::span<const Pose> bases);

 private:
  struct Part {  // a geom of the robot, which moves with the base
    int geom;
    Pose in_base;
    Eigen::Vector3d box_middle, box_half;  // in the geom's frame
    bool may_touch_floor;
  };
  struct Obstacle {  // a geom of the scene, or of a door at one place of its swing
    int geom;
    Pose in_world;
    Eigen::AlignedBox3d box;  // around it in the world, wider by the clearance
    bool is_floor;
  };
  void AddSwing(const Articulation& door);
  bool IsFree(const Pose& base, std::span<const Obstacle* const> near);

  Scene scene_;
  double clearance_;
  std::vector<Part> parts_;
  double radius_ = 0;  // of the robot around its base's origin, metres
  std::vector<Obstacle> obstacles_;
};

}  // namespace robocell::internal
