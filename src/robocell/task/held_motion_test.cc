#include "robocell/task/held_motion.h"

#include <gtest/gtest.h>

#include <optional>
#include <Eigen/Core>

#include "robocell/base/rng.h"
#include "robocell/kinematics/joint_vector.h"
#include "robocell/math/pose.h"
#include "robocell/math/rotation.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/motion/planning_scene.h"
#include "robocell/motion/vertical_line.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/robot_config.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/source_dir.h"

namespace robocell::internal {
namespace {

TEST(AppendStraight, MakesFineStepsToThePose) {
  Rng rng = Rng::Stream(0, "straight");
  for (int i = 0; i < 50; ++i) {
    const Pose from(Eigen::Vector3d(rng.Uniform(-1, 1), 0, 0), RandomQuaternion(rng));
    const Pose to(Eigen::Vector3d(rng.Uniform(-1, 1), 1, 0), RandomQuaternion(rng));
    HeldPath path = {from};
    AppendStraight(path, to);
    EXPECT_TRUE(path.back().is_close(to, 1e-9, 1e-9));
    for (size_t k = 1; k < path.size(); ++k)
      EXPECT_TRUE(path[k].is_close(path[k - 1], 0.0501, 0.00501));
  }
}

// Five joints cannot lean the hand to the side. The object may be a little off, and no more.
TEST(HeldMotions, AnArmOfFiveJointsTurnsTheObjectALittle) {
  const RobotConfig config = RobotConfig::Load(SourceDir() + "/examples/desk6/desk5.yaml");
  SceneSpec spec{.name = "test", .base = "tabletop", .timestep = 0.002, .add_floor = true};
  spec.objects.push_back(ObjectOnTheTable("box"));
  spec.robots.push_back({.name = "desk5", .config = config, .pos = {-0.4, 0, 0.4}});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  scene.Forward();
  const Robot robot = Robot::Of(scene, "desk5");
  ASSERT_EQ(robot.chain().n_joints(), 5);
  const auto shape = GripperShape::Of(config, spec.options, scene.timestep());
  PlanningScene planning(scene, robot, scene.compiled()->object("target").root_body, shape);
  const JointVector home(robot.arm().joint_pos());
  const Pose tcp = robot.tcp_in_world(), object_in_tcp(Eigen::Vector3d(0, 0, 0.01));
  const Eigen::Vector3d ahead =
      Rotate(robot.base_in_world().quaternion(), Eigen::Vector3d::UnitX());
  for (const double lean : {0.0, 0.7 * kMostTilt, 3 * kMostTilt}) {
    const Pose leaning(tcp.translation(),
                       QuaternionProduct(QuaternionFromRotvec(lean * ahead), tcp.quaternion()));
    HeldPath path = {leaning * object_in_tcp};
    AppendStraight(path, Pose(Eigen::Vector3d(0.02, 0.01, -0.03)) * path.front());
    HeldMotions motions(planning, object_in_tcp, {path}, home, {.gap = shape->open_gap()});
    const std::optional<HeldMotion> motion = motions.Next();
    EXPECT_EQ(motion.has_value(), lean < kMostTilt) << lean << ": " << motions.Reasons();
    if (!motion) continue;
    ASSERT_EQ(motion->along.size(), path.size());
    for (size_t i = 0; i < path.size(); ++i) {
      const Pose hand = robot.base_in_world() * robot.chain().Fk(motion->along[i]);
      const Pose wanted = path[i] * object_in_tcp.inverse();
      EXPECT_LT((hand.translation() - wanted.translation()).norm(), 2e-4);
      EXPECT_LE(AngleBetween(hand.quaternion(), wanted.quaternion()), kMostTilt);
    }
  }
}

}  // namespace
}  // namespace robocell::internal
