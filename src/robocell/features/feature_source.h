// FeatureSource: who makes some features of a cell (data/feature_schema.h) and reads their numbers
// from the simulation. Robots, objects, sensors and functions of a user's own are sources; a cell
// has several (cell_features.h).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "robocell/data/feature_schema.h"
#include "robocell/math/pose.h"

namespace robocell {

class FeatureSource {
 public:
  virtual ~FeatureSource() = default;
  const std::vector<Feature>& features() const { return features_; }
  int64_t size() const;
  // The numbers of all features in the scene's present state, one after another. `out` has size()
  // of them.
  virtual void Read(std::span<double> out) = 0;

 protected:
  void Add(Feature feature) { features_.push_back(std::move(feature)); }

 private:
  std::vector<Feature> features_;
};

// Position xyz (m) and quaternion xyzw.
inline constexpr int kPoseNumbers = 7;
void PutPose(const Pose& pose, std::span<double> out);
Feature PoseFeature(const std::string& name, const std::string& frame, FeatureRole role,
                    const std::string& source, const std::string& description);

}  // namespace robocell
