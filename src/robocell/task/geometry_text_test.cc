#include "robocell/task/geometry_text.h"

#include <gtest/gtest.h>

#include <string>

#include "robocell/testing/random_values.h"

namespace robocell::internal {
namespace {

// The pose of B in A does not depend on where both are, to the bit.
TEST(RoundedPose, IsTheSameWhereverBothBodiesAre) {
  Rng rng = Rng::Stream(1, "rounded");
  for (int i = 0; i < 200; ++i) {
    const Pose b_in_a(RandomVector(rng, 0.1), RandomQuaternion(rng));
    const Pose rounded = RoundedPose(b_in_a);
    EXPECT_TRUE(rounded.is_close(b_in_a, 1e-6, 1e-6));
    const Pose a = RandomPose(rng), b = a * b_in_a;
    const Pose again = RoundedPose(a.inverse() * b);
    EXPECT_EQ(again, rounded);
    std::string first, second;
    AppendPose(rounded, &first);
    AppendPose(again, &second);
    EXPECT_EQ(first, second);
  }
}

}  // namespace
}  // namespace robocell::internal
