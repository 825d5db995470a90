#include "robocell/rollout/action_noise.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>

#include "robocell/base/log.h"
#include "robocell/kinematics/ik.h"
#include "robocell/motion/joint_path.h"
#include "robocell/motion/motion_planner.h"
#include "robocell/robot/controller.h"
#include "robocell/robot/task_space.h"

namespace robocell::internal {
namespace {

constexpr double kTolerance = 1e-4;  // m and rad
// Largest motion of a joint by the noise, rad (m): a solution farther away is on another branch.
constexpr double kMostNoise = 0.3, kMostDisplaced = 1.0;
constexpr int kStartTries = 20;
constexpr double kStartClearance = 0.005;  // m

// Returns a vector of the unit ball, evenly distributed.
Eigen::Vector3d DrawInBall(Rng& rng) {
  for (;;) {
    const double x = rng.Uniform(-1, 1), y = rng.Uniform(-1, 1), z = rng.Uniform(-1, 1);
    const Eigen::Vector3d v(x, y, z);
    if (v.squaredNorm() <= 1) return v;
  }
}

// Returns joint positions that displace the TCP from where `q` has it; unset if there are none near.
std::optional<JointVector> Displaced(const Chain& chain, const TaskSpace& task,
                                     const JointVector& q, const Eigen::Vector3d& translation,
                                     const Eigen::Vector3d& rotation, double most) {
  const Pose tcp = chain.Fk(q) * Pose::FromRotvec(translation, rotation);
  const IkResult ik = task.is_partial(chain)
                          ? task.Step(chain, tcp, q)
                          : Ik(chain, tcp, {.tolerance = kTolerance, .seed = q, .max_restarts = 0});
  if (!ik.success || JointDistance(ik.q, q) > most) return std::nullopt;
  return ik.q;
}

}  // namespace

ActionNoise::ActionNoise(const std::vector<Robot>& robots, const ActionNoiseConfig& config,
                         double tick, const Rng& rng)
    : config_(config),
      kept_(config.correlation_seconds > 0 ? std::exp(-tick / config.correlation_seconds) : 0),
      rng_(rng) {
  for (const Robot& robot : robots) {
    for (const std::string& name : robot.group_names()) {
      const bool is_arm = robot.group(name).kind() == MoveGroupKind::kArm;
      if (is_arm && robot.is_driven(name) &&
          robot.controller(name).target_kind() == TargetKind::kJointPositions)
        arms_.push_back({.robot = robot, .group = name});
    }
    Targets targets{.actions = RobotActions(robot), .all = {}, .chosen = {}};
    const std::string action = "robots/" + robot.name() + "/action/";
    size_t at = 0;
    for (Feature feature : targets.actions.features()) {
      const auto size = static_cast<size_t>(feature.size());
      const std::string name = feature.column.name.substr(action.size());
      if (robot.has_group(name) || name == "tcp_pose") {
        feature.column.name = "robots/" + robot.name() + "/intended/" + name;
        feature.column.description = "What the action was before the noise: " + name + ".";
        feature.role = FeatureRole::kLabel;
        for (size_t i = 0; i < size; ++i) targets.chosen.push_back(at + i);
        schema_.Add(std::move(feature));
      }
      at += size;
    }
    targets.all.resize(at);
    targets_.push_back(std::move(targets));
  }
}

// Fades the noise and adds a random part that keeps its spread.
void ActionNoise::Advance(Eigen::Vector3d& share) {
  share = kept_ * share + std::sqrt(1 - kept_ * kept_) * DrawInBall(rng_);
  if (share.norm() > 1) share.normalize();
}

Action ActionNoise::Intended() const {
  Action action;
  for (const Arm& arm : arms_) {
    if (!arm.intended.empty())
      action[arm.robot.name()][arm.group] = GroupCommand::Joints(arm.intended);
  }
  return action;
}

Action ActionNoise::Perturb() {
  numbers_.clear();
  for (Targets& targets : targets_) {
    targets.actions.Read(targets.all);
    for (const size_t i : targets.chosen) numbers_.push_back(targets.all[i]);
  }
  noisy_.clear();
  const bool is_noisy = config_.translation + config_.rotation > 0;
  bool has_all = !arms_.empty();
  for (Arm& arm : arms_) {
    Advance(arm.translation);
    Advance(arm.rotation);
    const std::span<const double> target = arm.robot.controller(arm.group).commanded_joint_pos();
    arm.intended.assign(target.begin(), target.end());
    if (!is_noisy) continue;
    const JointVector q(target);
    const std::optional<JointVector> with_noise = Displaced(
        arm.robot.chain(arm.group), TaskSpaceOf(arm.robot.config(), arm.group), q,
        config_.translation * arm.translation, config_.rotation * arm.rotation, kMostNoise);
    has_all &= with_noise.has_value();
    if (with_noise) {
      noisy_[arm.robot.name()][arm.group] =
          GroupCommand::Joints({with_noise->begin(), with_noise->end()});
    }
  }
  ++actions_;
  without_ += is_noisy && !has_all;
  return noisy_;
}

std::optional<bool> DisplaceStart(const RunConfig& run, EpisodeStart& start, Rng& rng) {
  if (!run.noise || run.noise->start_translation + run.noise->start_rotation <= 0)
    return std::nullopt;
  const auto not_displaced = [&](const std::string& why) {
    LogWarn(fmt::format("scene '{}': the start is not displaced (`noise`): {}", start.scene.name(),
                        why));
    return false;
  };
  Robot robot = Robot::Of(start.scene, run.robot.config.name);
  if (!robot.has_arm()) return not_displaced(fmt::format("robot '{}' has no arm", robot.name()));
  const JointVector q(std::span<const double>(robot.arm().joint_pos()));
  MotionPlanner planner(robot, {.clearance = kStartClearance});
  planner.Update();
  for (int i = 0; i < kStartTries; ++i) {
    const Eigen::Vector3d translation = run.noise->start_translation * DrawInBall(rng);
    const Eigen::Vector3d rotation = run.noise->start_rotation * DrawInBall(rng);
    const std::optional<JointVector> displaced =
        Displaced(robot.chain(), TaskSpaceOf(robot), q, translation, rotation, kMostDisplaced);
    if (!displaced || !planner.IsFree(*displaced)) continue;
    robot.SetJointPos(*displaced);
    return true;
  }
  return not_displaced(
      fmt::format("{} postures within {:g} m and {:g} rad are out of reach or in collision; make "
                  "start_translation or start_rotation smaller",
                  kStartTries, run.noise->start_translation, run.noise->start_rotation));
}

}  // namespace robocell::internal
