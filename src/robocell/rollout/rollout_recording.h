// RolloutRecording: records one rollout in its cell, and how long that takes. Rows without images are
// written as they happen. Rows with images are drawn and written by threads of their own
// (row_queue.h), one for each renderer: beside the rollout or, if only kept rollouts are drawn, after
// it. The bytes do not depend on the number of threads.
//
//   RolloutRecording recording(run, start, cell, phases, portable, options, times);
//   recording.PutState([&] { return expert.phase(); });         // before each action ...
//   recording.LetLook([&] { expert.See(cell.Row()); });
//   recording.PutOutcome(outcome);                              // ... and after it
//   recording.Finish() && recording.Commit(summary);
//
// Without Commit nothing stays on the disk. One thread at a time.
#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/features/cell_images.h"
#include "robocell/rollout/action_noise.h"
#include "robocell/rollout/drawn_check.h"
#include "robocell/rollout/episode_recording.h"
#include "robocell/rollout/exact_replay.h"
#include "robocell/rollout/rollout.h"
#include "robocell/rollout/row_queue.h"
#include "robocell/rollout/run_cell.h"
#include "robocell/rollout/stage_clock.h"
#include "robocell/rollout/state_drawer.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

// What a rollout has beside its cell; null for what it has not.
struct RolloutParts {
  const ActionNoise* noise = nullptr;  // its intended actions are recorded
  ExactReplay* replay = nullptr;       // gets the controls of each tick
};

class RolloutRecording {
 public:
  // `phases`: names of the expert's phases. All that is passed has to outlive it.
  RolloutRecording(const RunConfig& run, const EpisodeStart& start, RunCell& in,
                   const std::vector<std::string>& phases, const PortableScene& portable,
                   const RolloutOptions& options, RolloutTimes& times,
                   const RolloutParts& parts = {});
  ~RolloutRecording();
  RolloutRecording(const RolloutRecording&) = delete;
  RolloutRecording& operator=(const RolloutRecording&) = delete;

  // `phase`: returns the expert's, once it is valid.
  void PutState(const std::function<int()>& phase);
  void RequirePhase(int phase) const { episode_.RequirePhase(phase); }
  // Calls the expert, which may look at images. Throws what went wrong while they were drawn, which
  // is not the expert's fault. Returns false if the stop request came first.
  bool LetLook(const std::function<void()>& call) const;
  // Returns false if the stop request came first.
  bool PutOutcome(const RowOutcome& outcome);
  // Throws what writing rows beside the rollout has met so far: an attempt on a full disk is no
  // ordinary failure.
  void RequireWritten();
  // Waits until all rows are written. Returns false if the stop request came first.
  bool Finish();
  // Returns false if the stop request came first.
  bool Commit(const EpisodeSummary& summary);
  // Returns the clock for other stages, which stop while this one records.
  StageClock& clock() { return clock_; }
  EngineWarnings warnings() const { return episode_.warnings(); }

 private:
  void PutControl(const mjModel* model, const mjData* data);
  void Open();
  bool FinishRows();
  // Repeats an action whose encoder was killed, after all rows were drawn and encoded again, so
  // that a killed encoder costs time and no episode. Returns false if the stop request came first;
  // so does the action.
  template <class Action>
  bool WithEncoders(const Action& action);
  bool Restart();
  void StartQueue(RowQueue::Begin begin);
  // What one thread draws with.
  struct Drawer {
    Drawer(const Scene& scene, std::unique_ptr<CellImages> owned, CellImages& drawn)
        : own(std::move(owned)), images(drawn), states(scene, drawn) {}
    std::unique_ptr<CellImages> own;  // null for the first one, which draws the cell's
    CellImages& images;
    StateDrawer states;
  };
  // Draws and writes a row. With images both run on a thread of the queue and use nothing of the
  // simulation, the task or the expert.
  void Draw(EpisodeRow& row, int thread);
  void Write(EpisodeRow& row, int thread);
  // Draws the images of the present row for a policy that looks at them. From then on they are drawn
  // in every row, as a policy that looks once looks again.
  void DrawForPolicy();
  void DrawNow();

  RolloutTimes& times_;
  const RolloutOptions& options_;
  std::string place_;
  RunCell& in_;
  RolloutParts parts_;
  StageClock clock_;
  EpisodeRecording episode_;
  const bool has_images_;
  const bool stores_;  // without it, images are drawn for the policy only
  const bool draws_later_;
  std::vector<std::unique_ptr<Drawer>> drawers_;  // of each thread
  DrawnCheck check_;
  EpisodeRow row_;                                 // the present one
  std::vector<std::shared_ptr<EpisodeRow>> rows_;  // with images: until the commit
  int restarts_ = 0;
  bool is_looked_at_ = false;
  bool is_stopped_ = false;  // while images were to be drawn for the policy
  std::exception_ptr draw_failure_;
  std::optional<RowQueue> queue_;  // ends before what it uses
};

}  // namespace robocell::internal
