// Tests starts of runs that draw their objects.
#include "robocell/task/object_task.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <map>
#include <set>

#include "robocell/base/files.h"
#include "robocell/motion/clearance.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/task/held.h"
#include "robocell/task/pick_task.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

RunConfig Demo() { return RunConfig::Load(SourceDir() + "/examples/demo.yaml"); }

Rng StreamOf(int i) { return Rng::Stream(7, "sampler test", i); }

// Accepted starts of the first episodes, each at its first accepted attempt.
struct Samples {
  std::vector<EpisodeStart> starts;
  int tries = 0;  // places, including those rejected within an attempt
};

Samples SamplesOf(const RunConfig& run) {
  Samples samples, *made = &samples;
  {
    StartSampler sampler(run);
    for (int episode = 0; episode < 20; ++episode) {
      for (int attempt = 0; attempt < 20; ++attempt) {
        Rng rng = Rng::Stream(7, episode, attempt);
        SampleResult result = sampler.Sample({.episode = episode, .attempt = attempt}, rng);
        ++made->tries;
        for (const auto& [reason, count] : result.redrawn()) made->tries += count;
        if (!result.start) continue;
        made->starts.push_back(std::move(*result.start));
        break;
      }
    }
  }
  return samples;
}

const Samples& DemoSamples() {
  static const Samples* samples = new Samples(SamplesOf(Demo()));
  return *samples;
}

double Span(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

TEST(ObjectTask, AcceptsMostSamples) {
  EXPECT_EQ(DemoSamples().starts.size(), 20u);
  EXPECT_LE(DemoSamples().tries, 50);  // 40 %
}

TEST(ObjectTask, AcceptsMostSamplesWithAStretchedHome) {
  REQUIRE_MENAGERIE("ufactory_xarm7");
  const Samples samples = SamplesOf(RunConfig::Load(SourceDir() + "/examples/xarm7_pick.yaml"));
  EXPECT_EQ(samples.starts.size(), 20u);
  EXPECT_LE(samples.tries, 50);  // 40 %
}

TEST(ObjectTask, TwentyEpisodesSpanTheConfiguredRanges) {
  const BaseRange range = BaseRangeOf(Demo().start, {});
  std::vector<double> distances, heights;
  for (const EpisodeStart& start : DemoSamples().starts) {
    const Eigen::Vector3d offset =
        start.base_in_world.translation() -
        start.scene.body_pose(start.scene.compiled()->object("target").root_body).translation();
    distances.push_back(offset.head<2>().norm());
    heights.push_back(offset.z() - range.height_offset);
  }
  EXPECT_GE(Span(distances), 0.8 * (range.distance[1] - range.distance[0]));
  EXPECT_GE(Span(heights), 0.8 * (range.height_noise[1] - range.height_noise[0]));
  // The target moves by about a millimetre while it settles.
  EXPECT_GE(*std::min_element(distances.begin(), distances.end()), range.distance[0] - 0.01);
  EXPECT_LE(*std::max_element(distances.begin(), distances.end()), range.distance[1] + 0.01);
}

TEST(ObjectTask, KindsAlternateAndOthersAreOfDifferentKinds) {
  std::map<std::string, int> counts;
  for (const EpisodeStart& start : DemoSamples().starts) {
    ++counts[start.object_kinds.front()];
    EXPECT_EQ(std::count(start.object_kinds.begin(), start.object_kinds.end(),
                         start.object_kinds.front()),
              1);
  }
  for (const std::string& kind : DefaultObjectKinds()) EXPECT_GE(counts[kind], 2) << kind;
}

// A policy must not be able to infer the distance from the kind.
TEST(ObjectTask, EachKindCoversTheWholeRange) {
  RunConfig run = Demo();
  const std::vector<std::string> all = DefaultObjectKinds();
  for (const size_t count : {2, 3, 4, 8}) {
    run.task.As<PickTaskConfig>().objects.names.assign(
        all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
    StartSampler sampler(run);
    std::map<std::string, std::vector<double>> distances, heights;
    for (int episode = 0; episode < 24 * static_cast<int>(count); ++episode) {
      Rng rng = StreamOf(episode);
      const SampleRequest request{.episode = episode};
      const std::string kind = StartTurn{static_cast<uint64_t>(run.seed), 0, episode}.Choose(
          run.task.As<PickTaskConfig>().objects.names);
      const BasePlacement placement = sampler.ChooseBasePlacement(request, rng);
      distances[kind].push_back(placement.distance);
      heights[kind].push_back(placement.height);
    }
    ASSERT_EQ(distances.size(), count);
    const auto& [near, far] = *run.start.base_distance;
    const auto& [low, high] = *run.start.base_height_noise;
    for (const auto& [kind, values] : distances) {
      EXPECT_EQ(values.size(), 24u) << "kinds take turns";
      EXPECT_GE(Span(values), 0.75 * (far - near)) << kind << " of " << count;
      EXPECT_GE(Span(heights[kind]), 0.75 * (high - low)) << kind << " of " << count;
    }
  }
}

TEST(ObjectTask, StartsDiffer) {
  std::set<std::vector<double>> states;
  for (const EpisodeStart& start : DemoSamples().starts) states.insert(start.scene.state());
  EXPECT_EQ(states.size(), DemoSamples().starts.size());
}

TEST(ObjectTask, AStartIsAtRestAndCollisionFree) {
  for (const EpisodeStart& start : DemoSamples().starts) {
    Scene scene = start.scene;
    EXPECT_EQ(scene.time(), 0);
    EXPECT_EQ(internal::RobotClearance(scene, RobotsOf(scene).front(), 0.009).robot_geom, "");
    EXPECT_FALSE(internal::TouchingBody(scene, scene.compiled()->object("target").root_body).robot);
    EXPECT_TRUE(internal::TouchingBody(scene, scene.compiled()->object("target").root_body).other);
    const Pose before = scene.body_pose(scene.compiled()->object("target").root_body);
    start.task->Begin(scene);
    EXPECT_FALSE(start.task->Judge(scene).success);
    EXPECT_LT(start.task->Judge(scene).reward, 0.5) << "what is not lifted counts by its nearness";
    EXPECT_EQ(before, scene.body_pose(scene.compiled()->object("target").root_body));
  }
}

TEST(ObjectTask, SameStreamSameStart) {
  StartSampler a(Demo()), b(Demo());
  Rng other = StreamOf(99);
  (void)b.Sample({.episode = 5}, other);  // history does not matter
  for (int i = 0; i < 3; ++i) {
    Rng ra = StreamOf(i), rb = StreamOf(i);
    const SampleResult x = a.Sample({.episode = i}, ra), y = b.Sample({.episode = i}, rb);
    ASSERT_EQ(x.start.has_value(), y.start.has_value());
    if (!x.start) continue;
    EXPECT_EQ(x.start->scene.state(), y.start->scene.state());
    EXPECT_EQ(x.start->object_kinds, y.start->object_kinds);
  }
}

// Makes a new house on the way, each in the place of the previous one.
class OneHouseAfterTheOther : public StartSampler {
 public:
  using StartSampler::StartSampler;
  static double Height(int house) { return 0.5 + 0.1 * house; }
  SceneSpec MakeBaseScene(int house) override {
    AtomicWrite(
        folder_ / "house.xml",
        fmt::format(
            "<mujoco><worldbody><body name='table' pos='0 0 {}'>"
            "<geom type='box' size='.4 .4 .02' pos='0 0 -.02'/></body></worldbody></mujoco>",
            Height(house)));
    SceneSpec spec{.name = "house", .timestep = 0.002, .add_floor = true, .add_skybox = false};
    spec.base = (folder_ / "house.xml").string();
    return spec;
  }

 private:
  TempDir folder_;
};

TEST(ObjectTask, ObjectsLieOnTheTableOfTheCurrentHouse) {
  OneHouseAfterTheOther sampler(Demo());
  for (const int house : {0, 1, 2}) {
    SampleResult result;
    for (int attempt = 0; attempt < 20 && !result.start; ++attempt) {
      Rng rng = Rng::Stream(7, house, attempt);
      result = sampler.Sample({.scene = house, .attempt = attempt}, rng);
    }
    ASSERT_TRUE(result.start.has_value()) << result.refusal.detail;
    Scene& scene = result.start->scene;
    const std::string target = scene.compiled()->object("target").root_body;
    const double above = scene.body_pose(target).translation().z() - sampler.Height(house);
    EXPECT_GT(above, -0.001) << house;
    EXPECT_LT(above, 0.095) << house;
  }
}

TEST(ObjectTask, RejectsABaseOutOfReachWithTheDistance) {
  RunConfig run = Demo();
  run.start.base_distance = {3, 3};
  StartSampler sampler(run);
  Rng rng = StreamOf(0);
  const SampleResult result = sampler.Sample({}, rng);
  ASSERT_FALSE(result.start.has_value());
  EXPECT_EQ(result.refusal.reason, Refusal::kNoReachableBasePose);
  EXPECT_THAT(result.refusal.detail, ::testing::HasSubstr("m away, reach is"));
}

TEST(ObjectTask, RejectsABaseThatAlwaysOverlapsTheTable) {
  RunConfig run = Demo();
  run.start.base_distance = {0.01, 0.01};
  run.start.base_height_noise = {0, 0};
  StartSampler sampler(run);
  Rng rng = StreamOf(0);
  const SampleResult result = sampler.Sample({}, rng);
  ASSERT_FALSE(result.start.has_value());
  EXPECT_EQ(result.refusal.reason, Refusal::kBaseInCollision);
  EXPECT_THAT(result.refusal.detail,
              ::testing::HasSubstr("0.01 m from the target and -0.25 m above it the robot overlaps "
                                   "the support or something else wherever the target lies"));
  EXPECT_EQ(result.refusal.redrawn.at("base: no base pose is free of collisions"),
            7);  // of 8 places
}

TEST(ObjectTask, RejectsABaseInsideTheTableAndNamesBothGeoms) {
  StartSampler sampler(Demo());
  Scene scene = DemoSamples().starts.front().scene;
  Robot robot = RobotsOf(scene).front();
  const Pose before = robot.base().pose();
  robot.base().SetPose(Pose({0, 0, 0.3}));
  const std::string target = scene.compiled()->object("target").root_body;
  const auto refusal = sampler.ValidateBasePose(scene, robot, target);
  ASSERT_TRUE(refusal.has_value());
  EXPECT_EQ(refusal->reason, Refusal::kBaseInCollision);
  EXPECT_THAT(refusal->detail, ::testing::HasSubstr("geom 'robot_0/"));
  EXPECT_THAT(refusal->detail, ::testing::HasSubstr("from geom 'table_"));
  robot.base().SetPose(before);
  scene.Forward();
}

// A sampler with a pool of unused objects: another mug, and a block that would fill the space over
// the table.
class BesideAPool : public StartSampler {
 public:
  using StartSampler::StartSampler;
  SceneSpec MakeBaseScene(int scene) override {
    SceneSpec spec = StartSampler::MakeBaseScene(scene);
    spec.objects.push_back({.name = "spare",
                            .mjcf_path = "mug",
                            .pos = Vec3{0, 0, 0.8},
                            .fixed = false,
                            .parked = true});
    spec.objects.push_back({.name = "block",
                            .shape = Shape::kBox,
                            .size = Vec3{0.8, 0.8, 0.5},
                            .rgba = Vec4{1, 0, 0, 1},
                            .mass = 5,
                            .friction = Vec3{1, 0.02, 0.001},
                            .pos = Vec3{0, 0, 1.2},
                            .parked = true});
    return spec;
  }
};

TEST(ObjectTask, ParkedObjectsAreNotSampledAndCollideWithNothing) {
  StartSampler alone(Demo());
  BesideAPool beside(Demo());
  int starts = 0;
  for (int i = 0; i < 5; ++i) {
    Rng a = StreamOf(i), b = StreamOf(i);
    const SampleResult x = alone.Sample({.episode = i}, a), y = beside.Sample({.episode = i}, b);
    ASSERT_EQ(x.start.has_value(), y.start.has_value()) << i << ": " << y.refusal.detail;
    if (!x.start) continue;
    ++starts;
    EXPECT_EQ(y.start->object_kinds, x.start->object_kinds);
    EXPECT_EQ(y.start->task->objects(), x.start->task->objects());
    EXPECT_EQ(y.start->base_in_world, x.start->base_in_world);
    const Scene& scene = y.start->scene;
    const std::string target = scene.compiled()->object("target").root_body;
    EXPECT_TRUE(scene.body_pose(target).is_close(x.start->scene.body_pose(target), 0.02, 1e-3));
    EXPECT_THAT(scene.parked_objects(), ::testing::ElementsAre("spare", "block"));
    EXPECT_THAT(scene.contacts("block"), ::testing::IsEmpty());
    EXPECT_GT(scene.body_pose("block").translation().z(), 500);
  }
  EXPECT_GE(starts, 3);
}

// A scene of the demo's robot and these objects on its table; the first is called `name`.
Scene TableWith(const std::string& name, std::vector<SceneObject> objects) {
  SceneSpec spec = MakePickScene(objects.front()).scene.spec();
  objects.front().name = name;
  spec.objects = {};
  for (const SceneObject& object : objects) spec.objects.push_back(object);
  Scene scene = Scene::Build(spec);
  scene.Reset();
  scene.Forward();
  return scene;
}

SceneObject Placed(const std::string& kind, const std::string& name, const Vec3& pos) {
  SceneObject object = ObjectOnTheTable(kind);
  object.name = name;
  object.pos = pos;
  return object;
}

// Names of the scene are no words of people.
TEST(ObjectTask, RefersToObjectsOfTheSceneByTheirWords) {
  SceneObject other = ObjectOnTheTable("box");
  other.name = "cube_1";
  (*other.pos)[1] = 0.25;
  const Scene scene = TableWith("cube_2", {ObjectOnTheTable("box"), other});
  PickTask task({.object = "cube_2", .refer = true});
  task.Begin(scene);
  EXPECT_EQ(task.instruction(), "pick up the rightmost box");
  PickTask plain({.object = "cube_2"});
  plain.Begin(scene);
  EXPECT_EQ(plain.instruction(), "pick up the cube_2");
}

// Whoever prepared the scene, the task knows the hollows around its object.
TEST(ObjectTask, RefersInAScenePreparedByAnother) {
  const double top = 0.4505;
  ModelFolder folder;
  std::string boards = "<geom type='box' size='.15 .15 .005'/>";
  for (const char* at : {".145", "-.145"}) {
    boards += fmt::format("<geom type='box' size='.005 .15 .08' pos='{} 0 .08'/>", at);
    boards += fmt::format("<geom type='box' size='.15 .005 .08' pos='0 {} .08'/>", at);
  }
  const std::string crate =
      folder.Write("crate", "<worldbody><body name='crate'>" + boards + "</body></worldbody>");
  const Scene scene = TableWith(
      "cube_1", {Placed("box", "target", {0, 0, top + 0.04}),
                 Placed("box", "cube_2", {0.02, -0.35, top + 0.04}),
                 {.name = "crate", .mjcf_path = crate, .pos = Vec3{0, 0, top}, .fixed = true}});
  PickTask task({.object = "cube_1", .refer = true});
  task.Begin(scene);
  EXPECT_EQ(task.instruction(), "pick up the box in the crate");
}

}  // namespace
}  // namespace robocell
