// Objects that a task's Prepare adds to an environment without saying where they are.
#include "robocell/env/prepared_objects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/env/env.h"
#include "robocell/env/env_batch.h"
#include "robocell/env/testing/envs.h"
#include "robocell/task/task_kind.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

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

// Apart, on a support of that height, in reach of the robot in the origin, and at rest.
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

TEST(PreparedObjects, StartApartAndAtRestInReach) {
  Env env(Cubes());
  for (uint64_t seed = 0; seed < 10; ++seed) {
    env.Reset({.seed = seed});
    const double distance = At(env, "first").head<2>().norm();
    EXPECT_GE(distance, 0.3) << "as far as base_range() says";
    EXPECT_LE(distance, 0.4);
    ExpectGoodStart(env, 0);
  }
}

TEST(PreparedObjects, StartOnATableThatIsInReach) {
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

TEST(PreparedObjects, FollowFromTheSeed) {
  Env env(Cubes()), other(Cubes());
  env.Reset({.seed = 4});
  const Eigen::Vector3d first = At(env, "first");
  env.Reset({.seed = 5});
  EXPECT_GT((At(env, "first") - first).norm(), 0.01);
  other.Reset({.seed = 4});
  EXPECT_EQ(At(other, "first"), first);
}

TEST(PreparedObjects, AreWhereTheTaskPutsThem) {
  Env starting(Cubes({.starts = true}));
  starting.Reset({.seed = 1});
  EXPECT_TRUE(At(starting, "first").isApprox(TwoCubes::kFirst, 1e-9));
  ExpectGoodStart(starting, 0);
  Env arranging(Cubes({.arranges = true}));
  arranging.Reset({.seed = 1});
  EXPECT_TRUE(At(arranging, "second").isApprox(TwoCubes::kSecond, 1e-9));
}

TEST(PreparedObjects, ThatArePlacedAreLoggedOnce) {
  std::vector<std::string> lines;
  const auto keep = [&](LogLevel, std::string_view text) { lines.emplace_back(text); };
  const ScopedLogSink capture(keep);
  Env env(Cubes());
  env.Reset({.seed = 1});
  env.Reset({.seed = 2});
  const std::string said = "prepare() added first, second without a pose, so each reset draws";
  EXPECT_EQ(
      std::ranges::count_if(
          lines, [&](const std::string& line) { return line.find(said) != std::string::npos; }),
      1);
  lines.clear();
  Env arranging(Cubes({.arranges = true}));
  EXPECT_THAT(lines, ::testing::Not(::testing::Contains(::testing::HasSubstr("without a pose"))));
}

TEST(PreparedObjects, NeedASupportInReachUnlessTheTaskPlacesThem) {
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

TEST(PreparedObjects, AreNoneInTheConfigurationItself) {
  const Env env(Rc7WithCube());
  EXPECT_THAT(internal::PreparedObjects(env.scene(), env.config(), TwoCubes({})).names(),
              IsEmpty());
}

}  // namespace
}  // namespace robocell
