#include "robocell/features/feature_source.h"

#include <algorithm>

namespace robocell {

int64_t FeatureSource::size() const {
  int64_t size = 0;
  for (const Feature& feature : features_) size += feature.size();
  return size;
}

void PutPose(const Pose& pose, std::span<double> out) {
  const Eigen::Vector3d& p = pose.translation();
  const Quaternion& q = pose.quaternion();
  std::copy_n(p.data(), 3, out.begin());
  std::copy_n(q.begin(), 4, out.begin() + 3);
}

Feature PoseFeature(const std::string& name, const std::string& frame, FeatureRole role,
                    const std::string& source, const std::string& description) {
  return {.column = {.name = name,
                     .shape = {kPoseNumbers},
                     .units = "m, 1",
                     .frame = frame,
                     .names = {"x", "y", "z", "qx", "qy", "qz", "qw"},
                     .description = description},
          .role = role,
          .source = source};
}

}  // namespace robocell
