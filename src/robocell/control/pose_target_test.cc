#include "robocell/control/pose_target.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/math/rotation.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

const Pose kTarget(Eigen::Vector3d(0.3, -0.2, 0.5), QuaternionFromRpy({0.4, -1.1, 2.0}));

TEST(PoseTarget, RoundTripsThroughNumbers) {
  const Robot robot = RobotAlone(Rc7());
  const PoseNumbers numbers = ToNumbers(kTarget);
  EXPECT_EQ(numbers[0], 0.3);
  EXPECT_TRUE(PoseFromNumbers(numbers, robot.arm()).is_close(kTarget, 1e-15, 1e-12));
  PoseNumbers opposite = numbers;
  for (int i = 3; i < 7; ++i) opposite[i] = -opposite[i];
  EXPECT_TRUE(PoseFromNumbers(opposite, robot.arm()).is_close(kTarget, 1e-15, 1e-12))
      << "both quaternions of a rotation mean the same";
}

TEST(PoseTarget, RejectsInvalidPosesAndNamesTheGroup) {
  const Robot robot = RobotAlone(Rc7());
  const PoseNumbers good = ToNumbers(kTarget);
  ExpectThrow<ArgumentError>([&] { PoseFromNumbers(std::vector<double>(6), robot.arm()); },
                             "group 'arm': expected 7 pose values, got 6");
  for (int i = 0; i < 7; ++i) {
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      PoseNumbers numbers = good;
      numbers[i] = bad;
      ExpectThrow<ArgumentError>([&] { PoseFromNumbers(numbers, robot.arm()); }, "group 'arm': ");
    }
  }
  PoseNumbers longer = good;
  longer[6] += 0.1;
  ExpectThrow<ArgumentError>([&] { PoseFromNumbers(longer, robot.arm()); }, "group 'arm': ");
}

}  // namespace
}  // namespace robocell
