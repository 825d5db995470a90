// MotionPlanner: collision-free motions of any robot, to one of a set of goals.
//
//   MotionPlanner planner(robot, {.clearance = 0.005});
//   MotionResult result = planner.Plan({MotionGoal::Tcp(grasp), MotionGoal::Tcp(other_grasp)});
//   if (!result.success) throw Error(result.message);
//   for (const std::vector<double>& q : result.path) ...          // waypoints, straight between
//   MotionResult once = Plan(robot, {MotionGoal::Joints(q)});     // without a planner to keep
//
// The planned joints are those of MotionOptions::groups: one arm, several arms at once, a planar
// base with its arm. All other joints of the scene stay in place, and all objects, except attached
// ones.
//
// Method: goals become joint positions by batched inverse kinematics within the limits; two trees
// connect the start with one of them (goal_trees.h) over spheres that contain the geoms
// (collision_model.h); the path is shortened, and then checked by the engine's own distances at
// steps of at most half a degree, wherever the spheres do not show more than the clearance. If
// that finds fault, planning continues with the engine's distances in place of doubtful spheres.
//
// The same scene, goals, options and seed give the same path, unless a deadline cuts the search
// short. Between joint positions that holds on every processor; inverse kinematics (goals of the
// TCP, keep_axis) rounds differently with other instruction sets. A motion that is not found is a result with a failure, not an exception.
// Throws ArgumentError for goals and options that do not fit the robot, NotFoundError for unknown
// names, Error after objects were added to the scene or removed. Threads: those of the scene.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include <Eigen/Core>

#include "robocell/motion/motion_goal.h"
#include "robocell/robot/robot.h"

namespace robocell {

// Keeps a direction of the TCP near one of the world during the whole motion: a cup upright.
struct AxisConstraint {
  Eigen::Vector3d axis_in_tcp = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d axis_in_world = Eigen::Vector3d::UnitZ();
  double tolerance = 0.1;  // rad
  std::string arm{};       // empty for the first planned one
};

struct MotionOptions {
  // Groups whose joints move: arms, and a planar base. Empty: the robot's first arm.
  std::vector<std::string> groups{};
  // Least distance to everything that is not the robot, m, at the checked configurations.
  double clearance = 0.001;
  // Pairs of bodies, with their subtrees, that may touch: {"cube", "table"}. An empty name stands for
  // everything.
  std::vector<std::pair<std::string, std::string>> allowed_contacts{};
  // Bodies that move with another body, as now: {"cube", "hand"}. They may touch what they touch of
  // the robot now.
  std::vector<std::pair<std::string, std::string>> attached{};
  std::optional<AxisConstraint> keep_axis{};
};

struct MotionBudget {
  uint64_t seed = 0;
  int iterations = 10000;  // of growing the trees
  // Seconds after which the search ends; unset: never. With it results depend on the processor.
  std::optional<double> deadline{};
  int shortcuts = 40;   // tries
  int most_goals = 32;  // joint positions that the goals are turned into
  // Called occasionally; its exception ends the search and is rethrown.
  std::function<void()> poll = {};
};

enum class MotionFailure {
  kNone,
  kStartInCollision,  // or nearer to something than the clearance
  kStartBeyondLimits,
  kStartAgainstConstraint,
  kGoalUnreachable,  // no goal has a solution within the limits
  kGoalInCollision,  // all solutions are in collision
  kGoalAgainstConstraint,
  kNoPath,  // none found in the budget
};
// Returns "start_in_collision" etc., and "none".
std::string ToString(MotionFailure failure);

struct MotionResult {
  bool success = false;
  MotionFailure failure = MotionFailure::kNone;
  std::string message{};  // of a failure: what, where and what to try
  // Of kNoPath: a larger budget may find a path. False when the start or the goals are shut in.
  bool more_may_help = false;
  // Way points from the start to the goal, one value for each planned joint; straight in between.
  std::vector<std::vector<double>> path{};
  int goal = -1;  // index of the reached goal
  int iterations = 0;
  int64_t configurations = 0;  // checked by spheres
  int64_t distances = 0;       // computed by the engine
};

class MotionPlanner {
 public:
  explicit MotionPlanner(const Robot& robot, const MotionOptions& options = {});
  ~MotionPlanner();
  MotionPlanner(MotionPlanner&&) noexcept;
  MotionPlanner& operator=(MotionPlanner&&) noexcept;

  // Plans from the present joint positions. Looks at the scene's present state first.
  MotionResult Plan(std::span<const MotionGoal> goals, const MotionBudget& budget = {});
  MotionResult Plan(std::initializer_list<MotionGoal> goals, const MotionBudget& budget = {}) {
    return Plan(std::span<const MotionGoal>(goals.begin(), goals.size()), budget);
  }
  // Plans from other joint positions, in the surroundings of the last Update().
  MotionResult PlanFrom(std::span<const double> start, std::span<const MotionGoal> goals,
                        const MotionBudget& budget = {});
  // Moves the TCP from the start on a straight line to a pose in the world. The rotation follows the
  // shortest arc. The path has a waypoint about every millimetre or half degree. Fails with
  // kGoalUnreachable where the arm cannot follow, and with kNoPath where something is in the way;
  // `path` is then the part before.
  MotionResult PlanLine(std::span<const double> start, const Pose& tcp_in_world,
                        const std::string& arm = "");

  // Copies the scene's present state.
  void Update();

  const Robot& robot() const;
  // Returns the names of the planned joints, in the order of all configurations.
  const std::vector<std::string>& joint_names() const;
  std::vector<Interval> joint_limits() const;
  std::vector<double> present() const;  // at the last Update()
  // Returns true if a configuration keeps the clearance, by the engine's distances.
  bool IsFree(std::span<const double> q) const;
  // Returns the smallest distance of the moving parts to everything else and to each other that is
  // below `horizon`, m; pairs that may touch do not count.
  double Clearance(std::span<const double> q, double horizon) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Plans a motion from the robot's present joint positions.
MotionResult Plan(const Robot& robot, std::span<const MotionGoal> goals,
                  const MotionOptions& options = {}, const MotionBudget& budget = {});

}  // namespace robocell
