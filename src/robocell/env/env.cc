#include "robocell/env/env.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "robocell/base/error.h"
#include "robocell/base/function_name.h"
#include "robocell/base/log.h"
#include "robocell/base/suggestions.h"
#include "robocell/env/env_impl.h"
#include "robocell/env/env_scene.h"
#include "robocell/robot/acting_arms.h"
#include "robocell/robot/task_space.h"
#include "robocell/robot/unused_groups.h"
#include "robocell/robot/validate_config.h"
#include "robocell/scene/require_keyframe.h"
#include "robocell/spec/locations.h"
#include "robocell/spec/validate.h"
#include "robocell/task/task_calls.h"
#include "robocell/task/task_features.h"
#include "robocell/task/task_judge.h"
#include "robocell/task/task_kind.h"

namespace robocell {
namespace {

constexpr const char* kSeedPurpose = "env reset";

std::vector<Robot> ArmsOf(const EnvConfig& config, const Scene& scene) {
  std::vector<Robot> robots;
  for (const auto& [name, robot] : config.robots.entries()) {
    for (const std::string& arm : internal::ActingArms(*robot, name))
      robots.push_back(Robot::Of(scene, arm));
  }
  return robots;
}

std::vector<internal::ArmDriver> DriversOf(const EnvConfig& config, const Scene& scene,
                                           const EnvLayout& layout) {
  std::vector<internal::ArmDriver> drivers;
  for (const RobotLayout& robot : layout.robots)
    drivers.emplace_back(config, Robot::Of(scene, robot.robot), robot);
  return drivers;
}

std::vector<Robot> RobotsOfDrivers(const std::vector<internal::ArmDriver>& drivers) {
  std::vector<Robot> robots;
  for (const internal::ArmDriver& driver : drivers) {
    for (const Robot& robot : driver.robots()) {
      // The arms of one robot are updated together.
      const bool is_known = std::ranges::any_of(
          robots, [&](const Robot& known) { return known.name() == robot.name(); });
      if (!is_known) robots.push_back(Robot::Of(robot.scene(), robot.name()));
    }
  }
  return robots;
}

std::vector<internal::CollisionMonitor::Watched> WatchedOf(
    const std::vector<internal::ArmDriver>& drivers) {
  std::vector<internal::CollisionMonitor::Watched> watched;
  for (const internal::ArmDriver& driver : drivers) {
    std::vector<Robot> robots = driver.robots();
    robots.erase(robots.begin());
    // One robot with several arms is watched once, with what is mounted on any of them.
    const auto known = std::ranges::find_if(
        watched, [&](const auto& each) { return each.robot.name() == driver.robot().name(); });
    if (known == watched.end())
      watched.push_back({driver.robot(), std::move(robots)});
    else
      known->grippers.insert(known->grippers.end(), robots.begin(), robots.end());
  }
  return watched;
}

std::vector<ObservedObject> ObservedObjects(const EnvLayout& layout, const Scene& scene,
                                            const std::shared_ptr<Task>& task) {
  std::vector<ObservedObject> objects;
  for (const ObjectLayout& object : layout.objects)
    objects.emplace_back(scene, object.object, ObjectOfNameIn(Lent(task)));
  return objects;
}

CameraSystemConfig StreamsOf(const EnvConfig& config) {
  CameraSystemConfig cameras = config.cameras;
  for (CameraConfig& stream : cameras.streams)
    stream.depth = stream.depth || config.wrappers.include_depth;
  return cameras;
}

// Returns make(), whose NotFoundError begins with the place of the field in the file.
template <class Make>
auto MadeOf(const EnvConfig& config, const std::string& field, const Make& make) {
  try {
    return make();
  } catch (const NotFoundError& error) {
    throw NotFoundError(WithPlace(config.locations.At(field), error.what()));
  }
}

EnvConfig Checked(EnvConfig config) {
  RequireValid(config, "environment '" + config.name + "'");
  return config;
}

// Returns the number of engine steps after which `seconds` have passed.
int64_t TicksUntil(double seconds, double timestep) {
  return static_cast<int64_t>(std::ceil(seconds / timestep - 1e-9));
}

// Notifies all observers of a step that has ended, whatever the first one throws.
void NotifyOfStep(const std::vector<EnvObserver*>& observers, const EnvStep& step) {
  std::exception_ptr first;
  for (EnvObserver* observer : observers) {
    try {
      observer->OnStep(step);
    } catch (...) {
      if (!first) first = std::current_exception();
    }
  }
  if (first) std::rethrow_exception(first);
}

}  // namespace

Env::Env(const EnvConfig& config, const DataFactory& factory)
    : Env(config, Scene::FromCompiled(CompileEnvScene(config), factory)) {}

Env::Env(EnvConfig config, Scene scene, std::optional<int> copy,
         const std::shared_ptr<internal::SharedDrawing>& drawing)
    : state_(std::make_unique<State>(std::move(config), std::move(scene), copy, drawing)) {}

Env::~Env() = default;
Env::Env(Env&&) noexcept = default;

const EnvConfig& Env::config() const { return state_->config(); }
const EnvLayout& Env::layout() const { return state_->layout(); }
const Scene& Env::scene() const { return state_->scene(); }
void Env::Reset(const EnvResetOptions& options) { state_->Reset(options); }
EnvStep Env::Step(std::span<const double> action, const std::function<void()>& poll) {
  return state_->Step(action, poll);
}
EnvStep Env::Act(const std::map<std::string, std::vector<double>>& commands,
                 const std::function<void()>& poll) {
  return state_->Act(commands, poll);
}
void Env::WantReset() { state_->WantReset(); }
void Env::RequireAction(std::span<const double> action) const { state_->RequireAction(action); }
void Env::RequireCommands(const std::map<std::string, std::vector<double>>& commands) {
  state_->RequireCommands(commands);
}
std::span<const double> Env::observation() const { return state_->observation(); }
CellFeatures& Env::features() { return state_->features(); }
const std::vector<ArmMotion>& Env::motions() const { return state_->motions(); }
const std::vector<CellImage>& Env::frames() const { return state_->cameras().frames(); }
void Env::DrawFrames() { state_->DrawFrames(); }
std::string Env::instruction() const { return state_->instruction(); }
const RandomizedValues& Env::randomized() const { return state_->randomized(); }
void Env::Save(const std::string& name) { state_->Save(name); }
void Env::Restore(const std::string& name) { state_->Restore(name); }
void Env::Forget(const std::string& name) { state_->Forget(name); }
std::vector<std::string> Env::saved() const { return state_->saved(); }
EnvState Env::state() const { return state_->state(); }
void Env::SetState(const EnvState& state, StateFrame frame) { state_->SetState(state, frame); }
void Env::AddObserver(EnvObserver* observer) { state_->AddObserver(observer); }
void Env::RemoveObserver(EnvObserver* observer) { state_->RemoveObserver(observer); }
void Env::SetOriginToCurrent(const std::string& robot) { state_->SetOriginToCurrent(robot); }
const std::shared_ptr<Task>& Env::task() const { return state_->task(); }
void Env::DropTask() { state_->DropTask(); }

Env::State::State(EnvConfig config, Scene scene, std::optional<int> copy,
                  const std::shared_ptr<internal::SharedDrawing>& drawing)
    : config_(Checked(std::move(config))),
      scene_(std::move(scene)),
      variations_(config_, scene_.inner()),
      task_(MakeTask(config_, scene_)),
      signals_(scene_.inner(), Lent(task_), "task"),
      chosen_(MadeOf(config_, "features",
                     [&] {
                       return internal::ChosenFeatures(scene_.inner(), RobotsOf(scene_.inner()),
                                                       config_.features.names);
                     })),
      layout_(MakeEnvLayout(config_, ArmsOf(config_, scene_), task_.get(), signals_, chosen_)),
      objects_(ObservedObjects(layout_, scene_, task_)),
      arms_(DriversOf(config_, scene_.inner(), layout_)),
      cell_(scene_.inner(), RobotsOfDrivers(arms_), {.control_ticks = 1, .sim_steps = 1},
            task_.get(), place()),
      collisions_(WatchedOf(arms_)),
      cameras_(MadeOf(
          config_, "cameras.streams",
          [&] { return internal::EnvCameras(scene_.inner(), StreamsOf(config_), drawing); })),
      seeds_(copy ? Rng::Stream(0, kSeedPurpose, *copy) : Rng::Stream(0, kSeedPurpose)),
      observation_(layout_.observation.size()),
      motions_(arms_.size()),
      draws_(!drawing) {
  if (config_.randomize) {
    randomization_.emplace(
        *config_.randomize, scene_.inner(),
        internal::Randomization::Options{.place = place(), .directory = config_.source_dir});
    randomization_->Validate();
  }
  const bool is_first = copy.value_or(0) == 0;  // only the first copy logs
  if (is_first) {
    for (const std::string& warning : scene_.compiled()->warnings())
      LogWarn(fmt::format("{}: {}", place(), warning));
    for (const internal::ArmDriver& arm : arms_) {
      WarnOfUndriven(arm.robot());
      WarnOfFewJoints(arm.robot());
      RequireDistances(arm);
    }
  }
  TryStart(is_first);
}

// Openings are shares of this distance, in actions and observations.
void Env::State::RequireDistances(const internal::ArmDriver& arm) const {
  for (const Robot& robot : arm.robots()) {
    Problems problems(robot.config().locations);
    internal::ValidateDistances(robot, problems);
    problems.Throw(fmt::format("{} / robot '{}'", place(), robot.name()));
  }
}

// Actions that are poses mean something else for them.
void Env::State::WarnOfFewJoints(const Robot& robot) const {
  if (config_.control_mode == ControlMode::kJoints) return;
  const internal::TaskSpace task = internal::TaskSpaceOf(robot);
  if (task.is_part()) {
    LogInfo(fmt::format("{} / robot '{}': by its task_space, of actions that are poses {} counts",
                        place(), robot.name(), task.text()));
  }
  const int joints = robot.chain().n_joints();
  if (!task.reaches_position_first(robot.chain())) return;
  LogWarn(fmt::format(
      "{} / robot '{}': an arm of {} degrees of freedom cannot take every pose: actions reach the "
      "position, and the rotation as nearly as the joints allow; `rotation_shortfall` is the "
      "rest. The arm's `task_space` chooses what counts, and `control_mode: joints` commands each "
      "joint",
      place(), robot.name(), joints));
}

void Env::State::WarnOfUndriven(const Robot& robot) const {
  if (internal::ArmNames(robot.config()).size() > 1) return;  // each of them is driven
  const std::string unused = internal::DescribeUnusedGroups(robot);
  if (unused.empty()) return;
  LogWarn(fmt::format(
      "{} / robot '{}': has several grippers, and an arm of an environment acts with one: {}, and "
      "no action or observation has them. Command them beside the steps with {}",
      place(), robot.name(), unused, internal::CppAndPythonName("Robot::Apply")));
}

void Env::State::Reset(const EnvResetOptions& options) {
  const SceneUse::Claim claim(scene_.use(), "Env.reset");
  if (options.keyframe) internal::RequireKeyframe(scene_, *options.keyframe);
  if (options.seed) seeds_ = Rng::Stream(*options.seed, kSeedPurpose);
  std::vector<std::vector<double>> kept;
  if (!config_.wrappers.home_on_reset && !options.keyframe && phase_ == Phase::kReady) {
    for (const internal::ArmDriver& arm : arms_) kept.push_back(arm.robot().arm().joint_pos());
  }
  const bool is_first = phase_ == Phase::kUnready;
  phase_ = Phase::kBroken;  // until the reset is complete
  features_.reset();        // a robot may have other groups now
  const uint64_t seed = seeds_.NextBits();
  Rng variation = Rng::Stream(seed, "env variation");
  variations_.Draw(variation);
  if (config_.randomize) {
    Rng stream = Rng::Stream(seed, "env randomization");
    const double drawn = std::floor(stream.Uniform(0, kRandomizationSeeds));
    if (!scene_randomization_seed_) scene_randomization_seed_ = drawn;
    const bool is_of_scene = config_.randomize->every == RandomizeEvery::kScene;
    Randomize(is_of_scene ? *scene_randomization_seed_ : drawn);
  }
  if (const auto refused = MakeStart(seed, options.keyframe, kept))
    throw ArgumentError(NoStart(*refused));
  cell_.Begin();
  if (task_ && is_first) internal::WarnOfNoWords(*task_, config_.task->kind(), instruction());
  collisions_.Forget();
  ticks_ = 0;
  pacer_.Start(0);
  cameras_.Reset();
  motions_.assign(arms_.size(), {});
  Observe();
  phase_ = Phase::kReady;
  for (EnvObserver* observer : observers_) observer->OnStart();
}

// The values follow from the seed and the configuration alone, so the scene is at its reset state.
void Env::State::Randomize(double seed) {
  if (randomization_seed_ == seed) return;
  randomization_seed_ = -1;  // until the values are applied
  randomization_->Restore();
  scene_.Reset();
  const RandomizedValues& values =
      randomization_->Apply(Rng::Stream(static_cast<uint64_t>(seed), "env randomize"));
  randomization_seed_ = seed;
  const RandomizedValue* delay = values.find("action_delay");
  const double seconds = delay && !delay->numbers.empty() ? delay->numbers.front() : 0;
  cell_.set_action_delay(std::llround(seconds / scene_.timestep()));
}

const RandomizedValues& Env::State::randomized() const {
  static const RandomizedValues none;
  return randomization_ ? randomization_->values() : none;
}

void Env::State::AddObserver(EnvObserver* observer) {
  observers_.push_back(observer);
  cell_.set_on_control_tick([this](const mjModel* model, const mjData* data) {
    for (EnvObserver* each : observers_) each->OnControlTick(model, data);
  });
}

void Env::State::RemoveObserver(EnvObserver* observer) {
  std::erase(observers_, observer);
  if (observers_.empty()) cell_.set_on_control_tick({});
}

std::string Env::State::instruction() const {
  return task_ ? internal::TaskCalls(*task_).Instruction() : "";
}

void Env::State::DropTask() {
  features_.reset();
  objects_.clear();
  cell_.DropTask();
  task_.reset();
}

void Env::State::RequireReady() const {
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

void Env::State::RequireAction(std::span<const double> action) const {
  RequireReady();
  if (action.size() != static_cast<size_t>(layout_.action.size())) {
    throw ArgumentError(fmt::format("{}: expected an action of {}, got {}", place(),
                                    Counted(layout_.action.size(), "number"), action.size()));
  }
  for (const internal::ArmDriver& arm : arms_) arm.RequireAction(action, place());
}

Action Env::State::RequireCommands(const std::map<std::string, std::vector<double>>& commands) {
  RequireReady();
  const auto placed = [&](const Error& error) {
    return fmt::format("environment '{}': {}", config_.name, error.what());
  };
  try {
    return features().ToAction(commands);
  } catch (const ArgumentError& error) {
    throw ArgumentError(placed(error));
  } catch (const NotFoundError& error) {
    throw NotFoundError(placed(error));
  }
}

CellFeatures& Env::State::features() {
  if (!features_) {
    const Scene scene = scene_.inner();
    features_.emplace(FeaturesOfCell(scene, RobotsOf(scene), Lent(task_),
                                     internal::OwnAmong(config_.features.names)));
  }
  return *features_;
}

std::vector<std::string> Env::State::Send(std::span<const double> action) {
  std::vector<std::string> failed;
  for (internal::ArmDriver& arm : arms_) {
    if (!arm.Send(action)) failed.push_back(arm.layout().robot);
  }
  return failed;
}

std::vector<std::string> Env::State::Send(Action action) {
  std::vector<std::string> failed;
  for (internal::ArmDriver& arm : arms_) {
    if (!arm.SendOwn(action)) failed.push_back(arm.layout().robot);
  }
  for (const auto& [name, commands] : action) {  // of groups that no action of its own moves
    if (commands.empty()) continue;
    if (!Robot::Of(scene_.inner(), name).Apply(commands).ok) failed.push_back(name);
  }
  return failed;
}

// Returns the ticks to the next multiple of 1/frequency since the reset, without drift; or at most
// the time that motions may take.
int64_t Env::State::TicksOfStep() const {
  const SimSettings& sim = config_.sim;
  if (!sim.async_control)
    return std::max<int64_t>(1, TicksUntil(sim.max_convergence_time, scene_.timestep()));
  const double end = (std::floor(TimeSinceReset() * sim.frequency + 1e-6) + 1) / sim.frequency;
  return std::max<int64_t>(1, TicksUntil(end, scene_.timestep()) - ticks_);
}

// Returns the status of the arm that is farthest from having arrived.
internal::ArmStatus Env::State::StatusOfAll() {
  internal::ArmStatus status = internal::ArmStatus::kArrived;
  for (internal::ArmDriver& arm : arms_) status = std::min(status, arm.Status(scene_.time()));
  return status;
}

double Env::State::TimeSinceReset() const {
  return static_cast<double>(ticks_) * scene_.timestep();
}

// Called after every engine step.
bool Env::State::ShouldEnd() {
  ++ticks_;
  cameras_.Tick(TimeSinceReset());
  for (internal::ArmDriver& arm : arms_) arm.Watch(scene_.time());
  collided_ = collisions_.FindNew() || collided_;
  if (collided_ && EndsAtCollision()) return true;
  return !config_.sim.async_control && StatusOfAll() != internal::ArmStatus::kMoving;
}

bool Env::State::EndsAtCollision() const {
  return config_.sim.on_collision != OnCollision::kReport && !held_;
}

EndReason Env::State::ReasonOf(const StepResult& step, const EnvStep& out) {
  if (step.status == StepResult::kStopped) return EndReason::kStopped;
  if (!step.ok()) return EndReason::kDiverged;
  if (held_ || (collided_ && EndsAtCollision())) return EndReason::kCollision;
  if (!out.ik_failed.empty()) return EndReason::kIkFailed;
  switch (StatusOfAll()) {
    case internal::ArmStatus::kArrived:
      return EndReason::kArrived;
    case internal::ArmStatus::kSettled:
      return EndReason::kSettled;
    case internal::ArmStatus::kMoving:
      break;
  }
  return EndReason::kTimeout;
}

// If a robot has collided, goes back to the beginning of the step, which is then simulated again
// with the arms held at their previous targets.
bool Env::State::GoBack(const EnvState& before, EnvStep& out) {
  if (!collided_) return false;
  out.collisions = collisions_.found();
  RecallCell(before);  // the task has not been asked since
  collisions_.Begin();
  cameras_.GoBackToMark();
  held_ = true;
  for (EnvObserver* observer : observers_) observer->OnTakenBack();
  return true;
}

EnvStep Env::State::Step(std::span<const double> action, const Poll& poll) {
  const SceneUse::Claim claim(scene_.use(), "Env.step");
  RequireAction(action);
  for (EnvObserver* observer : observers_) observer->OnAction(action);
  return Make([&] { return Send(action); }, poll);
}

EnvStep Env::State::Act(const std::map<std::string, std::vector<double>>& commands,
                        const Poll& poll) {
  const SceneUse::Claim claim(scene_.use(), "Env.step");
  const Action action = RequireCommands(commands);
  for (EnvObserver* observer : observers_) observer->OnCommands(action);
  return Make([&] { return Send(action); }, poll);
}

EnvStep Env::State::Make(const SendCommands& send, const Poll& poll) {
  EnvStep out;
  collided_ = held_ = false;
  const bool guarded = config_.sim.on_collision == OnCollision::kGuard;
  const std::optional<EnvState> before = guarded ? std::optional(CellState()) : std::nullopt;
  phase_ = Phase::kBroken;  // until the state is complete
  collisions_.Begin();
  internal::CellCommand command;
  command.send = [&] {
    out.ik_failed = send();
    return StepOutcome();
  };
  command.most_ticks = TicksOfStep();
  command.done = [&] {
    if (poll) poll();
    return ShouldEnd();
  };
  if (before) {
    cameras_.Mark();
    command.goes_back = [&] { return GoBack(*before, out); };
  }
  const internal::CellStep step = cell_.Step(command);
  out.reason = ReasonOf(step.step, out);
  out.message = step.step.message;
  if (!held_) out.collisions = collisions_.found();
  out.time = TimeSinceReset();
  if (out.reason == EndReason::kDiverged) {
    phase_ = Phase::kDiverged;
    NotifyOfStep(observers_, out);
    return out;
  }
  for (size_t i = 0; i < arms_.size(); ++i) motions_[i] = arms_[i].motion();
  static_cast<TaskVerdict&>(out) = step.verdict;
  Observe();  // after the verdict: signals may use it
  if (config_.sim.realtime) pacer_.Wait(out.time, poll);
  phase_ = Phase::kReady;
  NotifyOfStep(observers_, out);
  return out;
}

void Env::State::Observe() {
  for (const internal::ArmDriver& arm : arms_) arm.Observe(observation_);
  const Pose world_to_shared = scene_.shared_base_frame_to_world().inverse();
  for (size_t i = 0; i < objects_.size(); ++i) {
    const VectorPart& part = layout_.objects[i].tquat;
    const std::span<double> out = std::span(observation_).subspan(part.begin, part.size);
    internal::ObserveTquat(world_to_shared * objects_[i].pose_in_world(), out);
    for (double& x : out.first(3)) x = std::clamp(x, -kFarthestObject, kFarthestObject);
  }
  if (task_) ReadInto(signals_, layout_.all_signals);
  ReadInto(chosen_, layout_.all_features);
  if (draws_) cameras_.Draw(TimeSinceReset());
}

void Env::State::ReadInto(FeatureSource& source, const VectorPart& part) {
  if (part.size == 0) return;
  source.Read(std::span(observation_).subspan(part.begin, part.size));
  const VectorRange& range = layout_.observation;
  for (int i = part.begin; i < part.begin + part.size; ++i)
    observation_[i] = std::clamp(observation_[i], range.lower[i], range.upper[i]);
}

void Env::State::SetOriginToCurrent(const std::string& robot) {
  std::vector<std::string> names;
  for (internal::ArmDriver& arm : arms_) {
    if (arm.layout().robot == robot) return arm.SetOriginToCurrent();
    names.push_back(arm.layout().robot);
  }
  throw NotFoundError(NoSuchName(place(), "robot", robot, names));
}

}  // namespace robocell
