// Runs of robots that drive, in the room of the built-in table.
#pragma once

#include <string>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/navigate_task_config.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/task_sampler.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {

// The mobile manipulator drives to the table.
inline RunConfig DrivesToTheTable() {
  RunConfig run = ExampleRun("tasks/navigate.yaml");
  run.scenes = SceneSourceSpec("tabletop");
  run.cameras.streams.clear();
  NavigateTaskConfig task;
  task.to = "table";
  task.within = 0.6;
  task.facing = 0.4;
  run.task = TaskSpec(task);
  return run;
}

// The mobile manipulator picks a box from the table.
inline RunConfig PicksFromTheTable() {
  RunConfig run = ExampleRun("mobile/pick.yaml");
  run.scenes = SceneSourceSpec("tabletop");
  run.cameras.streams.clear();
  PickTaskConfig task;
  task.objects = {"box"};
  run.task = TaskSpec(task);
  return run;
}

// Returns the first start that the sampler accepts. Throws Error after 20 refusals.
inline EpisodeStart StartOf(TaskSampler& sampler, int seed) {
  std::string why;
  for (int attempt = 0; attempt < 20; ++attempt) {
    Rng rng = Rng::Stream(seed, "start", attempt);
    SampleResult sample = sampler.Sample({.episode = seed, .attempt = attempt}, rng);
    if (sample.start) return *std::move(sample.start);
    why += sample.refusal.reason + ": " + sample.refusal.detail + "\n";
  }
  throw Error("no start: " + why);
}

}  // namespace robocell
