#include "robocell/task/pick_and_place_task.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
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
      task_(fields) {}

void PickAndPlaceTask::Bind(const Scene& scene, const TaskSetting& setting) {
  ObjectTask::Bind(scene, setting);
  if (!task_.goal)
    throw ArgumentError(place() + ": task.goal is required: where the object is to be put");
  if (!has_goal_object()) {
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
  const Pose goal_in_object = has_goal_object() ? Pose(ToEigen(*task_.goal)) : Pose();
  for (int i = 0; i < kTries; ++i) {
    const Pose start = Start(rng);
    const Pose target = Around(goal_offset_, task_.goal_spread, rng);
    const Eigen::Vector3d goal = (target * goal_in_object).translation();
    if ((goal - start.translation()).head<2>().norm() < task_.goal_distance) continue;
    goal_ = goal;
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

void PickAndPlaceTask::Begin(const Scene& scene) {
  ObjectTask::Begin(scene);
  was_lifted_ = false;
}

Eigen::Vector3d PickAndPlaceTask::GoalInWorld() const {
  if (!has_goal_object()) return root() * goal_;
  return goal_body_->pose_in_world() * ToEigen(*task_.goal);
}

// The object is a free body.
bool PickAndPlaceTask::IsAtRest(const Scene& scene) const {
  const int dof = scene.model()->body_dofadr[object().id()];
  const Eigen::Map<const Eigen::Matrix<double, 6, 1>> v(scene.data()->qvel + dof);
  return v.head<3>().norm() < kRestSpeed && v.tail<3>().norm() < kRestTurn;
}

bool PickAndPlaceTask::IsPutDown(const Scene& scene) const {
  if ((ObjectInWorld() - GoalInWorld()).norm() > task_.goal_tolerance) return false;
  const Touching touching = TouchingBody(scene, object().name());
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
  return fmt::format("pick up the {} and put it {}", task_.object,
                     has_goal_object() ? "on the " + task_.goal_object : "down at the goal");
}

std::vector<std::string> PickAndPlaceTask::objects() const {
  std::vector<std::string> objects = {task_.object};
  if (has_goal_object()) objects.push_back(task_.goal_object);
  return objects;
}

std::vector<TaskSignal> PickAndPlaceTask::signals() const {
  return {
      {"goal", std::vector<double>(3, -kFarthestObject), std::vector<double>(3, kFarthestObject)}};
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
