#include "robocell/task/pick_and_place_task.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/task/goal_feasibility.h"
#include "robocell/task/grasp_candidates.h"
#include "robocell/task/held.h"

namespace robocell {
namespace {

constexpr double kRestSpeed = 0.02;  // m/s
constexpr double kRestTurn = 0.2;    // rad/s
constexpr int kTries = 1000;

}  // namespace

PickAndPlaceTask::PickAndPlaceTask(const PickAndPlaceTaskConfig& fields)
    : ObjectTask({.name = fields.object,
                  .lift_height = fields.lift_height,
                  .spread = fields.spread,
                  .rotate = fields.rotate}),
      task_(fields),
      goal_word_(fields.goal_object),
      all_objects_({fields.object}) {
  if (has_goal_object()) all_objects_.push_back(task_.goal_object);
}

PickAndPlaceTask::PickAndPlaceTask(const PickAndPlaceTaskConfig& fields, Objects objects)
    : ObjectTask({.name = std::move(objects.object),
                  .word = std::move(objects.kind),
                  .lift_height = fields.lift_height}),
      task_(fields),
      goal_word_(std::move(objects.goal_kind)),
      all_objects_(std::move(objects.all)) {
  task_.goal_object = std::move(objects.goal_object);
}

void PickAndPlaceTask::Bind(const Scene& scene, const TaskSetting& setting) {
  ObjectTask::Bind(scene, setting);
  if (!has_goal_object()) {
    if (!task_.goal)
      throw ArgumentError(place() + ": task.goal is required: where the object is to be put");
    goal_offset_ = Pose(ToEigen(*task_.goal));
    return;
  }
  const std::string& id = task_.goal_object;
  const ObjectRecord& object = scene.compiled()->object(id);
  goal_body_.emplace(scene, object.root_body);
  const auto offset = setting.objects.find(id);
  goal_offset_ = offset == setting.objects.end() ? Pose() : offset->second;
  if (object.free_joint || task_.goal_spread == Vec2{0, 0}) return;
  throw ArgumentError(
      fmt::format("{}: task.goal_spread moves task.goal_object '{}', which is fixed; set fixed: "
                  "false in root_frame_objects.{}, or leave goal_spread out",
                  place(), id, id));
}

BodyPoses PickAndPlaceTask::Starts(Rng& rng) {
  const Pose goal_in_object = has_goal_object() && task_.goal ? Pose(ToEigen(*task_.goal)) : Pose();
  for (int i = 0; i < kTries; ++i) {
    const Pose start = Start(rng);
    const Pose target = Around(goal_offset_, task_.goal_spread, rng);
    const Eigen::Vector3d goal = (target * goal_in_object).translation();
    if ((goal - start.translation()).head<2>().norm() < task_.goal_distance) continue;
    if (!has_goal_object()) goal_ = goal;
    BodyPoses starts = {{object().name(), root() * start}};
    if (has_goal_object() && task_.goal_spread != Vec2{0, 0})
      starts.emplace_back(goal_body_->name(), root() * target);
    return starts;
  }
  throw ArgumentError(
      fmt::format("{}: in {} tries '{}' was never {:g} m from its goal; widen task.spread or "
                  "task.goal_spread, or lower task.goal_distance",
                  place(), kTries, task_.object, task_.goal_distance));
}

std::optional<Refusal> PickAndPlaceTask::Arrange(Scene& scene, Rng& rng) {
  if (auto refusal = ObjectTask::Arrange(scene, rng)) return refusal;
  if (!is_possible_) RequirePossible(scene);
  is_possible_ = true;
  return CheckDrawnGoal(scene);
}

std::vector<std::string> PickAndPlaceTask::resting_objects() const {
  std::vector<std::string> resting = ObjectTask::resting_objects();
  if (has_goal_object() && task_.goal_spread != Vec2{0, 0}) resting.push_back(task_.goal_object);
  return resting;
}

// A goal given as a place is equally high above its support wherever it is drawn, unless the
// support ends there or something lies on it.
std::optional<Refusal> PickAndPlaceTask::CheckDrawnGoal(const Scene& scene) const {
  if (has_goal_object() || task_.goal_spread == Vec2{0, 0}) return std::nullopt;
  const int own = object().id();
  const double meant = internal::HeightOverSupport(scene, root() * goal_offset_.translation(), own);
  const double drawn = internal::HeightOverSupport(scene, GoalInWorld(), own);
  if (!std::isfinite(meant) || std::abs(drawn - meant) <= task_.goal_tolerance) return std::nullopt;
  return Refusal{.reason = "the goal that was drawn is not on what is under task.goal",
                 .detail = std::isfinite(drawn)
                               ? fmt::format("it is {:.2f} m too {}", std::abs(drawn - meant),
                                             drawn > meant ? "high" : "low")
                               : "nothing is under it"};
}

// Returns the possible goals of this start and of others, in the frame of goal_.
std::vector<Eigen::Vector3d> PickAndPlaceTask::PossibleGoals() const {
  std::vector<Eigen::Vector3d> goals = {goal_};
  if (has_goal_object()) return goals;  // the place of the goal object does not matter
  const Vec2& spread = task_.goal_spread;
  for (const int x : {-1, 0, 1}) {
    for (const int y : {-1, 0, 1})
      goals.emplace_back(goal_offset_.translation() +
                         Eigen::Vector3d(x * spread[0], y * spread[1], 0));
  }
  if (spread == Vec2{0, 0}) goals.resize(1);
  return goals;
}

void PickAndPlaceTask::RequirePossible(const Scene& scene) {
  Begin(scene);
  const mjModel* m = scene.model();
  const std::string goal = task_.goal ? fmt::format("task.goal [{}]", fmt::join(*task_.goal, ", "))
                                      : fmt::format("the goal on top of '{}'", task_.goal_object);
  const double spread = 2 * std::hypot(task_.goal_spread[0], task_.goal_spread[1]);
  const double slack = internal::RadiusOf(m, object().id()) + task_.goal_tolerance + spread;
  const Eigen::Vector3d at = GoalInWorld();
  if (const std::string why = internal::WhyOutOfReach(robots(), at, at.z(), slack); !why.empty()) {
    throw ArgumentError(fmt::format(
        "{}: {} is out of reach: {}. Move the goal or the robot (robot_to_shared_base_frame)",
        place(), goal, why));
  }
  std::vector<internal::RestPlace> places;
  for (const Eigen::Vector3d& at : PossibleGoals()) {
    places.push_back(has_goal_object() ? internal::RestPlace{goal_body_->id(), at}
                                       : internal::RestPlace{0, root() * at});
  }
  const std::string why = internal::WhyNoRest(scene, object().id(), places, task_.goal_tolerance);
  if (why.empty()) return;
  throw ArgumentError(fmt::format(
      "{}: '{}' cannot come to rest at {}: {}. Give the place of its root when it lies there, "
      "within task.goal_tolerance ({:g} m){}",
      place(), fields().name, goal, why, task_.goal_tolerance,
      has_goal_object() ? ", in the frame of '" + task_.goal_object + "'" : ""));
}

void PickAndPlaceTask::Begin(const Scene& scene) {
  ObjectTask::Begin(scene);
  was_lifted_ = false;
  if (has_goal_object()) goal_ = task_.goal ? ToEigen(*task_.goal) : TopOfGoalObject(scene);
}

// Returns where the object's root is when the object lies in the middle on top of goal_object, in
// its present orientation.
Eigen::Vector3d PickAndPlaceTask::TopOfGoalObject(const Scene& scene) const {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  const auto extent = [&](int geom) {
    return internal::GeomExtent(m, d, geom, Eigen::Vector3d::UnitZ());
  };
  double bottom = std::numeric_limits<double>::infinity(), top = -bottom;
  for (const int g : internal::CollisionGeomsOf(m, object().id()))
    bottom = std::min(bottom, extent(g).lower);
  const std::vector<int> geoms = internal::CollisionGeomsOf(m, goal_body_->id());
  for (const int g : geoms) top = std::max(top, extent(g).upper);
  if (!std::isfinite(bottom) || !std::isfinite(top)) {
    throw ArgumentError(fmt::format(
        "{}: '{}' cannot be put on '{}', since one of them has no shape that collides; set "
        "task.goal, where it is to rest in the frame of '{}'",
        place(), object().name(), goal_body_->name(), goal_body_->name()));
  }
  const Pose goal_object = goal_body_->pose_in_world();
  Eigen::Vector3d at = goal_object.translation();
  at.z() = top + 1;
  const double below = internal::CastRay(m, d, geoms, at, -Eigen::Vector3d::UnitZ()).distance;
  if (std::isfinite(below)) top = at.z() - below;  // a tray's floor is below its rims
  at.z() = top + ObjectInWorld().z() - bottom;
  return goal_object.inverse() * at;
}

Eigen::Vector3d PickAndPlaceTask::GoalInWorld() const {
  return has_goal_object() ? goal_body_->pose_in_world() * goal_ : root() * goal_;
}

// The object is a free body.
bool PickAndPlaceTask::IsAtRest(const Scene& scene) const {
  const int dof = scene.model()->body_dofadr[object().id()];
  const Eigen::Map<const Eigen::Matrix<double, 6, 1>> v(scene.data()->qvel + dof);
  return v.head<3>().norm() < kRestSpeed && v.tail<3>().norm() < kRestTurn;
}

bool PickAndPlaceTask::IsPutDown(const Scene& scene) const {
  if ((ObjectInWorld() - GoalInWorld()).norm() > task_.goal_tolerance) return false;
  const internal::Touching touching = internal::TouchingBody(scene, object().name());
  return touching.other && !touching.robot && IsAtRest(scene);
}

bool PickAndPlaceTask::IsDone(const Scene& scene) {
  was_lifted_ = was_lifted_ || IsLifted(scene);
  return was_lifted_ && IsPutDown(scene);
}

double PickAndPlaceTask::Progress() const {
  const double carried = was_lifted_ ? Near((ObjectInWorld() - GoalInWorld()).norm()) : 0;
  return 0.25 * Nearness() + 0.25 * (was_lifted_ ? 1 : Lifted()) + 0.5 * carried;
}

std::string PickAndPlaceTask::instruction() const {
  return fmt::format("pick up the {} and put it {}", word(),
                     has_goal_object() ? "on the " + goal_word_ : "down at the goal");
}

std::vector<Feature> PickAndPlaceTask::signals() const {
  return {{.column = {.name = "goal",
                      .shape = {3},
                      .units = "m",
                      .frame = "shared base frame",
                      .names = {"x", "y", "z"},
                      .description = "Where the object is to be put."},
           .role = FeatureRole::kPrivileged,
           .lower = std::vector<double>(3, -kFarthestObject),
           .upper = std::vector<double>(3, kFarthestObject)}};
}

void PickAndPlaceTask::Observe(const Scene& scene, std::span<double> out) const {
  const Eigen::Vector3d goal = scene.shared_base_frame_to_world().inverse() * GoalInWorld();
  std::copy_n(goal.data(), 3, out.begin());
}

std::vector<double> PickAndPlaceTask::memory() const {
  std::vector<double> memory = ObjectTask::memory();
  memory.insert(memory.end(), {goal_.x(), goal_.y(), goal_.z(), was_lifted_ ? 1.0 : 0.0});
  return memory;
}

void PickAndPlaceTask::Recall(std::span<const double> memory) {
  ObjectTask::Recall(memory);
  goal_ = {memory[3], memory[4], memory[5]};
  was_lifted_ = memory[6] != 0;
}

}  // namespace robocell
