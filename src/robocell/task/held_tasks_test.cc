#include "robocell/task/held_tasks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "robocell/base/error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/task/pouring.h"
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
    // The hole is as wide as the task says: a peg that is wider by the clearance does not fit.
    Rng rng = Rng::Stream(0, "places");
    EXPECT_FALSE(task.goals().front().bound->Sample(rng, 16).poses.empty());
    EXPECT_EQ(task.instruction(),
              std::string("insert the ") + shape + " peg into the " + shape + " hole");
  }
}

TEST(InsertTask, DrawsEachShape) {
  std::set<std::string> seen;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    InsertTask task({});
    SceneSpec spec = EmptyScene();
    Rng rng = Rng::Stream(seed, "prepare");
    task.Prepare(spec, rng);
    seen.insert(task.kind_of("hole"));
  }
  EXPECT_LE(seen.size(), 3u);
  EXPECT_FALSE(seen.empty());
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
