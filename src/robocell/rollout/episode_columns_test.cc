#include "robocell/rollout/episode_columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/data/episode_reader.h"
#include "robocell/features/cell_features.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;

TEST(FeatureColumns, MatchTheFeatures) {
  const Robot robot = RobotAlone(Rc7());
  CellFeatures features(robot.scene(), {robot});
  EpisodeSchema schema;
  const FeatureColumns columns(schema, features.observed());
  const TempDir folder;
  EpisodeWriter writer(folder.path(), "e", schema, {.features = features.observed()});
  const std::span<const double> numbers = features.ReadState();
  ExpectThrow<ArgumentError>([&] { columns.Put(writer, numbers.first(numbers.size() - 1)); },
                             "a row has");
  ExpectThrow<ArgumentError>([&] { columns.Put(writer, {}); }, "a row has 0 numbers");
  columns.Put(writer, numbers);
  writer.EndRow();
  const Episode episode(writer.Commit({}));
  EXPECT_EQ(episode.features().DifferenceFrom(features.observed()), "");
  std::span<const double> rest = numbers;
  for (const Feature& feature : features.observed().features()) {
    const ColumnSpec& stored = episode.column(feature.column.name).spec;
    EXPECT_EQ(stored.units, feature.column.units);
    EXPECT_EQ(stored.frame, feature.column.frame);
    const auto size = static_cast<size_t>(feature.size());
    EXPECT_EQ(
        episode.Read<double>(feature.column.name),
        (std::vector<double>(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(size))));
    rest = rest.subspan(size);
  }
}

struct Labels {
  explicit Labels(std::vector<std::string> subtasks = {})
      : columns(schema, RobotAlone(Rc7()).scene(), {"go", "stop"}, std::move(subtasks)),
        writer(folder.path(), "e", schema) {}
  TempDir folder;
  EpisodeSchema schema;
  OutcomeColumns columns;
  EpisodeWriter writer;
};

TEST(OutcomeColumns, ContainTheOutcomeOfAnAction) {
  Labels labels({"pick", "place"});
  labels.columns.PutPhase(labels.writer, 1);
  labels.columns.PutOutcome(labels.writer, {{.reward = 0.5, .progress = 0.25, .subtask = 1}});
  labels.writer.EndRow();
  const Episode episode(labels.writer.Commit({}));
  EXPECT_THAT(episode.Read<double>("progress"), ElementsAre(0.25));
  EXPECT_THAT(episode.Read<int32_t>("subtask"), ElementsAre(1));
  EXPECT_THAT(episode.column("subtask").spec.values, ElementsAre("pick", "place"));
  EXPECT_THAT(labels.columns.labels().Names(FeatureRole::kLabel),
              ElementsAre("phase", "reward", "progress", "subtask", "success", "terminated",
                          "truncated", "ik_failed", "engine_warnings"));
}

TEST(OutcomeColumns, RejectInvalidPhases) {
  Labels labels;
  ExpectThrow<ArgumentError>([&] { labels.columns.PutPhase(labels.writer, 2); },
                             "the expert's phase() is 2; it must be 0 to 1");
}

}  // namespace
}  // namespace robocell::internal
