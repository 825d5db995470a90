#include "robocell/task/held_relation.h"

#include <gtest/gtest.h>

#include <string>

#include "robocell/base/error.h"
#include "robocell/scenes/relations.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

TEST(HeldRelation, IsRegisteredOnceAndNeverAStart) {
  internal::RegisterTaskRelations();
  internal::RegisterTaskRelations();
  const PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  const auto held = BindRelation(scene.scene, ParseRelation("target held"));
  EXPECT_FALSE(held->Holds());  // it lies on the table
  Rng rng = Rng::Stream(0, "held");
  EXPECT_TRUE(held->Sample(rng, 4).poses.empty());
  EXPECT_EQ(WordsOf(ParseRelation("mug held"), "mug", ""), "pick up the mug");
}

TEST(HeldRelation, SharesAreAboveZeroAndAtMostOne) {
  internal::RegisterTaskRelations();
  for (const std::string relation : {"wiped", "poured_into"}) {
    for (const char* wrong : {" 0", " 3"})
      ExpectThrow<ArgumentError>([&] { ParseRelation("a " + relation + " b" + wrong); },
                                 "above 0 and at most 1");
    EXPECT_NO_THROW(ParseRelation("a " + relation + " b 1"));
  }
}

}  // namespace
}  // namespace robocell
