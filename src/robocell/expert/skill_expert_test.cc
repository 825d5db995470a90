#include "robocell/expert/skill_expert.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

TEST(SkillExpert, RejectsATaskWithoutRelations) {
  RunConfig run = ExampleRun("pick_and_place.yaml");
  ExpectThrow<SpecError>([&] { SkillExpert(run, EpisodeStart{}); },
                         "demonstrates tasks whose goals are relations");
}

}  // namespace
}  // namespace robocell
