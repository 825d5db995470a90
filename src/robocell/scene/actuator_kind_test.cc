// Compares the kinds of actuators with the engine's forces; models under construction agree with
// compiled ones.
#include "robocell/scene/actuator_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/spec_tree.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;

constexpr const char* kAllKinds = R"(
  <worldbody><body><joint name="j"/><geom size="0.1"/><site name="s"/>
    <body><joint name="ball" type="ball"/><geom size="0.1"/></body></body></worldbody>
  <actuator>
    <position name="position" joint="j" kp="7" kv="2"/>
    <position name="filtered" joint="j" kp="7" timeconst="0.1"/>
    <general name="scaled" joint="j" gainprm="0.1" biastype="affine" biasprm="-1 -9 -2"/>
    <general name="reversed" joint="j" gainprm="-3" biastype="affine" biasprm="0 -3 0"/>
    <velocity name="velocity" joint="j" kv="4"/>
    <motor name="motor" joint="j" gear="5"/>
    <general name="strong" joint="j" gainprm="6"/>
    <intvelocity name="integrating" joint="j" kp="7" actrange="-1 1"/>
    <general name="lagging" joint="j" dyntype="filter" dynprm="0.1" gainprm="6"/>
    <general name="pushing" joint="j" gainprm="6" biastype="affine" biasprm="0 8 0"/>
    <general name="offset" joint="j" gainprm="4" biastype="affine" biasprm="1 0 -4"/>
    <damper name="damper" joint="j" kv="3" ctrlrange="0 1"/>
    <motor name="at_a_site" site="s" gear="0 0 1 0 0 0"/>
    <motor name="on_a_ball" joint="ball" gear="0 0 1"/>
    <motor name="without_gear" joint="j" gear="0"/>
    <position name="beside_the_axis" joint="j" kp="7" gear="0 1"/>
    <motor name="site_without_gear" site="s" gear="0"/>
  </actuator>)";

class Kinds : public ::testing::Test {
 protected:
  ModelFolder folder;
  SpecPtr spec = ParseXmlFile(folder.Write("kinds", kAllKinds));
  ModelPtr model = Compile(spec.get());
  DataPtr data = MakeData(model.get());

  int Id(const std::string& name) { return RequireId(model.get(), mjOBJ_ACTUATOR, name, ""); }

  double Force(int actuator, double q, double v, double ctrl) {
    mj_resetData(model.get(), data.get());
    data->qpos[0] = q;
    data->qvel[0] = v;
    data->ctrl[actuator] = ctrl;
    mj_forward(model.get(), data.get());
    return data->actuator_force[actuator];
  }
};

TEST_F(Kinds, AreTheSameInASpecAndInItsModel) {
  int motors = 0;
  for (mjsElement* element : SpecElements(spec.get(), mjOBJ_ACTUATOR)) {
    const int id = Id(SpecName(element));
    const mjsActuator* actuator = mjs_asActuator(element);
    EXPECT_EQ(ActuatorKind(actuator), ActuatorKind(model.get(), id)) << SpecName(element);
    EXPECT_EQ(ActsOnJoint(actuator), ActsOnJoint(model.get(), id)) << SpecName(element);
    motors += ActuatorKind(actuator) == CtrlMode::kTorque ? 1 : 0;
  }
  EXPECT_EQ(motors, 4);
  EXPECT_FALSE(ActsOnJoint(model.get(), Id("at_a_site")));
}

TEST_F(Kinds, MatchTheForcesOfTheEngine) {
  for (int a = 0; a < model->nactuator; ++a) {
    const auto kind = ActuatorKind(model.get(), a);
    if (!kind || model->actuator_dyntype[a] != mjDYN_NONE || !ActsOnJoint(model.get(), a)) continue;
    const std::string name = ElementName(model.get(), mjOBJ_ACTUATOR, a);
    const double at_rest = Force(a, 0, 0, 0);
    EXPECT_NE(Force(a, 0, 0, 1), at_rest) << name;
    EXPECT_EQ(Force(a, 1, 0, 0) < at_rest, kind == CtrlMode::kPosition) << name;
    if (kind == CtrlMode::kVelocity) {
      EXPECT_EQ(Force(a, 0, 0.5, 0.5), 0) << name;
    }
    if (kind == CtrlMode::kTorque) {
      EXPECT_EQ(Force(a, 1, 1, 0.5), Force(a, 0, 0, 0.5)) << name;
    }
  }
}

TEST_F(Kinds, AreEmptyWithoutGear) {
  for (const char* name : {"without_gear", "beside_the_axis", "site_without_gear"}) {
    const int id = Id(name);
    EXPECT_EQ(ActuatorKind(model.get(), id), std::nullopt) << name;
    EXPECT_EQ(DescribeActuator(model.get(), id), "without effect, as its gear is 0");
    Force(id, 1, 1, 1);
    const int output = model->actuator_outadr[id], first = data->moment_rowadr[output];
    for (int i = first; i < first + data->moment_rownnz[output]; ++i)
      EXPECT_EQ(data->actuator_moment[i], 0) << name;
  }
  Force(Id("on_a_ball"), 0, 0, 1);
  EXPECT_EQ(data->qfrc_actuator[3], 1);
}

TEST_F(Kinds, AreEmptyForOtherActuators) {
  for (const char* name : {"position", "filtered", "scaled", "reversed"})
    EXPECT_TRUE(IsPositionServo(model.get(), Id(name))) << name;
  EXPECT_EQ(ActuatorKind(model.get(), Id("velocity")), CtrlMode::kVelocity);
  for (const char* name : {"motor", "strong"})
    EXPECT_EQ(ActuatorKind(model.get(), Id(name)), CtrlMode::kTorque) << name;
  for (const char* name : {"integrating", "lagging", "pushing", "offset", "damper"})
    EXPECT_EQ(ActuatorKind(model.get(), Id(name)), std::nullopt) << name;
  EXPECT_EQ(DescribeActuator(model.get(), Id("scaled")), "a position servo");
  EXPECT_EQ(DescribeActuator(model.get(), Id("integrating")),
            "a servo that integrates its control");
  EXPECT_EQ(DescribeActuator(model.get(), Id("damper")),
            "no position servo, velocity servo or motor");
}

TEST_F(Kinds, AreEmptyForServosWithoutAPositiveGain) {
  spec = ParseXmlFile(folder.Write("gains", R"(
    <worldbody><body><joint name="j"/><geom size="0.1"/></body></worldbody>
    <actuator>
      <position name="away" joint="j" kp="-400" kv="40"/>
      <position name="nowhere" joint="j" kp="0" kv="40"/>
      <velocity name="faster" joint="j" kv="-4"/>
    </actuator>)"));
  model = Compile(spec.get());
  const auto described = [&](const char* name) {
    EXPECT_EQ(ActuatorKind(model.get(), Id(name)), std::nullopt) << name;
    return DescribeActuator(model.get(), Id(name));
  };
  EXPECT_EQ(described("away"), "a servo with kp -400, which pushes away from its target");
  EXPECT_EQ(described("nowhere"), "a servo with kp 0, which drives to no target");
  EXPECT_EQ(described("faster"), "a servo with kv -4, which pushes away from its target");
}

TEST(ArmDrives, AreOfOneKindOnAllJoints) {
  using Names = std::vector<std::string>;
  const Names joints = {"a", "b"};
  const auto names = [&](const std::vector<JointActuator>& actuators) {
    const ArmDrive drive = FindArmDrive(joints, actuators);
    return drive.complete() ? drive.names : Names{};
  };
  const JointActuator servo_a{"a", "sa", CtrlMode::kPosition},
      servo_b{"b", "sb", CtrlMode::kPosition}, motor_a{"a", "ma", CtrlMode::kTorque},
      motor_b{"b", "mb", CtrlMode::kTorque};
  EXPECT_THAT(names({motor_a, motor_b, servo_b, servo_a}), ElementsAre("sa", "sb"));
  EXPECT_THAT(names({servo_a, motor_b, motor_a}), ElementsAre("ma", "mb"));
  EXPECT_THAT(names({{"b", "mb2", CtrlMode::kTorque}, motor_a, motor_b}), ElementsAre("ma", "mb2"));
  EXPECT_THAT(names({servo_a, motor_b}), ElementsAre());
  EXPECT_THAT(names({servo_a, motor_b, {"a", "a_torque", CtrlMode::kTorque}}), ElementsAre())
      << "one of them is switched off";
  EXPECT_THAT(names({{"a", "x", std::nullopt}, {"b", "y", std::nullopt}}), ElementsAre());
  EXPECT_EQ(FindArmDrive(joints, {servo_a, motor_b}).kind, CtrlMode::kPosition);
  EXPECT_FALSE(FindArmDrive(joints, {}).kind);
  EXPECT_FALSE(FindArmDrive({}, {servo_a}).complete());
}

TEST(ArmDrives, ExcludeActuatorsAddedForOtherModes) {
  const JointActuator added{"a", "a_position", CtrlMode::kPosition},
      own{"a", "m", CtrlMode::kTorque};
  EXPECT_THAT(FindArmDrive({"a"}, {own, added}).names, ElementsAre("m"));
  EXPECT_THAT(FindArmDrive({"a"}, {added, own}).names, ElementsAre("a_position"))
      << "what is added comes last: this is the model's own";
  EXPECT_THAT(FindArmDrive({"a"}, {{"a", "a_torque", CtrlMode::kTorque}, added}).names,
              ElementsAre("a_torque"));
}

}  // namespace
}  // namespace robocell::internal
