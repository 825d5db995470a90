// AnyArm: an expert with one expert for each arm of a robot, of which one acts in an episode: the
// first one that can begin, in the order of the distances of the arms' TCPs from the object. The other
// arms hold still.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/expert/expert.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task_sampler.h"

namespace robocell::internal {

// Returns names of arms, as of ArmsOfRun, by the distance of their TCPs from an object.
std::vector<std::string> NearestArms(const Scene& scene, std::vector<std::string> arms,
                                     const std::string& object);

// Returns the run with the arm of this name, as of ArmsOfRun, as its only one.
RunConfig WithArm(RunConfig run, const std::string& acting);

class AnyArm final : public Expert {
 public:
  struct Candidate {
    std::string arm;  // for Robot::Of
    std::shared_ptr<Expert> expert;
  };
  // At least one candidate.
  AnyArm(std::vector<Candidate> candidates, std::string object);

  void Begin(const Scene& scene, Rng& rng) override;
  void See(const CellRow& row) override { acting().See(row); }
  Action Act(const Scene& scene, Rng& rng) override { return acting().Act(scene, rng); }
  bool done() const override { return acting().done(); }
  std::string failure() const override { return acting().failure(); }
  int phase() const override { return acting().phase(); }
  std::vector<std::string> phase_names() const override { return acting().phase_names(); }
  // The acting expert's, with {"arm": "left"}.
  std::string results_json() const override;

 private:
  Expert& acting() const { return *candidates_[acting_].expert; }

  std::vector<Candidate> candidates_;
  std::string object_;
  size_t acting_ = 0;
};

}  // namespace robocell::internal
