// Tests ways of an arm through poses; forward kinematics is the oracle.
#include "robocell/expert/tcp_ways.h"

#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/workplace.h"

namespace robocell {
namespace {

class TcpWaysTest : public ::testing::Test {
 protected:
  // Returns the present TCP's pose, moved sideways in steps of 1 cm.
  std::vector<Pose> Sideways(double reach) const {
    const Pose from = arm_.tcp_in_world();
    std::vector<Pose> poses;
    for (double y = 0; y < reach; y += 0.01)
      poses.emplace_back(from.translation() + Eigen::Vector3d(0, y, 0), from.quaternion());
    return poses;
  }
  JointVector Present() const {
    return JointVector(std::span<const double>(arm_.arm().joint_pos()));
  }

  Scene scene_ = Scene::Build(Workplace());
  Robot arm_ = Robot::Of(scene_, "robot");
  Rng rng_ = Rng::Stream(1, "test");
};

TEST_F(TcpWaysTest, FollowThePosesWithoutJumps) {
  const std::vector<Pose> poses = Sideways(0.2);
  const std::vector<JointPath> ways = internal::TcpWays(
      arm_, poses, Present(), {.anchors = {0, poses.size() - 1}, .draws = 6}, rng_);
  ASSERT_GT(ways.size(), 1u) << "seven joints have several postures";
  for (size_t w = 0; w < ways.size(); ++w) {
    ASSERT_EQ(ways[w].size(), poses.size());
    for (size_t i = 0; i < poses.size(); ++i) {
      const Pose tcp = arm_.base_in_world() * arm_.chain().Fk(ways[w][i]);
      EXPECT_TRUE(tcp.is_close(poses[i], 2e-4, 2e-4));
      if (i > 0) EXPECT_LE(JointDistance(ways[w][i], ways[w][i - 1]), 0.25);
    }
    if (w > 0) {
      EXPECT_GE(JointDistance(ways[w].front(), Present()),
                JointDistance(ways[w - 1].front(), Present()));
      EXPECT_GT(JointDistance(ways[w].front(), ways[w - 1].front()), 0.1);
    }
  }
}

TEST_F(TcpWaysTest, AreNoneBeyondTheReach) {
  EXPECT_TRUE(internal::TcpWays(arm_, Sideways(2), Present(), {}, rng_).empty());
}

}  // namespace
}  // namespace robocell
