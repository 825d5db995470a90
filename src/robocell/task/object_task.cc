#include "robocell/task/object_task.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/mujoco/names.h"
#include "robocell/task/goal_feasibility.h"
#include "robocell/task/held.h"

namespace robocell {

double Near(double distance) {
  constexpr double kReachScale = 5;  // 1/m
  return 1 - std::tanh(kReachScale * distance);
}

void ObjectTask::Bind(const Scene& scene, const TaskSetting& setting) {
  place_ = setting.place;
  const ObjectRecord& object = scene.compiled()->object(fields_.name);
  if (!object.free_joint) {
    const mjModel* m = scene.model();
    const int root = FindId(m, mjOBJ_BODY, object.root_body);
    if (root >= 0 && m->body_jntnum[root] > 0) {
      throw ArgumentError(fmt::format(
          "{}: task.object '{}' moves on the joint '{}' of its root body, so that nobody can pick "
          "it; choose an object whose root has no joint",
          place_, fields_.name, ElementName(m, mjOBJ_JOINT, m->body_jntadr[root])));
    }
    throw ArgumentError(fmt::format(
        "{}: task.object '{}' is fixed, so that nobody can pick it; set fixed: false in "
        "root_frame_objects.{}",
        place_, fields_.name, fields_.name));
  }
  object_.emplace(scene, object.root_body);
  root_ = scene.root_frame_to_world();
  const auto offset = setting.objects.find(fields_.name);
  offset_ = offset == setting.objects.end() ? Pose() : offset->second;
  robots_.clear();
  for (const std::string& robot : setting.robots)
    robots_.push_back(Robot::Of(scene.inner(), robot));
}

std::optional<Refusal> ObjectTask::Arrange(Scene& scene, Rng& /*rng*/) {
  constexpr double kMayFall = -std::numeric_limits<double>::infinity();
  const std::string why = internal::WhyOutOfReach(robots_, ObjectInWorld(), kMayFall,
                                                  internal::RadiusOf(scene.model(), object_->id()));
  if (why.empty()) return std::nullopt;
  return Refusal{.reason = fmt::format("'{}' is out of reach", fields_.name), .detail = why};
}

void ObjectTask::Begin(const Scene& scene) {
  if (!object_) {  // by default all robots act
    TaskSetting setting{.place = "scene '" + scene.name() + "'", .robots = {}};
    for (const Robot& robot : RobotsOf(scene)) {
      if (robot.has_arm()) setting.robots.push_back(robot.name());
    }
    Bind(scene, setting);
  }
  start_ = root_.inverse() * ObjectInWorld();
}

TaskVerdict ObjectTask::Judge(const Scene& scene) {
  const bool success = IsDone(scene);
  const double progress = success ? 1 : Progress();
  return {.reward = progress, .success = success, .progress = progress};
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
  const Pose at = Around(offset_, fields_.spread, rng);
  const double yaw = fields_.rotate ? rng.Uniform(-internal::kPi, internal::kPi) : 0;
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

double ObjectTask::Lifted() const { return std::clamp(Lift() / fields_.lift_height, 0.0, 1.0); }

bool ObjectTask::IsLifted(const Scene& scene) const {
  return Lift() >= fields_.lift_height && internal::IsHeld(scene, object_->name());
}

}  // namespace robocell
