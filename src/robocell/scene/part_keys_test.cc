#include "robocell/scene/part_keys.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/scene/scene.h"
#include "robocell/scene/testing/keyed_arms.h"
#include "robocell/spec/yaml.h"

namespace robocell::internal {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Eq;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class PartKeysTest : public KeyedArms {};

TEST_F(PartKeysTest, OfRobotAndToolWithEqualNamesAreMerged) {
  AddArm(kHomeAndRetract);
  const std::string tool = folder.Write(
      "tool",
      R"(<worldbody><body name="tool"><joint name="t" axis="0 0 1"/><geom size="0.01"/></body></worldbody>
         <keyframe><key name="retract" qpos="0.7"/><key name="out" qpos="0.2"/></keyframe>)");
  spec.robots[0].attachments.push_back({.mjcf_path = tool, .attach_to = Site("flange")});
  Scene scene = Scene::Build(spec);
  EXPECT_THAT(scene.keyframes(), ElementsAre("home", "retract", "out"));
  scene.Reset({.keyframe = "retract"});
  EXPECT_EQ(scene.joint_pos("elbow"), -1.5);
  EXPECT_EQ(scene.joint_pos("t"), 0.7);
}

TEST_F(PartKeysTest, WithoutANameAreNumbered) {
  AddArm(R"(<key name="home" qpos="0 0"/><key qpos="0.5 0.5"/>)");
  Scene scene = Scene::Build(spec);
  EXPECT_THAT(scene.keyframes(), ElementsAre("home", "key1"));
}

TEST_F(PartKeysTest, AreDeletedByEditsAndFollowNewNames) {
  AddArm(kHomeAndRetract);
  const auto edit = [&](const std::string& text) {
    SceneSpec edited = spec;
    edited.robots[0].config->edits.push_back(FromYamlUnchecked<Edit>(text));
    return Scene::Build(edited);
  };
  EXPECT_THAT(edit("{delete: {key: retract}}").keyframes(), ElementsAre("home"));
  Scene renamed = Scene::Build([&] {
    spec.robots[0].config->move_groups.clear();
    SceneSpec edited = spec;
    edited.robots[0].config->edits.push_back(FromYamlUnchecked<Edit>("{joint: elbow, name: bend}"));
    return edited;
  }());
  renamed.Reset({.keyframe = 1});
  EXPECT_EQ(renamed.joint_pos("bend"), -1.5);
}

TEST_F(PartKeysTest, OutsideTheLimitsOrOfAnotherSizeAreWarnings) {
  AddArm(R"(<key name="home" qpos="0 0"/><key name="far" qpos="9 0"/>)");
  const Scene scene = Scene::Build(spec);
  EXPECT_THAT(scene.compiled()->warnings(),
              Contains(HasSubstr("keyframe 'far': 9 is outside the limits -2 to 2 of joint "
                                 "'shoulder'")));
}

// Everything that a key can contain: servos that integrate, motors with a filter, mocap bodies.
constexpr const char* kRich = R"(
  <compiler angle="radian"/>
  <worldbody>
    <body name="target" mocap="true" pos="0.5 0 0.5"><geom size="0.01" contype="0" conaffinity="0"/></body>
    <body name="base"><geom size="0.05"/>
      <body name="a" pos="0 0 0.2"><joint name="ball" type="ball"/><geom size="0.02" fromto="0 0 0 0 0 0.2" type="capsule"/>
        <body name="b" pos="0 0 0.2"><joint name="j1" axis="0 1 0"/><geom size="0.02" fromto="0 0 0 0 0 0.2" type="capsule"/>
          <body name="c" pos="0 0 0.2"><joint name="j2" axis="0 1 0"/><geom size="0.02" fromto="0 0 0 0 0 0.2" type="capsule"/></body>
        </body></body></body>
  </worldbody>
  <actuator>
    <intvelocity name="m1" joint="j1" kp="500" kv="20" actrange="-2 2" ctrlrange="-1 1"/>
    <general name="m2" joint="j2" dyntype="filter" dynprm="0.1" gainprm="3"/>
  </actuator>
  <keyframe>
    <key name="home" qpos="1 0 0 0 0.5 0.2" qvel="0.1 0.2 0.3 0.4 0.5" act="0.5 0.25" ctrl="0 0.5"
         mpos="0.1 0.2 0.3" mquat="0.6 0 0.8 0"/>
    <key name="up" qpos="0.6 0 0 0.8 1 -0.2" qvel="0 0 0 -0.4 0.1" act="1 -1" ctrl="0 -2"
         mpos="1 2 3" mquat="0 1 0 0"/>
  </keyframe>)";

TEST_F(PartKeysTest, KeepAllFieldsOfEngineKeys) {
  const std::string file = folder.Write("rich", kRich);
  spec.base = file;
  const Scene scene = Scene::Build(spec);
  ExpectAsTheEngine(scene, file, "home");
  ExpectAsTheEngine(scene, file, "up");
}

}  // namespace
}  // namespace robocell::internal
