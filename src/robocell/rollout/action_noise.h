// Noise of a run (`noise:`): on the targets of the arms, bounded in the space of the TCP, and at the
// start of an episode, where it displaces the arm.
//
//   DisplaceStart(run, start, rng);                            // before the episode begins
//   ActionNoise noise(robots, *run.noise, tick, rng);
//   each tick:
//     cell.Send(noise.Intended());  // takes the noise of the last tick away
//     cell.Send(action);
//     cell.Send(noise.Perturb());   // what was intended, with noise
//   noise.numbers();                // the intended targets
//
// The noise of a tick is its value a tick before, faded, and a random part: it pushes the arm off its
// path for a while, and the expert's next actions lead back. An arm that an action leaves out keeps its
// intended target, with new noise; a relative command is added to the intended target. Arms without
// joint position targets, and targets near which inverse kinematics finds no solution, stay without
// noise; without_noise() counts these actions.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/base/rng.h"
#include "robocell/data/feature_schema.h"
#include "robocell/features/robot_features.h"
#include "robocell/robot/action.h"
#include "robocell/robot/robot.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task_sampler.h"

namespace robocell::internal {

class ActionNoise {
 public:
  // `tick`: seconds between actions.
  ActionNoise(const std::vector<Robot>& robots, const ActionNoiseConfig& config, double tick,
              const Rng& rng);

  // The columns robots/<robot>/intended/<group> and .../intended/tcp_pose.
  const FeatureSchema& intended() const { return schema_; }
  // Returns the action that sends the arms to their intended targets; empty before Perturb.
  Action Intended() const;
  // Reads the present targets, which are the intended ones, and returns the action with noise.
  Action Perturb();
  // Returns the action that Perturb returned last.
  const Action& noisy() const { return noisy_; }
  // Returns the values of intended() at the last call of Perturb.
  std::span<const double> numbers() const { return numbers_; }
  // Returns how many actions there were, and how many of them stayed without noise for an arm.
  int actions() const { return actions_; }
  int without_noise() const { return without_; }

 private:
  struct Arm {
    Robot robot;
    std::string group;
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // shares of the bounds, in a unit ball
    Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
    std::vector<double> intended = {};  // its target without noise; empty before the first tick
  };
  struct Targets {
    RobotActions actions;
    std::vector<double> all;     // all numbers of the actions
    std::vector<size_t> chosen;  // indices of those that are recorded
  };
  void Advance(Eigen::Vector3d& share);

  ActionNoiseConfig config_;
  double kept_;  // share of the noise that a tick keeps
  Rng rng_;
  std::vector<Arm> arms_;
  std::vector<Targets> targets_;
  FeatureSchema schema_;
  std::vector<double> numbers_;
  Action noisy_;
  int actions_ = 0, without_ = 0;
};

// Moves the arm of a start to a free posture near its own, within the run's bounds. Returns true if it
// did. If there is no such posture, the arm stays, with a warning, and the result is false. Unset if
// the run displaces no starts.
std::optional<bool> DisplaceStart(const RunConfig& run, EpisodeStart& start, Rng& rng);

}  // namespace robocell::internal
