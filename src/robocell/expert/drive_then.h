// DriveThen: the expert of robots with planar bases. It drives the base to a place from which
// another expert finds a plan, and lets that one act there. It does not drive where the other expert
// finds a plan at once.
//
// Places are those from which grasps of the object are in reach (task/work_stances.h), by the
// shortest way first. The other expert plans from them in a copy of the scene, before the robot
// drives.
//
// Phases: turn, drive, settle, and those of the other expert. Failures: no place to stand, no way
// leads there, the base is blocked, and those of the other expert.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/expert/expert.h"
#include "robocell/expert/navigate_expert.h"
#include "robocell/motion/floor_map.h"
#include "robocell/robot/robot.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task_sampler.h"

namespace robocell::internal {

class DriveThen final : public Expert {
 public:
  static constexpr const char* kNoStance = "no place to stand from where the object is in reach";

  using MakeExpert = std::function<std::shared_ptr<Expert>()>;
  DriveThen(const RunConfig& run, const EpisodeStart& start, MakeExpert make);

  void Begin(const Scene& scene, Rng& rng) override;
  void See(const CellRow& row) override;
  Action Act(const Scene& scene, Rng& rng) override;
  bool done() const override { return works_ ? expert_->done() : !failure_.empty(); }
  std::string failure() const override { return works_ ? expert_->failure() : failure_; }
  bool ends_at_success() const override { return expert_->ends_at_success(); }
  int phase() const override;
  std::vector<std::string> phase_names() const override;
  std::string results_json() const override { return expert_->results_json(); }

 private:
  bool BeginsWork(const Scene& scene, Rng& rng);
  void PlanDrive(const Scene& scene, Rng& rng);
  bool CanWorkAt(Scene& copy, const Pose& base, Rng& rng) const;
  void Reject(const FloorPlace& place);

  std::string robot_name_, object_;
  double tick_;
  MakeExpert make_;
  std::shared_ptr<Expert> expert_;
  std::optional<Robot> robot_;
  std::optional<GuidedBase> base_;
  std::vector<FloorPlace> rejected_;
  FloorPlace goal_;
  bool works_ = false;  // the other expert acts
  int waited_ = 0, drives_ = 0, phase_ = 0;
  std::string failure_;
};

// Returns the expert that `make` makes, for a robot that drives one that takes it to its work.
std::shared_ptr<Expert> WithDrive(const RunConfig& run, const EpisodeStart& start,
                                  DriveThen::MakeExpert make);

}  // namespace robocell::internal
