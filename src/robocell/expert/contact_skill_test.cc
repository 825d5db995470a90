#include "robocell/expert/contact_skill.h"

#include <gtest/gtest.h>

#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

TEST(ContactSkill, FailsWithoutAPathForTheReasonOfItsKind) {
  const PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  Rng rng = Rng::Stream(1, "skill");
  ContactSkill skill({.robot = scene.robot.name(), .sim = scene.run.options},
                     {.paths = [](const Robot&, const GripperShape&) { return SourceOf({}); },
                      .target_body = scene.target_body,
                      .follow_phase = "push",
                      .without_paths = "no way to push it"});
  skill.Begin(scene.scene, rng);
  EXPECT_TRUE(skill.done());
  EXPECT_EQ(skill.failure(), "no way to push it");
}

TEST(ContactSkill, NamesWhatIsOutOfReach) {
  const PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  Rng rng = Rng::Stream(1, "skill");
  ContactPath far;
  far.tcp_in_world = {Pose(Eigen::Vector3d(5, 0, 1))};
  ContactSkill skill({.robot = scene.robot.name(), .sim = scene.run.options},
                     {.paths = [&](const Robot&, const GripperShape&) { return SourceOf({far}); },
                      .target_body = scene.target_body,
                      .follow_phase = "push"});
  skill.Begin(scene.scene, rng);
  EXPECT_TRUE(skill.done());
  EXPECT_EQ(skill.failure(), "nothing in reach");
}

}  // namespace
}  // namespace robocell
