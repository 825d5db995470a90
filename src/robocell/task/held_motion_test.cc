#include "robocell/task/held_motion.h"

#include <gtest/gtest.h>

#include "robocell/math/rotation.h"

namespace robocell::internal {
namespace {

TEST(AppendStraight, MakesFineStepsToThePose) {
  Rng rng = Rng::Stream(0, "straight");
  for (int i = 0; i < 50; ++i) {
    const Pose from(Eigen::Vector3d(rng.Uniform(-1, 1), 0, 0), RandomQuaternion(rng));
    const Pose to(Eigen::Vector3d(rng.Uniform(-1, 1), 1, 0), RandomQuaternion(rng));
    HeldPath path = {from};
    AppendStraight(path, to);
    EXPECT_TRUE(path.back().is_close(to, 1e-9, 1e-9));
    for (size_t k = 1; k < path.size(); ++k)
      EXPECT_TRUE(path[k].is_close(path[k - 1], 0.0501, 0.00501));
  }
}

}  // namespace
}  // namespace robocell::internal
