// Keyframes of several robots in one model.
#include "robocell/scene/key_share.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/scene/scene.h"
#include "robocell/scene/testing/keyed_arms.h"

namespace robocell::internal {
namespace {

using Joints = std::vector<double>;

// Two arms on one stand, each with a finger that no group lists.
constexpr const char* kTwins = R"(
  <compiler angle="radian"/>
  <worldbody><body name="stand">
    <body name="l_base"><body name="l_1"><joint name="l_j" axis="0 0 1"/><geom size="0.02"/>
      <body name="l_2" pos="0 0 0.2"><joint name="l_f" type="slide"/><geom size="0.02"/></body></body></body>
    <body name="r_base" pos="0 1 0"><body name="r_1"><joint name="r_j" axis="0 0 1"/><geom size="0.02"/>
      <body name="r_2" pos="0 0 0.2"><joint name="r_f" type="slide"/><geom size="0.02"/></body></body></body>
  </body></worldbody>
  <tendon><fixed name="l_t"><joint joint="l_f" coef="1"/></fixed>
          <fixed name="r_t"><joint joint="r_f" coef="1"/></fixed></tendon>
  <actuator>
    <position name="l_a" joint="l_j" kp="100"/><position name="l_g" tendon="l_t" kp="100"/>
    <position name="r_a" joint="r_j" kp="100"/><position name="r_g" tendon="r_t" kp="100"/>
  </actuator>
  <keyframe><key name="A" qpos="0.1 0.01 0.2 0.02" ctrl="0.1 0.01 0.2 0.02"/>
            <key name="B" qpos="0.3 0.03 0.4 0.04" ctrl="0.3 0.03 0.4 0.04"/></keyframe>)";

class SharedKeys : public ::testing::Test {
 protected:
  RobotSpec Arm(const std::string& side, const std::string& root) {
    RobotConfig config{.name = side, .model = model_, .root_body = root};
    config.move_groups["arm"] = {
        .kind = MoveGroupKind::kArm, .joints = {side + "_j"}, .actuators = {side + "_a"}};
    return {.name = side, .config = config, .prefix = "x_"};
  }
  Scene Twins(const std::string& left_root, const std::string& right_root) {
    SceneSpec spec = EmptyScene();
    spec.robots.push_back(Arm("l", left_root));
    RobotSpec right = Arm("r", right_root);
    right.part_of = "l";
    spec.robots.push_back(right);
    return Scene::Build(spec);
  }
  static Joints QposAfter(Scene& scene, const PartKeyframes& keys) {
    scene.Reset({.keyframe = keys});
    const mjData* d = scene.data();
    EXPECT_EQ(Joints(d->qpos, d->qpos + 4), Joints(d->ctrl, d->ctrl + 4));
    return {d->qpos, d->qpos + 4};
  }

  ModelFolder folder_;
  std::string model_ = folder_.Write("twins", kTwins);
};

TEST_F(SharedKeys, OfOneRobotKeepTheOthersAtHome) {
  Scene scene = Twins("l_base", "r_base");
  EXPECT_EQ(QposAfter(scene, {{"l", "A"}}), (Joints{0.1, 0.01, 0, 0}));
  EXPECT_EQ(QposAfter(scene, {{"r", "A"}}), (Joints{0, 0, 0.2, 0.02}));
  EXPECT_EQ(QposAfter(scene, {{"l", "A"}, {"r", "B"}}), (Joints{0.1, 0.01, 0.4, 0.04}));
  EXPECT_EQ(QposAfter(scene, {{"l", "B"}, {"r", "A"}}), (Joints{0.3, 0.03, 0.2, 0.02}));
  EXPECT_EQ(QposAfter(scene, {{"l", "B"}, {"r", "home"}}), (Joints{0.3, 0.03, 0, 0}));
}

TEST_F(SharedKeys, OfRobotsWithOneRootAreSplitByGroups) {
  Scene scene = Twins("stand", "stand");
  EXPECT_EQ(QposAfter(scene, {{"l", "A"}, {"r", "B"}}), (Joints{0.1, 0.01, 0.4, 0.04}));
}

TEST_F(SharedKeys, OfASeparateModelBelongToItsRobot) {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back(Arm("l", "stand"));
  Scene scene = Scene::Build(spec);
  EXPECT_EQ(QposAfter(scene, {{"l", "B"}}), (Joints{0.3, 0.03, 0.4, 0.04}));
  EXPECT_TRUE(ShareOfKeys(*scene.compiled(), "l").qpos.empty());
}

}  // namespace
}  // namespace robocell::internal
