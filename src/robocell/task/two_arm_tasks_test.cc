// Tests what the tasks for two arms add, and when they refuse.
#include "robocell/task/two_arm_tasks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

TEST(HandoverTask, SaysWhatItAdds) {
  internal::HandoverTask task({});
  SceneSpec spec = EmptyScene();
  Rng rng = Rng::Stream(3, "test");
  task.Prepare(spec, rng);
  ASSERT_EQ(spec.objects.size(), 1u);
  EXPECT_EQ(spec.objects[0].name, "target");
  EXPECT_THAT(task.objects(), ElementsAre("target"));
  EXPECT_EQ(task.kind_of("target"), "bar");
  EXPECT_EQ(task.instruction(), "hand the bar over from one arm to the other");
}

TEST(CarryTask, SaysWhatItAdds) {
  internal::CarryTask task({});
  SceneSpec spec = EmptyScene();
  Rng rng = Rng::Stream(3, "test");
  task.Prepare(spec, rng);
  EXPECT_THAT(task.objects(), ElementsAre("target", "region"));
  EXPECT_EQ(task.instruction(), "carry the case with both arms to the marked region");
}

TEST(CarryTask, NeedsTwoArms) {
  internal::CarryTask task({});
  SceneSpec spec = EmptyScene();
  Rng rng = Rng::Stream(3, "test");
  task.Prepare(spec, rng);
  spec.objects[0].pos = Vec3{};
  const Scene scene = Scene::Build(spec);
  ExpectThrow<ArgumentError>([&] { task.Bind(scene, {.place = "run 'a'", .robots = {}}); },
                             "needs two arms with grippers");
}

}  // namespace
}  // namespace robocell
