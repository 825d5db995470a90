#include "robocell/task/pick_and_place_task.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/task/pick_and_place_sampler.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

// The oracle is the simulation: what is let go where the goal is comes to rest there.
TEST(PickAndPlaceTask, AGoalOnTopOfSomethingIsWhereTheObjectComesToRest) {
  for (const char* kind : {"box", "mug", "bottle", "cylinder"}) {
    SceneSpec spec{.name = "test", .timestep = 0.002, .add_floor = true, .add_skybox = false};
    Rng rng = Rng::Stream(3, "goal", kind);
    SceneObject object = MakeCatalogueObject(kind, "thing", rng);
    object.pos = {0.5, 0, ObjectSizes().Of(object).height};
    spec.objects.push_back(object);
    SceneObject tray = MakeGoalObject("tray", "tray", rng);
    tray.pos = {0, 0, 0.009};
    tray.quat = Pose::FromRpy({0, 0, 0}, {0, 0, 0.4}).quaternion();
    spec.objects.push_back(tray);
    Scene scene = Scene::Build(spec);
    scene.Reset();
    ASSERT_TRUE(scene.StepN(500).ok());
    PickAndPlaceTask task({.object = "thing", .goal_object = "tray"});
    task.Bind(scene, {.place = "test", .robots = {}});
    task.Begin(scene);
    const std::string body = scene.compiled()->object("thing").root_body;
    const Eigen::Vector3d goal = task.GoalInWorld();
    scene.SetBodyPose(body,
                      {goal + Eigen::Vector3d(0, 0, 0.001), scene.body_pose(body).quaternion()});
    ASSERT_TRUE(scene.StepN(500).ok());
    EXPECT_LT((scene.body_pose(body).translation() - goal).norm(), 1e-3) << kind;
    // It goes along with the tray, and is remembered.
    const std::vector<double> memory = task.memory();
    PickAndPlaceTask again({.object = "thing", .goal_object = "tray"});
    again.Bind(scene, {.place = "test", .robots = {}});
    again.Recall(memory);
    EXPECT_TRUE(again.GoalInWorld().isApprox(task.GoalInWorld(), 1e-12));
  }
}

TEST(PickAndPlaceTask, NeedsAGoal) {
  SceneSpec spec{.name = "test", .timestep = 0.002, .add_floor = true, .add_skybox = false};
  Rng rng = Rng::Stream(3, "goal");
  spec.objects.push_back(MakeCatalogueObject("box", "thing", rng));
  Scene scene = Scene::Build(spec);
  PickAndPlaceTask task({.object = "thing"});
  ExpectThrow<ArgumentError>([&] { task.Bind(scene, {.place = "here", .robots = {}}); },
                             "here: task.goal is required");
}

}  // namespace
}  // namespace robocell::internal
