// Tests objects that a task's Prepare adds to an environment without a pose.
#include "robocell/env/prepared_objects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/log.h"
#include "robocell/env/env.h"
#include "robocell/env/env_batch.h"
#include "robocell/env/testing/envs.h"
#include "robocell/scenes/spatial_relation.h"
#include "robocell/task/start_sampler.h"
#include "robocell/task/task_kind.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct TwoCubesConfig {
  bool starts = false, arranges = false;

  static constexpr const char* kKind = "two_cubes_of_test";
  static constexpr const char* kTypeName = "TwoCubesConfig";
  template <class V>
  static void Fields(V&& v) {
    v("starts", &TwoCubesConfig::starts, "Whether Starts places the first.");
    v("arranges", &TwoCubesConfig::arranges, "Whether Arrange places both.");
  }
};

class TwoCubes final : public Task {
 public:
  static inline const Eigen::Vector3d kFirst = {0.35, 0.1, 0.02}, kSecond = {0.35, -0.1, 0.02};

  explicit TwoCubes(const TwoCubesConfig& fields) : fields_(fields) {}
  void Prepare(SceneSpec& spec, Rng& /*rng*/) override {
    for (const char* name : {"first", "second"})
      spec.objects.push_back({.name = name,
                              .shape = Shape::kBox,
                              .size = Vec3{0.02, 0.02, 0.02},
                              .rgba = Vec4{1, 0.5, 0, 1},
                              .mass = 0.1,
                              .friction = Vec3{1, 0.02, 0.001}});
  }
  BodyPoses Starts(Rng& /*rng*/) override {
    if (!fields_.starts) return {};
    return {{"first", Pose(kFirst)}};
  }
  std::optional<Refusal> Arrange(Scene& scene, Rng& /*rng*/) override {
    if (fields_.arranges) {
      scene.SetBodyPose("first", Pose(kFirst));
      scene.SetBodyPose("second", Pose(kSecond));
    }
    return {};
  }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "look at the cubes"; }
  std::vector<std::string> objects() const override { return {"first", "second"}; }
  BaseRange base_range() const override { return {.distance = {0.3, 0.4}}; }

 private:
  TwoCubesConfig fields_;
};

EnvConfig Cubes(const TwoCubesConfig& fields = {}) {
  static const bool kRegistered = [] {
    RegisterTask<TwoCubesConfig>(std::make_shared<TaskKindOf<TwoCubesConfig, TwoCubes>>());
    return true;
  }();
  (void)kRegistered;
  EnvConfig config = Rc7Env();
  config.add_floor = true;
  config.task = fields;
  return config;
}

Eigen::Vector3d At(const Env& env, const std::string& object) {
  return env.scene().body_pose(object).translation();
}

// Expects the objects apart, on a support of that height, in reach of the robot in the origin, and
// at rest.
void ExpectGoodStart(Env& env, double height) {
  const Eigen::Vector3d first = At(env, "first"), second = At(env, "second");
  EXPECT_GT((first - second).head<2>().norm(), 0.04);
  for (const char* object : {"first", "second"}) {
    EXPECT_NEAR(At(env, object).z(), height + 0.02, 0.002);
    EXPECT_LT(At(env, object).norm(), Robot::Of(env.scene(), "robot").reach());
  }
  Scene scene = env.scene();
  EXPECT_TRUE(scene.StepN(200).ok());
  EXPECT_LT((At(env, "first") - first).norm(), 0.003);
  EXPECT_LT((At(env, "second") - second).norm(), 0.003);
}

TEST(PreparedObjects, StartSeparatedAtRestAndInReach) {
  Env env(Cubes());
  for (uint64_t seed = 0; seed < 10; ++seed) {
    env.Reset({.seed = seed});
    const double distance = At(env, "first").head<2>().norm();
    EXPECT_GE(distance, 0.3) << "as far as base_range() says";
    EXPECT_LE(distance, 0.4);
    ExpectGoodStart(env, 0);
  }
}

TEST(PreparedObjects, StartOnATableInReach) {
  EnvConfig config = Cubes();
  config.root_frame_objects["table"] = {.offset = Pose(Eigen::Vector3d(0.4, 0, 0.1)),
                                        .fixed = true,
                                        .shape = Shape::kBox,
                                        .size = Vec3{0.15, 0.25, 0.1},
                                        .mass = 10.0};
  Env env(config);
  for (uint64_t seed = 0; seed < 5; ++seed) {
    env.Reset({.seed = seed});
    ExpectGoodStart(env, 0.2);
  }
}

TEST(PreparedObjects, DependOnTheSeed) {
  Env env(Cubes()), other(Cubes());
  env.Reset({.seed = 4});
  const Eigen::Vector3d first = At(env, "first");
  env.Reset({.seed = 5});
  EXPECT_GT((At(env, "first") - first).norm(), 0.01);
  other.Reset({.seed = 4});
  EXPECT_EQ(At(other, "first"), first);
}

TEST(PreparedObjects, AreAtTheirTaskPoses) {
  Env starting(Cubes({.starts = true}));
  starting.Reset({.seed = 1});
  EXPECT_TRUE(At(starting, "first").isApprox(TwoCubes::kFirst, 1e-9));
  ExpectGoodStart(starting, 0);
  Env arranging(Cubes({.arranges = true}));
  arranging.Reset({.seed = 1});
  EXPECT_TRUE(At(arranging, "second").isApprox(TwoCubes::kSecond, 1e-9));
}

TEST(PreparedObjects, LogTheirPlacementOnceAtDebugLevel) {
  const LogLevel level = GetLogLevel();
  SetLogLevel(LogLevel::kDebug);
  std::vector<std::string> lines;
  const auto keep = [&](LogLevel, std::string_view text) { lines.emplace_back(text); };
  const ScopedLogSink capture(keep);
  Env env(Cubes());
  env.Reset({.seed = 1});
  env.Reset({.seed = 2});
  const std::string advice = "prepare() added first, second without a pose, so each reset draws";
  EXPECT_EQ(
      std::ranges::count_if(
          lines, [&](const std::string& line) { return line.find(advice) != std::string::npos; }),
      1);
  lines.clear();
  Env arranging(Cubes({.arranges = true}));
  EXPECT_THAT(lines, ::testing::Not(::testing::Contains(::testing::HasSubstr("without a pose"))));
  SetLogLevel(level);
}

TEST(PreparedObjects, RequireASupportInReachUnlessTheTaskPlacesThem) {
  EnvConfig config = Cubes();
  config.add_floor = false;
  ExpectThrow<SpecError>([&] { Env env(config); },
                         "prepare() added first, second without saying where, and nothing level "
                         "within reach of the robots has room for them. Set `add_floor: true`");
  config.task = TwoCubesConfig{.arranges = true};
  Env env(config);
  env.Reset({.seed = 1});
  EXPECT_TRUE(At(env, "first").isApprox(TwoCubes::kFirst, 1e-9));
}

// A brick and a tray with an object on, in and beside them.
class Served final : public Task {
 public:
  struct Config {
    static constexpr const char* kKind = "served_of_test";
    static constexpr const char* kTypeName = "Config";
    template <class V>
    static void Fields(V&& /*v*/) {}
  };

  explicit Served(const Config& /*fields*/) {}
  void Prepare(SceneSpec& spec, Rng& /*rng*/) override {
    spec.objects.push_back(Block("brick", {0.05, 0.04, 0.02}));
    spec.objects.push_back({.name = "dish", .mjcf_path = "tray", .fixed = false});
    for (const char* name : {"cube", "peg", "die"})
      spec.objects.push_back(Block(name, {0.012, 0.012, 0.012}));
  }
  Map<ObjectPlace> places() const override {
    return {{"cube", {.on_top_of = "brick"}},
            {"peg", {.inside = "dish"}},
            {"die", {.next_to = "brick", .gap = {0.02, 0.06}}}};
  }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "look at them"; }
  std::vector<std::string> objects() const override { return {"brick"}; }
  BaseRange base_range() const override { return {.distance = {0.35, 0.5}}; }

  static void Register() {
    static const bool kRegistered = [] {
      RegisterTask<Config>(std::make_shared<TaskKindOf<Config, Served>>());
      return true;
    }();
    (void)kRegistered;
  }

 private:
  static SceneObject Block(const std::string& name, const Vec3& half) {
    SceneObject block = BoxObject(name, {});
    block.pos.reset();
    block.size = half;
    return block;
  }
};

void ExpectServed(Scene scene, const std::string& where) {
  EXPECT_TRUE(scene.StepN(300).ok());
  EXPECT_TRUE(SpatialRelation(scene, "cube", Relation::kOnTopOf, "brick").Holds()) << where;
  EXPECT_TRUE(SpatialRelation(scene, "peg", Relation::kInside, "dish").Holds()) << where;
  EXPECT_TRUE(SpatialRelation(scene, "die", Relation::kNextTo, "brick").Holds()) << where;
}

TEST(PreparedObjects, HaveTheSamePlacesInEnvironmentsAndRuns) {
  Served::Register();
  EnvConfig config = Rc7Env();
  config.task = Served::Config();
  Env env(config);
  for (uint64_t seed = 0; seed < 6; ++seed) {
    env.Reset({.seed = seed});
    ExpectServed(env.scene(), "environment");
  }
  RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
  run.task = Served::Config();
  run.start = {};
  StartSampler sampler(run);
  int starts = 0;
  for (int attempt = 0; attempt < 20 && starts < 3; ++attempt) {
    Rng rng = Rng::Stream(5, "served", attempt);
    const SampleResult result = sampler.Sample({.attempt = attempt}, rng);
    if (!result.start) continue;
    ++starts;
    ExpectServed(result.start->scene, "run");
  }
  EXPECT_GE(starts, 3);
}

// The cube of the configuration, without a task.
EnvConfig WithShelf(const Map<ObjectPlace>& places) {
  EnvConfig config = Rc7WithCube();
  config.root_frame_objects["shelf"] = {.offset = Pose(Eigen::Vector3d(0.4, 0.2, 0.1)),
                                        .fixed = true,
                                        .shape = Shape::kBox,
                                        .size = Vec3{0.1, 0.1, 0.1},
                                        .mass = 1};
  config.places = places;
  return config;
}

TEST(PreparedObjects, AConfigurationRelatesItsObjects) {
  for (const bool with_task : {false, true}) {
    EnvConfig config = WithShelf({{"cube", {.on_top_of = "shelf"}}});
    if (!with_task) config.task.reset();
    Env env(config);
    std::set<double> along;
    for (uint64_t seed = 0; seed < 6; ++seed) {
      env.Reset({.seed = seed});
      Scene scene = env.scene();
      EXPECT_TRUE(scene.StepN(300).ok());
      EXPECT_TRUE(SpatialRelation(scene, "cube", Relation::kOnTopOf, "shelf").Holds())
          << with_task << ": " << At(env, "cube").transpose();
      along.insert(At(env, "cube").x());
    }
    EXPECT_EQ(along.size(), 6u) << "each reset draws a place";
  }
}

std::string PlacesError(const Map<ObjectPlace>& places) {
  return ExpectThrow<SpecError>([&] { Env env(WithShelf(places)); }, "environment 'env'");
}

TEST(PreparedObjects, ErrorsInPlacesAreReportedAtConstruction) {
  EXPECT_THAT(PlacesError({{"cub", {.on_top_of = "shelf"}}}),
              AllOf(HasSubstr("places.cub: no object 'cub'"), HasSubstr("Did you mean 'cube'?")));
  EXPECT_THAT(
      PlacesError({{"cube", {.on_top_of = "shelv"}}}),
      AllOf(HasSubstr("places.cube: no object or body"), HasSubstr("Did you mean 'shelf'?")));
  EXPECT_THAT(PlacesError({{"shelf", {.on_top_of = "cube"}}}),
              HasSubstr("places.shelf: it is a fixed object, which stays where its pose is"));
  EXPECT_THAT(PlacesError({{"cube", {.inside = "shelf"}}}),
              HasSubstr("places.cube: 'shelf' has no hollow with a level floor"));
  EXPECT_THAT(PlacesError({{"cube", {.next_to = "cube"}}}),
              HasSubstr("places.cube: it refers to itself"));
}

TEST(PreparedObjects, ErrorsInPlacesNameTheirLine) {
  TempDir folder;
  AtomicWrite(folder / "cell.yaml",
              "name: cell\nrobots: {robot: " + assets::BuiltinRobotFile("rc7") +
                  "}\nplaces:\n  cube: {on_top_of: robt}\n");
  const EnvConfig config = EnvConfig::Load((folder / "cell.yaml").string());
  ExpectThrow<SpecError>([&] { Env env(config); }, "cell.yaml:4:9: places.cube: no object 'cube'");
}

class Origin final : public Task {
 public:
  struct Config {
    static constexpr const char* kKind = "origin_of_test";
    static constexpr const char* kTypeName = "Config";
    template <class V>
    static void Fields(V&& /*v*/) {}
  };
  explicit Origin(const Config& /*fields*/) {}
  void Prepare(SceneSpec& spec, Rng& /*rng*/) override {
    spec.objects.push_back(BoxObject("cube", {0, 0, 0}));
  }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "look at the cube"; }
};

// Given poses count, also at the origin, where an object without one is compiled.
TEST(PreparedObjects, WithAPoseAtTheOriginStayThere) {
  RegisterTask<Origin::Config>(std::make_shared<TaskKindOf<Origin::Config, Origin>>());
  EnvConfig config = Rc7Env();
  config.add_floor = false;
  config.shared_base_frame_to_root_frame = Pose(Eigen::Vector3d(-0.5, 0, 0));
  config.world_frame_objects["stand"] = {.offset = Pose(Eigen::Vector3d(0, 0, -0.07)),
                                         .fixed = true,
                                         .shape = Shape::kBox,
                                         .size = Vec3{0.05, 0.05, 0.05},
                                         .mass = 1};
  config.task = Origin::Config();
  Env env(config);
  env.Reset({.seed = 3});
  EXPECT_LT(At(env, "cube").norm(), 1e-9);
}

TEST(PreparedObjects, ExcludeObjectsOfTheConfiguration) {
  const Env env(Rc7WithCube());
  EXPECT_THAT(PreparedObjects(env.scene(), env.config(), nullptr).names(), IsEmpty());
}

// In the only part of the floor within reach that nothing stands on.
TEST(PreparedObjects, OnTheFloorAreInItsFreePart) {
  EnvConfig config = Cubes();
  for (const double x : {-0.6, 0.6}) {
    EnvObject wall;
    wall.shape = Shape::kBox;
    wall.size = Vec3{0.35, 1.5, 0.9};
    wall.offset = Pose(Eigen::Vector3d(x, x < 0 ? 0 : 1.7, 0.9));
    wall.fixed = true;
    wall.mass = 10;
    config.root_frame_objects[x < 0 ? "behind" : "left"] = wall;
  }
  Env env(config);
  for (uint64_t seed = 0; seed < 20; ++seed) {
    env.Reset({.seed = seed});
    ExpectGoodStart(env, 0);
  }
}

}  // namespace
}  // namespace robocell::internal
