// Writes the columns of a recorded episode row by row: everything but the images. docs/data.md
// lists them. Row i holds the state before action i; the action and its outcome are added to the
// same row.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "robocell/data/episode_schema.h"
#include "robocell/data/episode_writer.h"
#include "robocell/data/feature_schema.h"
#include "robocell/mujoco/warnings.h"
#include "robocell/scene/scene.h"
#include "robocell/task/task.h"

namespace robocell::internal {

// Writes features of floating point numbers as columns.
class FeatureColumns {
 public:
  FeatureColumns(EpisodeSchema& schema, const FeatureSchema& features);
  // Writes the numbers of all features, one after another. Throws ArgumentError for another number
  // of them.
  void Put(EpisodeWriter& writer, std::span<const double> numbers) const;

 private:
  struct Column {
    ColumnId id;
    size_t size;
  };
  std::vector<Column> columns_;
};

// The labels of a row: the task's verdict on its action, and what it did to the episode.
struct RowLabels {
  bool terminated = false, truncated = false;
  bool ik_failed = false;  // a pose command had no solution: its group kept its target
  int warnings = 0;        // engine warnings since the start of the episode
};
struct RowOutcome : TaskVerdict, RowLabels {};

// Writes the labels of rows, and the control table.
class OutcomeColumns {
 public:
  // `subtasks`: those of the task; without any there is no such column.
  OutcomeColumns(EpisodeSchema& schema, Scene scene, std::vector<std::string> phases,
                 std::vector<std::string> subtasks);
  // Returns the labels among the columns.
  const FeatureSchema& labels() const { return labels_; }
  // Returns the engine warnings since this object was made; those of making the start do not belong
  // to the episode.
  EngineWarnings warnings() const { return ReadWarnings(scene_.data()) - warnings_before_; }
  // Throws ArgumentError for an invalid phase of an expert; PutPhase checks it too.
  void RequirePhase(int phase) const;
  void PutPhase(EpisodeWriter& writer, int phase);
  void PutOutcome(EpisodeWriter& writer, const RowOutcome& outcome);
  // Writes a row of the control table: the controls of one tick, which act on the engine from
  // `time` on.
  void PutControl(EpisodeWriter& writer, double time, std::span<const double> ctrl);

 private:
  ColumnId AddLabel(EpisodeSchema& schema, ColumnSpec column);

  Scene scene_;
  std::vector<std::string> phases_;
  bool has_subtasks_;
  FeatureSchema labels_;
  ColumnId phase_, reward_, progress_, subtask_, success_, terminated_, truncated_, ik_failed_,
      warnings_;
  EngineWarnings warnings_before_;
  TableId control_;
  ColumnId control_time_, control_ctrl_;
};

}  // namespace robocell::internal
