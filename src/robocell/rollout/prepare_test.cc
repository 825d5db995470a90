#include "robocell/rollout/prepare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <thread>
#include <nlohmann/json.hpp>

#include "robocell/assets/model_files.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/data/dataset.h"
#include "robocell/data/dataset_lock.h"
#include "robocell/data/leftovers.h"
#include "robocell/data/model_store.h"
#include "robocell/data/testing/sample_episode.h"
#include "robocell/data/verify.h"
#include "robocell/rollout/run_inputs.h"
#include "robocell/rollout/run_renderer.h"
#include "robocell/spec/yaml.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

RunConfig Demo(const std::filesystem::path& output) {
  RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
  run.output = output.string();
  return run;
}

// Imitates the presence of an episode.
void Occupy(const RunConfig& run) {
  std::filesystem::create_directory(std::filesystem::path(run.output) / "s0000_e0000");
}

TEST(PrepareDataset, CreatesTheFolderWithItsManifest) {
  TempDir folder;
  const RunConfig run = Demo(folder / "a/b");
  PrepareDataset(run);
  const auto manifest = nlohmann::json::parse(ReadManifest(folder / "a/b").value());
  EXPECT_EQ(manifest["run"], "demo");
  EXPECT_THAT(manifest["identity"].get<std::string>(), HasSubstr("base_distance: [0.3, 0.55]"));
  EXPECT_EQ(Dataset(folder / "a/b").size(), 0u);
}

TEST(PrepareDataset, KeepsOnlyModelsOfEpisodes) {
  TempDir folder;
  const RunConfig run = Demo(folder.path());
  PrepareDataset(run);
  EXPECT_THAT(internal::StoredModels(folder.path()), IsEmpty());
  const std::vector<std::string> models = ModelsOf(run);
  ASSERT_GT(models.size(), 1u);
  const FileSet used = internal::ModelFileSet(models.front());
  const SampleEpisode sample(0, false, false);
  for (const bool kept : {false, true}) {
    EpisodeWriter episode(folder.path(), "s0000_e0000", sample.schema, sample.Options());
    episode.AddModel("robot", used);
    sample.PutRows(episode, 3);
    EXPECT_THAT(internal::StoredModels(folder.path()), IsEmpty()) << "an episode may be given up";
    if (kept) episode.Commit({.success = true, .terminated = true, .end_reason = "success"});
  }
  const std::string stored = internal::StoredModelFolder(internal::StoredModelPath(used));
  EXPECT_THAT(internal::StoredModels(folder.path()), ElementsAre(stored));
  std::filesystem::remove_all(folder / stored);
  PrepareDataset(run);
  EXPECT_THAT(internal::StoredModels(folder.path()), ElementsAre(stored))
      << "what was lost, and nothing else";
  EXPECT_TRUE(Verify(folder.path()).ok());
}

TEST(PrepareDataset, WritesTheSameManifestConcurrently) {
  TempDir folder;
  RunConfig run = Demo(folder / "a");
  PrepareDataset(run);
  run.output = (folder / "b").string();
  run.workers = 7;
  PrepareDataset(run);
  EXPECT_EQ(ReadManifest(folder / "a"), ReadManifest(folder / "b"));
}

// Several commands begin at once, and the quickest removes leftovers of dead processes.
TEST(PrepareDataset, IsNotDisturbedByCleanup) {
  TempDir folder;
  RunConfig run = Demo(folder / "out");
  std::filesystem::create_directory(folder / "out");
  std::atomic<bool> done = false;
  std::thread sweeper([&] {
    for (size_t swept = 0; swept < 5 && !done; std::this_thread::yield())
      swept += RemoveLeftovers(folder / "out").size();
  });
  for (int i = 0; i < 10; ++i) {
    std::filesystem::remove(folder / "out/dataset.json");
    EXPECT_NO_THROW(PrepareDataset(run, {.validate = false}));
  }
  done = true;
  sweeper.join();
  EXPECT_NO_THROW(RequireSameRun(run));
}

TEST(PrepareDataset, AcceptsMoreEpisodesAndOtherWorkers) {
  TempDir folder;
  RunConfig run = Demo(folder / "out");
  PrepareDataset(run);
  run.workers = 5;
  run.episodes = 3;
  run.episodes_per_scene = 50;
  EXPECT_NO_THROW(PrepareDataset(run));
}

TEST(PrepareDataset, RejectsAnotherConfigurationAndShowsTheDifferences) {
  TempDir folder;
  RunConfig run = Demo(folder / "out");
  PrepareDataset(run);
  Occupy(run);
  run.start.base_distance = {0.2, 0.5};
  const std::string text =
      ExpectThrow<SpecError>([&] { PrepareDataset(run); }, "was begun differently");
  EXPECT_THAT(text, HasSubstr("/demo.yaml:15:9: run 'demo': the dataset '"));
  EXPECT_THAT(text, HasSubstr("/demo.yaml:5:24: start.base_distance: [0.3, 0.55] then, [0.2, 0.5] "
                              "now\nChange these back"));
  EXPECT_THAT(text, HasSubstr(run.output));
  EXPECT_THAT(text, Not(HasSubstr("base_height")));
}

TEST(PrepareDataset, NamesTheOptionThatReplacedANumberOfAList) {
  TempDir folder;
  const std::string file = SourceDir() + "/examples/demo.yaml";
  const auto with = [&](const std::string& option) {
    return LoadYaml<RunConfig>(file, {"output=" + (folder / "out").string(), option});
  };
  const RunConfig run = with("seed=0");
  PrepareDataset(run);
  Occupy(run);
  ExpectThrow<SpecError>([&] { PrepareDataset(with("robot.home.arm[1]=0.3")); },
                         "\n  --set robot.home.arm[1]=0.3: robot.home.arm: [");
  ExpectThrow<SpecError>([&] { PrepareDataset(with("start.base_distance=[0.2, 0.5]")); },
                         "\n  --set start.base_distance=[0.2, 0.5]: start.base_distance: [");
}

TEST(PrepareDataset, DoesNotTouchOtherFolders) {
  TempDir folder;
  AtomicWrite(folder / "thesis.txt", "years of work");
  EXPECT_THAT(ExpectThrow<SpecError>([&] { PrepareDataset(Demo(folder.path())); },
                                     "holds 'thesis.txt' and is not a dataset"),
              HasSubstr("/demo.yaml:15:9: run 'demo': output: the folder"));
  EXPECT_FALSE(ReadManifest(folder.path()));
}

// Leftovers of an interrupted process are no reason to stop.
TEST(PrepareDataset, IgnoresUnfinishedWrites) {
  TempDir folder;
  MakeTempDirectory(folder.path(), "s0000_e0000");
  EXPECT_NO_THROW(PrepareDataset(Demo(folder.path())));
}

TEST(PrepareDataset, NamesAFolderThatCannotBeWritten) {
  TempDir folder;
  AtomicWrite(folder / "file", "");
  const RunConfig run = Demo(folder / "file/out");
  const std::string text =
      ExpectThrow<IoError>([&] { PrepareDataset(run); }, "cannot create the dataset's folder");
  EXPECT_THAT(text, HasSubstr(run.output));
}

TEST(PrepareDataset, RequiresAnOutput) {
  EXPECT_THAT(ExpectThrow<SpecError>([] { PrepareDataset(Demo("")); },
                                     "output: where should the dataset go?"),
              HasSubstr("/demo.yaml:15:9: run 'demo': "));
}

TEST(PrepareDataset, NamesADamagedManifest) {
  TempDir folder;
  const RunConfig run = Demo(folder.path());
  PrepareDataset(run);
  AtomicWrite(folder / "dataset.json", "{\"format\": ");
  ExpectThrow<IoError>([&] { PrepareDataset(run); }, "dataset.json' is damaged");
}

TEST(PrepareDataset, RestartsADatasetWithoutEpisodes) {
  TempDir folder;
  RunConfig run = Demo(folder / "out");
  PrepareDataset(run);
  AtomicWrite(folder / "out/.lock", "");
  AtomicWrite(folder / "out/report.json", "{}");
  std::filesystem::create_directory(folder / "out/.logs");
  run.seed = 7;
  ExpectThrow<SpecError>([&] { RequireSameRun(run); }, "seed: 0 then, 7 now");
  EXPECT_NO_THROW(ValidateDataset(run));
  PrepareDataset(run);
  EXPECT_NO_THROW(RequireSameRun(run));
}

TEST(PrepareDataset, DoesNotRestartADatasetInUse) {
  TempDir folder;
  RunConfig run = Demo(folder / "out");
  PrepareDataset(run);
  const DatasetLock other(run.output);
  EXPECT_NO_THROW(PrepareDataset(run));
  run.seed = 7;
  ExpectThrow<IoError>([&] { PrepareDataset(run); }, "in use by process");
}

TEST(PrepareDataset, StoresTheLastChoiceOfWhatIsDrawn) {
  TempDir folder;
  RunConfig run = Demo(folder.path());
  const auto prepare = [&](std::optional<RenderWhen> render) {
    run.render = render;
    PrepareDataset(run);
    RequireSameRun(run);
    run.render.reset();
    return internal::RenderOf(run);
  };
  EXPECT_EQ(prepare(RenderWhen::kKept), RenderWhen::kKept);
  Occupy(run);
  EXPECT_EQ(prepare(std::nullopt), RenderWhen::kKept);
  EXPECT_EQ(prepare(RenderWhen::kAlways), RenderWhen::kAlways);
  EXPECT_EQ(prepare(std::nullopt), RenderWhen::kAlways);
  const DatasetLock writing = DatasetLock::Writing(run.output);
  EXPECT_EQ(prepare(RenderWhen::kKept), RenderWhen::kAlways) << "another command is writing";
}

TEST(PrepareDataset, NamesAChangedVersion) {
  TempDir folder;
  const RunConfig run = Demo(folder / "out");
  PrepareDataset(run);
  auto manifest = nlohmann::json::parse(*ReadManifest(folder / "out"));
  manifest["versions"]["mujoco"] = "3.9.0";
  WriteManifest(folder / "out", manifest.dump());
  Occupy(run);
  ExpectThrow<SpecError>([&] { PrepareDataset(run); }, "mujoco: 3.9.0 then, 4.0.0 now");
}

// A mistake in the run leaves nothing behind, so that the corrected file begins afresh.
TEST(PrepareDataset, ChecksTheRunFirst) {
  TempDir folder;
  RunConfig run = Demo(folder / "out");
  run.task.As<PickTaskConfig>().objects.names = {"mgu"};
  ExpectThrow<SpecError>([&] { PrepareDataset(run); },
                         "no kind of object 'mgu'. Known kinds of object: ");
  run.task.As<PickTaskConfig>().objects = {};
  run.cameras.streams[0].camera = "nowhere";
  ExpectThrow<SpecError>([&] { PrepareDataset(run); }, "no camera 'nowhere'");
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(ValidateDataset, WritesNothing) {
  TempDir folder;
  ValidateDataset(Demo(folder / "out"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  AtomicWrite(folder / "thesis.txt", "years of work");
  ExpectThrow<SpecError>([&] { ValidateDataset(Demo(folder.path())); }, "is not a dataset");
}

}  // namespace
}  // namespace robocell
