// Tests tendons that chains leave out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/scene/testing/changed_arm.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Tendons : public ChangedArm {};

TEST_F(Tendons, ArmatureOfASpatialTendonOfAnArmIsNoted) {
  const auto notes = [&](const std::string& armature, const std::string& end) {
    std::string model = With(R"(<site name="here" pos="0 0.1 0"/>)", "<site name=\"flange\"");
    model.insert(model.find("<body name=\"upper\""), R"(<site name="there" pos="0 0.1 0"/>)");
    model.insert(model.find("<actuator>"), "<tendon><spatial name=\"cable\" armature=\"" +
                                               armature + "\"><site site=\"" + end +
                                               "\"/><site site=\"flange\"/></spatial></tendon>");
    return Compiled(model)->notes();
  };
  EXPECT_THAT(notes("0", "there"), IsEmpty());
  EXPECT_THAT(notes("0.3", "here"), IsEmpty()) << "both ends are on one link";
  EXPECT_THAT(
      notes("0.3", "there"),
      ElementsAre("robot 'a': the armature of tendon 'cable', 0.3 kg with that of actuators, is "
                  "left out of chain dynamics (mass matrix, inverse dynamics): what a spatial "
                  "tendon adds to the joints changes with the pose. Impedance control, which asks "
                  "the engine, has it"));
}

}  // namespace
}  // namespace robocell
