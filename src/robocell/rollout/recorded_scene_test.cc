#include "robocell/rollout/recorded_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/data/dataset.h"
#include "robocell/data/model_store.h"
#include "robocell/data/verify.h"
#include "robocell/mujoco/engine_defects.h"
#include "robocell/rollout/replay.h"
#include "robocell/rollout/runner.h"
#include "robocell/spec/yaml.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const fs::path kModels = fs::path(SourceDir()) / "models";

// A copy of the built-in robot as a user's own robot, on a user's own table.
RunConfig OwnRun(const fs::path& folder) {
  fs::create_directories(folder);
  fs::copy(kModels / "robots/rc7", folder / "robot", fs::copy_options::recursive);
  fs::copy(kModels / "scenes/tabletop.xml", folder / "table.xml");
  RunConfig run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
  run.cameras.streams = {};
  run.robot.config.source_dir = (folder / "robot").string();
  run.scenes = FilesScenes{.files = {(folder / "table.xml").string()}};
  run.output = (folder / "out").string();
  return run;
}

// Records one episode in `folder`/out.
Episode Record(const RunConfig& run) {
  PrepareDataset(run);
  EXPECT_TRUE(Runner(run).Run(MakePlan(run)[0]).success);
  return Dataset(run.output).Open("s0000_e0000");
}

class RecordedSceneTest : public ::testing::Test {
 protected:
  TempDir temp;
  fs::path machine = temp / "machine";
  fs::path other = temp / "other";
};

TEST_F(RecordedSceneTest, ReplaysAnEpisodeWithoutTheOriginalModels) {
  Record(OwnRun(machine));
  fs::rename(machine / "out", other);
  fs::remove_all(machine);
  const Episode episode = Dataset(other).Open("s0000_e0000");
  const ReplayResult result = VerifyReplay(episode, {.tolerance = 0});
  EXPECT_TRUE(result.ok()) << result.Text();
  EXPECT_GT(result.rows, 20);
  EXPECT_TRUE(Verify(other).ok()) << Verify(other).Text();
}

TEST_F(RecordedSceneTest, TheSceneNamesNoPathOfTheMachine) {
  const Episode episode = Record(OwnRun(machine));
  const auto metadata = nlohmann::json::parse(episode.metadata_json());
  EXPECT_THAT(metadata["scene_spec"].get<std::string>(), Not(HasSubstr(temp.path().string())));
  EXPECT_THAT(episode.run_json(), Not(HasSubstr(temp.path().string())));
  // The text alone is enough to build the scene from the dataset's folder.
  const auto spec = ParseYaml<SceneSpec>(metadata["scene_spec"].get<std::string>(), "scene_spec",
                                         machine / "out");
  EXPECT_NO_THROW(Scene::Build(spec));
}

TEST_F(RecordedSceneTest, PortableModelsKeepTheirNames) {
  RunConfig run = OwnRun(machine);
  run.robot.config.source_dir = (kModels / "robots/rc7").string();
  run.scenes = {};
  run.task.As<PickTaskConfig>().objects.names = {"box"};
  const Episode episode = Record(run);
  EXPECT_EQ(episode.models().size(), 2u);
  EXPECT_THAT(episode.models().at("rc7"), StartsWith("models/rc7-"));
  EXPECT_THAT(episode.models().at("tabletop"), StartsWith("models/tabletop-"));
  const auto metadata = nlohmann::json::parse(episode.metadata_json());
  EXPECT_NO_THROW(Scene::Build(ParseYaml<SceneSpec>(metadata["scene_spec"].get<std::string>())));
}

TEST_F(RecordedSceneTest, ASingleEpisodeFindsPortableModels) {
  RunConfig run = OwnRun(machine);
  run.robot.config.source_dir = (kModels / "robots/rc7").string();
  run.scenes = {};
  Record(run);
  fs::create_directory(other);
  fs::rename(machine / "out/s0000_e0000", other / "s0000_e0000");
  const Episode episode = Dataset(other).Open("s0000_e0000");
  EXPECT_TRUE(VerifyReplay(episode, {.tolerance = 0}).ok());
}

TEST_F(RecordedSceneTest, AnEpisodeWithoutItsModelsNamesTheMissingOnes) {
  Record(OwnRun(machine));
  fs::create_directory(other);
  fs::rename(machine / "out/s0000_e0000", other / "s0000_e0000");
  const Episode episode = Dataset(other).Open("s0000_e0000");
  const std::string text =
      ExpectThrow<NotFoundError>([&] { RecordedScene(episode); }, "keep an episode in its dataset");
  EXPECT_THAT(text, HasSubstr("models/table-"));
}

TEST_F(RecordedSceneTest, RejectsAChangedModel) {
  const Episode episode = Record(OwnRun(machine));
  const fs::path stored = machine / "out" / episode.models().begin()->second;
  AtomicWrite(stored, ReadFile(stored) + " ");
  ExpectThrow<IoError>([&] { RecordedScene(episode); },
                       "differs from the stored model; see `robocell verify");
}

TEST_F(RecordedSceneTest, RewritesALostManifestForTheSameRun) {
  RunConfig run = OwnRun(machine);
  Record(run);
  const std::string manifest = ReadManifest(run.output).value();
  fs::remove(machine / "out/dataset.json");
  EXPECT_TRUE(Verify(run.output).ok());
  EXPECT_THAT(Verify(run.output).Text(),
              HasSubstr("dataset.json: there is none; `robocell generate`"));
  run.task.As<PickTaskConfig>().lift_height *= 2;
  ExpectThrow<SpecError>([&] { PrepareDataset(run); }, "task.lift_height: ");
  run.task.As<PickTaskConfig>().lift_height /= 2;
  const fs::path model = machine / "robot/rc7.xml";
  const std::string text = ReadFile(model);
  AtomicWrite(model, text + " ");
  ExpectThrow<SpecError>([&] { PrepareDataset(run); }, "model file rc7.xml: changed since then");
  AtomicWrite(model, text);
  PrepareDataset(run);
  EXPECT_EQ(ReadManifest(run.output), manifest);
}

TEST_F(RecordedSceneTest, QuarantinesAndRewritesADamagedManifest) {
  const RunConfig run = OwnRun(machine);
  Record(run);
  const std::string manifest = ReadManifest(run.output).value();
  AtomicWrite(machine / "out/dataset.json", "{");
  const RepairResult repaired = Repair(run.output);
  EXPECT_THAT(repaired.moved, ElementsAre("dataset.json"));
  EXPECT_TRUE(repaired.remaining.empty());
  PrepareDataset(run);
  EXPECT_EQ(ReadManifest(run.output), manifest);
}

TEST_F(RecordedSceneTest, VerifyNamesModelsThatAreDamagedOrMissing) {
  const RunConfig run = OwnRun(machine);
  const Episode episode = Record(run);
  const fs::path dataset = machine / "out", stored = dataset / episode.models().begin()->second;
  const fs::path folder = fs::path("models") / stored.parent_path().filename();
  AtomicWrite(stored, ReadFile(stored) + " ");
  const RepairResult repaired = Repair(dataset);
  ASSERT_EQ(repaired.found.problems.size(), 1u) << repaired.found.Text();
  EXPECT_EQ(repaired.found.problems[0].Text(),
            (folder / stored.filename()).string() + ": its hash does not match its bytes");
  EXPECT_THAT(repaired.found.good, ElementsAre("s0000_e0000"));
  EXPECT_THAT(repaired.moved, ElementsAre(stored.parent_path().filename().string()));
  ASSERT_EQ(repaired.remaining.size(), 1u);
  EXPECT_EQ(repaired.remaining[0].Text(),
            folder.string() +
                ": it is missing; 1 episode can be read, not replayed. `robocell generate` with "
                "the run's file stores it again");
  PrepareDataset(run);
  EXPECT_TRUE(Verify(dataset).ok()) << Verify(dataset).Text();
}

// The mesh names the asset folder, and is in another file.
TEST_F(RecordedSceneTest, AMeshOfAnIncludedFileIsKeptAndItsChangeIsSeen) {
  RunConfig run = OwnRun(machine);
  const fs::path table = machine / "table.xml";
  std::string text = ReadFile(table);
  const size_t end = text.find('>', text.find("<mujoco")) + 1;
  text.insert(end, "<include file='a.xml'/><include file='b.xml'/>");
  AtomicWrite(table, text);
  AtomicWrite(machine / "a.xml",
              "<mujoco><asset><mesh name='s' file='s.obj'/></asset><worldbody><geom type='mesh' "
              "mesh='s' pos='5 5 0'/></worldbody></mujoco>");
  AtomicWrite(machine / "b.xml", "<mujoco><compiler meshdir='meshes'/></mujoco>");
  fs::create_directory(machine / "meshes");
  const std::string mesh =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  AtomicWrite(machine / "meshes/s.obj", mesh);
  Record(run);
  AtomicWrite(machine / "meshes/s.obj", mesh + "# changed\n");
  ExpectThrow<SpecError>([&] { PrepareDataset(run); }, "meshes/s.obj: changed since then");
  fs::rename(machine / "out", other);
  fs::remove_all(machine);
  EXPECT_TRUE(VerifyReplay(Dataset(other).Open("s0000_e0000"), {.tolerance = 0}).ok());
}

using nlohmann::json;

// Ten boxes have 60 degrees of freedom.
SceneSpec ManyBoxes(int count) {
  SceneSpec spec{.name = "boxes", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  for (int i = 0; i < count; ++i) {
    spec.objects.push_back({.name = "box" + std::to_string(i),
                            .shape = Shape::kBox,
                            .size = Vec3{0.02, 0.02, 0.02},
                            .rgba = Vec4{1, 0.5, 0, 1},
                            .mass = 0.1,
                            .friction = Vec3{0.8, 0.02, 0.001},
                            .pos = Vec3{0.1 * i, 0, 0.02}});
  }
  return spec;
}

TEST(EngineRecord, NamesJacobianSolverAndGuards) {
  EXPECT_EQ(EngineRecord(Scene::Build(ManyBoxes(3))),
            json::parse(R"({"jacobian": "auto", "solver": "newton", "guards": []})"));
  if (KnownEngineDefects().empty()) GTEST_SKIP() << "this engine has no known defect";
  Scene guarded = Scene::Build(ManyBoxes(10));
  EXPECT_EQ(EngineRecord(guarded), json::parse(R"({"jacobian": "dense", "solver": "newton",
                                                   "guards": ["sparse_newton"]})"));
  guarded.mutable_model()->opt.jacobian = mjJAC_SPARSE;
  EXPECT_EQ(EngineRecord(guarded),
            json::parse(R"({"jacobian": "sparse", "solver": "newton", "guards": []})"));
  SceneSpec overruled = ManyBoxes(10);
  overruled.options.jacobian = JacobianKind::kSparse;
  EXPECT_EQ(EngineRecord(Scene::Build(overruled)),
            json::parse(R"({"jacobian": "sparse", "solver": "newton", "guards": []})"));
}

TEST(EngineRecord, IsRestoredWithAnyEngine) {
  const auto Restored = [](const char* metadata, SceneSpec spec = ManyBoxes(10)) {
    RestoreEngine(json::parse(metadata), spec, "episode 'e'");
    return spec.options.jacobian;
  };
  EXPECT_EQ(Restored(R"({"engine": {"jacobian": "dense", "guards": ["sparse_newton"]}})"),
            JacobianKind::kDense);
  EXPECT_EQ(Restored(R"({"engine": {"jacobian": "auto", "guards": []}})"), std::nullopt);
  // The user set this in the model.
  EXPECT_EQ(Restored(R"({"engine": {"jacobian": "sparse", "guards": []}})"), JacobianKind::kSparse);
  EXPECT_EQ(Restored(R"({"engine": {"jacobian": "dense", "guards": []}})"), JacobianKind::kDense);
  // An episode that is older than the guard.
  EXPECT_EQ(Restored("{}"), JacobianKind::kAuto);
  SceneSpec own = ManyBoxes(10);
  own.options.jacobian = JacobianKind::kSparse;
  EXPECT_EQ(Restored("{}", own), JacobianKind::kSparse);
}

TEST(EngineRecord, NamesADamagedRecord) {
  for (const char* metadata :
       {R"({"engine": 5})", R"({"engine": null})", R"({"engine": "x"})", R"({"engine": []})",
        R"({"engine": {"guards": 5}})", R"({"engine": {"guards": "x"}})",
        R"({"engine": {"guards": [1]}})", R"({"engine": {"guards": {"a": 1}}})",
        R"({"engine": {"jacobian": 5}})", R"({"engine": {"jacobian": "spars"}})"}) {
    SceneSpec spec = ManyBoxes(1);
    ExpectThrow<SpecError>([&] { RestoreEngine(json::parse(metadata), spec, "episode 'e'"); },
                           "episode 'e': metadata.engine");
  }
}

}  // namespace
}  // namespace robocell
