// PickEnvTask: pick up an object that lies around its place in the root frame, turned about the
// root frame's z. The reward, 0 to 1, is half for a TCP near the object and half for its height; at
// success it is 1. Private to env: EnvTaskConfig::kind "pick".
#pragma once

#include "robocell/env/object_task.h"

namespace robocell {

class PickEnvTask final : public ObjectTask {
 public:
  using ObjectTask::ObjectTask;

  BodyPoses Starts(Rng& rng) override { return {{object().name(), root() * Start(rng)}}; }
  bool Success(const Scene& scene) override { return IsLifted(scene); }
  std::string instruction() const override { return "pick up the " + task().object; }

 private:
  double Progress() const override;
};

}  // namespace robocell
