// DrivingStartSampler: starts of robots that drive to their work. It makes a start beside the task's
// object, as StartSampler does, so that the task can be done from there. Then it puts the robot
// anywhere on the free floor from where a way leads there, and its cameras see from there what they
// have to.
#pragma once

#include <memory>
#include <optional>

#include "robocell/task/start_sampler.h"

namespace robocell::internal {

class DrivingStartSampler : public StartSampler {
 public:
  static constexpr const char* kNoWay = "no way leads there";

  using StartSampler::StartSampler;
  // Takes any distance from which the arm may reach the target.
  std::optional<Pose> ProposeBasePose(const Robot& robot, const Support& support,
                                      const Pose& target_in_world, const BasePlacement& placement,
                                      Rng& rng) override;

 protected:
  std::optional<Refusal> MoveBase(const Robot& robot, int scene_index, Rng& rng) override;
};

// Returns the sampler of a kind whose expert drives robots on planar bases to the object.
std::shared_ptr<TaskSampler> MakeSamplerOfWork(const RunConfig& run);

}  // namespace robocell::internal
