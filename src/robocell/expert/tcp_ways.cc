#include "robocell/expert/tcp_ways.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/robot/arm_ik.h"

namespace robocell::internal {
namespace {

constexpr int kWayRestarts = 6;    // of inverse kinematics for a drawn posture
constexpr double kSameWay = 0.15;  // rad or m: ways that begin nearer to each other count as one

// Returns the way through all poses from a posture at one of them.
std::optional<JointPath> WayFrom(const Chain& chain, std::span<const Pose> tcps, size_t anchor,
                                 const JointVector& q, IkOptions ik, double most_jump) {
  JointPath way(tcps.size());
  way[anchor] = q;
  const auto follow = [&](size_t from, size_t to) {
    ik.seed = way[from];
    const IkResult found = Ik(chain, tcps[to], ik);
    if (!found.success || JointDistance(found.q, way[from]) > most_jump) return false;
    way[to] = found.q;
    return true;
  };
  for (size_t i = anchor; i + 1 < tcps.size(); ++i)
    if (!follow(i, i + 1)) return std::nullopt;
  for (size_t i = anchor; i > 0; --i)
    if (!follow(i, i - 1)) return std::nullopt;
  return way;
}

// Returns postures all over the limits; joints without limits are in one turn.
std::vector<double> DrawPostures(const Robot& arm, int count, Rng& rng) {
  std::vector<double> drawn;
  for (int i = 0; i < count; ++i) {
    for (const Interval& limit : arm.joint_limits()) {
      const bool is_bounded = std::isfinite(limit.lower) && std::isfinite(limit.upper);
      drawn.push_back(is_bounded ? rng.Uniform(limit.lower, limit.upper)
                                 : rng.Uniform(-std::numbers::pi, std::numbers::pi));
    }
  }
  return drawn;
}

}  // namespace

std::vector<JointPath> TcpWays(const Robot& arm, std::span<const Pose> tcps,
                               const JointVector& seed, const TcpWayOptions& options, Rng& rng) {
  const Chain& chain = arm.chain();
  const Pose world_in_base = arm.base_in_world().inverse();
  std::vector<Pose> in_base;
  for (const Pose& tcp : tcps) in_base.push_back(world_in_base * tcp);
  const IkOptions line = ForArm(arm, {.tolerance = options.tolerance, .max_restarts = 0});
  const IkOptions anywhere =
      ForArm(arm, {.tolerance = options.tolerance, .max_restarts = kWayRestarts});
  std::vector<JointPath> ways;
  for (const size_t anchor : options.anchors) {
    std::vector<double> seeds(seed.begin(), seed.end());
    const std::vector<double> drawn = DrawPostures(arm, options.draws, rng);
    seeds.insert(seeds.end(), drawn.begin(), drawn.end());
    const std::vector<Pose> targets(static_cast<size_t>(options.draws) + 1, in_base[anchor]);
    const IkBatchResult found = IkBatch(chain, targets, seeds, {.ik = anywhere});
    for (int i = 0; i < found.size && ways.size() < options.most; ++i) {
      if (found.success[static_cast<size_t>(i)] == 0) continue;
      auto way = WayFrom(chain, in_base, anchor, JointVector(found.row(i)), line, options.jump);
      if (!way) continue;
      const bool is_known = std::ranges::any_of(ways, [&](const JointPath& known) {
        return JointDistance(known.front(), way->front()) < kSameWay;
      });
      if (!is_known) ways.push_back(*std::move(way));
    }
  }
  std::ranges::stable_sort(ways, {},
                           [&](const JointPath& way) { return JointDistance(way.front(), seed); });
  return ways;
}

}  // namespace robocell::internal
