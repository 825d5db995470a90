#include "robocell/expert/skill_expert.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

TEST(SkillExpert, RejectsATaskWithoutRelations) {
  const PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  const EpisodeStart start{.scene = scene.scene, .task = nullptr, .target_object = "target"};
  ExpectThrow<SpecError>([&] { SkillExpert(scene.run, start); },
                         "demonstrates tasks whose goals are relations");
}

}  // namespace
}  // namespace robocell
