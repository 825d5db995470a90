#include "robocell/mujoco/actuators.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;

// Two of them have three inputs and three outputs, so that values counted by inputs or outputs are
// not at an actuator's id.
constexpr const char* kOfAllKinds = R"(<mujoco>
  <worldbody><site name="fixed"/>
    <body name="a"><joint name="ball" type="ball"/><geom name="drum" type="cylinder" size="0.02 0.1"/>
      <site name="on_a" pos="0.1 0 0"/>
      <body name="b" pos="0.3 0 0"><joint name="hinge" axis="0 1 0"/><geom size="0.05" pos="0.1 0 0"/>
        <site name="on_b" pos="0.1 0 0.1"/></body></body>
    <body name="c" pos="0 1 0"><joint name="slide" type="slide"/><geom size="0.05"/>
      <site name="on_c" euler="0 90 0"/></body>
  </worldbody>
  <tendon><fixed name="coupled"><joint joint="hinge" coef="2"/></fixed>
    <spatial name="rope"><site site="on_b"/><geom geom="drum"/><site site="fixed"/></spatial></tendon>
  <actuator>
    <orientation name="turned" joint="ball" kp="1"/>
    <orientation name="against" site="on_b" refsite="fixed" kp="1"/>
    <pid name="three" joint="hinge" kp="1" kv="1" input="pos vel ff"/>
    <motor name="hinge" joint="hinge" gear="3"/>
    <motor name="slide" jointinparent="slide" gear="-4"/>
    <motor name="coupled" tendon="coupled" gear="5"/>
    <motor name="rope" tendon="rope" gear="6"/>
    <motor name="site" site="on_c" gear="0 0 7 0 0 0"/>
    <motor name="crank" cranksite="on_c" slidersite="fixed" cranklength="2" gear="8"/>
    <adhesion name="sticky" body="b" ctrlrange="0 1" gain="2"/>
  </actuator></mujoco>)";

class Actuators : public ::testing::Test {
 protected:
  int Id(const char* name) const { return RequireId(m, mjOBJ_ACTUATOR, name, "actuators"); }
  std::string Body(const char* actuator) const {
    return ElementName(m, mjOBJ_BODY, BodyOfActuator(m, Id(actuator)));
  }

  ModelPtr model = Compile(ParseXmlString(kOfAllKinds, "actuators").get(), nullptr, "actuators");
  const mjModel* m = model.get();
};

TEST_F(Actuators, AreFewerThanTheirInputsAndOutputs) {
  EXPECT_EQ(m->nactuator, 10);
  EXPECT_GT(m->nu, m->nactuator);
  EXPECT_GT(m->nout, m->nactuator);
}

TEST_F(Actuators, HaveTheGearOfTheirOutputs) {
  EXPECT_EQ(Gear(m, Id("hinge")), 3);
  EXPECT_EQ(Gear(m, Id("slide")), -4);
  EXPECT_EQ(Gear(m, Id("coupled")), 5);
  EXPECT_EQ(Gear(m, Id("rope")), 6);
  EXPECT_EQ(Gears(m, Id("site"))[2], 7);
  EXPECT_EQ(Gear(m, Id("crank")), 8);
}

TEST_F(Actuators, ActOnAJointOnlyWithAJointTransmission) {
  std::vector<std::string> on_joints;
  for (int a = 0; a < m->nactuator; ++a) {
    if (ActsOnJoint(m, a)) on_joints.push_back(ElementName(m, mjOBJ_ACTUATOR, a));
  }
  EXPECT_THAT(on_joints, ElementsAre("three", "hinge", "slide"));
}

TEST_F(Actuators, BelongToTheBodyTheyActOn) {
  EXPECT_EQ(Body("turned"), "a");
  for (const char* name : {"against", "three", "hinge", "coupled", "rope", "sticky"})
    EXPECT_EQ(Body(name), "b") << name;
  for (const char* name : {"slide", "site", "crank"}) EXPECT_EQ(Body(name), "c") << name;
}

// The oracle for the moved degrees of freedom is the engine's moment.
TEST_F(Actuators, MoveTheReportedBody) {
  DataPtr data = MakeData(m);
  data->qpos[4] = 0.3;
  mj_forward(m, data.get());
  for (int a = 0; a < m->nactuator; ++a) {
    if (m->actuator_trntype[a] == mjTRN_BODY) continue;  // moves nothing without a contact
    const int body = BodyOfActuator(m, a);
    bool moves = false;
    for (int out = m->actuator_outadr[a]; out < m->actuator_outadr[a] + m->actuator_outnum[a];
         ++out) {
      const int first = data->moment_rowadr[out];
      for (int i = first; i < first + data->moment_rownnz[out]; ++i)
        moves = moves || (data->actuator_moment[i] != 0 &&
                          IsInSubtree(m, body, m->dof_bodyid[data->moment_colind[i]]));
    }
    EXPECT_TRUE(moves) << ElementName(m, mjOBJ_ACTUATOR, a);
  }
}

}  // namespace
}  // namespace robocell::internal
