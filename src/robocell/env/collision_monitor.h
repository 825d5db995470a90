// CollisionMonitor: finds which robots collide, by robot and body, and whether the contact is new.
//
// A robot's collision geoms (RobotConfig::collision_geoms, else all) count, including carried
// objects. Of its gripper, which has to touch objects, only the geoms count that its own
// `collision_geoms` names, of a mounted gripper that gripper's, and never those of one finger on
// the other. What `ignored_collision_geoms` of a robot or gripper names may be touched by its
// geoms. Contacts of a robot with itself count too, but for links with a joint between them: models
// let these overlap.
//
//   monitor.Begin();                               // what touched at the last look is not new
//   ... step ...; if (monitor.FindNew()) ...       // no allocation unless something is new
//   for (const Collision& c : monitor.found()) ... // all since Begin
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robocell/env/env_step.h"
#include "robocell/robot/robot.h"

namespace robocell::internal {

class CollisionMonitor {
 public:
  // The arms, each with the robot of its gripper if that is another one.
  struct Watched {
    Robot robot;
    std::vector<Robot> grippers;
  };
  explicit CollisionMonitor(std::vector<Watched> watched);

  // Contacts at the last check as pairs of bodies, for restoring a state of the scene.
  using Memory = std::vector<std::pair<int, int>>;

  // Contacts of the last check are not new; after Forget, present contacts are not.
  void Begin();
  void Forget() { looked_ = false; }
  const Memory& memory() const { return touching_; }
  void Recall(const Memory& memory);
  // Checks the present contacts; returns true if there is a pair of bodies that was not found
  // before.
  bool FindNew();
  std::vector<Collision> found() const;

 private:
  void Bind();
  void Look();
  void MarkGeoms(const Watched& watched, int index);
  void Ignore(const Robot& robot);
  // Marks the geoms of a robot's own hand, which count only if `collision_geoms` names some.
  void MarkHand(const MoveGroup& gripper, bool counts);
  Collision MakeCollision(std::pair<int, int> bodies) const;

  std::vector<Watched> watched_;
  Scene scene_;
  uint64_t generation_ = ~uint64_t{0};
  std::vector<int> owner_;                  // per geom: index into watched_, or -1
  std::vector<int> body_owner_;             // per body
  std::vector<bool> of_gripper_;            // per geom: of a mounted gripper
  std::set<std::pair<int, int>> harmless_;  // counted geom, geom that it may touch
  bool bound_ = false;                      // names were looked up and are correct
  bool looked_ = false;                     // since Forget
  Memory touching_;                         // contacts at the last check
  Memory found_;                            // since Begin
};

}  // namespace robocell::internal
