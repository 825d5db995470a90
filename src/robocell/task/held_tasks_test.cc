#include "robocell/task/held_tasks.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/insertion.h"
#include "robocell/task/pouring.h"
#include "robocell/task/start_contents.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

// Builds what a task adds; each object lies in a row on the floor.
template <class T>
Scene Prepared(T& task, uint64_t seed) {
  SceneSpec spec = EmptyScene();
  Rng rng = Rng::Stream(seed, "prepare");
  task.Prepare(spec, rng);
  double x = 0;
  for (size_t i = 0; i < spec.objects.size(); ++i) {
    if (!spec.objects[i].pos) spec.objects[i].pos = Vec3{x += 0.3, 0, 0.08};
  }
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

TEST(InsertTask, PegsAreNarrowerThanTheirHolesByTheClearance) {
  for (const char* shape : {"square", "round"}) {
    const SceneObject peg = InsertTask::MakePeg(shape, "peg", 0.0008);
    EXPECT_NEAR(2 * (*peg.size)[0], InsertTask::kHoleWidth - 0.0008, 1e-12);
    InsertTask task({.shapes = {shape}, .clearance = 0.0008});
    const Scene scene = Prepared(task, 0);
    task.Begin(scene);
    Rng rng = Rng::Stream(0, "places");
    EXPECT_FALSE(task.goals().front().bound->Sample(rng, 16).poses.empty());
    EXPECT_EQ(task.instruction(),
              std::string("insert the ") + shape + " peg into the " + shape + " hole");
    // The hole is as wide as the task says: a peg that is wider by the clearance does not fit.
    SceneSpec spec = EmptyScene();
    spec.objects.push_back(InsertTask::MakePeg(shape, "peg", -0.0008));
    spec.objects[0].pos = Vec3{0, 0, 0.5};
    spec.objects.push_back({.name = "hole",
                            .mjcf_path = std::string(shape) + "_hole",
                            .pos = Vec3{0, 0, 0.021},
                            .fixed = true});
    Scene wider = Scene::Build(spec);
    wider.Reset();
    EXPECT_TRUE(Insertion(wider, "peg", "hole").FreePoses(16).empty()) << shape;
  }
}

TEST(InsertTask, DrawsEachShape) {
  std::set<std::string> seen;
  for (int episode = 0; episode < 3; ++episode) {
    InsertTask task({});
    SceneSpec spec = EmptyScene();
    Rng rng = Rng::Stream(0, "prepare");
    const Task::KnownScene unknown = [] { return nullptr; };
    const StartContents contents = PrepareContents(
        task, {.known = unknown, .kind = "insert", .turn = {.episode = episode}}, spec, rng);
    ASSERT_EQ(contents.objects.size(), 2u);
    seen.insert(task.kind_of("hole"));
  }
  EXPECT_EQ(seen.size(), 3u);
}

TEST(SortTask, EachCubeGoesToThePlateOfItsColour) {
  SortTask task({.objects = 4});
  Scene scene = Prepared(task, 0);
  task.Begin(scene);
  ASSERT_EQ(task.goals().size(), 4u);
  EXPECT_EQ(task.subtasks().front(), "put the red cube on the red plate");
  const auto put = [&](const std::string& cube, const std::string& plate) {
    Eigen::Vector3d at = scene.body_pose(plate).translation();
    at.z() += 0.004 + 0.02 - 1e-4;
    scene.SetBodyPose(cube, Pose(at));
    scene.Forward();
  };
  for (const char* colour : {"red", "blue", "green", "yellow"})
    put(std::string(colour) + "_cube", std::string(colour) + "_plate");
  const auto holds = [&] {
    return std::ranges::count_if(task.goals(), [](const auto& goal) { return goal.Holds(); });
  };
  EXPECT_EQ(holds(), 4);
  put("red_cube", "blue_plate");
  EXPECT_EQ(holds(), 3) << "a cube on another plate does not count";
}

// Posts are thinner than any grid of points: the sponge itself must be free.
TEST(WipeTask, TheAreaIsFreeOfThinThings) {
  WipeTask task({});
  SceneSpec spec = EmptyScene();
  Rng rng = Rng::Stream(0, "posts");
  task.Prepare(spec, rng);
  spec.objects[0].pos = Vec3{0, 0, 0.0251};
  std::vector<Eigen::Vector2d> posts;
  for (int i = 0; i < 12; ++i) {
    const double angle = rng.Uniform(-kPi, kPi), distance = rng.Uniform(0.06, 0.3);
    posts.emplace_back(distance * std::cos(angle), distance * std::sin(angle));
    SceneObject post = BoxObject(fmt::format("post_{}", i), {posts[i].x(), posts[i].y(), 0.02});
    post.size = Vec3{0.001, 0.001, 0.02};
    post.fixed = true;
    spec.objects.push_back(post);
  }
  Scene scene = Scene::Build(spec);
  scene.Reset();
  scene.Forward();
  task.Begin(scene);
  int placed = 0;
  for (int i = 0; i < 20; ++i) {
    if (task.Arrange(scene, rng)) continue;
    ++placed;
    const Pose area = scene.body_pose(scene.compiled()->object("area").root_body);
    for (const Eigen::Vector2d& post : posts) {
      const Eigen::Vector3d at = area.inverse() * Eigen::Vector3d(post.x(), post.y(), 0);
      EXPECT_FALSE(std::abs(at.x()) < 0.08 && std::abs(at.y()) < 0.06) << at.transpose();
    }
  }
  EXPECT_GT(placed, 0);
}

TEST(WipeTask, RejectsAnAreaOfAnotherSize) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("target", {0, 0, 0.02}));
  spec.objects.push_back(BoxObject("area", {0.3, 0, 0.02}));
  Scene scene = Scene::Build(spec);
  scene.Reset();
  WipeTask task({});
  ExpectThrow<ArgumentError>([&] { task.Begin(scene); },
                             "'area' has 16 cells of 0.01 m, and the task records 192");
}

TEST(PourTask, SaysWhichKindsAreNoVessels) {
  EXPECT_EQ(PourTask::WhyNotFrom("open_bottle", {}), "");
  EXPECT_EQ(PourTask::WhyNotInto("receiver"), "");
  EXPECT_THAT(PourTask::WhyNotFrom("box", {}), ::testing::HasSubstr("'box' has no hollow"));
  EXPECT_THAT(PourTask::WhyNotInto("box"), ::testing::HasSubstr("'box' has no hollow"));
  EXPECT_THAT(PourTask::WhyNotFrom("open_bottle", {.grains = 200}),
              ::testing::HasSubstr("lower task.grains or task.grain_radius"));
  EXPECT_EQ(PourTask::WhyNotFrom("open_bottle", {.grain_radius = 1e-7}), "");
}

TEST(PourTask, FillsTheVesselWithItsGrains) {
  for (const int grains : {20, 40}) {
    PourTask task({.grains = grains});
    Scene scene = Prepared(task, 0);
    task.Begin(scene);
    Rng rng = Rng::Stream(0, "draw");
    EXPECT_FALSE(task.Arrange(scene, rng).has_value());
    const Vessel vessel(scene, "target");
    const std::vector<std::string> names = GrainsOf(scene, "target");
    EXPECT_EQ(names.size(), static_cast<size_t>(grains));
    for (const std::string& grain : names)
      EXPECT_TRUE(vessel.Contains(scene.body_pose(grain).translation())) << grain;
    for (const Contact& contact : scene.contacts("target_open_bottle"))
      EXPECT_GT(contact.distance, -1e-4) << "grains are not in the walls";
    EXPECT_FALSE(task.Judge(scene).success);
  }
  PourTask many({.grains = 200});
  Scene scene = Prepared(many, 0);
  many.Begin(scene);
  Rng rng = Rng::Stream(0, "draw");
  ExpectThrow<ArgumentError>([&] { many.Arrange(scene, rng); }, "lower task.grains");
}

}  // namespace
}  // namespace robocell::internal
