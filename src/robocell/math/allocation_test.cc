// The functions of this layer are called inside control loops: none of them may allocate.
#include <array>

#include <gtest/gtest.h>

#include "robocell/base/rng.h"
#include "robocell/math/interpolation.h"
#include "robocell/math/pose.h"
#include "robocell/math/twist.h"
#include "robocell/testing/count_allocations.h"
#include "robocell/testing/random_values.h"

namespace robocell {
namespace {

TEST(Allocation, PosesAndRotationsDoNotAllocate) {
  const AllocationCount count;
  Rng rng = Rng::Stream(1, "allocation");
  Pose pose = RandomPose(rng);
  for (int i = 0; i < 10; ++i) {
    const Pose other = RandomPose(rng);
    pose = (pose * other.inverse()).interpolate(Pose(other.matrix()), 0.5).limit_rotation(1);
    pose = Pose::FromRpy(pose * other.translation(), pose.rpy()).limit_translation(1);
    pose = Integrate(pose, PoseDifference(pose, Pose::FromRotvec(pose.rotvec(), other.rotvec())));
    EXPECT_FALSE(pose.is_close(other, 0, 0));
  }
  EXPECT_EQ(count.allocations(), 0);
}

TEST(Allocation, TwistsAndInterpolationDoNotAllocate) {
  const AllocationCount count;
  Rng rng = Rng::Stream(2, "allocation");
  const Pose X_AB = RandomPose(rng);
  Twist twist = Twist::FromVector(AdjointMatrix(X_AB) *
                                  Twist{RandomVector(rng), Eigen::Vector3d::Zero()}.vector());
  twist = Shifted(Transformed(X_AB, twist), X_AB.translation());
  std::array<double, 3> from = {0, 1, 2}, to = {1, 1, -1}, ones = {1, 1, 1}, out = {};
  InterpolateJoints(from, to, MinimumJerk(0.3, JointMoveDuration(from, to, ones, ones)).position,
                    out);
  EXPECT_GT(TrapezoidalMotion(1, 1, 1).at(0.5).position + twist.linear.norm() + out[0], 0);
  EXPECT_EQ(count.allocations(), 0);
}

TEST(Allocation, TheCounterCountsAllocations) {
  const AllocationCount count;
  ::operator delete(::operator new(1));  // a new expression may be optimised away
  EXPECT_EQ(count.allocations(), 1);
}

}  // namespace
}  // namespace robocell
