#include "robocell/env/object_task.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/robot/robot.h"
#include "robocell/task/pick_task.h"

namespace robocell {

double Near(double distance) {
  constexpr double kReachScale = 5;  // 1/m
  return 1 - std::tanh(kReachScale * distance);
}

ObjectTask::ObjectTask(const EnvConfig& config, const Scene& scene)
    : name_(config.name),
      task_(*config.task),
      root_(config.root_frame_to_world),
      offset_(config.root_frame_objects.at(task_.object).offset),
      object_(scene, scene.compiled()->object(task_.object).root_body) {
  if (!scene.compiled()->object(task_.object).free_joint) {
    throw ArgumentError(fmt::format(
        "{}: task.object '{}' is fixed, so that nobody can pick it; set fixed: false in "
        "root_frame_objects.{}",
        place(), task_.object, task_.object));
  }
  for (const std::string& robot : config.robots.keys()) robots_.push_back(Robot::Of(scene, robot));
}

void ObjectTask::Begin(const Scene& /*scene*/) { start_ = root_.inverse() * ObjectInWorld(); }

TaskVerdict ObjectTask::Judge(const Scene& scene) {
  const bool success = Success(scene);
  return {success ? 1 : Progress(), success};
}

std::vector<double> ObjectTask::memory() const { return {start_.x(), start_.y(), start_.z()}; }

void ObjectTask::Recall(std::span<const double> memory) {
  start_ = {memory[0], memory[1], memory[2]};
}

Pose ObjectTask::Around(const Pose& offset, const Vec2& spread, Rng& rng) {
  const double x = rng.Uniform(-1, 1) * spread[0];
  const double y = rng.Uniform(-1, 1) * spread[1];
  return Pose(Eigen::Vector3d(x, y, 0)) * offset;
}

Pose ObjectTask::Start(Rng& rng) const {
  const Pose at = Around(offset_, task_.spread, rng);
  const double yaw = task_.rotate ? rng.Uniform(-kPi, kPi) : 0;
  const Pose turn = Pose::FromRpy(Eigen::Vector3d::Zero(), {0, 0, yaw});
  return {at.translation(), (turn * at).quaternion()};
}

double ObjectTask::Nearness() const {
  const Eigen::Vector3d object = ObjectInWorld();
  double nearest = std::numeric_limits<double>::infinity();
  for (const Robot& robot : robots_)
    nearest = std::min(nearest, (robot.tcp_in_world().translation() - object).norm());
  return Near(nearest);
}

double ObjectTask::Lift() const { return ObjectInWorld().z() - (root_ * start_).z(); }

bool ObjectTask::IsLifted(const Scene& scene) const {
  return Lift() >= task_.lift_height && IsHeld(scene, object_.name());
}

}  // namespace robocell
