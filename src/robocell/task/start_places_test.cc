// Tests what a run may state of places in its starts. The object that lies beside another one is
// measured in the starts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "robocell/base/rng.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/spec/problems.h"
#include "robocell/task/start_sampler.h"
#include "robocell/task/task_kind.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;

// A task that takes numbers from elsewhere than its stream.
class Forgetful final : public Task {
 public:
  struct Config {
    static constexpr const char* kKind = "forgetful_of_test";
    static constexpr const char* kTypeName = "Config";
    template <class V>
    static void Fields(V&& /*v*/) {}
  };
  explicit Forgetful(const Config& /*fields*/) {}
  void Prepare(SceneSpec& spec, Rng& /*rng*/) override {
    static double size = 0.02;
    SceneObject block = BoxObject("block", {0, 0, 0});
    block.pos.reset();
    block.size = Vec3{size, size, size};
    size += 0.001;
    spec.objects.push_back(block);
  }
  TaskVerdict Judge(const Scene& /*scene*/) override { return {}; }
  std::string instruction() const override { return "look"; }
};

TEST(StartPlaces, RequiresThatOneRandomStreamGivesOneScene) {
  RegisterTask<Forgetful::Config>(std::make_shared<TaskKindOf<Forgetful::Config, Forgetful>>());
  RunConfig run = ExampleRun("demo.yaml");
  run.task = Forgetful::Config();
  Problems problems(run.locations);
  StartSampler(run).ValidateStarts(std::array{0}, problems);
  ASSERT_EQ(problems.list().size(), 1);
  EXPECT_EQ(problems.list()[0].path, "task");
  EXPECT_THAT(problems.list()[0].message,
              HasSubstr("prepare() of 'forgetful_of_test' makes another scene of the "
                        "same random stream each time (object 'block')"));
}

// Of two objects that a run's task draws, the second is put beside the first.
TEST(StartPlaces, ARunPutsADrawnObjectNextToTheTarget) {
  RunConfig run = ExampleRun("demo.yaml");
  run.start.visible_from = {};
  run.start.places = {{"object_1", {.next_to = "target", .gap = {0.01, 0.04}}}};
  StartSampler sampler(run);
  int beside = 0;
  for (int attempt = 0; attempt < 12 && beside == 0; ++attempt) {
    Rng rng = Rng::Stream(7, "beside", attempt);
    const SampleResult result = sampler.Sample({.episode = attempt}, rng);
    if (!result.start || result.start->object_kinds.size() < 2) continue;
    ++beside;
    const Scene& scene = result.start->scene;
    const auto at = [&](const char* name) {
      return scene.body_pose(scene.compiled()->object(name).root_body).translation();
    };
    EXPECT_LT((at("object_1") - at("target")).head<2>().norm(), 0.3);
  }
  EXPECT_EQ(beside, 1);
}

}  // namespace
}  // namespace robocell
