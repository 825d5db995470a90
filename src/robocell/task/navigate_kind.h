// The kind of task `navigate`, and the sampler of its starts: a StartSampler whose robot stands
// anywhere on the free floor.
#pragma once

#include <memory>
#include <optional>

#include "robocell/task/start_sampler.h"
#include "robocell/task/task_kind.h"

namespace robocell::internal {

std::shared_ptr<const TaskKind> MakeNavigateKind();

// Starts of robots that drive: their bases are drawn all over the free floor.
class FloorStartSampler : public StartSampler {
 public:
  using StartSampler::StartSampler;
  SampleResult Sample(const SampleRequest& request, Rng& rng) override;
  std::optional<Pose> ProposeBasePose(const Robot& robot, const Support& support,
                                      const Pose& target_in_world, const BasePlacement& placement,
                                      Rng& rng) override;

 private:
  int scene_ = 0;
};

// Adds a problem for a robot whose base no actuators move in a plane.
void ValidateDrivenPlanarBase(const RobotConfig& robot, Problems& problems);

}  // namespace robocell::internal
