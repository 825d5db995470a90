// The features of a scene: its time, and the task's objects in the world frame and in the frames of
// each robot.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "robocell/features/feature_source.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/body_handle.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

class SceneFeatures final : public FeatureSource {
 public:
  // `objects`: their names. Throws NotFoundError for an unknown one.
  SceneFeatures(Scene given, std::vector<Robot> robots, const std::vector<std::string>& objects);

 private:
  void ReadNumbers(std::span<double> out) override;

  std::vector<Robot> robots_;
  std::vector<BodyHandle> objects_;
};

}  // namespace robocell::internal
