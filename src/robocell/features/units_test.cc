#include "robocell/features/units.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/files.h"
#include "robocell/scene/scene.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> UnitsOf(const std::string& actuators) {
  const TempDir folder;
  AtomicWrite(folder / "m.xml", R"(
<mujoco>
  <worldbody>
    <site name="anchor"/>
    <body name="a" pos="0 0 1">
      <joint name="hinge"/><geom size="0.1"/><site name="tip" pos="0.1 0 0"/>
      <body name="b"><joint name="slide" type="slide"/><geom size="0.1"/></body>
    </body>
    <body name="c" pos="1 0 1"><joint name="ball" type="ball"/><geom size="0.1"/></body>
  </worldbody>
  <tendon>
    <spatial name="rope"><site site="anchor"/><site site="tip"/></spatial>
    <fixed name="split"><joint joint="slide" coef="0.5"/></fixed>
  </tendon>
  <actuator>)" + actuators + "</actuator></mujoco>");
  const Scene scene =
      Scene::Build({.name = "units", .base = (folder / "m.xml").string(), .timestep = 0.002});
  return CtrlUnits(scene.model());
}

TEST(CtrlUnits, OfServosAndMotors) {
  EXPECT_THAT(UnitsOf(R"(
    <position joint="hinge" kp="50" kv="3"/> <position joint="slide" kp="50" timeconst="0.1"/>
    <velocity joint="hinge" kv="5"/> <velocity joint="slide" kv="5"/>
    <intvelocity joint="hinge" kp="5" actrange="-1 1"/>
    <motor joint="hinge"/> <motor joint="slide" gear="-1"/>
    <motor tendon="rope"/> <position tendon="rope" kp="5"/>)"),
              ElementsAre("rad", "m", "rad/s", "m/s", "rad/s", "N m", "N", "N", "m"));
}

TEST(CtrlUnits, AreOnePerInputOfAnActuator) {
  EXPECT_THAT(UnitsOf(R"(
    <orientation joint="ball" kp="1"/> <pid joint="hinge" kp="1" kv="1" input="pos vel ff"/>
    <motor joint="slide" gear="2"/> <position joint="slide" kp="50"/>
    <general joint="hinge" dyntype="filter" dynprm="0.1"/>)"),
              ElementsAre("actuator", "actuator", "actuator", "actuator", "actuator", "actuator",
                          "actuator", "m", "N m"));
}

TEST(CtrlUnits, OfActuatorsWithACustomScale) {
  EXPECT_THAT(UnitsOf(R"(
    <general joint="slide" gainprm="0.3" biastype="affine" biasprm="0 -100 -10"/>
    <general joint="slide" gainprm="100" biastype="affine" biasprm="5 -100 -10"/>
    <position joint="hinge" kp="50" gear="100"/> <motor joint="hinge" gear="100"/>
    <general joint="hinge" gainprm="7"/> <motor tendon="split"/> <motor joint="ball"/>
    <motor site="tip"/> <adhesion body="a" ctrlrange="0 1"/> <damper joint="hinge" kv="1"
    ctrlrange="0 1"/> <muscle joint="hinge" lengthrange="0 1"/>)"),
              ::testing::AllOf(::testing::SizeIs(11), ::testing::Each("actuator")));
}

}  // namespace
}  // namespace robocell::internal
