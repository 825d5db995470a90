#include "robocell/task/base_placement.h"

#include <fmt/format.h>

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/hook_error.h"
#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/low_discrepancy.h"
#include "robocell/motion/clearance.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/render/stream_camera.h"
#include "robocell/scenes/visibility.h"
#include "robocell/spec/robot_config.h"
#include "robocell/task/base_stances.h"

namespace robocell {
namespace {

constexpr double kWidening = 0.15;        // share of the range that each further attempt spreads by
constexpr double kRangeTolerance = 1e-6;  // metres
constexpr double kHandLength = 0.15;      // m from a TCP to the farthest point of its gripper

bool CanMove(const mjModel* m, int body) {
  return m->body_weldid[body] != 0 || m->body_mocapid[m->body_rootid[body]] >= 0;
}

// Formats a length rounded down to the millimetre, so that a field with the printed value is
// accepted.
std::string AtMost(double metres) {
  return fmt::format("{:.3f}", std::floor(1000 * metres) / 1000);
}

// Reflects a number into [0, 1] at the ends.
double Reflected(double u) {
  u = std::abs(u);
  return u > 1 ? std::max(0.0, 2 - u) : u;
}

}  // namespace

BaseRange BaseRangeOf(const StartConfig& start, const BaseRange& of_task) {
  return {.distance = start.base_distance.value_or(of_task.distance),
          .height_offset = start.base_height_offset.value_or(of_task.height_offset),
          .height_noise = start.base_height_noise.value_or(of_task.height_noise)};
}

void RequireSound(const BaseRange& range) {
  const auto require = [](const char* what, const Vec2& pair, double least) {
    const auto& [smallest, largest] = pair;
    const bool is_finite = std::isfinite(smallest) && std::isfinite(largest);
    if (is_finite && smallest >= least && smallest <= largest) return;
    throw ArgumentError(
        fmt::format("the {} of a base range is [{:g}, {:g}]; it is [smallest, largest] in finite "
                    "metres{}",
                    what, smallest, largest, least == 0 ? ", from 0 on" : ""));
  };
  require("distance", range.distance, 0);
  require("height_noise", range.height_noise, -HUGE_VAL);
  if (std::isfinite(range.height_offset)) return;
  throw ArgumentError(fmt::format(
      "the height_offset of a base range is {}; it must be finite metres", range.height_offset));
}

BaseRangeOwners OwnersOfBaseRange(const StartConfig& start, const Hooks& task,
                                  const std::string& kind, const BaseRange& of_task) {
  const std::string place = task.PlaceOfHook("base_range");
  const auto own = [&](const char* what) {
    return NumberOwner{
        .field = "task",
        .method = fmt::format("the {} that base_range() of '{}' returns, ", what, kind),
        .written = place.empty() ? "" : " (" + place + ")"};
  };
  const BaseRange plain;
  BaseRangeOwners owners;
  if (!start.base_distance && of_task.distance != plain.distance) owners.distance = own("distance");
  if (!start.base_height_offset && of_task.height_offset != plain.height_offset)
    owners.height = own("height_offset");
  return owners;
}

void ValidateBaseRange(const BaseRange& base, const Robot& robot, Problems& problems,
                       const BaseRangeOwners& owners) {
  const auto add = [&](const NumberOwner& owner, const std::string& text) {
    problems.AddAt(owner.field, owner.method + text + owner.written);
  };
  // The offset from the bottom of the robot's pedestal, which is what is placed, to its base frame.
  const Eigen::Vector3d up = (robot.base().pose().inverse() * robot.base_in_world()).translation();
  const double most = kReachShare * robot.reach();
  const double low = base.height_offset + base.height_noise[0] + up.z(),
               high = base.height_offset + base.height_noise[1] + up.z();
  const double height = low > 0 ? low : high < 0 ? -high : 0;  // the least there is
  const std::string reach = fmt::format(
      "the robot reaches {} m from its base frame, of which "
      "{:.0f} % is used",
      AtMost(robot.reach()), 100 * kReachShare);
  if (robot.config().base.kind == BaseKind::kPlanar) return;  // supports have many heights
  if (height > most) {
    add(owners.height,
        fmt::format("{:g} m puts the base frame {:.2f} ... {:.2f} m above the object "
                    "(with base_height_noise, and {:.2f} m of what the robot stands "
                    "on), but {}",
                    base.height_offset, low, high, up.z(), reach));
    return;
  }
  const double farthest = std::sqrt(most * most - height * height) + up.head<2>().norm();
  if (base.distance[1] <= farthest) return;
  add(owners.distance,
      fmt::format("[{:g}, {:g}] m goes beyond {} m, from where the object is out of "
                  "reach: {}; give [smallest, largest] within that",
                  base.distance[0], base.distance[1], AtMost(farthest), reach));
}

void RequireFinite(const BasePlacement& placement) {
  const auto require = [](const char* what, double value) {
    if (std::isfinite(value)) return;
    throw ArgumentError(
        fmt::format("the {} of a base placement is {}; it must be finite metres", what, value));
  };
  require("distance", placement.distance);
  require("height", placement.height);
}

BasePlacement SpreadBasePlacement(const BaseRange& range, uint64_t seed, uint64_t turn, int attempt,
                                  Rng& rng) {
  const auto point = [&](uint64_t base, const char* purpose) {
    const double shifted =
        internal::RadicalInverse(turn + 1, base) + Rng::Stream(seed, purpose).Uniform();
    const double even = shifted - std::floor(shifted);
    const double spread = std::min(1.0, kWidening * attempt);
    return Reflected(even + spread * rng.Uniform(-1, 1));
  };
  const double u = point(2, "base distance");
  const double v = point(3, "base height");
  return {std::lerp(range.distance[0], range.distance[1], u),
          range.height_offset + std::lerp(range.height_noise[0], range.height_noise[1], v)};
}

std::optional<Pose> ProposeBasePose(const Robot& robot, const Support& support, const Pose& target,
                                    const BasePlacement& placement, const StartConfig& start,
                                    Rng& rng) {
  const std::vector<Pose> bases =
      internal::BasesAround(robot, support, target, placement, start, rng);
  if (bases.empty()) return std::nullopt;
  return bases[rng.UniformInt(bases.size())];
}

std::optional<Refusal> ValidateBaseDistance(const Robot& robot, const Pose& target,
                                            const BaseRange& range) {
  const Eigen::Vector3d displacement = target.translation() - robot.base().pose().translation();
  const double distance = displacement.head<2>().norm();
  const auto& [smallest, largest] = range.distance;
  if (distance > smallest - kRangeTolerance && distance < largest + kRangeTolerance)
    return std::nullopt;
  return Refusal{Refusal::kNoReachableBasePose,
                 fmt::format("the task moved the object to {:.2f} m from the base, out of its "
                             "base range of {:g} to {:g} m",
                             distance, smallest, largest)};
}

std::optional<Refusal> ValidateBaseReach(const Robot& robot, const Pose& target) {
  const double distance = (target.translation() - robot.base_in_world().translation()).norm();
  if (distance <= kReachShare * robot.reach()) return std::nullopt;
  return Refusal{Refusal::kNoReachableBasePose,
                 fmt::format("{:.2f} m away, reach is {:.2f} m", distance, robot.reach())};
}

std::optional<Refusal> ValidateBaseReachOfPart(const Robot& robot, const std::string& body) {
  const Scene scene = robot.scene();
  const mjModel* m = scene.model();
  const Eigen::Vector3d base = robot.base_in_world().translation();
  double nearest = (scene.body_pose(body).translation() - base).norm();
  for (const int geom : internal::CollisionGeomsOf(m, FindId(m, mjOBJ_BODY, body))) {
    const Eigen::Map<const Eigen::Vector3d> middle(scene.data()->geom_xpos + 3 * geom);
    nearest = std::min(nearest, (middle - base).norm() - m->geom_rbound[geom]);
  }
  if (nearest <= kReachShare * robot.reach()) return std::nullopt;
  return Refusal{Refusal::kNoReachableBasePose,
                 fmt::format("{:.2f} m away, reach is {:.2f} m", nearest, robot.reach())};
}

std::string WhyOutOfReach(const std::vector<Robot>& robots, const Eigen::Vector3d& place,
                          double lowest, double slack) {
  double nearest = std::numeric_limits<double>::infinity();
  std::string why;
  for (const Robot& robot : robots) {
    const Chain& chain = robot.chain();
    const Scene scene = robot.scene();
    const int base = FindId(scene.model(), mjOBJ_BODY, chain.base_body());
    if (base < 0 || CanMove(scene.model(), base)) return "";
    const ChainModel& links = chain.model();
    const double reach = links.joints[0].fixed.translation.norm() + links.reach_bound;
    const Eigen::Vector3d from = scene.body_pose(chain.base_body()).translation();
    const double height = std::clamp(from.z(), std::min(lowest, place.z()), place.z());
    const double away = (from - Eigen::Vector3d(place.x(), place.y(), height)).norm();
    if (!(away > reach + kHandLength + slack)) return "";
    if (away - reach >= nearest) continue;
    nearest = away - reach;
    why = fmt::format("it is {:.2f} m from robot '{}', which reaches {:.2f} m", away, robot.name(),
                      robot.reach());
  }
  return why;
}

std::optional<Refusal> ValidateBaseClearance(const Scene& scene, const Robot& robot,
                                             double clearance) {
  const internal::Clearance nearest = internal::RobotClearance(scene, robot, clearance);
  if (nearest.distance >= clearance) return std::nullopt;
  return Refusal{Refusal::kBaseInCollision,
                 fmt::format("{} is {:.3f} m from {}", nearest.robot_geom, nearest.distance,
                             nearest.other_geom)};
}

std::optional<Refusal> ValidateVisibility(const Scene& scene, const std::string& target_body,
                                          const RunConfig& run) {
  for (const std::string& camera : run.start.visible_from) {
    const CameraConfig stream = StreamToSee(run.cameras, camera);
    const CameraModel model =
        ComputeCamera(scene.model(), scene.data(), internal::ViewOfStream(scene, stream),
                      run.cameras.width(stream), run.cameras.height(stream));
    const double share = internal::VisibleShare(scene, target_body, model);
    if (share >= run.start.visible_share && share > 0) continue;
    return Refusal{Refusal::kCameraConstraint,
                   fmt::format("camera '{}' sees {:.0f} % of the object, and start.visible_share "
                               "is {:.0f} %",
                               camera, 100 * share, 100 * run.start.visible_share)};
  }
  return std::nullopt;
}

CameraConfig StreamToSee(const CameraSystemConfig& cameras, const std::string& name) {
  for (const CameraConfig& stream : cameras.streams) {
    if (stream.name == name) return stream;
  }
  for (const CameraConfig& stream : cameras.streams) {
    if (stream.follow.empty() && stream.camera == name) return stream;
  }
  return {.name = "", .camera = name};
}

}  // namespace robocell
