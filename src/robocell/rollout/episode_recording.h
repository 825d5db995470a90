// EpisodeRecording: writes one episode of a cell, row by row: what the cell observed, what it was
// commanded, the outcome, the images and the controls of every tick. Generated episodes (rollout.h)
// and those of environments (env_recorder.h) are written by it, so that both have the same columns
// and the same metadata.
//
//   EpisodeRecording recording(scene, {features.observed(), features.commanded()});
//   recording.AddCameras(images.images(), rate);
//   recording.Begin(dataset, "episode-000000", metadata.dump(), portable);
//   recording.PutState(features.ReadState(), phase);     // once per row, in any order ...
//   recording.PutImages(images.images());
//   recording.PutCommands(features.ReadActions());
//   recording.PutOutcome(outcome);
//   recording.EndRow();
//   recording.PutControl(time, ctrl);                    // ... and once per control tick
//   recording.Commit({.success = true});
//
// Columns are declared before Begin, which writes down the engine's present state: a replay starts
// there. Begin is Describe and Open; a rollout whose images are drawn later opens the episode later
// too, and again once its encoder was killed. Throws the errors of the writer. One thread at a time.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <nlohmann/json_fwd.hpp>

#include "robocell/base/ratio.h"
#include "robocell/data/episode_writer.h"
#include "robocell/data/feature_schema.h"
#include "robocell/mujoco/warnings.h"
#include "robocell/rollout/episode_cameras.h"
#include "robocell/rollout/episode_columns.h"
#include "robocell/rollout/recorded_scene.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

struct EpisodeRates {
  double control_ms, sim_ms;
  std::optional<Ratio> rows = {};  // per second; unset if rows have no fixed rate
};

// Returns the metadata that all episodes have, whoever records them.
nlohmann::json EpisodeMetadata(const Scene& scene, const PortableScene& portable,
                               const std::string& instruction, const EpisodeRates& rates);

class EpisodeRecording {
 public:
  struct Columns {
    const FeatureSchema& observed;
    const FeatureSchema& commanded;
    std::vector<const FeatureSchema*> more = {};  // further numbers of a row: PutMore
    std::vector<std::string> phases = {}, subtasks = {};
  };
  EpisodeRecording(Scene scene, const Columns& columns);

  // Declarations, before Begin. Returns the column of a label, which is recorded with writer().Put.
  void AddCameras(std::span<const CellImage> images, const Ratio& rate,
                  FrameTimes times = FrameTimes::kOfRows);
  ColumnId AddLabel(ColumnSpec column, const std::string& source);

  void Begin(const std::filesystem::path& dataset, const std::string& id,
             const std::string& metadata_json, const PortableScene& portable,
             const std::vector<ConstantSpec>& constants = {});
  // Ends the declarations and keeps the initial state. `portable` has to outlive this object.
  void Describe(const std::filesystem::path& dataset, const std::string& id,
                const std::string& metadata_json, const PortableScene& portable,
                const std::vector<ConstantSpec>& constants = {});
  // Begins to write; rows of an earlier Open are dropped.
  void Open();
  bool is_open() const { return writer_.has_value(); }

  // Throws Error if the scene has other objects than at the beginning. `place` begins the message,
  // and `next_step` ends it.
  void RequireSameScene(const std::string& place, const std::string& next_step) const;
  void RequirePhase(int phase) const { outcome_.RequirePhase(phase); }
  // Returns the engine warnings since the beginning.
  EngineWarnings warnings() const { return outcome_.warnings(); }

  void PutState(std::span<const double> observed, int phase);
  void PutCommands(std::span<const double> commanded);
  // `which`: of Columns::more.
  void PutMore(size_t which, std::span<const double> numbers);
  void PutImages(std::span<const CellImage> images, std::span<const double> times = {});
  void PutOutcome(const RowOutcome& outcome) { outcome_.PutOutcome(*writer_, outcome); }
  void PutControl(double time, std::span<const double> ctrl) {
    outcome_.PutControl(*writer_, time, ctrl);
  }
  void EndRow() { writer_->EndRow(); }
  EpisodeWriter& writer() { return *writer_; }
  void Commit(const EpisodeSummary& summary) { writer_->Commit(summary); }

 private:
  Scene scene_;
  uint64_t generation_;
  FeatureSchema features_;  // of all columns but the labels
  EpisodeSchema schema_;
  FeatureColumns observed_, commanded_;
  std::vector<FeatureColumns> more_;
  OutcomeColumns outcome_;
  FeatureSchema labels_;  // of AddLabel
  std::optional<EpisodeCameras> cameras_;
  std::filesystem::path dataset_;
  std::string id_;
  EpisodeOptions options_;
  const PortableScene* portable_ = nullptr;
  std::optional<EpisodeWriter> writer_;
};

}  // namespace robocell::internal
