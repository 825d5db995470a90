#include "robocell/task/pick_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/spec/testing/duo_env.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/testing/pour_task.h"
#include "robocell/spec/yaml.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/pick_task.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/start_sampler.h"
#include "robocell/task/task_kind.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using testing::ParseError;

TEST(PickKind, ARunWithoutAKindPicks) {
  EXPECT_EQ(TaskSpec().kind(), "pick");
  EXPECT_EQ(Parse("{lift_height: 0.07}").task.As<PickTaskConfig>().lift_height, 0.07);
}

TEST(PickKind, ATaskIsAboutAnObjectOfTheRig) {
  EnvConfig env = Duo();
  env.root_frame_objects["cube"] = Thing();
  env.task = PickTaskConfig{.object = "cub"};
  EXPECT_EQ(Message(env),
            "it is not valid: task.object: root_frame_objects: no object 'cub'. Its objects: cube. "
            "Did you mean 'cube'?");
  env.task->As<PickTaskConfig>().object = "box";
  EXPECT_THAT(Message(env), HasSubstr("'box' is a kind of object: `objects: [box]` in its place"));
  env.task->As<PickTaskConfig>().object = "cube";
  EXPECT_EQ(Message(env), "");
  env.world_frame_objects["ball"] = Thing();
  env.task->As<PickTaskConfig>().object = "ball";
  EXPECT_EQ(Message(env),
            "it is not valid: task.object: 'ball' is in world_frame_objects, which stay in the "
            "room; a task goes with the rig, and so do its objects: move it to root_frame_objects");
}

TEST(PickKind, RejectsInvalidObjectsAndGoalsOfATask) {
  EnvConfig env = Duo();
  env.root_frame_objects["cube"] = Thing();
  env.task = PickAndPlaceTaskConfig{.object = "cube"};
  EXPECT_EQ(Message(env), "") << "the goal is drawn";
  auto& task = env.task->As<PickAndPlaceTaskConfig>();
  task.goal = Vec3{0, 0, 0.02};
  task.goal_object = "cub";
  EXPECT_THAT(Message(env), HasSubstr("task.goal_object: root_frame_objects: no object 'cub'."));
  task.goal_object = "cube";
  EXPECT_THAT(Message(env), HasSubstr("task.goal_object: is the object that is to be put there"));
}

TEST(PickKind, DoubtsLengthsOfAnEnvironmentThatLookLikeMillimetres) {
  EnvConfig env = Duo();
  env.root_frame_objects["cube"] = Thing();
  const std::string doubt =
      "50 m is more than any arm reaches, and lengths are in metres. Is it in millimetres? Then "
      "write 0.05";
  env.task = PickTaskConfig{.object = "cube", .lift_height = 50};
  EXPECT_EQ(Message(env), "it is not valid: task.lift_height: " + doubt);
  env.task = PickTaskConfig{.object = "cube", .spread = {0, 50}};
  EXPECT_EQ(Message(env), "it is not valid: task.spread: " + doubt);
  PickAndPlaceTaskConfig place{.object = "cube", .goal = Vec3{0, 0, 0.02}};
  place.goal_distance = 50;
  env.task = place;
  EXPECT_EQ(Message(env), "it is not valid: task.goal_distance: " + doubt);
}

// What `task:` says in an environment with the object "cube", and in a run.
struct Messages {
  std::string in_env, in_run;
};

Messages MessagesOf(const std::string& task) {
  Messages messages;
  EnvConfig env = Duo();
  env.root_frame_objects["cube"] = Thing();
  env.root_frame_objects["mat"] = Thing();
  const std::string text = kRunHead + "task: " + task + "\n";
  env.task = FromYamlUnchecked<RunConfig>(text).task;
  messages.in_env = Message(env);
  messages.in_run = ParseError<RunConfig>(text);
  return messages;
}

// The same block has the same rules in both.
TEST(PickKind, NamesOrDrawsInRunsAndEnvironmentsAlike) {
  for (const char* task :
       {"{kind: pick}", "{kind: pick, objects: [box, mug]}", "{kind: pick, object: cube}",
        "{kind: pick, object: cube, spread: [0.05, 0.1], rotate: false}", "{kind: pick_and_place}",
        "{kind: pick_and_place, objects: [box], goals: [tray]}",
        "{kind: pick_and_place, object: cube, goals: [tray]}",
        "{kind: pick_and_place, objects: [box], goal: [0.4, 0, 0.02]}",
        "{kind: pick_and_place, object: cube, goal_object: mat, goal_spread: [0.1, 0.1]}"}) {
    const Messages messages = MessagesOf(task);
    EXPECT_EQ(messages.in_env, "") << task;
    EXPECT_EQ(messages.in_run, "") << task;
  }
  const std::vector<std::pair<const char*, const char*>> rejected = {
      {"{kind: pick, object: cube, objects: [box]}",
       "task.objects: are the kinds that the object is drawn from, and `object` names it already: "
       "leave one of them out"},
      {"{kind: pick, spread: [0.1, 0]}",
       "task.spread: is about the place that `object` has in the scene, and none is named"},
      {"{kind: pick, rotate: false}", "task.rotate: is about the place that `object` has"},
      {"{kind: pick_and_place, goal: [0, 0, 0], goals: [tray]}",
       "task.goals: are the kinds that the goal is drawn from, and `goal` names it already"},
      {"{kind: pick_and_place, goal_object: mat, goals: [tray]}", "`goal_object` names it already"},
      {"{kind: pick_and_place, goal_spread: [0.1, 0]}",
       "task.goal_spread: is about the place that `goal` or `goal_object` has"},
      {"{kind: pick_and_place, object: cube, goal_object: cube}",
       "task.goal_object: is the object that is to be put there"},
      {"{kind: pick, objects: [bok]}", "Did you mean 'box'?"},
      {"{kind: pick, lift_height: 50}", "50 m is more than any arm reaches"}};
  for (const auto& [task, text] : rejected) {
    const Messages messages = MessagesOf(task);
    EXPECT_THAT(messages.in_env, HasSubstr(text)) << task;
    EXPECT_THAT(messages.in_run, HasSubstr(text)) << task;
  }
}

TEST(PickKind, ReportsUnknownObjectKindsAtTheirPlace) {
  const std::string error =
      ParseError<RunConfig>(kRunHead +
                            "task: {kind: pick_and_place, objects: [box, mgu], goals: "
                            "[try]}\n");
  EXPECT_THAT(error, HasSubstr("yaml:4:45: task.objects[1]: no kind of object 'mgu'"));
  EXPECT_THAT(error, HasSubstr("Did you mean 'mug'?"));
  EXPECT_THAT(error, HasSubstr("Categories, which stand for all their kinds: blocks, books"));
  EXPECT_THAT(error, HasSubstr("task.goals[0]: no kind of object 'try'"));
}

TEST(PickKind, HasOneObjectOfEachKind) {
  RunConfig run = ExampleRun("demo.yaml");
  EXPECT_EQ(FindTaskKind("pick")->Contents(run).size(), DefaultObjectKinds().size());
  run.task.As<PickTaskConfig>().objects = {"mug"};
  const std::vector<SceneObject> contents = FindTaskKind("pick")->Contents(run);
  ASSERT_EQ(contents.size(), 1u);
  EXPECT_EQ(contents[0].name, "mug");
}

TEST(PickKind, DrawsTheKindsOfACategory) {
  RunConfig run = ExampleRun("demo.yaml");
  run.task.As<PickTaskConfig>().objects = {"fruit", "milk_carton"};
  EXPECT_EQ(FindTaskKind("pick")->Contents(run).size(), 6u);
  std::set<std::string> kinds;
  for (int i = 0; i < 40; ++i) {
    PickTask task(run.task.As<PickTaskConfig>());
    Rng rng = Rng::Stream(1, "fruit", i);
    SceneSpec spec;
    task.Prepare(spec, rng);
    for (const std::string& object : task.objects()) kinds.insert(task.kind_of(object));
    EXPECT_EQ(task.instruction(), "pick up the " + WordOfKind(task.kind_of("target")));
  }
  EXPECT_THAT(kinds, ::testing::UnorderedElementsAre("apple", "banana", "lemon", "milk_carton",
                                                     "orange", "pear"));
}

// A source whose scenes have a cube on a table, and scene 1 a ball instead.
struct ShelfConfig {
  static constexpr const char* kKind = "cube_of_pick_test";
  static constexpr const char* kTypeName = "ShelfConfig";
  template <class V>
  static void Fields(V&& /*v*/) {}
};

class Shelf final : public SceneSource {
 public:
  explicit Shelf(const ShelfConfig& /*fields*/) {}
  std::optional<int> size() const override { return 2; }
  SceneSpec Make(int index) override {
    SceneSpec spec{.base = "tabletop", .add_floor = true, .add_skybox = true};
    SceneObject object = ObjectOnTheTable("box");
    object.name = index == 0 ? "cube" : "ball";
    spec.objects.push_back(std::move(object));
    return spec;
  }
};

RunConfig RunOnShelf(TaskSpec task, int scene) {
  static const bool kRegistered = [] {
    RegisterSceneSource<ShelfConfig>(std::make_shared<SceneSourceKindOf<ShelfConfig, Shelf>>());
    return true;
  }();
  (void)kRegistered;
  RunConfig run = ExampleRun("demo.yaml");
  run.scenes = ShelfConfig{};
  run.scenes.houses = {{scene}};
  run.task = std::move(task);
  return run;
}

// The kind's own check of a run's scenes.
std::string ProblemsOf(const RunConfig& run) {
  PickScene scene = MakePickScene(ObjectOnTheTable("box"));
  Problems problems, doubts;
  FindTaskKind(run.task.kind())->ValidateScene(run, scene.scene, scene.robot, problems, doubts);
  return problems.empty() ? "" : problems.Text("it");
}

TEST(PickKind, ANamedObjectIsInAllScenesOfTheRun) {
  EXPECT_EQ(ProblemsOf(RunOnShelf(PickTaskConfig{.object = "cube"}, 0)), "");
  RunConfig both = RunOnShelf(PickTaskConfig{.object = "cube"}, 0);
  both.scenes.houses = {{0, 1}};
  EXPECT_THAT(ProblemsOf(both), HasSubstr("task.object: scene 1 of source 'cube_of_pick_test': no "
                                          "object 'cube'. Its objects: ball"));
  RunConfig table = ExampleRun("demo.yaml");
  table.task = PickTaskConfig{.object = "cube"};
  EXPECT_THAT(
      ProblemsOf(table),
      HasSubstr("task.object: no object 'cube': scene 0 of source 'tabletop' has no objects, "
                "which a source puts into SceneSpec.objects. Leave `object` out"));
  EXPECT_THAT(
      ProblemsOf(RunOnShelf(PickAndPlaceTaskConfig{.object = "cube", .goal_object = "mat"}, 0)),
      HasSubstr("task.goal_object: scene 0 of source"));
}

// The start of a run with a named object: the object lies where the scene has it, moved by `spread`,
// the robot stands in range of it, and it can be grasped and lifted there.
TEST(PickKind, ARunPicksTheObjectOfItsScene) {
  const RunConfig run = RunOnShelf(PickTaskConfig{.object = "cube", .spread = {0.05, 0.03}}, 0);
  const Vec3 own = Shelf({}).Make(0).objects[0].pos.value();
  const BaseRange range = BaseRangeOf(run.start, {});
  int accepted = 0;
  double farthest = 0;
  StartSampler sampler(run);
  for (int episode = 0; episode < 8; ++episode) {
    Rng rng = Rng::Stream(7, "named", episode);
    const SampleResult result = sampler.Sample({.episode = episode}, rng);
    if (!result.start) continue;
    ++accepted;
    const EpisodeStart& start = *result.start;
    EXPECT_EQ(start.target_object, "cube");
    EXPECT_EQ(start.object_kinds, std::vector<std::string>{"cube"});
    EXPECT_EQ(start.scene.object_names(), std::vector<std::string>{"cube"});
    EXPECT_EQ(start.task->instruction(), "pick up the cube");
    const Eigen::Vector3d at =
        start.scene.body_pose(start.scene.compiled()->object("cube").root_body).translation();
    const Eigen::Vector3d displacement = at - ToEigen(own);
    EXPECT_LE(std::abs(displacement.x()), 0.05 + 0.002);
    EXPECT_LE(std::abs(displacement.y()), 0.03 + 0.002);
    farthest = std::max(farthest, displacement.head<2>().norm());
    const double distance = (start.base_in_world.translation() - at).head<2>().norm();
    EXPECT_GE(distance, range.distance[0] - 0.01);
    EXPECT_LE(distance, range.distance[1] + 0.01);
  }
  EXPECT_GE(accepted, 4);
  EXPECT_GT(farthest, 0.01) << "the spread is drawn";
}

// A place in relation to something comes before a pose in the scene, as in an environment.
TEST(PickKind, ARunPlacesTheObjectOfItsSceneByARelation) {
  RunConfig run = RunOnShelf(PickTaskConfig{.object = "cube"}, 0);
  run.start.places = {{"cube", {.on_top_of = "table"}}};
  const Vec3 own = Shelf({}).Make(0).objects[0].pos.value();
  StartSampler sampler(run);
  Problems problems;
  sampler.ValidateStarts(std::vector<int>{0}, problems);
  EXPECT_TRUE(problems.empty()) << problems.Text("it");
  int accepted = 0;
  double farthest = 0;
  for (int episode = 0; episode < 8; ++episode) {
    Rng rng = Rng::Stream(7, "placed", episode);
    const SampleResult result = sampler.Sample({.episode = episode}, rng);
    if (!result.start) continue;
    ++accepted;
    const Scene& scene = result.start->scene;
    EXPECT_EQ(result.start->target_object, "cube");
    EXPECT_EQ(result.start->object_kinds, std::vector<std::string>{"cube"});
    const Eigen::Vector3d at =
        scene.body_pose(scene.compiled()->object("cube").root_body).translation();
    EXPECT_NEAR(at.z(), own[2], 0.002);
    farthest = std::max(farthest, (at - ToEigen(own)).norm());
  }
  EXPECT_GE(accepted, 2);
  EXPECT_GT(farthest, 0.02) << "it does not stay at its place";
  run.start.places = {{"cub", {.on_top_of = "table"}}};
  StartSampler wrong(run);
  wrong.ValidateStarts(std::vector<int>{0}, problems);
  EXPECT_THAT(problems.Text("it"), HasSubstr("start.places.cub: no object 'cub'"));
}

TEST(PickKind, ARunPutsANamedObjectOnADrawnTray) {
  const RunConfig run = RunOnShelf(PickAndPlaceTaskConfig{.object = "cube"}, 0);
  StartSampler sampler(run);
  int accepted = 0;
  for (int attempt = 0; attempt < 12 && accepted == 0; ++attempt) {
    Rng rng = Rng::Stream(7, "named goal", attempt);
    const SampleResult result = sampler.Sample({.attempt = attempt}, rng);
    if (!result.start) continue;
    ++accepted;
    EXPECT_EQ(result.start->target_object, "cube");
    EXPECT_EQ(result.start->object_kinds, (std::vector<std::string>{"cube", "tray"}));
    EXPECT_EQ(result.start->task->instruction(), "pick up the cube and put it on the tray");
  }
  EXPECT_EQ(accepted, 1);
}

}  // namespace
}  // namespace robocell
