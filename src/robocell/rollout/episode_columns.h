// The columns of a recorded episode, row by row: everything but the images. See docs/data.md for the
// list. Row i holds the state before action i; the action and its outcome are added to the same row.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "robocell/data/episode_schema.h"
#include "robocell/data/episode_writer.h"
#include "robocell/data/feature_schema.h"
#include "robocell/mujoco/warnings.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

// Features of floating point numbers as columns.
class FeatureColumns {
 public:
  FeatureColumns(EpisodeSchema& schema, const FeatureSchema& features);
  // The numbers of all features, one after another.
  void Put(EpisodeWriter& writer, std::span<const double> numbers) const;

 private:
  struct Column {
    ColumnId id;
    size_t size;
  };
  std::vector<Column> columns_;
};

// What an action led to.
struct RowOutcome {
  double reward = 0, progress = 0;
  int subtask = 0;
  bool success = false;
  bool terminated = false, truncated = false;
  bool ik_failed = false;  // a pose command had no solution: its group kept its target
  int warnings = 0;        // of the engine, since the start of the episode
};

// What is said about a row, and the control table.
class OutcomeColumns {
 public:
  // `subtasks`: of the task; without any there is no such column.
  OutcomeColumns(EpisodeSchema& schema, Scene scene, std::vector<std::string> phases,
                 std::vector<std::string> subtasks);
  // The labels among the columns.
  const FeatureSchema& labels() const { return labels_; }
  // Engine warnings since this object was made: those of the start's making are not the episode's.
  EngineWarnings warnings() const { return ReadWarnings(scene_.data()) - warnings_before_; }
  // ArgumentError for what an expert or a task may not say. PutPhase and PutOutcome check it too.
  void RequirePhase(int phase) const;
  void RequireOutcome(const RowOutcome& outcome) const;
  void PutPhase(EpisodeWriter& writer, int phase);
  void PutOutcome(EpisodeWriter& writer, const RowOutcome& outcome);
  // The control table: one row per control tick, what acts on the engine from `time` on.
  void PutControl(EpisodeWriter& writer, double time, std::span<const double> ctrl);

 private:
  ColumnId AddLabel(EpisodeSchema& schema, ColumnSpec column);

  Scene scene_;
  std::vector<std::string> phases_, subtasks_;
  FeatureSchema labels_;
  ColumnId phase_, reward_, progress_, subtask_, success_, terminated_, truncated_, ik_failed_,
      warnings_;
  EngineWarnings warnings_before_;
  TableId control_;
  ColumnId control_time_, control_ctrl_;
};

}  // namespace robocell::internal
