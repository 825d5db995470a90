#include "robocell/robot/collision_filter.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/scratch_robot.h"

namespace robocell {
namespace {

double CheckedClearance(double clearance) {
  if (clearance >= 0 && std::isfinite(clearance)) return clearance;
  throw ArgumentError(
      fmt::format("collision filter: clearance is {} m; it must be 0 or more", clearance));
}

}  // namespace

struct CollisionFilter::State {
  State(const Robot& robot, double least)
      : scratch(robot, least, "make the filter again"),
        clearance(least),
        ignored(scratch.model()->ngeom, 0) {}

  bool IsFree(std::span<const double> q);

  std::mutex mutex;  // threads that share a filter share its scratch data
  internal::ScratchRobot scratch;
  double clearance;
  std::vector<char> ignored;  // per geom
};

CollisionFilter::CollisionFilter(const Robot& robot, const CollisionFilterOptions& options)
    : state_(std::make_shared<State>(robot, CheckedClearance(options.clearance))) {
  const mjModel* m = state_->scratch.model();
  const std::string place = "collision filter of robot '" + robot.name() + "': ignored";
  for (const std::string& name : options.ignored) {
    const int body = RequireId(m, mjOBJ_BODY, name, place);
    for (int g = 0; g < m->ngeom; ++g) {
      if (internal::IsInSubtree(m, m->geom_bodyid[g], body)) state_->ignored[g] = 1;
    }
  }
}

void CollisionFilter::Update() {
  const Scene scene = state_->scratch.robot().scene();
  const SceneUse::Claim claim(scene.use(), "CollisionFilter::Update");
  const std::lock_guard lock(state_->mutex);
  state_->scratch.Update();
}

std::optional<Scene> CollisionFilter::scene_of_sole_handle() const {
  if (state_.use_count() != 1) return std::nullopt;
  return state_->scratch.robot().scene();
}

int CollisionFilter::n_joints() const { return state_->scratch.robot().chain().n_joints(); }

bool CollisionFilter::State::IsFree(std::span<const double> q) {
  scratch.robot().chain().RequireJointValues("collision filter: q", q);
  scratch.SetArm(q);
  if (!scratch.FindTouches()) return false;  // missing contacts may be collisions
  const auto is_fine = [&](const internal::ScratchRobot::Touch& touch) {
    return (!touch.itself && touch.distance >= clearance) || ignored[touch.own_geom] ||
           ignored[touch.other_geom];
  };
  return std::all_of(scratch.touches().begin(), scratch.touches().end(), is_fine);
}

bool CollisionFilter::IsFree(std::span<const double> q) {
  const std::lock_guard lock(state_->mutex);
  return state_->IsFree(q);
}

void CollisionFilter::operator()(std::span<const double> q, int count, std::span<uint8_t> keep) {
  const size_t n = static_cast<size_t>(n_joints());
  if (q.size() != n * static_cast<size_t>(count) || keep.size() != static_cast<size_t>(count)) {
    throw ArgumentError(
        fmt::format("collision filter of robot '{}': expected {} for {} of {}, got {}",
                    state_->scratch.robot().name(), Counted(n_joints() * count, "value"),
                    Counted(count, "configuration"), Counted(n_joints(), "joint"), q.size()));
  }
  const std::lock_guard lock(state_->mutex);
  for (int k = 0; k < count; ++k) keep[k] = state_->IsFree(q.subspan(k * n, n)) ? 1 : 0;
}

}  // namespace robocell
