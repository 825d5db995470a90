// Tests what all recorded episodes have, whoever records them; the columns of generated episodes and
// of environments are tested with their recorders.
#include "robocell/rollout/episode_recording.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <memory>
#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/data/episode_reader.h"
#include "robocell/features/cell_features.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

class EpisodeRecordingTest : public ::testing::Test {
 protected:
  EpisodeRecordingTest() {
    more.Add({.column = {.name = "more/number", .units = "m"}});
    recording = std::make_unique<EpisodeRecording>(
        robot.scene(), EpisodeRecording::Columns{.observed = features.observed(),
                                                 .commanded = features.commanded(),
                                                 .more = {&more},
                                                 .phases = {"go"}});
  }
  void Begin() {
    const auto metadata = EpisodeMetadata(robot.scene(), portable, "wait",
                                          {.control_ms = 4, .sim_ms = 2, .rows = Ratio{25, 2}});
    const ConstantSpec constant{.column = {.name = "its_own", .shape = {2}}, .values = {1, 2}};
    recording->Begin(folder.path(), "e", metadata.dump(), portable, {constant});
  }
  void PutRow(double number) {
    recording->PutState(features.ReadState(), 0);
    recording->PutCommands(features.ReadActions());
    recording->PutMore(0, {&number, 1});
    recording->PutOutcome({{.reward = number}});
    recording->EndRow();
    const std::vector<double> ctrl(static_cast<size_t>(robot.scene().model()->nu), number);
    recording->PutControl(number, ctrl);
  }

  TempDir folder;
  Robot robot = RobotAlone(Rc7());
  CellFeatures features{robot.scene(), {robot}};
  FeatureSchema more;
  PortableScene portable = MakePortable(robot.scene().spec());
  std::unique_ptr<EpisodeRecording> recording;
};

TEST_F(EpisodeRecordingTest, WritesRowsTicksAndTheStartForAReplay) {
  const ColumnId label =
      recording->AddLabel({.name = "its_label", .type = ColumnType::kInt64}, "a test");
  const std::vector<double> state = robot.scene().state();
  Begin();
  for (const double number : {0.5, 1.5}) {
    recording->writer().Put(label, static_cast<int64_t>(10 * number));
    PutRow(number);
  }
  recording->Commit({.success = true, .end_reason = "success"});
  const Episode episode(folder / "e");
  EXPECT_EQ(episode.Read<double>("initial_state"), state);
  EXPECT_EQ(episode.Read<double>("its_own"), (std::vector<double>{1, 2}));
  EXPECT_EQ(episode.Read<double>("more/number"), (std::vector<double>{0.5, 1.5}));
  EXPECT_EQ(episode.Read<int64_t>("its_label"), (std::vector<int64_t>{5, 15}));
  EXPECT_EQ(episode.Read<double>("control/time"), (std::vector<double>{0.5, 1.5}));
  for (const char* name : {"robots/rc7/arm/qpos", "more/number", "reward", "its_label"})
    EXPECT_NO_THROW(episode.features().Find(name)) << name;
}

TEST_F(EpisodeRecordingTest, MetadataNamesSceneEngineAndRates) {
  Begin();
  PutRow(0);
  recording->Commit({.success = true, .end_reason = "success"});
  const auto metadata = nlohmann::json::parse(Episode(folder / "e").metadata_json());
  EXPECT_EQ(metadata["instruction"], "wait");
  EXPECT_EQ(metadata["timestep"], robot.scene().timestep());
  EXPECT_EQ(metadata["rates"]["policy_ms"], 80);
  EXPECT_EQ(metadata["rates"]["policy_hz"], (std::vector<int>{25, 2}));
  EXPECT_EQ(metadata["rates"]["control_ms"], 4);
  EXPECT_TRUE(metadata.contains("engine"));
  EXPECT_NO_THROW(Scene::Build(RecordedScene(Episode(folder / "e"))));
  const auto free = EpisodeMetadata(robot.scene(), portable, "", {.control_ms = 2, .sim_ms = 2});
  EXPECT_FALSE(free["rates"].contains("policy_hz")) << "rows have no fixed rate";
}

TEST_F(EpisodeRecordingTest, AChangedSceneEndsTheRecording) {
  Begin();
  EXPECT_NO_THROW(recording->RequireSameScene("cell", "stop"));
  Scene scene = robot.scene();
  scene.AddObject(BoxObject("late", {1, 1, 1}));
  ExpectThrow<Error>([&] { recording->RequireSameScene("cell", "stop here"); },
                     "cell: objects were added or removed while an episode is recorded");
}

}  // namespace
}  // namespace robocell::internal
