// Tests cameras that are far away from their robot.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/scene/testing/arm_with_hand.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

using CameraPlaces = ArmWithHand;

TEST_F(CameraPlaces, ACameraFarAway) {
  const char* camera =
      "cameras:\n  - {{name: eye, attach_to: {{body: {}}}, pos: [{}, 0, 0], fovy: "
      "60}}\n";
  EXPECT_THAT(Warnings({}, fmt::format(fmt::runtime(camera), "fore", 0.3)), IsEmpty());
  EXPECT_THAT(Warnings({}, fmt::format(fmt::runtime(camera), "base", 2.5)), IsEmpty());
  EXPECT_THAT(Warnings({}, fmt::format(fmt::runtime(camera), "fore", 80)),
              ElementsAre(AllOf(
                  StartsWith(file_ + ":7:"),
                  HasSubstr("robot 'arm' / camera 'eye': camera 'eye' is 79.8 m away from the "
                            "robot, which is 0."),
                  HasSubstr("m large: `pos` is in metres, in the frame of its parent"))));
}

TEST_F(CameraPlaces, AcceptsACameraOfTheModelAnywhere) {
  Model({.finger = "/><camera name=\"view\" pos=\"5 0 0\"/><camera name=\"follow\" "
                   "mode=\"trackcom\" pos=\"0 5 0\"/><geom size=\"0.001\""});
  EXPECT_THAT(Build().compiled()->warnings(), IsEmpty());
  EXPECT_THAT(Build("edits: [{camera: follow, pos: [0, 6, 0]}, {camera: view, fovy: 50}]\n")
                  .compiled()
                  ->warnings(),
              IsEmpty());
  EXPECT_THAT(Build("edits: [{camera: view, pos: [80, 0, 0]}]\n").compiled()->warnings(),
              ElementsAre(AllOf(StartsWith(file_ + ":6:"),
                                HasSubstr("robot 'arm' / edits[0]: camera 'view' is "))));
}

}  // namespace
}  // namespace robocell
