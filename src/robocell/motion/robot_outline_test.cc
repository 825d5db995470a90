#include "robocell/motion/robot_outline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robocell/base/rng.h"
#include "robocell/base/units.h"
#include "robocell/motion/clearance.h"
#include "robocell/robot/testing/robots.h"

namespace robocell::internal {
namespace {

constexpr double kMargin = 0.01;
const LevelArea kPlate{Pose::FromRpy({0.4, -0.1, 0.5}, {0, 0, 0.3}), 0.3, 0.2, 0.04};

// The built-in robot beside a box, which is the support.
struct Cell {
  Scene scene;
  Robot robot;
};

Cell MakeCell() {
  SceneSpec spec{.name = "test", .timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.robots.push_back({.name = "r", .config = Rc7()});
  SceneObject plate = BoxObject("plate", {});
  plate.size = Vec3{kPlate.half_x, kPlate.half_y, kPlate.thickness / 2};
  const Pose middle = kPlate.frame_to_world * Pose(Eigen::Vector3d(0, 0, -kPlate.thickness / 2));
  plate.pos = ToVec3(middle.translation());
  plate.quat = middle.quaternion();
  plate.fixed = true;
  spec.objects.push_back(plate);
  const Scene scene = Scene::Build(spec);
  return {scene, Robot::Of(scene, "r")};
}

TEST(RobotOutline, NeverReportsACollidingPlaceAsFree) {
  Cell cell = MakeCell();
  const RobotOutline outline(cell.robot);
  Rng rng = Rng::Stream(2, "outline");
  int clear = 0, free = 0;
  for (int i = 0; i < 300; ++i) {
    const Pose base =
        kPlate.frame_to_world *
        Pose::FromRpy({rng.Uniform(-0.9, 0.9), rng.Uniform(-0.9, 0.9), rng.Uniform(-0.6, 0.1)},
                      {0, 0, rng.Uniform(-internal::kPi, internal::kPi)});
    cell.robot.base().SetPose(base);
    cell.scene.Forward();
    const bool is_free =
        internal::RobotClearance(cell.scene, cell.robot, kMargin).robot_geom.empty();
    const bool is_clear = outline.IsClearOf(kPlate, base, kMargin);
    EXPECT_TRUE(is_free || !is_clear) << i;
    free += is_free;
    clear += is_clear;
  }
  EXPECT_LT(free, 290) << "some of these places are taken";
  EXPECT_GE(clear, 0.7 * free) << "boxes are no tight fit, but not a wide one either";
}

TEST(RobotOutline, TurnsWithTheBase) {
  const Cell cell = MakeCell();
  const RobotOutline outline(cell.robot);
  const double wide = std::hypot(kPlate.half_x, kPlate.half_y) + cell.robot.reach() + 0.3;
  for (int i = 0; i < 12; ++i) {
    const double bearing = 2 * internal::kPi * i / 12;
    const Pose far = kPlate.frame_to_world *
                     Pose::FromRpy({wide * std::cos(bearing), wide * std::sin(bearing), -0.2},
                                   {0, 0, 3 * bearing});
    EXPECT_TRUE(outline.IsClearOf(kPlate, far, kMargin)) << i;
    const Pose inside = kPlate.frame_to_world * Pose::FromRpy({0, 0, -0.1}, {0, 0, bearing});
    EXPECT_FALSE(outline.IsClearOf(kPlate, inside, kMargin)) << i;
  }
}

TEST(RobotOutline, IsTheSameAtAnyRobotPose) {
  Cell cell = MakeCell();
  const RobotOutline before(cell.robot);
  cell.robot.base().SetPose(Pose::FromRpy({2, 1, 0.3}, {0, 0, 1.2}));
  cell.scene.Forward();
  const RobotOutline after(cell.robot);
  Rng rng = Rng::Stream(3, "outline");
  for (int i = 0; i < 200; ++i) {
    const Pose base = Pose::FromRpy({rng.Uniform(-1, 1), rng.Uniform(-1, 1), rng.Uniform(0, 0.5)},
                                    {0, 0, rng.Uniform(-internal::kPi, internal::kPi)});
    EXPECT_EQ(before.IsClearOf(kPlate, base, kMargin), after.IsClearOf(kPlate, base, kMargin)) << i;
  }
}

}  // namespace
}  // namespace robocell::internal
