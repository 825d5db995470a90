// Tests proposed servos: they hold what they move, and their numbers against the engine's inertia.
#include "robocell/scene/servo_proposal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/compile.h"
#include "robocell/scene/testing/urdf_texts.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

using ServoProposals = UrdfTexts;

// The tolerance of `robocell check` for joints that hold their home is 0.01 rad.
TEST_F(ServoProposals, ServosCarryTheWeight) {
  const Urdf urdf = ReadUrdf(Write(Arm()));
  const SpecPtr spec = MakeUrdfSpec(urdf);
  AddUrdfServos(urdf, spec.get());
  spec->option.integrator = mjINT_IMPLICITFAST;  // as in scenes
  const ModelPtr model = Compile(spec.get());
  const DataPtr data = MakeData(model.get());
  for (int i = 0; i < 1000; ++i) mj_step(model.get(), data.get());
  EXPECT_NEAR(data->qpos[0], 0, 0.01);
  EXPECT_NEAR(data->qpos[1], 0, 0.001);
}

TEST_F(ServoProposals, ServosHoldTheArm) {
  const Urdf urdf = ReadUrdf(Write(Arm()));
  const SpecPtr spec = MakeUrdfSpec(urdf);
  EXPECT_THAT(AddUrdfServos(urdf, spec.get()),
              ElementsAre(HasSubstr("position servos were made for turn, slide")));
  spec->option.integrator = mjINT_IMPLICITFAST;  // as in scenes
  const ModelPtr model = Compile(spec.get());
  ASSERT_EQ(model->nactuator, 2);
  EXPECT_EQ(model->actuator_forcerange[1], 40) << "effort";
  EXPECT_EQ(model->actuator_ctrlrange[0], -1);
  EXPECT_EQ(model->actuator_ctrlrange[1], 2);
  const DataPtr data = MakeData(model.get());
  data->ctrl[0] = 0.5;
  for (int i = 0; i < 1000; ++i) mj_step(model.get(), data.get());
  EXPECT_NEAR(data->qpos[0], 0.5, 0.1);
  EXPECT_NEAR(data->qvel[0], 0, 0.01);
}

// The inertia of a rod about its end, and of a second one that follows it twice as fast.
TEST_F(ServoProposals, StiffnessFollowsTheInertiaThatTheJointMoves) {
  const std::string rod = "<geom type='capsule' fromto='0 0 0 0 0 1' size='.001' mass='3'/>";
  const auto joint = [](const std::string& name) {
    return "<joint name='" + name + "' axis='0 1 0' armature='1e-9'/>";
  };
  const std::string bodies = "<worldbody><body>" + joint("a") + rod + "</body><body>" + joint("b") +
                             rod + "</body></worldbody>";
  const auto propose = [&](const std::string& rest) {
    const std::string text = "<mujoco><option gravity='0 0 0'/>" + bodies + rest + "</mujoco>";
    const ModelPtr model = Compile(ParseXmlString(text).get());
    return ProposeServo(model.get(), 0);
  };
  const ServoProposal alone = propose("");
  EXPECT_NEAR(alone.kp, 25.0 * 25.0, 10);  // 1 kg m2
  EXPECT_NEAR(alone.kv, 2 * 25.0, 1);      // critically damped
  EXPECT_EQ(alone.armature, 0);
  EXPECT_FALSE(alone.ctrl_range);
  const ServoProposal two =
      propose("<equality><joint joint1='b' joint2='a' polycoef='0 2 0 0 0'/></equality>");
  EXPECT_NEAR(two.kp, 5 * 25.0 * 25.0, 100);  // 1 + 2^2
}

}  // namespace
}  // namespace robocell::internal
