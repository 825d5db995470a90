// ArmContacts: what touches an object: which arms of the scene's robots, which of their grippers grasp
// it, and whether anything else does. For tasks in which it counts which arm holds something.
//
//   const ArmContacts contacts(scene, "cup");
//   if (contacts.Look().only_holder() == 1) ...   // arm number 1 alone holds it, in the air
//
// Throws NotFoundError for an unknown body. Threads: those of the scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/scene/body_handle.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

class ArmContacts {
 public:
  struct Seen {
    std::vector<char> touches, grasps;  // of each arm
    bool other = false;                 // something else touches it: the support, a torso

    int touching() const;
    int grasping() const;
    // Returns the number of the arm that holds it if nothing else touches it; -1 for none.
    int only_holder() const;
  };

  // `body`: its full name. The arms are those of ActingArms(scene) that have a gripper.
  ArmContacts(const Scene& scene, const std::string& body);

  // Looks at the present contacts.
  Seen Look() const;
  const std::vector<std::string>& arms() const { return arms_; }  // names for Robot::Of
  const BodyHandle& body() const { return body_; }

 private:
  void FindRoots() const;

  Scene scene_;
  BodyHandle body_;
  std::vector<std::string> arms_;
  std::vector<Robot> robots_;       // seen from these arms
  mutable std::vector<int> roots_;  // the body that the first joint of each arm moves
  mutable uint64_t generation_ = 0;
};

}  // namespace robocell::internal
