#include "robocell/motion/path_judge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"

namespace robocell::internal {
namespace {

class PathJudges : public ::testing::Test {
 protected:
  static SceneSpec Spec() {
    SceneSpec spec = SceneWith({.name = "rc7", .config = Rc7()});
    SceneObject pole = BoxObject("pole", {0.13, 0.2, 0.6});
    pole.size = Vec3{0.005, 0.005, 0.5};
    pole.fixed = true;
    spec.objects.push_back(pole);
    return spec;
  }
  static std::vector<int> JointIdsOf(const Robot& robot) {
    std::vector<int> joints;
    for (const std::string& name : robot.joint_names())
      joints.push_back(FindId(robot.scene().model(), mjOBJ_JOINT, name));
    return joints;
  }

  Scene scene_ = Scene::Build(Spec());
  Robot robot_ = Robot::Of(scene_, "rc7");
  CollisionModel model_{robot_, JointIdsOf(robot_), {.clearance = 0.001}};
  std::vector<Interval> limits_ = robot_.joint_limits();
  JointSpace space_ = {.bounds = limits_, .units = std::vector<double>(7, 1.0)};
};

TEST_F(PathJudges, SeeAThinObstacleOnTheWay) {
  const std::vector<double> start = Rc7().home.at("arm");
  std::vector<double> beyond = start, before = start;
  beyond[0] += 2;
  before[0] += 0.3;
  PathJudge judge(&model_, space_, nullptr, limits_);
  for (const PathJudge::Kind kind : {PathJudge::Kind::kBold, PathJudge::Kind::kEngine}) {
    judge.Use(kind, 0.0087, 0);
    EXPECT_TRUE(judge.IsFree(start));
    EXPECT_TRUE(judge.IsFree(beyond));
    EXPECT_TRUE(judge.IsFree(start, before));
    EXPECT_FALSE(judge.IsFree(start, beyond));
    EXPECT_FALSE(judge.IsFree(beyond, start));
  }
}

TEST_F(PathJudges, AgreeOnAnEdgeWithTheCheckOfEachOfItsConfigurations) {
  PathJudge judge(&model_, space_, nullptr, limits_);
  judge.Use(PathJudge::Kind::kEngine, 0.02, 0);
  Rng rng = Rng::Stream(1, "edges");
  const std::vector<double> home = Rc7().home.at("arm");
  int blocked = 0;
  for (int k = 0; k < 40; ++k) {
    std::vector<double> to = home;
    for (double& x : to) x += rng.Uniform(-0.6, 0.6);
    const int steps = static_cast<int>(std::ceil([&] {
      double longest = 0;
      for (int i = 0; i < 7; ++i) longest = std::max(longest, std::abs(to[i] - home[i]));
      return longest / 0.02;
    }()));
    bool free = true;
    for (int s = 1; s <= steps; ++s) {
      std::vector<double> q = to;
      for (int i = 0; i < 7; ++i) q[i] = home[i] + (to[i] - home[i]) * s / steps;
      free = free && !model_.FindContact(q);
    }
    EXPECT_EQ(judge.IsFree(home, to), free);
    blocked += !free;
  }
  EXPECT_GT(blocked, 0);
  EXPECT_LT(blocked, 40);
}

TEST_F(PathJudges, ProjectOntoTheConstraintWithinTheLimits) {
  const Chain& chain = robot_.chain();
  std::vector<int> dofs;
  for (int i = 0; i < 7; ++i) dofs.push_back(i);
  const Eigen::Matrix3d home = chain.Fk(Rc7().home.at("arm")).rotation();
  const TipAxis axis{.chain = chain,
                     .dofs = dofs,
                     .present = JointVector(7),
                     .in_tip = home.transpose() * Eigen::Vector3d::UnitZ(),
                     .in_base = Eigen::Vector3d::UnitZ(),
                     .tolerance = 0.05};
  EXPECT_NEAR(axis.Angle(Rc7().home.at("arm")), 0, 1e-6);
  PathJudge judge(&model_, space_, &axis, limits_);
  judge.Use(PathJudge::Kind::kBold, 0.02, 0);
  Rng rng = Rng::Stream(2, "tilted");
  int projected = 0;
  for (int k = 0; k < 50; ++k) {
    std::vector<double> q = Rc7().home.at("arm");
    for (double& x : q) x += rng.Uniform(-0.4, 0.4);
    if (axis.Angle(q) > axis.tolerance) {
      EXPECT_FALSE(judge.IsFree(q));
    }
    if (!judge.Project(q)) continue;
    ++projected;
    EXPECT_LE(axis.Angle(q), axis.tolerance);
    for (int i = 0; i < 7; ++i) {
      EXPECT_GE(q[i], limits_[i].lower);
      EXPECT_LE(q[i], limits_[i].upper);
    }
  }
  EXPECT_GT(projected, 40);
}

}  // namespace
}  // namespace robocell::internal
