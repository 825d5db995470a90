#include "robocell/env/env.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/base/names.h"
#include "robocell/env/env_scene.h"
#include "robocell/spec/validate.h"

namespace robocell {
namespace {

constexpr const char* kSeedPurpose = "env reset";

std::vector<Robot> ArmsOf(const EnvConfig& config, const Scene& scene) {
  std::vector<Robot> robots;
  for (const std::string& name : config.robots.keys()) robots.push_back(Robot::Of(scene, name));
  return robots;
}

std::vector<ArmDriver> DriversOf(const EnvConfig& config, const Scene& scene,
                                 const EnvLayout& layout) {
  std::vector<ArmDriver> drivers;
  for (const RobotLayout& robot : layout.robots)
    drivers.emplace_back(config, Robot::Of(scene, robot.robot), robot);
  return drivers;
}

std::vector<Robot> RobotsOfDrivers(const std::vector<ArmDriver>& drivers) {
  std::vector<Robot> robots;
  for (const ArmDriver& driver : drivers) {
    for (const Robot& robot : driver.robots()) robots.push_back(robot);
  }
  return robots;
}

std::vector<CollisionMonitor::Watched> WatchedOf(const std::vector<ArmDriver>& drivers) {
  std::vector<CollisionMonitor::Watched> watched;
  for (const ArmDriver& driver : drivers) {
    std::vector<Robot> robots = driver.robots();
    robots.erase(robots.begin());
    watched.push_back({driver.robot(), std::move(robots)});
  }
  return watched;
}

CameraSystemConfig StreamsOf(const EnvConfig& config) {
  CameraSystemConfig cameras = config.cameras;
  for (CameraConfig& stream : cameras.streams)
    stream.depth = stream.depth || config.wrappers.include_depth;
  return cameras;
}

EnvConfig Checked(EnvConfig config) {
  RequireValid(config, "environment '" + config.name + "'");
  return config;
}

// The number of engine steps after which `seconds` have passed.
int64_t TicksUntil(double seconds, double timestep) {
  return static_cast<int64_t>(std::ceil(seconds / timestep - 1e-9));
}

}  // namespace

const char* ToString(EndReason reason) {
  switch (reason) {
    case EndReason::kDiverged:
      return "diverged";
    case EndReason::kCollision:
      return "collision";
    case EndReason::kIkFailed:
      return "ik_failed";
    case EndReason::kArrived:
      return "arrived";
    case EndReason::kTimeout:
      break;
  }
  return "timeout";
}

Env::Env(const EnvConfig& config, const DataFactory& factory)
    : Env(config, Scene::Build(EnvSceneSpec(config), factory)) {}

Env::Env(EnvConfig config, Scene scene, std::optional<int> copy)
    : config_(Checked(std::move(config))),
      scene_(std::move(scene)),
      layout_(MakeEnvLayout(config_, ArmsOf(config_, scene_))),
      arms_(DriversOf(config_, scene_, layout_)),
      stepper_(scene_, RobotsOfDrivers(arms_), {.control_ticks = 1, .sim_steps = 1}),
      collisions_(WatchedOf(arms_)),
      cameras_(scene_, StreamsOf(config_)),
      task_(MakeEnvTask(config_, scene_)),
      seeds_(copy ? Rng::Stream(0, kSeedPurpose, *copy) : Rng::Stream(0, kSeedPurpose)),
      observation_(layout_.observation.size()) {}

void Env::Reset(const EnvResetOptions& options) {
  if (options.seed) seeds_ = Rng::Stream(*options.seed, kSeedPurpose);
  std::vector<std::vector<double>> kept;
  if (!config_.wrappers.home_on_reset && phase_ == Phase::kReady) {
    for (const ArmDriver& arm : arms_) kept.push_back(arm.robot().arm().joint_pos());
  }
  phase_ = Phase::kBroken;  // until all is done
  const uint64_t seed = seeds_.NextBits();
  scene_.Reset({.seed = seed});
  for (size_t i = 0; i < kept.size(); ++i) Robot(arms_[i].robot()).SetJointPos(kept[i]);
  for (ArmDriver& arm : arms_) arm.Reset();
  if (task_) {
    Rng rng = Rng::Stream(seed, "env task");
    task_->Arrange(scene_, rng);
    task_->Begin(scene_);
  }
  collisions_.Forget();
  ticks_ = 0;
  pacer_.Start(0);
  cameras_.Reset();
  Observe();
  phase_ = Phase::kReady;
}

void Env::RequireReady() const {
  switch (phase_) {
    case Phase::kReady:
      return;
    case Phase::kUnready:
      throw Error(place() + ": call reset before the first step");
    case Phase::kDiverged:
      throw Error(place() + ": the simulation has diverged; call reset to go on");
    case Phase::kBroken:
      throw Error(place() + ": an error ended its last reset or step halfway; call reset to go on");
  }
}

void Env::CheckAction(std::span<const double> action) const {
  RequireReady();
  if (action.size() != static_cast<size_t>(layout_.action.size())) {
    throw ArgumentError(fmt::format("{}: expected an action of {} numbers, got {}", place(),
                                    layout_.action.size(), action.size()));
  }
  for (const ArmDriver& arm : arms_) arm.Check(action, place());
}

std::vector<std::string> Env::Send(std::span<const double> action) {
  std::vector<std::string> failed;
  for (ArmDriver& arm : arms_) {
    if (!arm.Send(action)) failed.push_back(arm.layout().robot);
  }
  return failed;
}

// To the next multiple of 1/frequency since the reset, without drift; or at most the time that
// motions may take.
int64_t Env::TicksOfStep() const {
  const SimSettings& sim = config_.sim;
  if (!sim.async_control)
    return std::max<int64_t>(1, TicksUntil(sim.max_convergence_time, scene_.timestep()));
  const double end = (std::floor(TimeSinceReset() * sim.frequency + 1e-6) + 1) / sim.frequency;
  return std::max<int64_t>(1, TicksUntil(end, scene_.timestep()) - ticks_);
}

bool Env::HaveArrived() {
  bool arrived = true;
  for (ArmDriver& arm : arms_) arrived = arm.HasArrived(scene_.time()) && arrived;
  return arrived;
}

double Env::TimeSinceReset() const { return static_cast<double>(ticks_) * scene_.timestep(); }

// After every engine step.
bool Env::ShouldEnd() {
  ++ticks_;
  cameras_.Tick(TimeSinceReset());
  collided_ = collisions_.FindNew() || collided_;
  if (collided_ && config_.sim.on_collision == OnCollision::kStop) return true;
  return !config_.sim.async_control && HaveArrived();
}

EndReason Env::ReasonOf(const StepResult& step, const EnvStep& out) {
  if (!step.ok()) return EndReason::kDiverged;
  if (collided_ && config_.sim.on_collision == OnCollision::kStop) return EndReason::kCollision;
  if (!out.ik_failed.empty()) return EndReason::kIkFailed;
  return HaveArrived() ? EndReason::kArrived : EndReason::kTimeout;
}

EnvStep Env::Step(std::span<const double> action) {
  CheckAction(action);
  EnvStep out;
  collided_ = false;
  phase_ = Phase::kBroken;  // until all is done
  collisions_.Begin();
  out.ik_failed = Send(action);
  const StepOutcome outcome =
      stepper_.AdvanceUntil({}, TicksOfStep(), [this] { return ShouldEnd(); });
  out.reason = ReasonOf(outcome.step, out);
  out.message = outcome.step.message;
  out.collisions = collisions_.found();
  out.time = TimeSinceReset();
  if (out.reason == EndReason::kDiverged) {
    phase_ = Phase::kDiverged;
    return out;
  }
  Observe();
  if (task_) {
    out.reward = task_->Reward(scene_);
    out.success = task_->Success(scene_);
  }
  phase_ = Phase::kReady;
  if (config_.sim.realtime) pacer_.Wait(out.time);
  return out;
}

void Env::Observe() {
  for (const ArmDriver& arm : arms_) arm.Observe(observation_);
  const Pose world_to_shared = scene_.shared_base_frame_to_world().inverse();
  for (const ObjectLayout& object : layout_.objects) {
    const std::string& body = scene_.compiled()->object(object.object).root_body;
    const Pose pose = world_to_shared * scene_.body_pose(body);
    const std::span<double> out =
        std::span(observation_).subspan(object.tquat.begin, object.tquat.size);
    ObserveTquat(pose, out);
    for (double& x : out.first(3)) x = std::clamp(x, -kFarthestObject, kFarthestObject);
  }
  cameras_.Draw(TimeSinceReset());
}

void Env::Save(const std::string& name) {
  RequireReady();
  Snapshot& snapshot = saved_[name];
  snapshot = {.generation = scene_.generation(),
              .state = scene_.state(),
              .task = task_ ? task_->Clone() : nullptr,
              .touching = collisions_.memory(),
              .ticks = ticks_};
  for (const ArmDriver& arm : arms_) snapshot.arms.push_back(arm.memory());
}

Env::Snapshot& Env::RequireSnapshot(const std::string& name) {
  const auto found = saved_.find(name);
  if (found == saved_.end()) throw NotFoundError(NoSuchName(place(), "saved state", name, saved()));
  return found->second;
}

void Env::Restore(const std::string& name) {
  const Snapshot& snapshot = RequireSnapshot(name);
  if (snapshot.generation != scene_.generation()) {
    throw Error(
        fmt::format("{}: the scene was compiled anew since '{}' was saved, so that there "
                    "is no way back to it",
                    place(), name));
  }
  phase_ = Phase::kBroken;  // until all is done
  scene_.SetState(snapshot.state);
  for (size_t i = 0; i < arms_.size(); ++i) arms_[i].Recall(snapshot.arms[i]);
  if (snapshot.task) task_ = snapshot.task->Clone();
  collisions_.Recall(snapshot.touching);
  ticks_ = snapshot.ticks;
  pacer_.Start(TimeSinceReset());
  cameras_.GoOnFrom(TimeSinceReset());
  Observe();
  phase_ = Phase::kReady;
}

void Env::Forget(const std::string& name) {
  RequireSnapshot(name);
  saved_.erase(name);
}

std::vector<std::string> Env::saved() const {
  std::vector<std::string> names;
  for (const auto& [name, snapshot] : saved_) names.push_back(name);
  return names;
}

void Env::SetOriginToCurrent(const std::string& robot) {
  for (ArmDriver& arm : arms_) {
    if (arm.layout().robot == robot) return arm.SetOriginToCurrent();
  }
  throw NotFoundError(NoSuchName(place(), "robot", robot, config_.robots.keys()));
}

}  // namespace robocell
