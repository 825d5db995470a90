#include "robocell/rollout/drawn_check.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <numeric>

#include "robocell/base/error.h"
#include "robocell/features/feature_source.h"

namespace robocell::internal {

DrawnCheck::DrawnCheck(const Scene& scene, const FeatureSchema& observed) {
  size_t at = 0;
  for (const Feature& feature : observed.features()) {
    for (const ObjectRecord& object : scene.compiled()->objects()) {
      if (feature.column.name != "objects/" + object.name + "/pose") continue;
      const int body = mj_name2id(scene.model(), mjOBJ_BODY, object.root_body.c_str());
      objects_.push_back({object.name, body, at});
    }
    at += static_cast<size_t>(feature.size());
  }
}

void DrawnCheck::Require(const std::string& episode, int64_t row, std::span<const double> observed,
                         StateDrawer& drawer) const {
  constexpr double kTolerance = 1e-9;  // m, and 1 - |cos(angle / 2)|
  for (const Object& object : objects_) {
    const Pose drawn = drawer.DrawnPose(object.body);
    std::array<double, kPoseNumbers> numbers;
    PutPose(drawn, numbers);
    const std::span<const double> recorded = observed.subspan(object.at, kPoseNumbers);
    // A quaternion and its negative are the same rotation.
    const double turned =
        std::inner_product(numbers.begin() + 3, numbers.end(), recorded.begin() + 3, 0.0);
    const bool same = std::abs(numbers[0] - recorded[0]) <= kTolerance &&
                      std::abs(numbers[1] - recorded[1]) <= kTolerance &&
                      std::abs(numbers[2] - recorded[2]) <= kTolerance &&
                      std::abs(turned) >= 1 - kTolerance;
    if (same) continue;
    throw Error(fmt::format(
        "episode '{}', row {}: object '{}' is drawn at ({:.6f}, {:.6f}, {:.6f}) m and recorded "
        "at ({:.6f}, {:.6f}, {:.6f}) m, or turned otherwise; the episode is not kept",
        episode, row, object.name, numbers[0], numbers[1], numbers[2], recorded[0], recorded[1],
        recorded[2]));
  }
}

}  // namespace robocell::internal
