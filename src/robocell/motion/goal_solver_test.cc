#include "robocell/motion/goal_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"

namespace robocell::internal {
namespace {

class GoalSolver : public ::testing::Test {
 protected:
  GoalSolver() {
    for (const std::string& name : robot_.joint_names())
      joints_.push_back(FindId(robot_.scene().model(), mjOBJ_JOINT, name));
    model_.emplace(robot_, joints_, CollisionOptions{});
    arms_ = FindPlannedArms(*model_);
    space_ = {.bounds = limits_, .units = std::vector<double>(7, 1.0)};
  }
  SolvedGoals Solve(const std::vector<MotionGoal>& goals, int most = 32) {
    return SolveGoals(*model_, arms_, space_, limits_, model_->present(), goals, most, "test",
                      Rng::Stream(1, "goals"));
  }
  Pose TcpAt(const std::vector<double>& q) const {
    return robot_.base_in_world() * robot_.FkFrame(q);
  }

  Robot robot_ = RobotAlone(Rc7());
  std::vector<int> joints_;
  std::optional<CollisionModel> model_;
  std::vector<PlannedArm> arms_;
  std::vector<Interval> limits_ = robot_.joint_limits();
  JointSpace space_;
};

TEST_F(GoalSolver, FindsSeveralSolutionsOfAPoseWithinTheLimits) {
  const Pose target = TcpAt({0.3, 0.2, 0.1, 1.5, 0.2, 1.0, 0.4});
  const SolvedGoals solved = Solve({MotionGoal::Tcp(target)});
  EXPECT_GT(solved.solutions.size(), 5u);
  EXPECT_EQ(solved.why_none, "");
  double last = 0;
  for (const SolvedGoals::Solution& s : solved.solutions) {
    EXPECT_TRUE(TcpAt(s.q).is_close(target, 1e-4, 1e-4));
    for (int i = 0; i < 7; ++i) {
      EXPECT_GE(s.q[i], limits_[i].lower - 1e-6);
      EXPECT_LE(s.q[i], limits_[i].upper + 1e-6);
    }
    const double distance = DistanceIn(space_, model_->present(), s.q);
    EXPECT_GE(distance, last);
    last = distance;
  }
}

TEST_F(GoalSolver, SamplesTheWholeRegion) {
  MotionGoal goal = MotionGoal::Tcp(TcpAt(Rc7().home.at("arm")));
  goal.position_box = {0.05, 0, 0};
  goal.free_rotation = {0, 0, std::numbers::pi};
  double left = 0, right = 0;
  std::set<int> quadrants;
  for (const SolvedGoals::Solution& s : Solve({goal}).solutions) {
    const Pose at = goal.tcp.inverse() * TcpAt(s.q);
    left = std::min(left, at.translation().x());
    right = std::max(right, at.translation().x());
    EXPECT_LT(std::abs(at.translation().y()), 1e-4);
    quadrants.insert(static_cast<int>(std::floor(at.rpy().z() / (std::numbers::pi / 2))));
  }
  EXPECT_LT(left, -0.02);
  EXPECT_GT(right, 0.02);
  EXPECT_GE(quadrants.size(), 3u);
}

TEST_F(GoalSolver, LeavesNoGoalOutWhenThereAreManySolutions) {
  std::vector<MotionGoal> goals;
  for (int k = 0; k < 4; ++k)
    goals.push_back(MotionGoal::Tcp(TcpAt({0.4 * k, 0, 0, 1.5, 0, 1, 0})));
  const SolvedGoals solved = Solve(goals, 8);
  EXPECT_EQ(solved.solutions.size(), 8u);
  std::set<int> reached;
  for (const SolvedGoals::Solution& s : solved.solutions) reached.insert(s.goal);
  EXPECT_EQ(reached.size(), 4u);
}

TEST_F(GoalSolver, SaysHowNearAnArmGets) {
  const SolvedGoals solved = Solve({MotionGoal::Tcp(Pose(Eigen::Vector3d(4, 0, 0)))});
  EXPECT_TRUE(solved.solutions.empty());
  EXPECT_NE(solved.why_none.find("it comes within"), std::string::npos) << solved.why_none;
}

}  // namespace
}  // namespace robocell::internal
