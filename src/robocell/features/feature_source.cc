#include "robocell/features/feature_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/hook_error.h"

namespace robocell {

int64_t FeatureSource::size() const {
  int64_t size = 0;
  for (const Feature& feature : features_) size += feature.size();
  return size;
}

void FeatureSource::RequireFinite(size_t feature, std::span<const double> numbers) const {
  const auto bad = std::ranges::find_if_not(numbers, [](double x) { return std::isfinite(x); });
  if (bad == numbers.end()) return;
  throw HookError(fmt::format("feature '{}' is {} at t = {:.3f} s; features must be finite",
                              features_[feature].column.name, *bad, scene_.time()),
                  PlaceOf(feature));
}

void FeatureSource::Read(std::span<double> out) {
  ReadNumbers(out);
  if (!is_users()) return;
  for (size_t i = 0; i < features_.size(); ++i) {
    const std::span<double> numbers = out.first(static_cast<size_t>(features_[i].size()));
    RequireFinite(i, numbers);
    out = out.subspan(numbers.size());
  }
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
