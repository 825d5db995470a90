// FeatureSource: defines some features of a cell (data/feature_schema.h) and reads their numbers
// from the simulation. Robots, objects, sensors and a user's own functions are sources; a cell has
// several (cell_features.h).
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/data/feature_schema.h"
#include "robocell/math/pose.h"
#include "robocell/scene/scene.h"

namespace robocell {

class FeatureSource {
 public:
  virtual ~FeatureSource() = default;
  const std::vector<Feature>& features() const { return features_; }
  int64_t size() const;
  // Writes the numbers of all features in the scene's present state, one after another. `out` has
  // size() numbers. They are not clipped to the range of their feature; observations may clip them.
  // Throws HookError that names a feature of a user's code whose numbers are not finite.
  void Read(std::span<double> out);

 protected:
  explicit FeatureSource(Scene scene) : scene_(std::move(scene)) {}
  // A user's code gets scene().outer().
  const Scene& scene() const { return scene_; }
  void Add(Feature feature) { features_.push_back(std::move(feature)); }

 private:
  virtual void ReadNumbers(std::span<double> out) = 0;
  // Returns true if a user's code computes the numbers, which must then be finite. The engine's
  // numbers are not checked.
  virtual bool is_users() const { return false; }
  // Returns where a user's code reads a feature (base/hook_error.h), for messages.
  virtual std::string PlaceOf(size_t /*feature*/) const { return ""; }
  void RequireFinite(size_t feature, std::span<const double> numbers) const;

  Scene scene_;
  std::vector<Feature> features_;
};

// Position xyz (m) and quaternion xyzw.
inline constexpr int kPoseNumbers = 7;
void PutPose(const Pose& pose, std::span<double> out);
Feature PoseFeature(const std::string& name, const std::string& frame, FeatureRole role,
                    const std::string& source, const std::string& description);

}  // namespace robocell
