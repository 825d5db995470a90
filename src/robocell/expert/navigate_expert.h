// NavigateExpert: drives a robot with a planar base along the shortest way of its task
// (task/navigate_task.h). It turns on the spot and drives straight, each from rest to rest within
// the speeds of the task; the base's servos follow.
//
// Phases: turn, drive, settle, done. Failures: no way leads there, the base is blocked.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/expert/expert.h"
#include "robocell/expert/expert_kind.h"
#include "robocell/math/pose.h"
#include "robocell/motion/floor_map.h"
#include "robocell/robot/robot.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/navigate_task.h"
#include "robocell/task/task_sampler.h"

namespace robocell::internal {

// The targets of a planar base along a way of its drive frame (robot/planar_motion.h), one per
// policy tick.
class GuidedBase {
 public:
  // Largest speeds, m/s and rad/s; `tick`: seconds between targets.
  struct Speeds {
    double drive = 0.6, turn = 1.2;
  };
  GuidedBase(const Robot& robot, std::span<const FloorPlace> way, const Speeds& speeds,
             double tick);

  // Returns the next target of the base's joints; at the end the last one again.
  const std::vector<double>& Next();
  bool finished() const { return next_ >= targets_.size(); }
  bool turns() const;   // true while the present target is one of a turn
  bool Blocked();       // far behind its targets for a while; call once per tick
  bool AtRest() const;  // at the end of the way, without speed

 private:
  struct Target {
    std::vector<double> joints;
    Pose pose;  // of the base
    bool turns;
  };
  struct Lag {
    double place, turn;  // m and rad, of the base behind its target
  };
  Lag lag() const;

  Robot robot_;
  double tick_;
  std::vector<Target> targets_;
  std::vector<double> joints_;  // the present target
  Pose present_;
  size_t next_ = 0;
  int lagging_ = 0;
};

class NavigateExpert final : public Expert {
 public:
  NavigateExpert(std::string robot, std::shared_ptr<const NavigateTask> task, double tick);
  // Makes the expert of a run. Throws SpecError for another task.
  NavigateExpert(const RunConfig& run, const EpisodeStart& start);

  void Begin(const Scene& scene, Rng& rng) override;
  Action Act(const Scene& scene, Rng& rng) override;
  bool done() const override { return finished_; }
  std::string failure() const override { return failure_; }
  int phase() const override { return static_cast<int>(phase_); }
  std::vector<std::string> phase_names() const override {
    return {"turn", "drive", "settle", "done"};
  }

 private:
  enum class Phase { kTurn, kDrive, kSettle, kDone };

  std::string robot_name_;
  std::shared_ptr<const NavigateTask> task_;
  double tick_;
  std::optional<Robot> robot_;
  std::optional<GuidedBase> base_;
  Phase phase_ = Phase::kTurn;
  int waited_ = 0;
  bool finished_ = false;
  std::string failure_;
};

std::shared_ptr<const ExpertKind> MakeNavigateExpert();

}  // namespace robocell::internal
