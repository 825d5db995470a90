#include "robocell/task/handle_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

Scene SceneWith(const std::string& kind, double yaw) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "unit",
                          .mjcf_path = kind,
                          .pos = Vec3{0.3, -0.2, 0},
                          .euler = {0, 0, yaw},
                          .fixed = true});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

TEST(HandleMotion, FindsTheBarAndItsFront) {
  for (const double yaw : {0.0, 50.0, -130.0}) {
    const Eigen::Vector3d front(std::cos(yaw * M_PI / 180), std::sin(yaw * M_PI / 180), 0);
    for (const char* joint : {"unit_drawer_1_slide", "unit_drawer_3_slide"}) {
      const Scene scene = SceneWith("drawer_unit", yaw);
      const JointOpening opening = JointOpening::Of(scene, joint);
      const auto bar = internal::FindHandle(scene, opening);
      ASSERT_TRUE(bar.has_value());
      EXPECT_NEAR(bar->WidthAlong(Eigen::Vector3d::UnitZ()), 0.012, 1e-9);
      EXPECT_NEAR(bar->outward.dot(front), 1, 1e-6);
      EXPECT_NEAR(internal::FrontOf(scene, opening)->dot(front), 1, 1e-6);
    }
    const Scene lid = SceneWith("lid_box", yaw);
    const JointOpening opening = JointOpening::Of(lid, "unit");
    const internal::HandleBar lip = *internal::FindHandle(lid, opening);
    EXPECT_NEAR(lip.outward.dot(front), 1, 1e-6);
    EXPECT_NEAR(lip.WidthAlong(Eigen::Vector3d::UnitZ()), 0.012, 1e-9);  // a box of 28 x 60 x 12 mm
    EXPECT_NEAR(lip.WidthAlong(front), 0.028, 1e-9);
    EXPECT_NEAR(internal::FrontOf(lid, opening)->dot(front), 1, 1e-6);
  }
}

// The point between the pads stays on the bar wherever the joint is: the engine says where that is.
TEST(HandleMotion, PathsFollowTheHandleOfTheEngine) {
  const PickScene hand = MakePickScene(ObjectOnTheTable("box"));
  const auto shape = hand.shape();
  for (const auto& [kind, joint] :
       std::vector<std::pair<std::string, std::string>>{{"drawer_unit", "unit_drawer_2"},
                                                        {"cupboard", "unit"},
                                                        {"lid_box", "unit"},
                                                        {"laptop", "unit"},
                                                        {"faucet", "unit"},
                                                        {"microwave", "unit_door"}}) {
    Scene scene = SceneWith(kind, 30);
    JointOpening opening = JointOpening::Of(scene, joint);
    const std::vector<ContactPath> paths = internal::HandlePaths(scene, opening, *shape, 0.7);
    ASSERT_FALSE(paths.empty()) << kind;
    for (const double share : {0.0, 0.7}) {
      opening.Put(share);
      scene.Forward();
      const internal::HandleBar bar = *internal::FindHandle(scene, opening);
      const auto distance_to = [&](const Eigen::Vector3d& point) {
        const double along =
            std::clamp((point - bar.middle).dot(bar.axis), -bar.half_length, bar.half_length);
        return (point - bar.middle - along * bar.axis).norm();
      };
      for (const ContactPath& path : paths) {
        const Pose& tcp = share == 0 ? path.tcp_in_world.front() : path.tcp_in_world.back();
        EXPECT_LT(distance_to(tcp * shape->grasp_in_tcp() * shape->PadAt(path.contact_gap)), 1e-6)
            << kind;
      }
    }
    opening.Put(0);
  }
}

// One finger of the open hand comes free behind the bar, and is where the bar was when it arrives.
TEST(HandleMotion, AFingerBehindTheBarMovesIt) {
  const PickScene hand = MakePickScene(ObjectOnTheTable("box"));
  const auto shape = hand.shape();
  for (const auto& [kind, joint] :
       std::vector<std::pair<std::string, std::string>>{{"drawer_unit", "unit_drawer_2"},
                                                        {"lid_box", "unit"},
                                                        {"laptop", "unit"},
                                                        {"microwave", "unit_door"}}) {
    Scene scene = SceneWith(kind, -40);
    JointOpening opening = JointOpening::Of(scene, joint);
    const internal::HandleBar before = *internal::FindHandle(scene, opening);
    const std::vector<ContactPath> paths =
        internal::HandlePaths(scene, opening, *shape, 0.5, internal::HandleHold::kBehind);
    ASSERT_FALSE(paths.empty()) << kind;
    const std::vector<Eigen::Vector3d> way = internal::WayOfHandle(scene, opening, 0.5);
    EXPECT_LT((way.front() - before.middle).norm(), 1e-9);
    opening.Put(0.5);
    scene.Forward();
    EXPECT_LT((way.back() - internal::FindHandle(scene, opening)->middle).norm(), 1e-6) << kind;
    opening.Put(0);
    scene.Forward();
    const Eigen::Vector3d ahead = (way[1] - way[0]).normalized();
    for (const ContactPath& path : paths) {
      EXPECT_FALSE(path.grips);
      const Pose grasp = path.tcp_in_world.front() * shape->grasp_in_tcp();
      const Eigen::Vector3d across = grasp.rotation().col(1);
      const double side = across.dot(ahead) > 0 ? -1 : 1;  // of the finger behind the bar
      const Eigen::Vector3d pad =
          grasp * shape->PadAt(shape->open_gap()) + side * shape->open_gap() / 2 * across;
      const double behind =
          side * (pad - before.middle).dot(across) - before.WidthAlong(across) / 2;
      EXPECT_GT(behind, 0.004) << kind;
      EXPECT_LT(behind, 0.015) << kind;
    }
  }
}

// The tip pushes against a face along the motion of that face, and moves as the engine moves it.
TEST(HandleMotion, PushesFacesAlongTheirMotion) {
  for (const char* kind : {"drawer_unit", "cupboard", "lid_box"}) {
    SceneSpec spec = EmptyScene();
    spec.objects.push_back(
        {.name = "unit", .mjcf_path = kind, .pos = Vec3{0.6, 0, 0}, .fixed = true});
    spec.robots.push_back({.name = "arm", .config = ExampleRun("demo.yaml").robot.config});
    Scene scene = Scene::Build(spec);
    scene.Reset();
    const Robot robot = Robot::Of(scene, "arm");
    const std::string joint = kind == std::string("drawer_unit") ? "unit_drawer_1" : "unit";
    JointOpening opening = JointOpening::Of(scene, joint);
    opening.Put(0.6);
    scene.Forward();
    const std::string body = kind == std::string("drawer_unit") ? "unit_drawer_1"
                             : kind == std::string("cupboard")  ? "unit_door"
                                                                : "unit_lid";
    const Pose before = scene.body_pose(body);
    const auto shape = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
    const std::vector<ContactPath> paths = internal::PushedJointPaths(robot, opening, *shape, 0.05);
    ASSERT_FALSE(paths.empty()) << kind;
    opening.Put(0.05);
    scene.Forward();
    const Pose moved = scene.body_pose(body) * before.inverse();
    for (const ContactPath& path : paths) {
      EXPECT_FALSE(path.grips);
      const Eigen::Vector3d first =
          path.tcp_in_world[1].translation() - path.tcp_in_world[0].translation();
      EXPECT_GT(-path.from.dot(first.normalized()), 0.7) << kind;
      EXPECT_TRUE(path.tcp_in_world.back().is_close(moved * path.tcp_in_world.front(), 1e-6, 1e-6));
    }
  }
}

// The closed hand is behind the bar, seen along the motion, and moves as the engine moves the door.
TEST(HandleMotion, HooksAreBehindTheBar) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(
      {.name = "unit", .mjcf_path = "cupboard", .pos = Vec3{0.6, 0, 0}, .fixed = true});
  spec.robots.push_back({.name = "arm", .config = ExampleRun("demo.yaml").robot.config});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Robot robot = Robot::Of(scene, "arm");
  JointOpening opening = JointOpening::Of(scene, "unit");
  const auto shape = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  const internal::HandleBar bar = *internal::FindHandle(scene, opening);
  const std::vector<ContactPath> paths = internal::HookedJointPaths(robot, opening, *shape, 0.5);
  ASSERT_FALSE(paths.empty());
  const Pose before = scene.body_pose("unit_door");
  opening.Put(0.5);
  scene.Forward();
  const Pose moved = scene.body_pose("unit_door") * before.inverse();
  for (const ContactPath& path : paths) {
    EXPECT_FALSE(path.grips);
    const Eigen::Vector3d hand =
        path.tcp_in_world.front() * shape->grasp_in_tcp() * shape->PadAt(path.contact_gap);
    EXPECT_LT((hand - bar.middle).dot(bar.outward), -0.005) << "between the handle and the door";
    EXPECT_TRUE(path.tcp_in_world.back().is_close(moved * path.tcp_in_world.front(), 1e-6, 1e-6));
  }
}

// Where the robot stands changes nothing about the grasps of the door: they are computed once, and a
// start has several stances.
TEST(HandleMotion, ASecondStanceTakesTheGraspsOfTheFirst) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(
      {.name = "unit", .mjcf_path = "cupboard", .pos = Vec3{0.6, 0, 0}, .fixed = true});
  spec.robots.push_back({.name = "arm", .config = ExampleRun("pick_and_place.yaml").robot.config});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Robot robot = Robot::Of(scene, "arm");
  JointOpening opening = JointOpening::Of(scene, "unit");
  opening.Put(0.3137);  // no other test's
  const auto shape = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  std::vector<std::vector<ContactPath>> all;
  std::vector<double> seconds;
  for (const double y : {0.0, 0.2}) {
    robot.base().SetPose(Pose(Eigen::Vector3d(0, y, 0)));
    scene.Forward();
    const std::clock_t begin = std::clock();
    std::vector<ContactPath>& paths =
        all.emplace_back(internal::HookedJointPaths(robot, opening, *shape, 0.5));
    std::ranges::move(internal::PushedJointPaths(robot, opening, *shape, 0.5),
                      std::back_inserter(paths));
    seconds.push_back(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  ASSERT_FALSE(all[0].empty());
  ASSERT_EQ(all[0].size(), all[1].size());
  for (size_t i = 0; i < all[0].size(); ++i)
    EXPECT_TRUE(all[0][i].tcp_in_world.back().is_close(all[1][i].tcp_in_world.back(), 1e-6, 1e-6));
  EXPECT_LT(seconds[1], seconds[0] / 2);
}

// The paths of one way of the hand after the other: after a failure the other ways come first.
TEST(HandleMotion, AfterAFailureTheOtherWaysComeFirst) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(
      {.name = "unit", .mjcf_path = "drawer_unit", .pos = Vec3{0.6, 0, 0}, .fixed = true});
  spec.robots.push_back({.name = "arm", .config = ExampleRun("demo.yaml").robot.config});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Robot robot = Robot::Of(scene, "arm");
  JointOpening::Of(scene, "unit_drawer_1").Put(0.6);
  scene.Forward();
  const auto shape = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  for (const auto& [text, grips_first] : std::vector<std::pair<std::string, bool>>{
           {"unit_drawer_1 open 0.9", true}, {"unit_drawer_1 closed 0.1", false}}) {
    for (const int failures : {0, 1, 2, 3}) {
      const ContactPathSource source =
          internal::JointPaths(robot, ParseRelation(text), *shape, failures);
      const std::vector<ContactPath> first = source();
      ASSERT_FALSE(first.empty());
      for (const ContactPath& path : first)
        EXPECT_EQ(path.grips, (failures % 2 == 0) == grips_first) << text << " " << failures;
    }
  }
}

TEST(HandleMotion, AimsSomewhatFurtherThanTheGoal) {
  EXPECT_NEAR(internal::ShareFor(ParseRelation("d open 0.5")), 0.6, 1e-9);
  EXPECT_NEAR(internal::ShareFor(ParseRelation("d open 0.95")), 1, 1e-9);
  EXPECT_NEAR(internal::ShareFor(ParseRelation("d closed 0.15")), 0.05, 1e-9);
  EXPECT_NEAR(internal::ShareFor(ParseRelation("d closed 0.05")), 0, 1e-9);
}

TEST(HandleMotion, PressesAlongTheSlideBeyondItsEnd) {
  const PickScene hand = MakePickScene(ObjectOnTheTable("box"));
  const Scene scene = SceneWith("button_panel", 20);
  const JointOpening button = JointOpening::Of(scene, "unit_green_button");
  const std::vector<ContactPath> paths = internal::PressPaths(scene, button, *hand.shape());
  EXPECT_EQ(paths.size(), 8u);
  for (const ContactPath& path : paths) {
    const Eigen::Vector3d way =
        path.tcp_in_world.back().translation() - path.tcp_in_world.front().translation();
    EXPECT_NEAR(way.z(), -0.011, 1e-3);
    EXPECT_LT(way.head<2>().norm(), 1e-9);
  }
  EXPECT_FALSE(internal::FrontOf(scene, button).has_value());  // pressed from above
  const Scene oven = SceneWith("microwave", 90);
  const auto front = internal::FrontOf(oven, JointOpening::Of(oven, "unit_start_button"));
  ASSERT_TRUE(front.has_value());
  EXPECT_NEAR(front->y(), 1, 1e-6);
}

TEST(HandleMotion, TellsDialsFromDoors) {
  const Scene oven = SceneWith("microwave", 0), panel = SceneWith("button_panel", 0);
  EXPECT_TRUE(internal::TurnsOnTheSpot(oven, JointOpening::Of(oven, "unit_dial")));
  EXPECT_FALSE(internal::TurnsOnTheSpot(oven, JointOpening::Of(oven, "unit_door")));
  EXPECT_TRUE(internal::TurnsOnTheSpot(panel, JointOpening::Of(panel, "unit_dial")));
  EXPECT_FALSE(internal::TurnsOnTheSpot(panel, JointOpening::Of(panel, "unit_switch")));
}

// A mesh is no bar: the grasps are computed from its convex hull, and move as the engine moves it.
TEST(HandleMotion, GripsHandlesThatAreMeshes) {
  ModelFolder folder;
  const std::string door = folder.Write("door", R"(
    <asset><mesh name="grip" vertex="-.01 -.006 -.05  .01 -.006 -.05  .01 .006 -.05  -.01 .006 -.05
                                     -.01 -.006 .05  .01 -.006 .05  .01 .006 .05  -.01 .006 .05"/></asset>
    <worldbody><body name="frame"><geom type="box" size=".02 .15 .01"/>
      <body name="door" pos="0 .15 .2"><joint name="hinge" axis="0 0 1" range="0 1.5"/>
        <geom type="box" size=".01 .14 .15" pos="0 -.14 0"/>
        <geom name="handle" type="mesh" mesh="grip" pos=".06 -.25 0"/>
        <geom type="box" size=".02 .005 .005" pos=".03 -.25 0"/>
      </body></body></worldbody>)");
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(
      {.name = "unit", .mjcf_path = door, .pos = Vec3{0.6, 0, 0}, .fixed = true});
  RobotConfig config = ExampleRun("pick_and_place.yaml").robot.config;
  spec.robots.push_back({.name = "arm", .config = config});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Robot robot = Robot::Of(scene, "arm");
  JointOpening opening = JointOpening::Of(scene, "unit");
  const auto bar = internal::FindHandle(scene, opening);
  ASSERT_TRUE(bar.has_value());
  EXPECT_FALSE(bar->is_exact);
  EXPECT_NEAR(bar->half_length, 0.05, 1e-6);
  EXPECT_NEAR(bar->outward.x(), 1, 1e-6);
  EXPECT_NEAR(internal::FrontOf(scene, opening)->x(), 1, 1e-6);
  const auto shape = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  const std::vector<ContactPath> paths =
      AllPathsOf(internal::JointPaths(robot, ParseRelation("unit open 0.5"), *shape));
  ASSERT_FALSE(paths.empty());
  const Pose before = scene.body_pose("unit_door");
  opening.Put(0.6);
  scene.Forward();
  const Pose moved = scene.body_pose("unit_door") * before.inverse();
  for (const ContactPath& path : paths)
    EXPECT_TRUE(path.tcp_in_world.back().is_close(moved * path.tcp_in_world.front(), 1e-6, 1e-6));
}

}  // namespace
}  // namespace robocell
