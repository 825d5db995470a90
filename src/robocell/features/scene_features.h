// The features of a scene: its time, and the task's objects in the world frame and in the frames of
// each robot.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "robocell/features/feature_source.h"
#include "robocell/features/observed_object.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

class SceneFeatures final : public FeatureSource {
 public:
  // `objects`: the names under which they are observed (observed_object.h). Throws NotFoundError for
  // an unknown one.
  SceneFeatures(Scene given, std::vector<Robot> robots, const std::vector<std::string>& objects,
                const ObjectOfName& object_of = {});

 private:
  void ReadNumbers(std::span<double> out) override;

  std::vector<Robot> robots_;
  std::vector<ObservedObject> objects_;
};

}  // namespace robocell::internal
