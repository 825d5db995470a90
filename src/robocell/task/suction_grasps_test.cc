// Tests where a suction cup sticks: on flat and level tops that are larger than its face.
#include "robocell/task/suction_grasps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <memory>

#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/random_values.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

// A lift whose cup, of 2 cm radius, points down; the TCP is at its lip.
constexpr const char* kCup = R"(<worldbody><body name="mast" pos="0 0 1">
  <body name="cup"><joint name="lift" type="slide" axis="0 0 1" range="-.1 .1"/>
    <geom name="lip" type="cylinder" size=".02 .03" mass=".1"/>
    <site name="tip" pos="0 0 -.03" quat="0 1 0 0"/></body></body></worldbody>
  <actuator><position joint="lift" kp="2000" kv="100"/>
    <adhesion name="suck" body="cup" gain="40" ctrlrange="0 1"/></actuator>)";

class SuctionGrasps : public ::testing::Test {
 protected:
  SuctionGrasps() {
    const RobotConfig config{
        .name = "lifter",
        .model = folder_.Write("lifter", kCup),
        .move_groups = {
            {"arm",
             {.kind = MoveGroupKind::kArm, .joints = {"lift"}, .leaf = ElementRef{.name = "tip"}}},
            {"cup",
             {.kind = MoveGroupKind::kGripper,
              .actuators = {"suck"},
              .leaf = ElementRef{.name = "tip"}}}}};
    shape_ = GripperShape::Of(config, {}, 0.002);
  }

  std::vector<GraspCandidate> On(const SceneObject& object, const Quaternion& turn = {0, 0, 0, 1}) {
    SceneSpec spec = EmptyScene();
    spec.objects.push_back(object);
    Scene scene = Scene::Build(spec);
    scene.SetBodyPose(object.name, Pose({0.3, 0.1, 0.5}, turn));
    scene.Forward();
    return FindGrasps(scene.model(), scene.data(), FindId(scene.model(), mjOBJ_BODY, object.name),
                      *shape_, Pose());
  }

  ModelFolder folder_;
  std::shared_ptr<const GripperShape> shape_;
};

TEST_F(SuctionGrasps, TheShapeIsThatOfTheFaceOfTheCup) {
  EXPECT_TRUE(shape_->is_suction());
  EXPECT_TRUE(shape_->joint_names().empty());
  EXPECT_EQ(shape_->open_gap(), 0);
  EXPECT_NEAR(shape_->pad_half_width(), 0.02, 1e-3);
  EXPECT_NEAR(shape_->pad_half_height(), 0.02, 1e-3);
  EXPECT_TRUE(shape_->PadAt(0).isZero(1e-9)) << "the TCP is at the lip";
  EXPECT_NEAR(shape_->grasp_in_tcp().rotation()(2, 2), 1, 1e-12) << "it points along z of the TCP";
}

TEST_F(SuctionGrasps, StickToTheTopOfABoxFromAbove) {
  SceneObject box = BoxObject("box", {0, 0, 0});
  box.size = Vec3{0.04, 0.05, 0.03};
  const std::vector<GraspCandidate> grasps = On(box);
  ASSERT_FALSE(grasps.empty());
  for (const GraspCandidate& grasp : grasps) {
    const Vector3d at = grasp.tcp_in_world.translation();
    EXPECT_NEAR(at.z(), 0.53 - 0.001, 1e-6) << "it presses a little";
    EXPECT_LE(std::abs(at.x() - 0.3), 0.02) << "the whole face is on the box";
    EXPECT_LE(std::abs(at.y() - 0.1), 0.03);
    EXPECT_NEAR(grasp.tcp_in_world.rotation()(2, 2), -1, 1e-12);
    EXPECT_EQ(grasp.width, 0);
  }
  EXPECT_NEAR((grasps[0].tcp_in_world.translation() - Vector3d(0.3, 0.1, 0.529)).norm(), 0, 1e-6)
      << "the middle is best";
}

TEST_F(SuctionGrasps, DoNotStickToRoundTiltedAndSmallTops) {
  SceneObject ball = BoxObject("ball", {0, 0, 0});
  ball.shape = Shape::kSphere;
  ball.size = Vec3{0.04, 0, 0};
  EXPECT_TRUE(On(ball).empty());
  SceneObject small = BoxObject("small", {0, 0, 0});
  small.size = Vec3{0.015, 0.05, 0.03};
  EXPECT_TRUE(On(small).empty());
  SceneObject box = BoxObject("box", {0, 0, 0});
  box.size = Vec3{0.04, 0.05, 0.03};
  EXPECT_TRUE(On(box, Quaternion{std::sin(0.15), 0, 0, std::cos(0.15)}).empty()) << "0.3 rad";
  EXPECT_THAT(internal::WhyNothingSticks(*shape_),
              ::testing::HasSubstr("not flat and level over the 0.04 m of the suction cup"));
}

}  // namespace
}  // namespace robocell
