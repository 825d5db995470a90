// Plans one pick: which grasp, and how the arm gets above it. Planning has no side effects: the
// PickPlanner executes the plan.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/motion/planning_scene.h"
#include "robocell/task/grasp_motion.h"

namespace robocell {

// Clearances between the robot and everything else on paths, metres: the largest that both ends
// have is used.
inline constexpr double kPathClearances[] = {0.02, 0.008, 0.002};
inline constexpr int kMostPathSearches = 4;  // grasps or places to which a path is searched

struct PickPlan {
  GraspMotion motion;
  JointPath approach;  // path from the start to the pregrasp, both included
};

// Returns true for a grasp from which the task can go on.
using GraspUse = std::function<bool(PlanningScene&, const GraspMotion&)>;

struct PickPlanRequest {
  JointVector start;        // the arm's present positions
  JointVector home;         // joint positions that solutions should be near
  Pose tcp_now;             // TCP in the world at `start`
  std::vector<Pose> avoid;  // grasps that failed: TCP in the object's frame
  GraspMotionOptions motion = {};
  // Rejects grasps after which the task could not go on. It may change the planning scene.
  GraspUse usable = {};
};

struct PickPlanResult {
  std::optional<PickPlan> plan = {};
  std::string failure = {};  // one of few texts, so that failures can be counted
};

PickPlanResult PlanPick(PlanningScene& planning, const PickPlanRequest& request, Rng& rng);

}  // namespace robocell
