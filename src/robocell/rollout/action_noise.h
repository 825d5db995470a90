// Noise of a run (`noise:`): on the targets of the arms, bounded in the space of the TCP, and at the
// start of an episode, where it displaces the arm.
//
//   DisplaceStart(run, start, rng);                            // before the episode begins
//   ActionNoise noise(robots, *run.noise, tick, rng);
//   each tick: cell.Send(action); cell.Send(noise.Perturb());  // what was intended, then the noise
//   noise.numbers();                                           // the intended targets
//
// The noise of a tick is its value a tick before, faded, and a random part: it pushes the arm off its
// path for a while, and the expert's next actions lead back. Arms without joint position targets, and
// targets near which inverse kinematics finds no solution, stay without noise.
#pragma once

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
  // Reads the present targets, which are the intended ones, and returns the action with noise.
  Action Perturb();
  // Returns the values of intended() at the last call of Perturb.
  std::span<const double> numbers() const { return numbers_; }

 private:
  struct Arm {
    Robot robot;
    std::string group;
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // shares of the bounds, in a unit ball
    Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
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
};

// Moves the arm of a start to a free posture near its own, within the run's bounds; it stays if there
// is none. Nothing without `noise`.
void DisplaceStart(const RunConfig& run, EpisodeStart& start, Rng& rng);

}  // namespace robocell::internal
