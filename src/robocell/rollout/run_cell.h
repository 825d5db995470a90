// RunCell: the cell of a run at one start: its clock and task, its features and its images. Rollouts
// (rollout.h) and runs as environments (run_env.h) act in it and observe it.
//
//   RunCell cell(run, start, renderer);      // begins the task's episode
//   const CellRow row = cell.Row();          // what an episode records before an action
//   CellStep step = cell.cell.Step({.send = ...});
//
// The start, which has a bound task, and the renderer have to outlive it.
#pragma once

#include <string>

#include "robocell/env/cell.h"
#include "robocell/features/cell_features.h"
#include "robocell/features/cell_images.h"
#include "robocell/features/cell_row.h"
#include "robocell/render/renderer.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task_sampler.h"

namespace robocell::internal {

struct RunCell {
  // `renderer` may be null for a run without streams. `place` begins messages about the task.
  RunCell(const RunConfig& run, const EpisodeStart& start, Renderer* renderer,
          std::string place = "");

  // Returns what was read last, with ReadState and Draw.
  CellRow Row() const { return {features.observed(), features.state(), images}; }

  Cell cell;
  CellFeatures features;
  CellImages images;
};

}  // namespace robocell::internal
