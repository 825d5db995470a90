// Tests when something is handed over, and when it is carried. Hands and objects are put in place;
// nothing is simulated.
#include "robocell/task/two_arm_relations.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/task/testing/two_hands.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

class TwoArmRelations : public TwoHandsTest {};

TEST_F(TwoArmRelations, HandedOverNeedsBothArmsOneAfterTheOther) {
  const auto over = Bound("bar handed_over");
  Hold(false, false, Lying());
  EXPECT_FALSE(Judge(*over));
  EXPECT_EQ(over->Progress(), 0);
  Hold(true, false);
  EXPECT_FALSE(Judge(*over));
  const double with_one = over->Progress();
  EXPECT_GT(with_one, 0);
  Hold(true, true);
  EXPECT_FALSE(Judge(*over)) << "both hold it";
  EXPECT_GT(over->Progress(), with_one);
  Hold(false, true);
  EXPECT_TRUE(Judge(*over));
  EXPECT_EQ(over->Progress(), 1);
}

TEST_F(TwoArmRelations, HandedOverNotByPuttingItDown) {
  const auto over = Bound("bar handed_over");
  Hold(true, false);
  Judge(*over);
  Hold(false, false, Lying());
  Judge(*over);
  Hold(false, true);
  EXPECT_FALSE(Judge(*over)) << "it was put down, and picked up by the other arm";
  Hold(true, false);
  EXPECT_TRUE(Judge(*over)) << "and this one was in the air";
}

TEST_F(TwoArmRelations, AreRestoredFromTheirMemory) {
  const auto over = Bound("bar handed_over"), again = Bound("bar handed_over");
  Hold(true, false);
  Judge(*over);
  Hold(false, true);
  EXPECT_FALSE(again->Holds());
  again->Recall(over->memory());
  EXPECT_TRUE(again->Holds());
  again->Recall(std::vector<double>(over->memory().size(), 0));
  EXPECT_FALSE(again->Holds());
}

TEST_F(TwoArmRelations, CarriedNeedsTwoArmsALevelWayAndTheRegion) {
  const auto carried = Bound("bar carried region 0.3");
  const auto restart = [&] { carried->Recall(std::vector<double>(2, 0)); };
  Hold(false, false, Lying());
  EXPECT_FALSE(Judge(*carried)) << "it lies there, but was not carried";
  Hold(true, true);
  EXPECT_FALSE(Judge(*carried));
  Hold(false, false, Lying());
  EXPECT_TRUE(Judge(*carried));
  Hold(false, false, Pose(Eigen::Vector3d(0.3, 0, kBarHalfWidth - kBarSqueeze)));
  EXPECT_FALSE(Judge(*carried)) << "beside the region";

  restart();
  Hold(true, true);
  Judge(*carried);
  Hold(true, false);
  Judge(*carried);
  Hold(false, false, Lying());
  EXPECT_FALSE(Judge(*carried)) << "one arm alone held it on the way";

  restart();
  Hold(true, true, Pose::FromRpy({0, 0, kHandHeight}, {0, 0.35, 0}));
  Judge(*carried);
  Hold(false, false, Lying());
  EXPECT_FALSE(Judge(*carried)) << "it was tilted";
}

TEST_F(TwoArmRelations, NeedTwoArms) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("bar", {0, 0, kHandHeight}));
  spec.objects.push_back({.name = "region", .mjcf_path = "region", .pos = Vec3{0, 0, 0.001}});
  const Scene scene = Scene::Build(spec);
  for (const char* text : {"bar handed_over", "bar carried region"}) {
    ExpectThrow<ArgumentError>([&] { BindRelation(scene, ParseRelation(text)); },
                               "needs two arms with grippers");
  }
}

}  // namespace
}  // namespace robocell
