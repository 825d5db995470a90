#include "robocell/rollout/runner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hook_error.h"
#include "robocell/data/dataset.h"
#include "robocell/data/dataset_lock.h"
#include "robocell/data/episode_reader.h"
#include "robocell/expert/pick_planner.h"
#include "robocell/rollout/on_disk.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/task/grasp_check.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/long_form.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::Pair;

// Loads a run file of the examples without its cameras, whose cost is not tested here.
RunConfig Blind(const std::string& file, const std::filesystem::path& output) {
  RunConfig run = RunConfig::Load(SourceDir() + "/examples/" + file);
  run.cameras.streams = {};
  run.output = output.string();
  PrepareDataset(run);
  return run;
}

// Gives up at once.
class Idle : public Expert {
 public:
  void Begin(const Scene&, Rng&) override {}
  Action Act(const Scene&, Rng&) override { return {}; }
  bool done() const override { return true; }
  std::string failure() const override { return "idle"; }
  int phase() const override { return 0; }
  std::vector<std::string> phase_names() const override { return {"idle"}; }
};

// An expert that gives up in the first `times` rollouts.
RunnerParts IdleAtFirst(int times) {
  return {.sampler = {},
          .expert = [left = times](const RunConfig& run, const EpisodeStart& start) mutable {
            if (left-- > 0) return std::unique_ptr<Expert>(std::make_unique<Idle>());
            return MakePickPlanner(run, start);
          }};
}

class Refusing : public TaskSampler {
 public:
  SampleResult Sample(const SampleRequest&, Rng&) override {
    return {.start = {}, .refusal = {kNoGrasp, "as told"}};
  }
};

// Checks that at least nine of ten accepted starts succeed. For twenty:
// tests/integration/test_pick_dataset.py.
void ExpectGoodRun(const RunConfig& run, int episodes) {
  Runner runner(run);
  int accepted = 0, attempts = 0;
  for (int i = 0; i < episodes; ++i) {
    const ItemResult result = runner.Run(MakePlan(run)[i]);
    EXPECT_TRUE(result.committed && result.success) << result.item.id;
    EXPECT_EQ(result.kept, 1);
    EXPECT_GT(result.rows, 40);
    accepted += result.accepted;
    attempts += result.attempts;
  }
  EXPECT_EQ(Dataset(run.output).size(), static_cast<size_t>(episodes));
  EXPECT_GE(episodes, 0.9 * accepted);
  EXPECT_GE(accepted, 0.4 * attempts);
}

TEST(Runner, TheDemosEpisodesSucceed) {
  TempDir folder;
  ExpectGoodRun(Blind("demo.yaml", folder / "out"), LongForm() ? 5 : 2);
}

TEST(Runner, TheEpisodesOfARealArmSucceed) {
  REQUIRE_MENAGERIE("ufactory_xarm7");
  TempDir folder;
  ExpectGoodRun(Blind("xarm7_pick.yaml", folder / "out"), LongForm() ? 5 : 2);
}

// A table with a cube of its own.
struct CubeScenes {
  static constexpr const char* kKind = "cube_of_runner_test";
  static constexpr const char* kTypeName = "CubeScenes";
  template <class V>
  static void Fields(V&& /*v*/) {}
};

class CubeSource final : public SceneSource {
 public:
  explicit CubeSource(const CubeScenes& /*fields*/) {}
  std::optional<int> size() const override { return std::nullopt; }
  SceneSpec Make(int /*index*/) override {
    SceneSpec spec{.base = "tabletop", .add_floor = true, .add_skybox = true};
    SceneObject cube = ObjectOnTheTable("box");
    cube.name = "cube";
    spec.objects.push_back(std::move(cube));
    return spec;
  }
};

// The task names an object of the scene, as in an environment; on the tray, the goal is drawn.
TEST(Runner, TheExpertPicksAndPlacesANamedObject) {
  RegisterSceneSource<CubeScenes>(std::make_shared<SceneSourceKindOf<CubeScenes, CubeSource>>());
  TempDir folder;
  for (const TaskSpec& task : {TaskSpec(PickTaskConfig{.object = "cube", .spread = {0.03, 0.03}}),
                               TaskSpec(PickAndPlaceTaskConfig{.object = "cube"})}) {
    RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
    run.cameras.streams = {};
    run.scenes = CubeScenes{};
    run.task = task;
    run.output = (folder / task.kind()).string();
    PrepareDataset(run, {.validate = true});
    const ItemResult result = Runner(run).Run(MakePlan(run)[0]);
    EXPECT_TRUE(result.success) << task.kind();
    EXPECT_EQ(result.object_kind, "cube");
    const Episode episode = Dataset(run.output).Open(result.item.id);
    // The recorded poses are the oracle: the cube rose by more than lift_height.
    const std::vector<double> pose = episode.Read<double>("objects/cube/pose");
    double highest = pose[2];
    for (size_t i = 2; i < pose.size(); i += 7) highest = std::max(highest, pose[i]);
    EXPECT_GE(highest - pose[2], kLiftHeight);
  }
}

TEST(Runner, AnEpisodeDoesNotDependOnEarlierOnes) {
  TempDir folder;
  const RunConfig one = Blind("demo.yaml", folder / "one"),
                  other = Blind("demo.yaml", folder / "other");
  const std::vector<PlanItem> plan = MakePlan(one);
  Runner forward(one), backward(other);
  for (int i = 0; i < 3; ++i) forward.Run(plan[i]);
  for (int i = 2; i >= 0; --i) backward.Run(plan[i]);
  for (int i = 0; i < 3; ++i) {
    const std::string steps = plan[i].id + "/steps.h5";
    EXPECT_EQ(ReadFile(folder / "one" / steps), ReadFile(folder / "other" / steps)) << plan[i].id;
  }
  EXPECT_NE(ReadFile(folder / "one" / plan[0].id / "steps.h5"),
            ReadFile(folder / "one" / plan[1].id / "steps.h5"));
}

// Fails in its first rollouts.
class Failing : public Idle {
 public:
  explicit Failing(int& left, bool throws) : left_(left), throws_(throws) {}
  Action Act(const Scene&, Rng&) override {
    if (left_-- <= 0) return {};
    if (throws_) throw std::runtime_error("out of ideas");
    return {{"nobody", {}}};
  }

 private:
  int& left_;
  bool throws_;
};

RunnerParts FailingParts(int& left, bool throws) {
  return {.sampler = {}, .expert = [&left, throws](const RunConfig&, const EpisodeStart&) {
            return std::make_unique<Failing>(left, throws);
          }};
}

TEST(Runner, AnInvalidHookResultEndsTheRollout) {
  TempDir folder;
  RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
  run.cameras.streams = {};
  run.output = (folder / "out").string();
  run.max_attempts = 5;
  PrepareDataset(run);
  for (const bool throws : {true, false}) {
    const std::string text =
        throws ? "in act: out of ideas" : "action: no robot 'nobody'. Its robots: rc7.";
    int left = 1;
    const ItemResult result = Runner(run, FailingParts(left, throws)).Run(MakePlan(run)[0]);
    EXPECT_THAT(result.failures, ::testing::Contains(Pair(::testing::HasSubstr(text), 1)));
    EXPECT_GE(result.failures.at("idle"), 1);
    left = 100;
    ExpectThrow<HookError>([&] { Runner(run, FailingParts(left, throws)).Run(MakePlan(run)[0]); },
                           text);
  }
}

// In evaluations another start may be easier.
TEST(Runner, DoesNotReplaceTheFirstStart) {
  TempDir folder;
  RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
  run.cameras.streams = {};
  run.output = (folder / "out").string();
  run.keep = Keep::kFirst;
  PrepareDataset(run);
  for (const auto& [throws, text] : {std::pair(true, "policy error: in act: out of ideas"),
                                     std::pair(false, "policy error: action: no robot 'nobody'")}) {
    int left = 1;
    const PlanItem item = MakePlan(run)[throws ? 0 : 1];
    RunnerParts parts = FailingParts(left, throws);
    parts.stores = false;
    const ItemResult unstored = Runner(run, std::move(parts)).Run(item);
    EXPECT_TRUE(unstored.complete && !unstored.committed && !unstored.success);
    EXPECT_FALSE(std::filesystem::exists(folder / "out" / item.id));
    left = 1;
    const ItemResult result = Runner(run, FailingParts(left, throws)).Run(item);
    EXPECT_EQ(unstored.failures, result.failures);
    EXPECT_EQ(unstored.failure, result.failures.begin()->first);
    EXPECT_EQ(unstored.rows, result.rows);
    EXPECT_TRUE(result.complete && result.committed && !result.success);
    ASSERT_EQ(result.failures.size(), 1u);
    EXPECT_THAT(result.failures.begin()->first, ::testing::StartsWith(text));
    const Episode kept(folder / "out" / item.id);
    EXPECT_EQ(kept.end_reason(), result.failures.begin()->first);
    EXPECT_TRUE(nlohmann::json::parse(kept.results_json()).value("policy_error", false));
  }
}

TEST(Runner, AnExpertThatFailsToConstructFailsTheEvaluation) {
  TempDir folder;
  RunConfig run = Blind("demo.yaml", folder / "out");
  run.output = (folder / "first").string();
  run.keep = Keep::kFirst;
  PrepareDataset(run);
  Runner runner(run,
                {.sampler = {},
                 .expert = [](const RunConfig&, const EpisodeStart&) -> std::shared_ptr<Expert> {
                   throw std::runtime_error("no weights");
                 }});
  const PlanItem item = MakePlan(run)[0];
  const ItemResult result = runner.Run(item);
  EXPECT_TRUE(result.complete && result.committed && !result.success);
  EXPECT_THAT(result.failures, ::testing::ElementsAre(Pair(
                                   "policy error: in the expert's constructor: no weights", 1)));
  const Episode kept(folder / "first" / item.id);
  EXPECT_TRUE(nlohmann::json::parse(kept.results_json()).value("policy_error", false));
}

// Acts so that the next step of the simulation is a fatal error of the engine.
class BreaksTheEngine : public Idle {
 public:
  Action Act(const Scene&, Rng&) override {
    mjcb_control = [](const mjModel*, mjData*) {
      mjcb_control = nullptr;
      mju_error("callback failed");
    };
    return {};
  }
};

TEST(Runner, AnEngineErrorIsNotAFailureOfTheExpert) {
  TempDir folder;
  const RunConfig run = Blind("demo.yaml", folder / "out");
  Runner runner(run, {.sampler = {}, .expert = [](const RunConfig&, const EpisodeStart&) {
                        return std::make_unique<BreaksTheEngine>();
                      }});
  const std::string message =
      ExpectThrow<EngineError>([&] { runner.Run(MakePlan(run)[0]); }, "callback failed");
  EXPECT_THAT(message, ::testing::Not(::testing::HasSubstr("in act")));
  EXPECT_EQ(Dataset(run.output).size(), 0u);
}

TEST(Runner, NeverMixesRuns) {
  TempDir folder;
  RunConfig run = Blind("demo.yaml", folder / "out");
  const PlanItem item = MakePlan(run)[0];
  run.seed = 7;
  ExpectThrow<SpecError>([&] { Runner(run).Run(item); }, "seed: 0 then, 7 now");
  run.output = (folder / "none").string();
  ExpectThrow<SpecError>([&] { Runner(run).Run(item); },
                         "first call PrepareDataset (in Python prepare_dataset)");
  EXPECT_FALSE(std::filesystem::exists(folder / "none"));
}

// The dataset was begun anew for another run while this runner lived.
TEST(Runner, DetectsAReplacedDataset) {
  TempDir folder;
  RunConfig run = Blind("demo.yaml", folder / "out"), other = run;
  Runner runner(run);
  const PlanItem item = MakePlan(run)[0];
  runner.Run(item);
  std::filesystem::remove_all(folder / "out" / item.id);
  other.seed = 7;
  PrepareDataset(other);
  ExpectThrow<SpecError>([&] { runner.Run(item); }, "seed: 7 then, 0 now");
}

TEST(Runner, DoesNotWriteDuringARepair) {
  TempDir folder;
  const RunConfig run = Blind("demo.yaml", folder / "out");
  Runner runner(run);
  std::optional<DatasetLock> repair = DatasetLock::Alone(run.output);
  ExpectThrow<IoError>([&] { runner.Run(MakePlan(run)[0]); }, "in use");
  repair.reset();
  EXPECT_TRUE(runner.Run(MakePlan(run)[0]).success);
}

TEST(Runner, DoesNotRepeatAnExistingEpisode) {
  TempDir folder;
  const RunConfig run = Blind("demo.yaml", folder / "out");
  const PlanItem item = MakePlan(run)[0];
  EXPECT_FALSE(IsComplete(run, item));
  EXPECT_EQ(Runner(run).Run(item).kept, 1);
  EXPECT_TRUE(IsComplete(run, item));
  const auto written = std::filesystem::last_write_time(folder / "out" / item.id / "episode.json");
  const ItemResult again = Runner(run).Run(item);
  EXPECT_TRUE(again.resumed && again.committed && again.success);
  EXPECT_EQ(again.attempts, 0);
  EXPECT_EQ(std::filesystem::last_write_time(folder / "out" / item.id / "episode.json"), written);
}

TEST(Runner, DropsFailuresAndRetries) {
  TempDir folder;
  const RunConfig run = Blind("demo.yaml", folder / "out");
  const ItemResult result = Runner(run, IdleAtFirst(2)).Run(MakePlan(run)[0]);
  EXPECT_TRUE(result.success);
  EXPECT_EQ(result.accepted, 3);
  EXPECT_THAT(result.failures, ElementsAre(Pair("idle", 2)));
  EXPECT_THAT(Dataset(run.output).ids(), ElementsAre("s0000_e0000"));
}

TEST(Runner, KeepsFailuresOnRequestAndAddsOnlyMissingEpisodes) {
  TempDir folder;
  RunConfig run = Blind("demo.yaml", folder / "out");
  run.output = (folder / "all").string();
  run.keep = Keep::kAll;
  PrepareDataset(run);
  const PlanItem item = MakePlan(run)[0];
  const ItemResult result = Runner(run, IdleAtFirst(2)).Run(item);
  EXPECT_EQ(result.kept, 3);
  EXPECT_TRUE(IsComplete(run, item));
  EXPECT_THAT(Dataset(run.output).ids(),
              ElementsAre("s0000_e0000_a00", "s0000_e0000_a01", "s0000_e0000_a02"));
  EXPECT_FALSE(Dataset(run.output).Open("s0000_e0000_a01").success());

  const std::string steps = ReadFile(folder / "all/s0000_e0000_a02/steps.h5");
  std::filesystem::remove_all(folder / "all/s0000_e0000_a02");
  EXPECT_FALSE(IsComplete(run, item));
  const ItemResult resumed = Runner(run, IdleAtFirst(0)).Run(item);
  EXPECT_EQ(resumed.attempts, 3) << "those that are there count";
  EXPECT_THAT(resumed.failures, ElementsAre(Pair("idle", 2)));
  EXPECT_EQ(resumed.kept, 1);
  EXPECT_TRUE(resumed.success);
  EXPECT_EQ(ReadFile(folder / "all/s0000_e0000_a02/steps.h5"), steps);

  std::filesystem::remove_all(folder / "all/s0000_e0000_a00");
  EXPECT_FALSE(IsComplete(run, item)) << "a failure before the success is missing";
  const ItemResult mended = Runner(run, IdleAtFirst(1)).Run(item);
  EXPECT_TRUE(mended.success);
  EXPECT_EQ(mended.kept, 1);
  EXPECT_EQ(mended.rows, resumed.rows);
  EXPECT_THAT(mended.failures, ElementsAre(Pair("idle", 2)));
  EXPECT_EQ(mended.rollouts, result.rollouts);
  EXPECT_TRUE(IsComplete(run, item));
  const auto metadata = [&](const std::string& id) {
    return nlohmann::json::parse(Dataset(run.output).Open(id).metadata_json());
  };
  const nlohmann::json earlier = metadata("s0000_e0000_a02")["earlier_attempts"];
  ASSERT_EQ(earlier.size(), 2u);
  EXPECT_EQ(earlier[1]["failed"], "idle");
  EXPECT_EQ(earlier[1]["object_kind"], result.object_kind);
  EXPECT_EQ(metadata("s0000_e0000_a00")["earlier_attempts"].size(), 0u);
}

// A user's code raises in the first attempt, fails in the second, and the process ends before the
// item is made.
TEST(Runner, ResumesAnItemWhoseFirstAttemptRaised) {
  TempDir folder;
  RunConfig run = Blind("demo.yaml", folder / "out");
  run.output = (folder / "all").string();
  run.keep = Keep::kAll;
  PrepareDataset(run);
  const PlanItem item = MakePlan(run)[0];
  const auto parts = [](int raises, int idles) {
    return RunnerParts{
        .sampler = {},
        .expert = [raises, idles](const RunConfig& of,
                                  const EpisodeStart& start) mutable -> std::shared_ptr<Expert> {
          if (raises-- > 0) throw std::runtime_error("out of ideas");
          if (idles-- > 0) return std::make_unique<Idle>();
          return MakePickPlanner(of, start);
        }};
  };
  const ItemResult made = Runner(run, parts(1, 1)).Run(item);
  EXPECT_TRUE(made.success && made.complete);
  EXPECT_EQ(made.kept, 2);
  EXPECT_TRUE(IsComplete(run, item)) << "the attempt that raised left nothing";
  const ItemResult again = Runner(run, parts(0, 0)).Run(item);
  EXPECT_TRUE(again.resumed && again.success);
  EXPECT_EQ(again.attempts, 0);
  const std::vector<std::string> ids = Dataset(run.output).ids();
  ASSERT_EQ(ids.size(), 2u);
  const std::string steps = ReadFile(folder / "all" / ids[1] / "steps.h5");

  std::filesystem::remove_all(folder / "all" / ids[1]);
  const ItemResult resumed = Runner(run, parts(1, 0)).Run(item);  // it raises again
  EXPECT_TRUE(resumed.success && resumed.complete);
  EXPECT_EQ(resumed.kept, 1);
  EXPECT_EQ(resumed.failures, made.failures);
  EXPECT_EQ(ReadFile(folder / "all" / ids[1] / "steps.h5"), steps);
  EXPECT_TRUE(IsComplete(run, item));
}

TEST(Runner, GeneratesTheSameEpisodesForAnyRenderSetting) {
  TempDir folder;
  std::map<std::string, std::string> first;
  std::string identity;
  for (const auto render : {std::optional<RenderWhen>(), std::optional(RenderWhen::kKept)}) {
    RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
    run.cameras.resolution = {64, 48};
    run.render = render;
    run.output = (folder / (render ? "kept" : "always")).string();
    PrepareDataset(run);
    Runner runner(run, IdleAtFirst(2));
    for (int i = 0; i < 2; ++i) EXPECT_TRUE(runner.Run(MakePlan(run)[i]).success);
    std::map<std::string, std::string> made;
    for (const Episode& episode : Dataset(run.output)) {
      for (const std::string& file : episode.files())
        made[episode.id() + "/" + file] = ReadFile(episode.folder() / file);
    }
    EXPECT_GE(made.size(), 6);
    if (!render) first = made, identity = RunIdentity(run);
    EXPECT_TRUE(made == first);
    EXPECT_EQ(RunIdentity(run), identity) << "a run may go on either way";
  }
}

// An expert that notes whether an episode is being written while it acts, and gives up.
class Watching : public Idle {
 public:
  Watching(std::filesystem::path dataset, std::vector<bool>* written)
      : dataset_(std::move(dataset)), written_(written) {}
  Action Act(const Scene& scene, Rng& rng) override {
    bool is_written = false;
    for (const auto& entry : std::filesystem::directory_iterator(dataset_)) {
      is_written |= IsTemporaryName(entry.path().filename().string());
    }
    written_->push_back(is_written);
    return Idle::Act(scene, rng);
  }

 private:
  std::filesystem::path dataset_;
  std::vector<bool>* written_;
};

TEST(Runner, KeepsTheRenderSettingOfTheDatasetByDefault) {
  TempDir folder;
  RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
  run.cameras.resolution = {64, 48};
  run.output = (folder / "out").string();
  run.max_attempts = 1;
  run.render = RenderWhen::kKept;
  PrepareDataset(run);
  std::vector<bool> written;
  for (const auto chosen : {std::optional(RenderWhen::kKept), std::optional<RenderWhen>(),
                            std::optional(RenderWhen::kAlways)}) {
    run.render = chosen;
    RunnerParts parts;
    parts.expert = [&](const RunConfig&, const EpisodeStart&) {
      return std::make_unique<Watching>(run.output, &written);
    };
    EXPECT_FALSE(Runner(run, parts).Run(MakePlan(run)[0]).success);
  }
  EXPECT_THAT(written, ElementsAre(false, false, true));
}

TEST(Runner, CountsRefusalsAndGivesUpAfterTheLastTrial) {
  TempDir folder;
  RunConfig run = Blind("demo.yaml", folder / "out");
  run.max_attempts = 4;
  PrepareDataset(run);
  Runner runner(run, {.sampler = [](const RunConfig&) { return std::make_unique<Refusing>(); },
                      .expert = {}});
  const ItemResult result = runner.Run(MakePlan(run)[0]);
  EXPECT_FALSE(result.committed);
  EXPECT_EQ(result.attempts, 4);
  EXPECT_EQ(result.accepted, 0);
  EXPECT_THAT(result.refusals, ElementsAre(Pair("no grasp", 4)));
}

TEST(Runner, AStopLeavesNothingUnfinished) {
  TempDir folder;
  const RunConfig run = Blind("demo.yaml", folder / "out");
  const ItemResult result = Runner(run).Run(MakePlan(run)[0], [] { return true; });
  EXPECT_TRUE(result.stopped);
  EXPECT_FALSE(result.committed);
  EXPECT_EQ(Dataset(run.output).size(), 0u);
}

// The stop is requested while the expert acts: the rollout ends at the next tick.
TEST(Runner, AStopInTheMiddleOfARolloutIsObeyed) {
  TempDir folder;
  const RunConfig run = Blind("demo.yaml", folder / "out");
  bool stop = false;
  Runner runner(run,
                {.sampler = {}, .expert = [&](const RunConfig& config, const EpisodeStart& start) {
                   stop = true;
                   return MakePickPlanner(config, start);
                 }});
  const ItemResult result = runner.Run(MakePlan(run)[0], [&] { return stop; });
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(result.kept, 0);
  EXPECT_EQ(result.undecided, 1);
  EXPECT_EQ(result.accepted, 0) << "neither a success nor a failure";
  EXPECT_TRUE(result.failures.empty());
  for (const auto& entry : std::filesystem::directory_iterator(run.output)) {
    EXPECT_THAT(entry.path().filename().string(), AnyOf("dataset.json", "models", ".lock-writers"));
  }
}

// The sampler polls while the start is sampled: no attempt is counted as refused.
TEST(Runner, AStopWhileSamplingIsObeyed) {
  TempDir folder;
  const RunConfig run = Blind("demo.yaml", folder / "out");
  int polls = 0;
  Runner runner(run);
  const ItemResult result = runner.Run(MakePlan(run)[0], [&] { return ++polls > 1; });
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(result.accepted, 0);
  EXPECT_EQ(result.attempts, 0);
  EXPECT_EQ(result.undecided, 1);
  EXPECT_TRUE(result.refusals.empty());
  EXPECT_GT(polls, 2) << "the sampler asks too";
}

TEST(Runner, AnExceptionOfTheStopRequestPropagatesCleanly) {
  TempDir folder;
  const RunConfig run = Blind("demo.yaml", folder / "out");
  bool acting = false;
  Runner runner(run,
                {.sampler = {}, .expert = [&](const RunConfig& config, const EpisodeStart& start) {
                   acting = true;
                   return MakePickPlanner(config, start);
                 }});
  const StopRequest stop = [&] { return acting ? throw Error("interrupted") : false; };
  ExpectThrow<Error>([&] { runner.Run(MakePlan(run)[0], stop); }, "interrupted");
  EXPECT_EQ(Dataset(run.output).size(), 0u);
}

TEST(Runner, RejectsAllInvalidStreamsTogether) {
  TempDir folder;
  RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
  run.output = folder.path().string();
  run.cameras.streams[0].rgb = false;
  run.cameras.streams[0].depth = true;
  run.cameras.streams[1].rate = 5;
  const std::string text =
      ExpectThrow<SpecError>([&] { Runner runner(run); }, "a recorded stream needs rgb: true");
  EXPECT_THAT(text, testing::HasSubstr("(cameras.streams[0]).rgb"));
  EXPECT_THAT(text, testing::HasSubstr("(cameras.streams[1]).rate"));
}

}  // namespace
}  // namespace robocell
