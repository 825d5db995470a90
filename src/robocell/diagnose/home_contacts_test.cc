// Tests contacts at home.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "robocell/diagnose/testing/bar.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;

using HomeContacts = BarTrial;

TEST_F(HomeContacts, AreReportedBeforeStiffness) {
  const char* block = "<body name='block' pos='0.3 0 0'><geom type='box' size='.02 .1 .1'/></body>";
  const std::vector<std::string> doubts = Doubts("kp='500' kv='50'", "gravcomp: true\n", block);
  ASSERT_FALSE(doubts.empty());
  EXPECT_THAT(doubts[0],
              HasSubstr("home: 'bar' and 'block' touch at home: exclude the pair in the model"));
  for (size_t i = 1; i < doubts.size(); ++i)
    EXPECT_THAT(doubts[i],
                AllOf(HasSubstr("'bar' and 'block' touch"), Not(HasSubstr("stiffness"))));
}

TEST_F(HomeContacts, IgnoresGeomsThatOnlyTheirMarginsReach) {
  const char* block =
      "<body name='block' pos='0.3 0 0.05'><geom type='box' size='.02 .1 .02' "
      "margin='.0105'/></body>";
  EXPECT_THAT(Doubts("kp='500' kv='50'", "gravcomp: true\n", block), IsEmpty());
}

// Excludes contacts of two objects of its scene and of the fingers of a closed gripper.
TEST_F(HomeContacts, IncludeOnlyContactsOfTheRobot) {
  Doubts("kp='500' kv='50'");
  const std::string gripper = folder_.Write("grip", kTwoFingerGripper);
  AtomicWrite(file_, "name: bar\nmodel: bar.xml\ngravcomp: true\nattachments: [{mjcf_path: " +
                         gripper + R"(, attach_to: {site: tip}}]
move_groups:
  arm: {kind: arm, joints: [hip], leaf: {site: tip}}
  gripper: {kind: gripper, joints: [left_slide, right_slide], actuators: [grip],
            fingers: [left_pad, right_pad], ctrl: {open: 255, closed: 0}}
home: {arm: [0], gripper: [0.004, 0.004]}
)");
  SceneSpec spec = SceneWith({.name = "bar", .config = RobotConfig::Load(file_)});
  spec.objects = {BoxObject("low", {1, 1, 0.02}), BoxObject("high", {1, 1, 0.059})};
  const Scene scene = Scene::Build(spec);
  std::set<std::string> touching;
  for (const Contact& contact : scene.contacts()) touching.insert(contact.body2);
  EXPECT_THAT(touching, IsSupersetOf({"right", "high"})) << "else this tests nothing";
  EXPECT_THAT(LinesOfRobot(Robot::Of(scene, "bar")), IsEmpty());
}

}  // namespace
}  // namespace robocell
