#include "robocell/task/furniture.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "robocell/assets/resolve.h"
#include "robocell/base/rng.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/task/door_swings.h"
#include "robocell/task/handle_motion.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

TEST(Furniture, StandsOnTheTableWithItsFrontOverAnEdge) {
  EXPECT_TRUE(internal::IsFurniture("drawer_unit"));
  EXPECT_TRUE(internal::IsFurniture("button_panel"));
  EXPECT_FALSE(internal::IsFurniture("mug"));
  EXPECT_FALSE(internal::IsFurniture("tray"));
  SceneSpec spec = EmptyScene();
  spec.base = "tabletop";
  const SceneAnnotations annotations = DeriveAnnotations(spec);
  for (uint64_t seed = 0; seed < 10; ++seed) {
    Rng rng = Rng::Stream(seed, "furniture");
    const SceneObject unit = internal::PutFurniture(spec, annotations, "unit", "drawer_unit", rng);
    const Pose pose = unit.pose();
    EXPECT_EQ(unit.fixed, true);
    EXPECT_NEAR(pose.translation().z(), 0.45, 0.001);
    // The table is longer along y: its longer edges are at the ends of x.
    EXPECT_GT(std::abs(pose.rotation()(0, 0)), 0.9);
    // Its front is over the edge, and looks away from the table.
    const Eigen::Vector3d out = pose * Eigen::Vector3d(0.3, 0, 0) - pose.translation();
    EXPECT_GT(out.x() * pose.translation().x(), 0);
  }
}

// What stands fixed does not collide with what stands fixed: the distances of the geoms are measured.
double LeastDistance(const Scene& scene, const std::string& a, const std::string& b) {
  const mjModel* m = scene.model();
  double least = 1;
  for (int g = 0; g < m->ngeom; ++g) {
    for (int h = 0; h < m->ngeom; ++h) {
      const bool is_pair = ElementName(m, mjOBJ_GEOM, g).starts_with(a) &&
                           ElementName(m, mjOBJ_GEOM, h).starts_with(b) &&
                           internal::IsCollisionGeom(m, g) && internal::IsCollisionGeom(m, h);
      if (is_pair) least = std::min(least, mj_geomDistance(m, scene.data(), g, h, 1, nullptr));
    }
  }
  return least;
}

TEST(Furniture, StandsBesideWhatStandsThereAlready) {
  for (const bool has_table : {true, false}) {
    for (uint64_t seed = 0; seed < 4; ++seed) {
      SceneSpec spec = EmptyScene();
      if (has_table) spec.base = "tabletop", spec.add_floor.reset(), spec.add_skybox.reset();
      SceneObject vase = BoxObject("vase", {0.3, 0, 0.5});
      vase.fixed = true;
      spec.objects.push_back(vase);
      const SceneAnnotations annotations = DeriveAnnotations(spec);
      Rng rng = Rng::Stream(seed, "furniture");
      for (const char* kind : {"lid_box", "button_panel", "lid_box"}) {
        const std::string name = "unit" + std::to_string(spec.objects.size());
        spec.objects.push_back(internal::PutFurniture(spec, annotations, name, kind, rng));
      }
      Scene scene = Scene::Build(spec);
      scene.Reset();
      scene.Forward();
      const std::vector<std::string> names = {"vase", "unit1_", "unit2_", "unit3_"};
      for (size_t i = 0; i < names.size(); ++i) {
        for (size_t j = i + 1; j < names.size(); ++j)
          EXPECT_GT(LeastDistance(scene, names[i], names[j]), internal::kBesideFurniture - 0.006)
              << (has_table ? "table" : "floor") << " seed " << seed << ": " << names[i] << " "
              << names[j];
      }
    }
  }
}

TEST(Furniture, StandsInFrontOfTheRobotWhereverThatStands) {
  SceneSpec spec = EmptyScene();
  spec.root_frame_to_world = Pose::FromRpy({2, 1, 0}, {0, 0, 1});
  spec.robots.push_back({.name = "arm",
                         .config = ExampleRun("pick_and_place.yaml").robot.config,
                         .attach_to = Root(),
                         .pos = {0.5, 0, 0},
                         .euler = {0, 0, 90}});
  Rng rng = Rng::Stream(1, "furniture");
  const Pose unit =
      internal::PutFurniture(spec, SceneAnnotations(), "unit", "drawer_unit", rng).pose();
  const Pose robot = spec.root_frame_to_world * spec.robots[0].pose();
  const Eigen::Vector3d from_robot = robot.inverse() * unit.translation();
  EXPECT_NEAR(from_robot.x(), 0.45, 0.01);
  EXPECT_NEAR(from_robot.y(), 0, 0.01);
  EXPECT_LT((unit.rotation().col(0) + robot.rotation().col(0)).norm(), 0.3);  // face to face
}

// On a table, too: its front looks to the robot, which reaches it, and it stands on the table whole.
TEST(Furniture, LooksToTheRobotBesideTheTable) {
  for (const double side : {1.0, -1.0}) {
    for (uint64_t seed = 0; seed < 5; ++seed) {
      SceneSpec spec = EmptyScene();
      spec.base = "tabletop", spec.add_floor.reset(), spec.add_skybox.reset();
      const SceneAnnotations annotations = DeriveAnnotations(spec);
      spec.robots.push_back({.name = "arm",
                             .config = ExampleRun("pick_and_place.yaml").robot.config,
                             .pos = {0.45 * side, 0.1, 0.2},
                             .euler = {0, 0, side > 0 ? 180.0 : 0.0}});
      Rng rng = Rng::Stream(seed, "furniture");
      const Pose unit = internal::PutFurniture(spec, annotations, "unit", "lid_box", rng).pose();
      const Eigen::Vector3d to = (spec.robots[0].pose().translation() - unit.translation());
      const Eigen::Vector3d front = unit.rotation().col(0);
      EXPECT_GT(front.head<2>().dot(to.head<2>().normalized()), 0.9);
      const Eigen::Vector3d handle = unit * Eigen::Vector3d(0.2, 0, 0.1);
      EXPECT_LT((spec.robots[0].pose().translation() - handle).head<2>().norm(), 0.7);
      for (const double x : {-0.09, 0.09}) {
        for (const double y : {-0.13, 0.13}) {
          const Eigen::Vector3d corner = unit * Eigen::Vector3d(x, y, 0);
          EXPECT_LE(std::abs(corner.x()), 0.25);
          EXPECT_LE(std::abs(corner.y()), 0.4);
        }
      }
    }
  }
}

// A place for the base is searched around the furniture until the check accepts one.
TEST(Furniture, TheRobotStandsWhereItsCheckAccepts) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(
      {.name = "oven", .mjcf_path = "microwave", .pos = Vec3{2, 0, 0.3}, .fixed = true});
  spec.robots.push_back({.name = "arm",
                         .config = ExampleRun("pick_and_place.yaml").robot.config,
                         .pos = {1.4, 0, 0}});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Robot robot = Robot::Of(scene, "arm");
  const JointOpening door = JointOpening::Of(scene, "oven_door");
  const int root = FindId(scene.model(), mjOBJ_BODY, "oven_microwave");
  Rng rng = Rng::Stream(3, "stance");
  int checks = 0;
  const auto refusal = internal::StandInFront(
      scene, robot, root, door, 0.6,
      [&]() -> std::optional<Refusal> {
        if (++checks < 3) return Refusal{"not here"};
        return std::nullopt;
      },
      rng);
  EXPECT_FALSE(refusal.has_value());
  EXPECT_EQ(checks, 3);
  // All of the way of the handle is within reach, and the door has room to swing.
  for (const Eigen::Vector3d& point : internal::WayOfHandle(scene, door, 0.6)) {
    const Eigen::Vector3d to = point - robot.base_in_world().translation();
    EXPECT_LE(to.norm(), 0.9 * robot.reach());
    EXPECT_GE(to.head<2>().norm(), 0.25 * robot.reach());
  }
  const auto never = internal::StandInFront(
      scene, robot, root, door, 0.6, [] { return Refusal{"not here"}; }, rng);
  ASSERT_TRUE(never.has_value());
  EXPECT_EQ(never->reason, "not here");
}

// The root of a house is far from its doors, and its robots are put beside tables: the stance is in
// front of the handle, and the base is not in the way of the door that it opens.
TEST(Furniture, ARobotStandsInFrontOfADoorThatIsFarFromItsRoot) {
  ModelFolder folder;
  const std::string house = folder.Write("house", R"(
    <worldbody><body name="house"><geom type="box" size=".1 .1 .1" pos="0 0 -.1"/>
      <body name="door" pos="4 3 0"><joint name="hinge" axis="0 0 1" range="0 80"/>
        <geom type="box" size=".02 .4 1" pos="0 .4 1"/>
        <geom name="handle" type="capsule" size=".01 .08" pos="-.07 .7 .8"/>
        <geom type="box" size=".03 .01 .01" pos="-.04 .7 .8"/>
      </body></body></worldbody>)");
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "house", .mjcf_path = house, .pos = Vec3{}, .fixed = true});
  spec.robots.push_back({.name = "arm",
                         .config = ExampleRun("pick_and_place.yaml").robot.config,
                         .pos = {-1, 0, 0.3}});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Robot robot = Robot::Of(scene, "arm");
  const JointOpening door = JointOpening::Of(scene, "house_hinge");
  const int root = FindId(scene.model(), mjOBJ_BODY, "house_house");
  ASSERT_GT(root, 0);
  for (const double share : {0.2, 0.4}) {
    Rng rng = Rng::Stream(5, "far door");
    const auto refusal = internal::StandInFront(
        scene, robot, root, door, share, []() -> std::optional<Refusal> { return std::nullopt; },
        rng);
    ASSERT_FALSE(refusal.has_value()) << refusal->reason << ": " << refusal->detail;
    for (const Eigen::Vector3d& point : internal::WayOfHandle(scene, door, share))
      EXPECT_LE((point - robot.base_in_world().translation()).norm(), 0.9 * robot.reach());
    EXPECT_FALSE(internal::ValidateMovedJoint(scene, robot, door, share, 0.01).has_value());
  }
}

// Its servos hold a planar base there, and do not drive it back to where it was before.
TEST(Furniture, AMobileRobotStaysWhereItStands) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "house",
                          .mjcf_path = folder.Write("house", R"(
    <worldbody><body name="house"><geom type="box" size=".1 .1 .1" pos="0 0 -.1"/>
      <body name="door" pos="4 3 0"><joint name="hinge" axis="0 0 1" range="0 80"/>
        <geom type="box" size=".02 .4 1" pos="0 .4 1"/>
        <geom name="handle" type="capsule" size=".01 .08" pos="-.07 .7 .8"/>
        <geom type="box" size=".03 .01 .01" pos="-.04 .7 .8"/>
      </body></body></worldbody>)"),
                          .pos = Vec3{},
                          .fixed = true});
  spec.robots.push_back({.name = "arm",
                         .config = RobotConfig::Load(assets::BuiltinRobotFile("rc7_mobile")),
                         .pos = {-1, 0, 0}});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  Robot robot = Robot::Of(scene, "arm");
  robot.Update();
  Rng rng = Rng::Stream(5, "mobile");
  const auto refusal = internal::StandInFront(
      scene, robot, FindId(scene.model(), mjOBJ_BODY, "house_house"),
      JointOpening::Of(scene, "house_hinge"), 0.2,
      []() -> std::optional<Refusal> { return std::nullopt; }, rng);
  ASSERT_FALSE(refusal.has_value()) << refusal->reason << ": " << refusal->detail;
  const Pose stance = robot.base().pose();
  EXPECT_GT((stance.translation() - Eigen::Vector3d(-1, 0, 0)).norm(), 2);
  for (int i = 0; i < 100; ++i) {
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
  EXPECT_TRUE(robot.base().pose().is_close(stance, 0.01, 0.01));
}

}  // namespace
}  // namespace robocell
