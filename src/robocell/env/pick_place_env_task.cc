#include "robocell/env/pick_place_env_task.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/env/env_layout.h"
#include "robocell/task/pick_task.h"

namespace robocell {
namespace {

constexpr double kRestSpeed = 0.02;  // m/s
constexpr double kRestTurn = 0.2;    // rad/s
constexpr int kTries = 1000;

}  // namespace

PickPlaceEnvTask::PickPlaceEnvTask(const EnvConfig& config, const Scene& scene)
    : ObjectTask(config, scene) {
  if (!has_goal_object()) {
    goal_offset_ = Pose(ToEigen(*task().goal));
    return;
  }
  const std::string& id = task().goal_object;
  const ObjectRecord& object = scene.compiled()->object(id);
  goal_body_.emplace(scene, object.root_body);
  goal_offset_ = config.root_frame_objects.at(id).offset;
  if (object.free_joint || task().goal_spread == Vec2{0, 0}) return;
  throw ArgumentError(
      fmt::format("{}: task.goal_spread moves task.goal_object '{}', which is fixed; set fixed: "
                  "false in root_frame_objects.{}, or leave goal_spread out",
                  place(), id, id));
}

BodyPoses PickPlaceEnvTask::Starts(Rng& rng) {
  const Pose goal_in_object = has_goal_object() ? Pose(ToEigen(*task().goal)) : Pose();
  for (int i = 0; i < kTries; ++i) {
    const Pose start = Start(rng);
    const Pose target = Around(goal_offset_, task().goal_spread, rng);
    const Eigen::Vector3d goal = (target * goal_in_object).translation();
    if ((goal - start.translation()).head<2>().norm() < task().goal_distance) continue;
    goal_ = goal;
    BodyPoses starts = {{object().name(), root() * start}};
    if (has_goal_object() && task().goal_spread != Vec2{0, 0})
      starts.emplace_back(goal_body_->name(), root() * target);
    return starts;
  }
  throw ArgumentError(
      fmt::format("{}: in {} tries '{}' was never {:g} m from its goal; widen task.spread or "
                  "task.goal_spread, or lower task.goal_distance",
                  place(), kTries, task().object, task().goal_distance));
}

void PickPlaceEnvTask::Begin(const Scene& scene) {
  ObjectTask::Begin(scene);
  was_lifted_ = false;
}

Eigen::Vector3d PickPlaceEnvTask::GoalInWorld() const {
  if (!has_goal_object()) return root() * goal_;
  return goal_body_->pose_in_world() * ToEigen(*task().goal);
}

// The object is a free body.
bool PickPlaceEnvTask::IsAtRest(const Scene& scene) const {
  const int dof = scene.model()->body_dofadr[object().id()];
  const Eigen::Map<const Eigen::Matrix<double, 6, 1>> v(scene.data()->qvel + dof);
  return v.head<3>().norm() < kRestSpeed && v.tail<3>().norm() < kRestTurn;
}

bool PickPlaceEnvTask::IsPutDown(const Scene& scene) const {
  if ((ObjectInWorld() - GoalInWorld()).norm() > task().goal_tolerance) return false;
  const Touching touching = TouchingBody(scene, object().name());
  return touching.other && !touching.robot && IsAtRest(scene);
}

bool PickPlaceEnvTask::Success(const Scene& scene) {
  was_lifted_ = was_lifted_ || IsLifted(scene);
  return was_lifted_ && IsPutDown(scene);
}

double PickPlaceEnvTask::Progress() const {
  const double lifted = std::clamp(Lift() / task().lift_height, 0.0, 1.0);
  const double carried = was_lifted_ ? Near((ObjectInWorld() - GoalInWorld()).norm()) : 0;
  return 0.25 * Nearness() + 0.25 * (was_lifted_ ? 1 : lifted) + 0.5 * carried;
}

std::string PickPlaceEnvTask::instruction() const {
  return fmt::format("pick up the {} and put it {}", task().object,
                     has_goal_object() ? "on the " + task().goal_object : "down at the goal");
}

std::vector<std::string> PickPlaceEnvTask::objects() const {
  std::vector<std::string> objects = {task().object};
  if (has_goal_object()) objects.push_back(task().goal_object);
  return objects;
}

std::vector<TaskSignal> PickPlaceEnvTask::signals() const {
  return {
      {"goal", std::vector<double>(3, -kFarthestObject), std::vector<double>(3, kFarthestObject)}};
}

void PickPlaceEnvTask::Observe(const Scene& scene, std::span<double> out) const {
  const Eigen::Vector3d goal = scene.shared_base_frame_to_world().inverse() * GoalInWorld();
  std::copy_n(goal.data(), 3, out.begin());
}

std::vector<double> PickPlaceEnvTask::memory() const {
  std::vector<double> memory = ObjectTask::memory();
  memory.insert(memory.end(), {goal_.x(), goal_.y(), goal_.z(), was_lifted_ ? 1.0 : 0.0});
  return memory;
}

void PickPlaceEnvTask::Recall(std::span<const double> memory) {
  ObjectTask::Recall(memory);
  goal_ = {memory[3], memory[4], memory[5]};
  was_lifted_ = memory[6] != 0;
}

}  // namespace robocell
