// HandMeetings: where two arms can meet so that one hands an object to the other: poses of the object
// in the air, with a posture of both arms for each.
//
//   HandMeetings meetings(giver, taker, "bar", middle);
//   meetings.Find(object, tcp_in_object, away, near, 2000, [&](const HandMeeting& m) { ... });
//
// Threads: those of the scene.
#pragma once

#include <functional>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/kinematics/joint_vector.h"
#include "robocell/math/pose.h"
#include "robocell/motion/motion_planner.h"
#include "robocell/robot/robot.h"
#include "robocell/task/grasp.h"

namespace robocell::internal {

struct HandMeeting {
  Pose object;                // in the world
  JointVector giver;          // holds the object there
  JointVector before, taken;  // of the taker: at the begin of its approach, and at the contact
  Grasp grasp;                // of the taker
};

class HandMeetings {
 public:
  // `giver` and `taker`: one robot, seen from each arm. `middle`: where the hands meet best, in the
  // world, m.
  HandMeetings(const Robot& giver, const Robot& taker, const std::string& body,
               const Eigen::Vector3d& middle);

  // Returns true if the second hand has a grasp far enough from the first one, whose TCP is at
  // `tcp_in_object`.
  bool HasRoom(const Pose& tcp_in_object) const { return !GraspsBeside(tcp_in_object).empty(); }
  // Calls `use` with meetings, the best places first, until it returns true, and returns whether it
  // did. `object`: its present pose, from which it is turned. The arms are free in them: with the
  // taker before its approach for the planner `away`, at the contact for `near`; their groups are the
  // arms of giver and taker. At most `most` postures are checked.
  bool Find(const Pose& object, const Pose& tcp_in_object, const MotionPlanner& away,
            const MotionPlanner& near, int most,
            const std::function<bool(const HandMeeting&)>& use) const;

 private:
  std::vector<Grasp> GraspsBeside(const Pose& tcp_in_object) const;
  std::vector<Pose> Places(const Pose& object) const;

  Robot giver_, taker_;
  Eigen::Vector3d middle_;
  std::vector<Grasp> grasps_;  // of the taker
};

}  // namespace robocell::internal
