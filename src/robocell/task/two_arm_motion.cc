#include "robocell/task/two_arm_motion.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <Eigen/Core>

#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/task/remembered_grasps.h"

namespace robocell::internal {
namespace {

// Few points with all directions of each: many points would leave the best ones, in the middle.
const GraspOptions kAllOver = {.samples = 200, .most = 2000};
constexpr double kLeastApart = 0.14;  // m between two hands
constexpr double kEndShare = 0.3;     // of the half length from the middle, at least
constexpr double kMostLevel = 0.6;    // -z of the approach, at least
constexpr size_t kMostOfArm = 24;     // grasps of each arm that are paired
constexpr double kUneven = 2;         // cost of 1 m between the two distances from the middle
constexpr double kUnevenAcross = 1;   // cost of 1 m between the two grasps across the length

struct Ended {
  Grasp grasp;
  double along = 0, across = 0;  // from the middle of the object, m
};

}  // namespace

std::vector<PairGrasp> PairGrasps(const Scene& scene, const std::array<Robot, 2>& arms,
                                  const std::string& body) {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  const int id = RequireId(m, mjOBJ_BODY, body, "scene '" + scene.name() + "'");
  const Pose at = scene.body_pose(body);
  // Its longer level axis, and the middle between its ends.
  double half[3], middle[3];
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d direction = at.rotation().col(axis);
    const Interval extent = BodyExtent(m, d, id, direction);
    half[axis] = (extent.upper - extent.lower) / 2;
    middle[axis] = (extent.upper + extent.lower) / 2 - at.translation().dot(direction);
  }
  int longest = -1, other = -1;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(at.rotation().col(axis).z()) > 0.7) continue;  // upright
    if (longest < 0 || half[axis] > half[longest]) {
      other = longest;
      longest = axis;
    } else {
      other = axis;
    }
  }
  if (longest < 0 || other < 0 || 2 * half[longest] < kLeastApart) return {};
  // The arm whose TCP is farther along the axis has that end.
  const Eigen::Vector3d axis = at.rotation().col(longest);
  const bool first_has_upper = arms[0].tcp_in_world().translation().dot(axis) >=
                               arms[1].tcp_in_world().translation().dot(axis);
  std::array<std::vector<Ended>, 2> ended;
  for (size_t arm = 0; arm < 2; ++arm) {
    const double sign = (arm == 0) == first_has_upper ? 1 : -1;
    const GraspSet grasps = RememberedGrasps(arms[arm], body, kAllOver);
    for (const Grasp& grasp : grasps.grasps) {
      const Eigen::Vector3d approach = Rotate(at.quaternion(), grasp.approach);
      if (-approach.z() < kMostLevel) continue;
      const Eigen::Vector3d& tcp = grasp.tcp_in_body.translation();
      const double along = sign * (tcp[longest] - middle[longest]);
      if (along < std::max(kEndShare * half[longest], kLeastApart / 2)) continue;
      ended[arm].push_back({grasp, along, tcp[other] - middle[other]});
    }
    std::ranges::stable_sort(ended[arm], {}, [](const Ended& e) { return -e.grasp.score; });
    if (ended[arm].size() > kMostOfArm) ended[arm].resize(kMostOfArm);
  }
  std::vector<PairGrasp> pairs;
  for (size_t i = 0; i < ended[0].size(); ++i) {
    for (size_t j = 0; j < ended[1].size(); ++j) {
      const Ended &a = ended[0][i], &b = ended[1][j];
      pairs.push_back({{a.grasp, b.grasp},
                       {i, j},
                       2 - a.grasp.score - b.grasp.score + kUneven * std::abs(a.along - b.along) +
                           kUnevenAcross * std::abs(a.across - b.across)});
    }
  }
  std::ranges::stable_sort(pairs, {}, &PairGrasp::cost);
  return pairs;
}

}  // namespace robocell::internal
