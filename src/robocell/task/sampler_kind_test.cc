#include "robocell/task/sampler_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

// It refuses every start.
class NeverOfTest final : public TaskSampler {
 public:
  explicit NeverOfTest(const RunConfig& run) : run_(run.run) {}
  SampleResult Sample(const SampleRequest& /*request*/, Rng& /*rng*/) override {
    return {.start = {}, .refusal = {.reason = "never in " + run_}};
  }

 private:
  std::string run_;
};

TEST(SamplerKind, ARunNamesItsSampler) {
  RegisterSampler("never_of_test", std::make_shared<SamplerKindOf<NeverOfTest>>(), true);
  RunConfig run = ExampleRun("demo.yaml");
  EXPECT_NE(std::dynamic_pointer_cast<StartSampler>(MakeSampler(run)), nullptr);
  run.sampler = "never_of_test";
  Rng rng = Rng::Stream(1, "start");
  EXPECT_EQ(MakeSampler(run)->Sample({}, rng).refusal.counted_as(), "never in demo");
  EXPECT_THAT(SamplerKinds(), ::testing::Contains("never_of_test"));
}

// Counts how often it is bound.
class BoundOfTest final : public Task {
 public:
  void Bind(const Scene& /*scene*/, const TaskSetting& setting) override {
    ++times;
    robots = setting.robots;
  }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "be bound"; }

  int times = 0;
  std::vector<std::string> robots;
};

TEST(BindStart, BindsATaskOnceUnlessTheSamplerDid) {
  const RunConfig run = ExampleRun("demo.yaml");
  SceneSpec spec{.name = "cell", .timestep = 0.002, .add_floor = false, .add_skybox = false};
  spec.robots.push_back({.name = "other", .config = run.robot.config, .prefix = "a/"});
  spec.robots.push_back({.name = run.robot.config.name,
                         .config = run.robot.config,
                         .prefix = "b/",
                         .pos = {2, 0, 0}});
  const auto task = std::make_shared<BoundOfTest>();
  EpisodeStart start{.scene = Scene::Build(spec), .task = task};
  BindStart(start, run);
  BindStart(start, run);
  EXPECT_EQ(task->times, 1);
  EXPECT_EQ(task->robots, std::vector<std::string>{run.robot.config.name});
  const auto bound = std::make_shared<BoundOfTest>();
  EpisodeStart of_sampler{.scene = start.scene, .task = bound, .is_bound = true};
  BindStart(of_sampler, run);
  EXPECT_EQ(bound->times, 0);
}

TEST(SamplerKind, RejectsDuplicateAndUnknownNames) {
  RegisterSampler("never_of_test", std::make_shared<SamplerKindOf<NeverOfTest>>(), true);
  ExpectThrow<ArgumentError>(
      [] { RegisterSampler("never_of_test", std::make_shared<SamplerKindOf<NeverOfTest>>()); },
      "sampler 'never_of_test' is registered already");
  ExpectThrow<NotFoundError>([] { FindSamplerKind("nevre_of_test"); },
                             "Did you mean 'never_of_test'?");
}

}  // namespace
}  // namespace robocell
