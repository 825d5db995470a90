// Tests simulations that fail while they are recorded: unstable models, states poisoned with NaN,
// scenes too crowded for the engine's buffers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/log.h"
#include "robocell/data/episode_reader.h"
#include "robocell/expert/pick_planner.h"
#include "robocell/rollout/on_disk.h"
#include "robocell/rollout/prepare.h"
#include "robocell/rollout/rollout.h"
#include "robocell/rollout/runner.h"
#include "robocell/scene/testing/gates.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/source_dir.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

// A task without a goal.
class NoTask : public Task {
 public:
  void Begin(const Scene&) override {}
  TaskVerdict Judge(const Scene&) override { return {}; }
  std::string instruction() const override { return "stand still"; }
  std::vector<std::string> objects() const override { return {}; }
};

// Sends no commands; changes the scene before its third action.
class Standing : public Expert {
 public:
  explicit Standing(std::function<void(Scene)> spoil = {}) : spoil_(std::move(spoil)) {}
  void Begin(const Scene&, Rng&) override {}
  Action Act(const Scene& scene, Rng&) override {
    if (++actions_ == 3 && spoil_) spoil_(scene);
    return {};
  }
  bool done() const override { return actions_ >= 20; }
  std::string failure() const override { return "idle"; }
  int phase() const override { return 0; }
  std::vector<std::string> phase_names() const override { return {"idle"}; }

 private:
  std::function<void(Scene)> spoil_;
  int actions_ = 0;
};

void PutNan(Scene scene) { scene.data()->qvel[0] = std::numeric_limits<double>::quiet_NaN(); }

// An arm whose servo is far too stiff for the timestep.
RobotConfig UnstableArm(ModelFolder& models) {
  std::string text = kTwoJointArm;
  const std::string gentle = R"(joint="shoulder" kp="100" kv="10")";
  text.replace(text.find(gentle), gentle.size(), R"(joint="shoulder" kp="1e9")");
  return ArmConfig(models.Write("unstable", text));
}

EpisodeStart StartIn(const SceneSpec& spec) {
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return {.scene = scene, .task = std::make_shared<NoTask>(), .target_object = ""};
}

// Unstable scenes for the first two episodes, pick scenes after.
class UnstableAtFirst : public TaskSampler {
 public:
  UnstableAtFirst(std::shared_ptr<TaskSampler> pick, ModelFolder& models)
      : pick_(std::move(pick)), models_(models) {}
  SampleResult Sample(const SampleRequest& request, Rng& rng) override {
    if (request.episode >= 2) return pick_->Sample(request, rng);
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.name = "arm", .config = UnstableArm(models_)});
    return {.start = StartIn(spec)};
  }

 private:
  std::shared_ptr<TaskSampler> pick_;
  ModelFolder& models_;
};

class DivergenceTest : public ::testing::Test {
 protected:
  RunConfig Run(const std::string& name, Keep keep = Keep::kSuccesses, int max_attempts = 20) {
    RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
    run.cameras.streams = {};
    run.keep = keep;
    run.max_attempts = max_attempts;
    run.output = (folder / name).string();
    PrepareDataset(run);
    return run;
  }
  // A runner whose first two rollouts are done by `expert`.
  RunnerParts AtFirst(std::function<std::shared_ptr<Expert>()> expert) {
    return {
        .sampler = {},
        .expert = [expert, left = 2](const RunConfig& run,
                                     const EpisodeStart& start) mutable -> std::shared_ptr<Expert> {
          if (left-- > 0) return expert();
          return MakePickPlanner(run, start);
        }};
  }
  static void ExpectTimesIncrease(const Episode& episode) {
    for (const char* column : {"time", "control/time"}) {
      const std::vector<double> times = episode.Read<double>(column);
      ASSERT_FALSE(times.empty());
      for (size_t i = 1; i < times.size(); ++i) ASSERT_GT(times[i], times[i - 1]) << column;
    }
  }

  TempDir folder;
  ModelFolder models;
  std::vector<std::string> log;
  ScopedLogSink sink{[this](LogLevel, std::string_view text) { log.emplace_back(text); }};
};

TEST_F(DivergenceTest, UnstableModelsEndTheirEpisodesOnly) {
  const RunConfig run = Run("stormy", Keep::kAll, 5);
  const RunConfig calm = Run("calm", Keep::kAll, 5);
  const RunnerParts parts{
      .sampler = [this](const RunConfig& r) -> std::shared_ptr<TaskSampler> {
        return std::make_shared<UnstableAtFirst>(std::make_unique<StartSampler>(r), models);
      },
      .expert = [](const RunConfig& r, const EpisodeStart& start) -> std::shared_ptr<Expert> {
        if (start.target_object.empty()) return std::make_shared<Standing>();
        return MakePickPlanner(r, start);
      }};
  Runner runner(run, parts);
  const std::vector<PlanItem> plan = MakePlan(run);
  for (int i = 0; i < 2; ++i) {
    const ItemResult result = runner.Run(plan[i]);
    EXPECT_THAT(result.failures, ElementsAre(Pair("diverged", run.max_attempts)));
    const Episode episode(folder / "stormy" / EpisodeId(run, plan[i], 0));
    EXPECT_EQ(episode.end_reason(), "diverged");
    EXPECT_TRUE(episode.terminated());
    EXPECT_THAT(episode.warnings(),
                Contains(AllOf(HasSubstr("diverged at t="), HasSubstr("joint 'shoulder'"))));
    EXPECT_THAT(
        log, Contains(AllOf(HasSubstr(EpisodeId(run, plan[i], 0)), HasSubstr("joint 'shoulder'"))));
    ExpectTimesIncrease(episode);
    const std::vector<double> q = episode.Read<double>("robots/arm/arm/qpos");
    for (const double value : q) EXPECT_TRUE(std::isfinite(value)) << "a row of a diverged state";
  }
  EXPECT_TRUE(runner.Run(plan[2]).success);
  Runner(calm).Run(plan[2]);
  const Episode episode(folder / "stormy" / EpisodeId(run, plan[2], 0));
  ExpectTimesIncrease(episode);
  const std::string steps = EpisodeId(run, plan[2], 0) + "/steps.h5";
  EXPECT_EQ(ReadFile(folder / "stormy" / steps), ReadFile(folder / "calm" / steps));
}

TEST_F(DivergenceTest, TheNextRolloutClearsANonFiniteState) {
  const RunConfig poisoned = Run("poisoned"), idle = Run("idle");
  Runner hit(poisoned, AtFirst([] { return std::make_shared<Standing>(&PutNan); }));
  Runner spared(idle, AtFirst([] { return std::make_shared<Standing>(); }));
  const std::vector<PlanItem> plan = MakePlan(poisoned);
  for (int i = 0; i < 2; ++i) {
    const ItemResult result = hit.Run(plan[i]);
    EXPECT_EQ(result.failures.contains("diverged"), i == 0);
    EXPECT_TRUE(result.success && spared.Run(plan[i]).success);
    const std::string steps = plan[i].id + "/steps.h5";
    EXPECT_EQ(ReadFile(folder / "poisoned" / steps), ReadFile(folder / "idle" / steps));
  }
}

TEST_F(DivergenceTest, ARolloutThatAViewerStoppedIsUndecided) {
  const RunConfig run = Run("closed", Keep::kAll);
  std::shared_ptr<GateForTests> gate;
  const auto close = [&](const Scene& scene) {
    gate = GateForTests::Of(scene, GateForTests::kStop);
  };
  Runner runner(run, AtFirst([&] { return std::make_shared<Standing>(close); }));
  const ItemResult result = runner.Run(MakePlan(run)[0]);
  EXPECT_TRUE(result.stopped);
  EXPECT_FALSE(result.committed);
  EXPECT_TRUE(result.failures.empty());
  EXPECT_EQ(result.undecided, 1);
}

// Boxes on top of each other in a world with space for only some of their contacts.
class Crowd : public DivergenceTest {
 protected:
  internal::RolloutResult Rollout(const std::string& memory) {
    SceneSpec spec = EmptyScene();
    spec.options.jacobian = JacobianKind::kDense;  // with any engine the same memory
    spec.base = models.Write("small", "<size memory=\"" + memory + "\"/>");
    for (int i = 0; i < 30; ++i) {
      spec.objects.push_back(
          BoxObject("box" + std::to_string(i), {0.02 * (i % 6), 0.02 * (i / 6), 0.03}));
    }
    EpisodeStart start = StartIn(spec);
    Standing expert;
    Rng rng = Rng::Stream(1, "expert");
    return internal::RunRollout(Run("crowd"), start, expert, rng,
                                {.dataset = folder / "crowd",
                                 .episode_id = "e",
                                 .metadata_json = "{}",
                                 .keep_failures = true});
  }
};

TEST_F(Crowd, RecordsFullContactBuffers) {
  EXPECT_TRUE(Rollout("450K").committed);
  const Episode episode(folder / "crowd" / "e");
  EXPECT_THAT(episode.warnings(), Contains(AllOf(HasSubstr(" x contact buffer full"),
                                                 HasSubstr(" x constraint buffer full"))));
  const std::vector<int32_t> counted = episode.Read<int32_t>("engine_warnings");
  EXPECT_GT(counted.front(), 0);
  for (size_t i = 1; i < counted.size(); ++i) EXPECT_GE(counted[i], counted[i - 1]);
  ExpectTimesIncrease(episode);
}

// With a little more memory the contacts fit, but not the results computed from them.
TEST_F(Crowd, ThatExceedsTheMemoryIsAnErrorWithARemedy) {
  const std::string message = ExpectThrow<EngineError>([&] { Rollout("5000K"); }, "scene 'test'");
  EXPECT_THAT(message, HasSubstr("increase <size memory"));
}

}  // namespace
}  // namespace robocell
