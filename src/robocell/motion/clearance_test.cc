#include "robocell/motion/clearance.h"

#include <gtest/gtest.h>

#include "robocell/scene/testing/scenes.h"
#include "robocell/spec/element_ref.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {
namespace {

// A robot of two balls: of radius 0.1 in the origin, of radius 0.05 at (0.3, 0, 0).
constexpr const char* kBalls = R"(
  <worldbody><body name="base">
    <geom name="big" size="0.1"/>
    <body name="tip" pos="0.3 0 0"><joint name="turn" axis="0 0 1"/><geom name="small" size="0.05"/></body>
  </body></worldbody>)";

SceneObject Ball(const Eigen::Vector3d& at) {
  SceneObject ball = BoxObject("ball", ToVec3(at));
  ball.shape = Shape::kSphere;
  ball.size = Vec3{0.02, 0, 0};
  ball.fixed = true;
  return ball;
}

class ClearanceOfBalls : public ::testing::Test {
 protected:
  // The two balls 1 m above the floor, and one more in their frame.
  Clearance With(const Eigen::Vector3d& ball, double horizon) {
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.name = "r", .config = config, .pos = {0, 0, 1}});
    spec.objects.push_back(Ball(ball + Eigen::Vector3d(0, 0, 1)));
    const Scene scene = Scene::Build(spec);
    return RobotClearance(scene, Robot::Of(scene, "r"), horizon);
  }

  ModelFolder folder;
  RobotConfig config = [&] {
    RobotConfig balls{.name = "balls", .model = folder.Write("balls", kBalls)};
    balls.move_groups["turn"] = {.kind = MoveGroupKind::kGeneric, .joints = {"turn"}};
    return balls;
  }();
};

TEST_F(ClearanceOfBalls, IsTheDistanceOfTheNearestPair) {
  const Clearance to_small = With({0.3, 0.2, 0}, 0.5);
  EXPECT_NEAR(to_small.distance, 0.2 - 0.05 - 0.02, 1e-9);
  EXPECT_EQ(to_small.robot_geom, "geom 'small'");
  EXPECT_EQ(to_small.other_geom, "geom 'ball_geom'");
  const Clearance to_big = With({0, -0.3, 0.1}, 0.5);
  EXPECT_NEAR(to_big.distance, std::hypot(0.3, 0.1) - 0.1 - 0.02, 1e-9);
  EXPECT_EQ(to_big.robot_geom, "geom 'big'");
}

TEST_F(ClearanceOfBalls, IsNegativeWhereTheyOverlap) {
  EXPECT_NEAR(With({0.3, 0, 0.06}, 0.5).distance, -0.01, 1e-9);
}

TEST_F(ClearanceOfBalls, EndsAtTheHorizon) {
  const Clearance far = With({0.3, 0.2, 0}, 0.1);
  EXPECT_EQ(far.distance, 0.1);
  EXPECT_EQ(far.robot_geom, "");
  EXPECT_EQ(far.other_geom, "");
}

TEST_F(ClearanceOfBalls, UsesOnlyTheCollisionGeomsOfTheRobot) {
  config.collision_geoms = {ElementRef{.name = "big"}};
  EXPECT_NEAR(With({0.3, 0.2, 0}, 0.5).distance, std::hypot(0.3, 0.2) - 0.1 - 0.02, 1e-9);
}

TEST_F(ClearanceOfBalls, IncludesTheFloorForTheArmButNotForThePedestal) {
  EXPECT_NEAR(With({5, 0, 0}, 2).distance, 0.9, 1e-9);  // to the floor
  config.base = {.kind = BaseKind::kMocap, .size = Vec3{0.1, 0.1, 0.5}};
  EXPECT_NEAR(With({5, 0, 0}, 2).distance, 1.4, 1e-9);  // the pedestal's bottom is at 1 m
}

// A planar base stands on floors and low steps, but only the base, and only on what is fixed.
TEST_F(ClearanceOfBalls, LeavesOutWhatAPlanarBaseStandsOn) {
  config.base = {.kind = BaseKind::kPlanar};
  config.move_groups["turn"] = {.kind = MoveGroupKind::kArm,
                                .joints = {"turn"},
                                .leaf = ElementRef{.kind = ElementKind::kBody, .name = "tip"}};
  const auto over = [&](const Eigen::Vector3d& top, bool fixed) {
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.name = "r", .config = config, .pos = {0, 0, 1}});
    SceneObject step = BoxObject("step", ToVec3(top + Eigen::Vector3d(0, 0, 1 - 0.05)));
    step.size = Vec3{0.05, 0.05, 0.05};
    step.fixed = fixed;
    spec.objects.push_back(step);
    const Scene scene = Scene::Build(spec);
    return RobotClearance(scene, Robot::Of(scene, "r"), 0.1).distance;
  };
  EXPECT_GT(over({0, 0, 0.01}, true), 0) << "the base on a low step";
  EXPECT_LT(over({0, 0, 0.03}, true), 0) << "the base in a higher one";
  EXPECT_LT(over({0, 0, 0.01}, false), 0) << "the base on something that moves";
  EXPECT_LT(over({0.3, 0, 0.01}, true), 0) << "the arm on a low step";
}

}  // namespace
}  // namespace robocell::internal
