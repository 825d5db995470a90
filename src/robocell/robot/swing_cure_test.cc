// Tests servos that oscillate with the timestep: they are found, and what calms them does so.
#include "robocell/robot/swing_cure.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <string>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/owners.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

// A light link on a servo at its force limit, and a heavy one on a soft servo.
struct TwoLinks {
  explicit TwoLinks(const std::string& light = "", double timestep = 0.002) {
    const std::string xml = fmt::format(
        R"(<mujoco><option timestep="{}" integrator="implicitfast" gravity="0 0 0"/><worldbody>
    <body><joint name="left_light" axis="0 1 0" {}/>
      <geom type="capsule" size=".02" fromto=".02 0 0 .1 0 0" mass=".05"/></body>
    <body pos="0 1 0"><joint name="left_heavy" axis="0 1 0" damping="1"/>
      <geom type="capsule" size=".02" fromto=".02 0 0 .3 0 0" mass="2"/></body></worldbody><actuator>
    <position name="left_fast" joint="left_light" kp="5000" kv="50" forcerange="-2 2"/>
    <position name="left_slow" joint="left_heavy" kp="100" kv="10"/></actuator></mujoco>)",
        timestep, light);
    model = Compile(ParseXmlString(xml, "links").get());
    data = MakeData(model.get());
    data->ctrl[0] = data->ctrl[1] = 0.1;
  }
  SwingTrial trial() const {
    return {.model = model.get(), .start = data.get(), .joints = {0, 1}, .prefix = "left_"};
  }

  ModelPtr model;
  DataPtr data;
};

TEST(SwingCure, OnlyJointsThatTurnBackAgainAndAgainSwing) {
  EXPECT_THAT(SwingingJoints(TwoLinks().trial()), ElementsAre(0));
  EXPECT_THAT(SwingingJoints(TwoLinks("armature=\"0.2\"").trial()), IsEmpty());
  EXPECT_THAT(SwingingJoints(TwoLinks("", 1e-4).trial()), IsEmpty());
}

TEST(SwingCure, NamesTheArmatureAndTheTimestepThatCalmIt) {
  const TwoLinks links;
  const SwingCure cure = FindSwingCure(links.trial());
  ASSERT_EQ(cure.edits.size(), 1u);
  EXPECT_THAT(cure.edits[0], StartsWith("{joint: 'light', armature: 0.0"));
  EXPECT_THAT(cure.Text(), HasSubstr("In a trial `edits: [" + cure.edits[0] +
                                     "]` brought it to rest, and so did a timestep of "));
  const std::string value = cure.edits[0].substr(cure.edits[0].rfind(' ') + 1);
  const double armature = std::stod(value);
  EXPECT_THAT(SwingingJoints(TwoLinks(fmt::format("armature=\"{}\"", armature)).trial()),
              IsEmpty());
  ASSERT_GT(cure.timestep, 0);
  EXPECT_THAT(SwingingJoints(TwoLinks("", cure.timestep).trial()), IsEmpty());
  EXPECT_EQ(links.model->dof_armature[0], 0) << "the model itself stays as it is";
}

TEST(SwingCure, HasNothingToSayAboutJointsAtRest) {
  const SwingCure cure = FindSwingCure(TwoLinks("armature=\"0.2\"").trial());
  EXPECT_FALSE(cure.found());
}

}  // namespace
}  // namespace robocell::internal
