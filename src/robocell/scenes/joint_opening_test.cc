#include "robocell/scenes/joint_opening.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/base/error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;

// A door that opens backwards is closed where its model has it.
TEST(JointOpening, IsClosedAtTheReferenceAndOpenAtTheFarEnd) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  const std::string doors = folder.Write("doors", R"(<compiler angle="radian"/><worldbody>
    <body name="doors"><geom size=".1"/>
      <body name="left"><joint name="left" range="-1.5 0"/><geom size=".1" mass="1"/></body>
      <body name="right"><joint name="right" range="0.2 1.2"/><geom size=".1" mass="1"/></body>
      <body name="free"><joint name="free"/><geom size=".1" mass="1"/></body>
    </body></worldbody>)");
  spec.objects.push_back({.name = "d", .mjcf_path = doors, .pos = Vec3{0, 0, 1}, .fixed = true});
  const Scene scene = Scene::Build(spec);
  const JointOpening left = JointOpening::Of(scene, "d_left"),
                     right = JointOpening::Of(scene, "d_right");
  EXPECT_EQ(left.closed(), 0);
  EXPECT_EQ(left.open(), -1.5);
  EXPECT_EQ(right.closed(), 0.2);
  EXPECT_EQ(right.open(), 1.2);
  EXPECT_EQ(left.PositionAt(0.5), -0.75);
  ExpectThrow<ArgumentError>([&] { JointOpening::Of(scene, "d_free"); }, "has no range");
  const std::string several =
      ExpectThrow<ArgumentError>([&] { JointOpening::Of(scene, "d"); }, "has 3 joints");
  EXPECT_THAT(several, HasSubstr("d_left, d_right, d_free"));
  ExpectThrow<NotFoundError>([&] { JointOpening::Of(scene, "d_lef"); }, "Did you mean 'd_left'?");
}

}  // namespace
}  // namespace robocell
