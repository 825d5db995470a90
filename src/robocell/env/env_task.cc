#include "robocell/env/env_task.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/robot/robot.h"
#include "robocell/task/pick_task.h"

namespace robocell {
namespace {

constexpr double kReachScale = 5;  // 1/m: how fast the reward falls with the distance to the object

// Picks an object that lies around its place in the root frame, turned about the root frame's z.
// The reward, 0 to 1, is half for a TCP near the object and half for its height; at success it is
// 1.
class PickEnvTask final : public EnvTask {
 public:
  PickEnvTask(const EnvConfig& config, const Scene& scene)
      : config_(*config.task),
        place_(config.root_frame_to_world * config.root_frame_objects.at(config_.object).offset),
        pick_(config_.object, config_.object, {config_.object}, config_.lift_height),
        body_(scene.compiled()->object(config_.object).root_body) {
    for (const std::string& name : config.robots.keys()) robots_.push_back(Robot::Of(scene, name));
  }

  void Arrange(Scene& scene, Rng& rng) override {
    const double x = rng.Uniform(-1, 1) * config_.spread[0];
    const double y = rng.Uniform(-1, 1) * config_.spread[1];
    const double yaw = config_.rotate ? rng.Uniform(-kPi, kPi) : 0;
    const Pose& p = place_;
    const Pose turn = Pose::FromRpy(Eigen::Vector3d::Zero(), {0, 0, yaw});
    scene.SetBodyPose(body_, p * Pose(Eigen::Vector3d(x, y, 0)) * turn);
  }
  std::unique_ptr<EnvTask> Clone() const override { return std::make_unique<PickEnvTask>(*this); }
  void Begin(const Scene& scene) override { pick_.Begin(scene); }
  double Reward(const Scene& scene) override {
    if (Success(scene)) return 1;
    const Eigen::Vector3d object = scene.body_pose(body_).translation();
    double nearest = std::numeric_limits<double>::infinity();
    for (const Robot& robot : robots_)
      nearest = std::min(nearest, (robot.tcp_in_world().translation() - object).norm());
    const double lifted = std::min(1.0, pick_.Reward(scene) / config_.lift_height);
    return 0.5 * (1 - std::tanh(kReachScale * nearest)) + 0.5 * lifted;
  }
  bool Success(const Scene& scene) override { return pick_.Success(scene); }
  std::string instruction() const override { return pick_.instruction(); }
  std::vector<std::string> objects() const override { return pick_.objects(); }

 private:
  EnvTaskConfig config_;
  Pose place_;  // in the world
  PickTask pick_;
  std::string body_;
  std::vector<Robot> robots_;
};

}  // namespace

std::unique_ptr<EnvTask> MakeEnvTask(const EnvConfig& config, const Scene& scene) {
  if (!config.task) return nullptr;
  const std::string& object = config.task->object;
  if (!scene.compiled()->object(object).free_joint) {
    throw ArgumentError(fmt::format(
        "environment '{}': task.object '{}' is fixed, so that nobody can pick it; set fixed: false "
        "in root_frame_objects.{}",
        config.name, object, object));
  }
  return std::make_unique<PickEnvTask>(config, scene);
}

}  // namespace robocell
