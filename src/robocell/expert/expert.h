// Expert: acts in an episode, one action per policy tick. It may look at the simulation, and it gets
// what is recorded of the state: scripted planners (pick_planner.h), policies and teleoperation are
// experts. Users can subclass it, in C++ or Python, and register it by name (expert_kind.h).
//
// Randomness only comes from the Rng that is passed in.
#pragma once

#include <string>
#include <vector>

#include "robocell/base/hook_error.h"
#include "robocell/base/rng.h"
#include "robocell/features/cell_row.h"
#include "robocell/robot/action.h"
#include "robocell/scene/scene.h"

namespace robocell {

class Expert : public Hooks {
 public:
  virtual void Begin(const Scene& scene, Rng& rng) = 0;
  // Receives, before each Act, what is recorded of the state: for policies that act from that
  // alone.
  virtual void See(const CellRow& /*row*/) {}
  // Returns the action of one policy tick for the present state.
  virtual Action Act(const Scene& scene, Rng& rng) = 0;
  virtual bool done() const = 0;  // finished or given up
  // Returns why it gave up, "" otherwise. A rollout that ends with a failure is not a success, even
  // if its task judges it as one.
  virtual std::string failure() const = 0;
  // Returns true if a rollout ends as soon as the task is done: for policies, which do not know it.
  virtual bool ends_at_success() const { return false; }
  virtual int phase() const = 0;  // index into phase_names(), for the record
  virtual std::vector<std::string> phase_names() const = 0;
  // Returns what the episode's results record of the expert, a JSON object: asked at the end.
  virtual std::string results_json() const { return "{}"; }
};

}  // namespace robocell
