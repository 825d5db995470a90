#include "robocell/task/grasp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/base/error.h"

namespace robocell {
namespace {

TEST(Grasp, KindsAreKnownByTheirNames) {
  for (const auto& [kind, name] : kGraspKinds) {
    EXPECT_EQ(ToString(kind), name);
    EXPECT_EQ(GraspKindOf(name), kind);
  }
  try {
    GraspKindOf("rimm");
    FAIL();
  } catch (const NotFoundError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("Did you mean 'rim'?"));
  }
}

TEST(Grasp, TheApproachBeginsBackAlongItsDirection) {
  const Grasp grasp{.tcp_in_body = Pose({1, 2, 3}, Quaternion{1, 0, 0, 0}),
                    .approach = {0, 1, 0},
                    .approach_length = 0.5};
  EXPECT_TRUE(grasp.before().is_close(Pose({1, 1.5, 3}, Quaternion{1, 0, 0, 0}), 1e-12, 1e-12));
}

}  // namespace
}  // namespace robocell
