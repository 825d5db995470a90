#include "robocell/rollout/env_recorder.h"

#include <sys/wait.h>
#include <unistd.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <csignal>
#include <filesystem>
#include <numeric>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/units.h"
#include "robocell/data/dataset.h"
#include "robocell/data/hdf5.h"
#include "robocell/data/leftovers.h"
#include "robocell/data/verify.h"
#include "robocell/env/arm_target.h"
#include "robocell/env/env_batch.h"
#include "robocell/env/testing/envs.h"
#include "robocell/features/own_features.h"
#include "robocell/rollout/env_of_episode.h"
#include "robocell/rollout/replay.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<double> GoingTo(const Eigen::Vector3d& tcp, double gripper = 1) {
  std::vector<double> action(8);
  internal::PutTquat(Pose::FromRpy(tcp, {internal::kPi, 0, 0}), action);
  action[7] = gripper;
  return action;
}

// Takes three steps above the cube.
void ActOut(Env& env) {
  for (const double z : {0.3, 0.2, 0.1}) env.Step(GoingTo({0.45, 0, z}));
}

std::vector<double> NumbersOf(std::span<const double> numbers) {
  return {numbers.begin(), numbers.end()};
}

// Checks what holds for every dataset: it is complete and replays to the bit.
void ExpectSound(const fs::path& dataset, size_t episodes) {
  const VerifyResult report = Verify(dataset);
  EXPECT_THAT(report.problems, IsEmpty());
  const Dataset all(dataset);
  EXPECT_EQ(all.size(), episodes);
  for (const Episode& episode : all)
    EXPECT_TRUE(VerifyReplay(episode, {.tolerance = 0}).ok())
        << VerifyReplay(episode, {.tolerance = 0}).Text();
}

TEST(EnvRecorders, SaveAnEpisodeAtEachReset) {
  const TempDir folder;
  Env env(Rc7WithCube());
  {
    EnvRecorder recorder(env, folder / "out");
    env.Reset({.seed = 5});
    ActOut(env);
    EXPECT_EQ(recorder.rows(), 3);
    EXPECT_THAT(recorder.episodes(), IsEmpty());
    env.Reset();
    EXPECT_THAT(recorder.episodes(), ElementsAre("episode-000000"));
    env.Reset();  // no step, no episode
    env.Step(GoingTo({0.4, 0.1, 0.3}));
    recorder.Close();
    recorder.Close();
    EXPECT_THAT(recorder.episodes(), ElementsAre("episode-000000", "episode-000001"));
    ExpectThrow<ClosedError>([&] { recorder.Save(); }, "is closed");
    env.Step(GoingTo({0.4, 0.1, 0.3}));
  }
  ExpectSound(folder / "out", 2);
  const Dataset dataset(folder / "out");
  EXPECT_EQ(dataset.At(0).rows(), 3);
  EXPECT_EQ(dataset.At(1).rows(), 1);
  EXPECT_EQ(dataset.At(0).end_reason(), "stopped");
  EXPECT_TRUE(dataset.At(0).truncated());
  EXPECT_EQ(dataset.At(0).Read<uint8_t>("truncated"), (std::vector<uint8_t>{0, 0, 1}));
}

TEST(EnvRecorders, RecordObservationsActionsAndRewards) {
  const TempDir folder;
  Env env(Rc7WithCube());
  EnvRecorder recorder(env, folder.path(), {.metadata_json = R"({"operator": "ann"})"});
  env.Reset({.seed = 5});
  std::vector<std::vector<double>> seen = {NumbersOf(env.observation())};
  std::vector<double> rewards, times;
  for (const double z : {0.3, 0.1}) {
    times.push_back(env.scene().time());
    rewards.push_back(env.Step(GoingTo({0.45, 0, z})).reward);
    seen.push_back(NumbersOf(env.observation()));
  }
  ASSERT_EQ(recorder.Save(), "episode-000000");
  const Episode episode = Dataset(folder.path()).At(0);
  EXPECT_EQ(episode.Read<double>("reward"), rewards);
  EXPECT_EQ(episode.Read<double>("time"), times);
  const std::vector<double> requested =
      episode.Read<double>("action/robot/tquat", {.first = 1, .count = 1});
  EXPECT_EQ(requested[2], 0.1);
  const auto final = nlohmann::json::parse(episode.results_json()).at(kFinalObservation);
  for (const Feature& feature : env.layout().observed.features()) {
    const std::string& name = feature.column.name;
    EXPECT_EQ(episode.features().Find(name).column.units, feature.column.units);
    const auto size = static_cast<size_t>(feature.size());
    const std::vector<double> column = episode.Read<double>(name);
    ASSERT_EQ(column.size(), 2 * size);
    std::vector<double> shown, last;
    for (size_t row = 0; row < 2; ++row)
      shown.insert(shown.end(), seen[row].begin(), seen[row].begin() + feature.size());
    EXPECT_EQ(column, shown) << name;
    last.assign(seen[2].begin(), seen[2].begin() + feature.size());
    EXPECT_EQ(final.at(name).get<std::vector<double>>(), last) << name;
    for (std::vector<double>& row : seen) row.erase(row.begin(), row.begin() + feature.size());
  }
  // The columns of generated episodes are there too.
  EXPECT_EQ(episode.Read<double>("robots/robot/arm/qpos"),
            episode.Read<double>("observation/robot/joints"));
  EXPECT_TRUE(episode.features().Has("objects/cube/pose"));
  const auto metadata = nlohmann::json::parse(episode.metadata_json());
  EXPECT_EQ(metadata.at("user").at("operator"), "ann");
  EXPECT_EQ(metadata.at("instruction"), env.instruction());
}

TEST(EnvRecorders, WaitForAResetAfterSaveOrDiscard) {
  const TempDir folder;
  Env env(Rc7WithCube());
  env.Reset({.seed = 5});
  env.Step(GoingTo({0.45, 0, 0.3}));
  EnvRecorder recorder(env, folder.path());  // from here on
  env.Step(GoingTo({0.45, 0, 0.2}));
  EXPECT_EQ(recorder.Save({.success = true, .reason = "the operator said so"}), "episode-000000");
  EXPECT_EQ(recorder.Save(), std::nullopt);
  ActOut(env);
  EXPECT_EQ(recorder.rows(), 0);
  const EnvState state = env.state();
  env.SetState(state);  // begins an episode like a reset
  ActOut(env);
  recorder.Discard();
  env.Reset();
  EXPECT_THAT(recorder.episodes(), ElementsAre("episode-000000"));
  ExpectSound(folder.path(), 1);
  const Episode episode = Dataset(folder.path()).At(0);
  EXPECT_TRUE(episode.success());
  EXPECT_TRUE(episode.terminated());
  EXPECT_EQ(episode.end_reason(), "the operator said so");
}

TEST(EnvRecorders, LeaveNothingOfAnUnsavedEpisode) {
  const TempDir folder;
  Env env(Rc7WithCube());
  {
    EnvRecorder recorder(env, folder.path());
    env.Reset();
    ActOut(env);
    EXPECT_EQ(recorder.rows(), 3);
  }
  env.Step(GoingTo({0.45, 0, 0.3}));
  for (const auto& entry : fs::directory_iterator(folder.path()))
    EXPECT_THAT(entry.path().filename().string(), ::testing::StartsWith(".lock"));
}

TEST(EnvRecorders, FailedStepsAreNotRecorded) {
  struct Enough {};
  const TempDir folder;
  Env env(Rc7WithCube());
  EnvRecorder recorder(env, folder.path());
  env.Reset({.seed = 5});
  ActOut(env);
  EXPECT_THROW(env.Step(GoingTo({0.4, 0.2, 0.3}), [] { throw Enough(); }), Enough);
  env.Reset();
  EXPECT_THAT(recorder.episodes(), ElementsAre("episode-000000"));
  ExpectSound(folder.path(), 1);
  const Episode episode = Dataset(folder.path()).At(0);
  EXPECT_EQ(episode.rows(), 3);
  EXPECT_EQ(episode.Read<uint8_t>("truncated"), (std::vector<uint8_t>{0, 0, 1}));
}

TEST(EnvRecorders, TheLastRowKeepsTheSuccessBeforeAFailedStep) {
  struct Enough {};
  const TempDir folder;
  Env env(Rc7WithCube());
  EnvRecorder recorder(env, folder.path());
  env.Reset({.seed = 5});
  ActOut(env);
  EXPECT_THROW(env.Step(GoingTo({0.4, 0.2, 0.3}), [] { throw Enough(); }), Enough);
  recorder.Save({.success = true});
  const Episode episode = Dataset(folder.path()).At(0);
  EXPECT_EQ(episode.Read<uint8_t>("success"), (std::vector<uint8_t>{0, 0, 1}));
  EXPECT_EQ(episode.Read<uint8_t>("terminated"), (std::vector<uint8_t>{0, 0, 1}));
  ExpectSound(folder.path(), 1);
}

TEST(EnvRecorders, ReplayStepsRevokedByAGuard) {
  const TempDir folder;
  EnvConfig config = Rc7BesideAWall();
  config.sim.on_collision = OnCollision::kGuard;
  Env env(config);
  EnvRecorder recorder(env, folder.path());
  env.Reset({.seed = 5});
  std::vector<double> turned(8);
  env.Step(turned);
  turned[0] = 1.2;
  EXPECT_EQ(env.Step(turned).reason, EndReason::kCollision);
  turned[0] = -0.2;
  env.Step(turned);
  recorder.Close();
  ExpectSound(folder.path(), 1);
  const Episode episode = Dataset(folder.path()).At(0);
  EXPECT_EQ(episode.Read<int32_t>("step_reason")[1], static_cast<int>(EndReason::kCollision));
  EXPECT_EQ(episode.column("step_reason").spec.values[1], "collision");
  Env other(config);
  EXPECT_TRUE(ReplayActions(other, episode).ok());
}

TEST(EnvRecorders, CommandsByNameAreRecordedByTheirNamesAndReplayed) {
  const TempDir folder;
  const char* arm = "robots/robot/action/arm";
  Env env(Rc7WithCube());
  EnvRecorder recorder(env, folder.path());
  env.Reset({.seed = 5});
  env.features().ReadState();
  std::vector<double> target(env.features().ReadActions().begin(),
                             env.features().ReadActions().begin() + 7);
  for (int i = 0; i < 3; ++i) {
    target[1] += 0.1;
    env.Act({{arm, target}, {"robots/robot/action/gripper", {0}}});
  }
  ExpectThrow<ArgumentError>(
      [&] {
        env.Step(GoingTo({0.45, 0, 0.3}));
      },
      "this episode is recorded with commands by name; save it");
  env.Reset({.seed = 6});
  for (int i = 0; i < 2; ++i) env.Act({{arm, target}});
  env.Reset({.seed = 7});
  ActOut(env);  // the other form in another episode
  recorder.Close();
  ExpectSound(folder.path(), 3);
  const Episode episode = Dataset(folder.path()).At(0);
  EXPECT_FALSE(episode.features().Has("action/robot/tquat"));
  EXPECT_EQ(episode.rows(), 3);
  EXPECT_EQ(episode.Read<double>(arm)[2 * 7 + 1], target[1]);
  Env other(Rc7WithCube());
  for (const Episode& each : Dataset(folder.path()))
    EXPECT_TRUE(ReplayActions(other, each).ok()) << each.id();
}

TEST(EnvRecorders, RecordTheVariationsOfObjects) {
  const TempDir folder;
  EnvConfig config = Rc7WithCube();
  config.variations["cube"] = {.mass = {0.5, 2}, .friction = {0.5, 1.5}, .colour = 0.2};
  Env env(config);
  EnvRecorder recorder(env, folder.path());
  for (int i = 0; i < 2; ++i) {
    env.Reset();
    env.Step(GoingTo({0.45, 0, 0.03}, 1));
    env.Step(GoingTo({0.45, 0, 0.03}, 0));
    env.Step(GoingTo({0.45, 0, 0.2}, 0));
  }
  recorder.Close();
  ExpectSound(folder.path(), 2);
  EXPECT_TRUE(
      ReplayActions(*EnvOfEpisode(Dataset(folder.path()).At(1)), Dataset(folder.path()).At(1))
          .ok());
}

TEST(EnvRecorders, ADivergenceIsTheLastRow) {
  const TempDir folder;
  EnvConfig config = Rc7WithCube();
  config.task.reset();
  Env env(config);
  EnvRecorder recorder(env, folder.path());
  env.Reset({.seed = 5});
  env.Step(GoingTo({0.45, 0, 0.3}));
  const mjModel* m = env.scene().model();
  const int dof = m->body_dofadr[mj_name2id(m, mjOBJ_BODY, "cube")];
  env.scene().data()->qvel[dof] = 1e12;
  EXPECT_EQ(env.Step(GoingTo({0.45, 0, 0.2})).reason, EndReason::kDiverged);
  env.Reset();
  recorder.Close();
  const Episode episode = Dataset(folder.path()).At(0);
  EXPECT_EQ(episode.end_reason(), "diverged");
  EXPECT_EQ(episode.rows(), 2);
  EXPECT_TRUE(episode.terminated());
  EXPECT_FALSE(episode.success());
  EXPECT_THAT(episode.warnings(), Contains(HasSubstr("diverged")));
  EXPECT_THAT(Verify(folder.path()).problems, IsEmpty());
}

TEST(EnvRecorders, RecordTheObservedFrames) {
  const TempDir folder;
  EnvConfig config = Rc7WithCube();
  config.camera_adds["top"] = {.fovy = 30, .offset = Pose(Eigen::Vector3d(0.4, 0, 1.5))};
  config.cameras.resolution = {32, 24};
  config.cameras.streams.push_back({.name = "top", .camera = "top", .depth = true});
  config.cameras.streams[0].segmentation = true;
  Env env(config);
  EnvRecorder recorder(env, folder.path());
  env.Reset({.seed = 5});
  std::vector<uint16_t> depth = env.frames()[0].depth_mm;
  env.Step(GoingTo({0.45, 0, 0.3}));
  env.Step(GoingTo({0.45, 0, 0.2}));
  recorder.Close();
  ExpectSound(folder.path(), 1);
  const Episode episode = Dataset(folder.path()).At(0);
  std::vector<uint16_t> recorded(depth.size());
  episode.ReadFrame("top", ImageKind::kDepth, 0, std::span(recorded));
  EXPECT_EQ(recorded, depth) << "lossless";
  EXPECT_EQ(episode.camera("top").frames, 2);
  EXPECT_EQ(episode.Read<double>("cameras/top/time")[0], 0);
  const std::unique_ptr<Env> again = EnvOfEpisode(episode, true);
  EXPECT_TRUE(ReplayActions(*again, episode).ok());
  EXPECT_EQ(again->frames().size(), 1u);

  EnvRecorder blind(env, folder / "blind", {.images = false});
  env.Reset();
  env.Step(GoingTo({0.45, 0, 0.3}));
  blind.Close();
  EXPECT_THAT(Dataset(folder / "blind").At(0).cameras(), IsEmpty());

  config.cameras.streams[0].rgb = false;
  Env colourless(config);
  ExpectThrow<ArgumentError>([&] { EnvRecorder(colourless, folder / "colourless"); },
                             "stream 'top' has no colour images, so it cannot be recorded; set");
}

TEST(EnvRecorders, EachCopyOfABatchHasItsOwn) {
  const TempDir folder;
  EnvConfig config = Rc7WithCube();
  EnvBatch batch(config, 2, 2);
  std::vector<std::unique_ptr<EnvRecorder>> recorders;
  for (int i = 0; i < 2; ++i) {
    recorders.push_back(std::make_unique<EnvRecorder>(
        batch.env(i), folder.path(), EnvRecorderOptions{.prefix = "copy" + std::to_string(i)}));
  }
  batch.Reset(std::vector<std::optional<uint64_t>>{1, 2});
  std::vector<double> actions = GoingTo({0.45, 0, 0.2});
  const std::vector<double> other = GoingTo({0.4, 0.1, 0.25});
  actions.insert(actions.end(), other.begin(), other.end());
  for (int i = 0; i < 2; ++i) batch.Step(actions);
  batch.Step(actions, {false, true});  // the second begins its next episode by itself
  batch.Step(actions);
  for (const auto& recorder : recorders) recorder->Close();
  ExpectSound(folder.path(), 3);
  EXPECT_EQ(Dataset(folder.path()).Open("copy0-000000").rows(), 4);
  EXPECT_EQ(Dataset(folder.path()).Open("copy1-000000").rows(), 2);
  Env alone(config);
  for (const Episode& episode : Dataset(folder.path()))
    EXPECT_TRUE(ReplayActions(alone, episode).ok());
  EXPECT_NO_THROW(EnvRecorder(batch.env(1), folder.path(), {.prefix = "copy1"}));
}

TEST(EnvRecorders, ContinueTheNumberingOfTheirPrefix) {
  const TempDir folder;
  Env env(Rc7WithCube());
  for (int i = 0; i < 2; ++i) {
    EnvRecorder recorder(env, folder.path());
    env.Reset();
    env.Step(GoingTo({0.45, 0, 0.3}));
    if (i == 0) continue;
    ExpectThrow<IoError>(
        [&] { EnvRecorder(env, folder.path()); },
        "episodes 'episode-...' of '" + folder.path().string() + "' are being written");
    recorder.Close();
    EXPECT_THAT(recorder.episodes(), ElementsAre("episode-000000"));
    EnvRecorder next(env, folder.path());
    env.Step(GoingTo({0.45, 0, 0.3}));
    EXPECT_EQ(next.Save(), "episode-000001");
  }
}

// Kills a recorder in a process of its own in the middle of an episode.
TEST(EnvRecorders, RemoveLeftoversOfAKilledRecorder) {
  const TempDir folder;
  for (const char* prefix : {"episode", "episode-left"}) {
    const pid_t child = internal::hdf5::Fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      Env env(Rc7WithCube());
      EnvRecorder recorder(env, folder.path(), {.prefix = prefix});
      env.Reset({.seed = 5});
      ActOut(env);
      kill(getpid(), SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
  }
  ASSERT_EQ(UnfinishedIn(folder.path()).size(), 2u);
  Env env(Rc7WithCube()), other(Rc7WithCube());
  EnvRecorder recorder(env, folder.path());
  ASSERT_EQ(UnfinishedIn(folder.path()).size(), 1u) << "the other prefix's stays";
  env.Reset({.seed = 5});
  env.Step(GoingTo({0.45, 0, 0.3}));
  // An active recorder keeps its files.
  EnvRecorder left(other, folder.path(), {.prefix = "episode-left"});
  EXPECT_EQ(Verify(folder.path()).being_written.size(), 1u);
  EXPECT_EQ(UnfinishedIn(folder.path()).size(), 1u);
  other.Reset({.seed = 6});
  other.Step(GoingTo({0.45, 0, 0.3}));
  ExpectThrow<IoError>([&] { EnvRecorder(other, folder.path()); }, "are being written");
  recorder.Close();
  left.Close();
  EXPECT_THAT(UnfinishedIn(folder.path()), IsEmpty());
  ExpectSound(folder.path(), 2);
}

TEST(EnvRecorders, RejectFoldersOfAnotherConfiguration) {
  const TempDir folder;
  EnvConfig config = Rc7WithCube();
  {
    Env env(config);
    EnvRecorder recorder(env, folder.path());
    env.Reset();
    env.Step(GoingTo({0.45, 0, 0.3}));
    recorder.Close();
    EnvRecorder again(env, folder.path());
  }
  config.sim.max_convergence_time = 1.25;
  Env other(config);
  ExpectThrow<ArgumentError>([&] { EnvRecorder(other, folder.path()); },
                             "1.25 now; choose another folder");
}

TEST(EnvRecorders, OneFolderHasTheEpisodesOfOneConfigurationAlthoughBothRecordersWereMadeBefore) {
  const TempDir folder;
  EnvConfig config = Rc7WithCube();
  Env env(config);
  config.sim.max_convergence_time = 1.25;
  Env other(config);
  EnvRecorder recorder(env, folder.path(), {.prefix = "a"});
  EnvRecorder late(other, folder.path(), {.prefix = "b"});
  for (Env* each : {&env, &other}) {
    each->Reset();
    each->Step(GoingTo({0.45, 0, 0.3}));
  }
  recorder.Close();
  ExpectThrow<ArgumentError>([&] { late.Close(); }, "1.25 now; choose another folder");
  ExpectSound(folder.path(), 1);
}

TEST(EnvRecorders, EpisodesRequireTheirOriginalCode) {
  const TempDir folder;
  const std::string code = (folder / "mine.cc").string();
  AtomicWrite(code, "return 1;");
  RegisterFeature("recorded_feature", {.column = {.units = "m"}},
                  [](const Scene&, std::span<double> out) { out[0] = 1; }, true,
                  {.files = [code] { return std::vector<std::string>{code}; }});
  EnvConfig config = Rc7WithCube();
  config.features.names = {"recorded_feature"};
  Env env(config);
  EnvRecorder recorder(env, folder / "out");
  env.Reset();
  env.Step(GoingTo({0.45, 0, 0.3}));
  recorder.Close();
  const Episode episode = Dataset(folder / "out").At(0);
  EXPECT_TRUE(ReplayActions(*EnvOfEpisode(episode), episode).ok());
  AtomicWrite(code, "return 5;");
  ExpectThrow<SpecError>([&] { EnvOfEpisode(episode); }, "was recorded with other code than");
  const DataFactory never = [](CompiledScene&) -> DataHandle {
    throw Error("the scene was built");
  };
  ExpectThrow<SpecError>([&] { EnvOfEpisode(episode, false, never); }, "other code than");
  ExpectThrow<SpecError>([&] { ReplayActions(env, episode); }, "mine.cc");
  ExpectThrow<ArgumentError>([&] { EnvRecorder(env, folder / "out"); },
                             "mine.cc: not the recorded one; choose another folder");
}

TEST(EnvRecorders, FeaturesKeepTheirShape) {
  const TempDir folder;
  RegisterFeature(
      "recorded_matrix", {.column = {.shape = {2, 3}, .names = {"a", "b", "c"}}},
      [](const Scene&, std::span<double> out) { std::iota(out.begin(), out.end(), 1); }, true);
  RegisterFeature(
      "recorded_number", {}, [](const Scene&, std::span<double> out) { out[0] = 7; }, true);
  EnvConfig config = Rc7WithCube();
  config.features.names = {"recorded_matrix", "recorded_number"};
  Env env(config);
  EnvRecorder recorder(env, folder / "out");
  env.Reset();
  env.Step(GoingTo({0.45, 0, 0.3}));
  recorder.Close();
  const Episode episode = Dataset(folder / "out").At(0);
  const FeatureSchema& schema = episode.features();
  for (const std::string path : {"features/", "observation/features/"}) {
    const Feature& matrix = schema.Find(path + "recorded_matrix");
    EXPECT_EQ(matrix.column.shape, (std::vector<int64_t>{2, 3})) << path;
    EXPECT_EQ(matrix.column.names, (std::vector<std::string>{"a", "b", "c"})) << path;
    EXPECT_EQ(schema.Find(path + "recorded_number").column.shape, std::vector<int64_t>{}) << path;
    const std::vector<double> row = episode.Read<double>(path + "recorded_matrix", {0, 1});
    EXPECT_EQ(row, (std::vector<double>{1, 2, 3, 4, 5, 6})) << path;
  }
}

TEST(EnvRecorders, RejectUnsuitableFolders) {
  const TempDir folder;
  Env env(Rc7WithCube());
  fs::create_directory(folder / "things");
  AtomicWrite(folder / "things" / "notes.txt", "mine");
  ExpectThrow<ArgumentError>([&] { EnvRecorder(env, folder / "things"); }, "is not a dataset");
  fs::create_directory(folder / "run");
  WriteManifest(folder / "run", "{}");
  ExpectThrow<ArgumentError>([&] { EnvRecorder(env, folder / "run"); },
                             "is the dataset of a run, whose episodes are those of its plan");
  ExpectThrow<ArgumentError>([&] { EnvRecorder(env, folder.path(), {.prefix = "a/b"}); },
                             "'a/b' cannot begin the ids of episodes");
  ExpectThrow<ArgumentError>([&] { EnvRecorder(env, folder.path(), {.metadata_json = "[]"}); },
                             "must be an object in JSON");
}

}  // namespace
}  // namespace robocell
