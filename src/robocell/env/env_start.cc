// The start of an Env's episodes: starts are drawn until the objects lie still, and one is tried
// when the environment is made.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/base/suggestions.h"
#include "robocell/env/env_impl.h"
#include "robocell/robot/floating_base.h"
#include "robocell/scenes/settle.h"
#include "robocell/task/task_calls.h"

namespace robocell {
namespace {

constexpr int kMostStarts = 100;    // draws for one reset
constexpr uint64_t kTriedSeed = 0;  // seed of the start that a new environment tries
// A tried start whose object turns over or moves by more than this does not rest in place.
constexpr double kMostTilt = 10;   // degrees
constexpr double kMostDrop = 0.2;  // metres straight down, because an object may be dropped

bool Contains(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

// The refused starts of a reset, counted as in runs.
class Refusals {
 public:
  void Add(Refusal refusal) {
    const std::string counted = refusal.counted_as();
    ++counts_[counted];
    last_[counted] = std::move(refusal);
  }
  // Counts a refusal for which the task was not asked.
  void Add(const std::string& why) { Add(Refusal{.reason = why}.MadeBy(Refusal::kObjectsStage)); }
  // Returns the last refusal for the most frequent reason.
  const Refusal& MostOften() const {
    const auto most = std::ranges::max_element(counts_, std::less<>(),
                                               [](const auto& each) { return each.second; });
    return last_.at(most->first);
  }

 private:
  RefusalCounts counts_;
  std::map<std::string, Refusal> last_;
};

bool IsOfTask(const Refusal& refusal) { return refusal.stage == Refusal::kTaskStage; }

std::string TextOf(const Refusal& refusal) {
  if (!IsOfTask(refusal)) return refusal.detail.empty() ? refusal.reason : refusal.detail;
  return "the task refused: " + refusal.reason +
         (refusal.detail.empty() ? "" : " (" + refusal.detail + ")");
}

std::vector<std::string> ObjectsThatMayHang(const EnvConfig& config) {
  std::vector<std::string> names;
  for (const auto* objects : {&config.root_frame_objects, &config.world_frame_objects}) {
    for (const auto& [id, object] : objects->entries()) {
      if (!object->fixed) names.push_back(id);
    }
  }
  return names;
}

Pose RootPose(const Scene& scene, const std::string& object) {
  return scene.body_pose(scene.compiled()->object(object).root_body);
}

// Describes the change of an object between two poses, "falls by 2.00 m"; "" if it stayed. An
// object may turn about the vertical.
std::string ChangeOf(const Pose& before, const Pose& after) {
  const Eigen::Vector3d displacement = after.translation() - before.translation();
  const Eigen::Vector3d was_up = before.rotation().row(2), is_up = after.rotation().row(2);
  const double cosine = std::clamp(was_up.dot(is_up), -1.0, 1.0);
  const double tilt = std::acos(cosine) * 180 / std::numbers::pi;
  if (-displacement.z() > kMostDrop) return fmt::format("falls by {:.2f} m", -displacement.z());
  const double aside = displacement.head<2>().norm();
  if (aside > internal::kMostSettling) return fmt::format("moves away by {:.2f} m", aside);
  if (tilt > kMostTilt) return fmt::format("tips over by {:.0f} degrees", tilt);
  return "";
}

std::string WhyPlaced(const std::vector<std::string>& objects) {
  return fmt::format(
      "prepare() added {} without a pose, so each reset draws a place on a support in reach. An "
      "object with a `pos` stays there",
      ListNames(objects));
}

}  // namespace

BodyPoses Env::State::TaskStarts(Rng& rng) {
  return task_ ? internal::TaskCalls(*task_).Starts(rng) : BodyPoses();
}

void Env::State::ResetToStart(const ResetOptions& options) {
  if (task_)
    internal::TaskCalls(*task_).Reset(scene_, options);
  else
    scene_.Reset(options);
}

// Returns the most frequent refusal unless a start was found. Each start is drawn from the next
// values of the seed's stream.
std::optional<Refusal> Env::State::MakeStart(uint64_t seed,
                                             const std::optional<KeyframeChoice>& keyframe,
                                             const std::vector<std::vector<double>>& kept_joints) {
  Rng of_task = Rng::Stream(seed, "env task"), of_places = Rng::Stream(seed, "env places");
  Refusals refusals;
  for (int i = 0; i < kMostStarts; ++i) {
    // Called before the reset, which puts bodies there and is one evaluation of the scene.
    BodyPoses starts = TaskStarts(of_task);
    if (prepared_) {
      const std::string why_not = prepared_->Draw(starts, of_places).why_not;
      if (!why_not.empty()) {
        refusals.Add(Refusal{Refusal::kNoFreePlace, why_not}.MadeBy(Refusal::kObjectsStage));
        continue;
      }
    }
    if (start_inspector_) starts = start_inspector_->Lowered(std::move(starts));
    const uint64_t noise = i == 0 ? seed : Rng::Stream(seed, "env start", i).NextBits();
    ResetToStart({.keyframe = keyframe, .seed = noise, .body_poses = starts});
    for (size_t k = 0; k < kept_joints.size(); ++k)
      Robot(arms_[k].robot()).SetJointPos(kept_joints[k]);
    for (internal::ArmDriver& arm : arms_) arm.Reset();
    if (task_) {
      if (auto refusal = internal::TaskCalls(*task_).Arrange(scene_, of_task)) {
        refusals.Add(std::move(*refusal).MadeBy(Refusal::kTaskStage));
        continue;
      }
    }
    if (prepared_ && !prepared_->Unplaced().empty()) {
      if (!prepared_->has_support()) throw SpecError(NoPlace());
      refusals.Add(Refusal::kNoFreePlace);
      continue;
    }
    if (const std::string why = start_inspector_ ? start_inspector_->WhyNot() : ""; !why.empty()) {
      refusals.Add(why);
      continue;
    }
    auto refusal = task_ ? internal::TaskCalls(*task_).CheckStart(scene_) : std::nullopt;
    if (!refusal) return std::nullopt;
    refusals.Add(std::move(*refusal).MadeBy(Refusal::kTaskStage));
  }
  return refusals.MostOften();
}

std::string Env::State::NoStart(const Refusal& most_often) const {
  // A size that is wrong by a factor of thousand causes all other problems.
  if (const auto huge = internal::ObjectsInMillimetres(scene_); !huge.empty())
    return fmt::format("{}: no episode can begin, because {}", place(), huge.front());
  const std::string found = fmt::format("{}: {}found no start in {} tries: most often {}", place(),
                                        config_.task ? "task '" + config_.task->kind() + "' " : "",
                                        kMostStarts, TextOf(most_often));
  if (IsOfTask(most_often))
    return found +
           ". Change the fields of `task`, its objects, or where these and the robots are "
           "(root_frame_to_world, robot_to_shared_base_frame)";
  return found + ". Move its objects to a free place (root_frame_objects), or change task.spread";
}

std::string Env::State::NoPlace() const {
  return fmt::format("{}: task '{}': {}", place(), config_.task->kind(), prepared_->Advice());
}

// Finds the objects that stay at their positions: they must be at rest there, like those that the
// task names.
void Env::State::FindPreparedObjects(bool is_first) {
  if (!task_ && config_.places.empty()) return;
  if (task_) resting_ = internal::TaskCalls(*task_).RestingObjects(scene_);
  prepared_.emplace(scene_.inner(), config_, task_.get());
  if (prepared_->empty()) return prepared_.reset();
  Rng of_task = Rng::Stream(kTriedSeed, "env task"), of_places = Rng::Stream(kTriedSeed, "places");
  BodyPoses starts;
  internal::PreparedObjects::Drawn drawn{.why_not = "not drawn"};
  for (int i = 0; i < kMostStarts && !drawn.why_not.empty(); ++i) {
    starts = TaskStarts(of_task);
    drawn = prepared_->Draw(starts, of_places);
  }
  ResetToStart({.body_poses = starts});
  if (task_ && internal::TaskCalls(*task_).Arrange(scene_, of_task))
    ResetToStart({.body_poses = starts});
  std::vector<std::string> placed = prepared_->PlacedHere(drawn.added);
  std::vector<std::string> on_support = prepared_->names_on_support();
  std::erase_if(on_support, [&](const std::string& object) { return !Contains(placed, object); });
  if (is_first && !on_support.empty())
    LogDebug(fmt::format("{}: {}", place(), WhyPlaced(on_support)));
  std::erase_if(placed, [&](const std::string& object) { return Contains(resting_, object); });
  resting_.insert(resting_.end(), placed.begin(), placed.end());
  PutPrepared(of_places);
}

// Puts them into a free start, which the inspector accepts and warnings describe.
void Env::State::PutPrepared(Rng& rng) {
  for (int i = 0; i < kMostStarts; ++i) {
    BodyPoses places;
    prepared_->Draw(places, rng);
    scene_.Reset({.body_poses = places});
    if (places.empty()) return;
    internal::StartInspector inspector(scene_, prepared_->names());
    inspector.Accept();
    if (inspector.WhyNot().empty()) return;
  }
}

// Inspects the present scene, with objects in their places.
void Env::State::MakeInspector() {
  if (!resting_.empty()) start_inspector_.emplace(scene_.inner(), resting_);
}

// Leaves the scene in the state after a reset.
void Env::State::TryStart(bool is_first) {
  const SceneUse::Claim claim(scene_.use(), "Env");
  scene_.Reset();
  FindPreparedObjects(is_first);
  MakeInspector();
  const bool is_placed = !prepared_ || prepared_->has_support();  // else the task has to place them
  if (is_first && is_placed) WarnOfStart();
  if (!start_inspector_) {
    if (!task_ && !prepared_) return;
    if (const auto refused = MakeStart(kTriedSeed, {}, {})) throw SpecError(NoStart(*refused));
    scene_.Reset();
    return;
  }
  start_inspector_->Accept();
  const std::optional<Refusal> doubt = MakeStart(kTriedSeed, {}, {});
  if (doubt) {
    // Objects also rest on grids and rings, which a ray misses: only simulating them shows it.
    start_inspector_->AcceptGaps();
    if (const auto refused = MakeStart(kTriedSeed, {}, {})) throw SpecError(NoStart(*refused));
  }
  if (is_first) RequireRest(doubt ? TextOf(*doubt) : "");
  scene_.Reset();
}

void Env::State::RequireRest(const std::string& doubt) {
  std::vector<Robot> robots = RobotsOf(scene_);
  const std::vector<std::string>& resting = resting_;
  const std::string of_task = config_.task ? " of task '" + config_.task->kind() + "'" : "";
  const std::string body = scene_.compiled()->object(resting.front()).root_body;
  std::vector<Pose> before;
  for (const std::string& object : resting) before.push_back(RootPose(scene_, object));
  const std::string why_not =
      internal::Settle(scene_, robots, body,
                       {.resting = resting, .most_drift = std::numeric_limits<double>::infinity()});
  for (size_t i = 0; why_not.empty() && i < resting.size(); ++i) {
    const std::string change = ChangeOf(before[i], RootPose(scene_, resting[i]));
    if (change.empty()) continue;
    throw SpecError(fmt::format(
        "{}: no episode can begin, because '{}'{} does not rest where it starts: it {}. "
        "Give it the pose in which it rests on its support (root_frame_objects)",
        place(), resting[i], of_task, change));
  }
  if (why_not.empty()) return;
  throw SpecError(
      fmt::format("{}: no episode can begin, because the objects{} do not come to rest: {}. Put "
                  "something under them: `add_floor: true`, or an object with `fixed: true`",
                  place(), of_task, doubt.empty() ? why_not : doubt));
}

std::string Env::State::AdviceFor(const internal::RobotOverlap& overlap) const {
  if (!overlap.object.empty()) {
    return fmt::format("Move '{}' to a free place, or the robot (robot_to_shared_base_frame)",
                       overlap.object);
  }
  std::string advice = "Move the robot (robot_to_shared_base_frame)";
  // Environments drop the pose of a robot's root unless its file keeps it.
  const RobotConfig* robot = config_.robots.find(overlap.robot);
  if (robot && robot->reset_root_pose.value_or(true))
    advice +=
        ", or write `reset_root_pose: false` in its file when its model has the height in its "
        "root's pose";
  return advice;
}

void Env::State::WarnOfStart() {
  if (const std::vector<std::string> huge = internal::ObjectsInMillimetres(scene_); !huge.empty()) {
    for (const std::string& object : huge) LogWarn(fmt::format("{}: {}", place(), object));
    return;  // it causes all other problems
  }
  std::vector<internal::RobotOverlap> inside = internal::RobotsInTheFloor(scene_);
  internal::StartInspector inspector =
      start_inspector_ ? *start_inspector_ : internal::StartInspector(scene_, {});
  for (internal::RobotOverlap& overlap : inspector.RobotsInside())
    inside.push_back(std::move(overlap));
  for (const internal::RobotOverlap& overlap : inside)
    LogWarn(fmt::format("{}: at the start {}. {}", place(), overlap.text, AdviceFor(overlap)));
  for (const std::string& robot : inspector.RobotsInsideThemselves()) {
    LogWarn(fmt::format(
        "{}: at the start {}, and is pushed apart. Correct where the part is mounted (`offset`, "
        "gripper_offsets), exclude the pair in the model if it may overlap, or choose another "
        "`home`",
        place(), robot));
  }
  for (const RobotRecord& robot : scene_.compiled()->robots()) {
    if (const std::string why = internal::WhyBaseFalls(scene_, robot); !why.empty())
      LogWarn(fmt::format("{}: robot '{}': {}", place(), robot.name, why));
  }
  for (const std::string& text : internal::HangingObjects(scene_, ObjectsThatMayHang(config_)))
    LogWarn(fmt::format("{}: {}", place(), text));
  for (const std::string& text : internal::ObjectsInTheFloor(scene_))
    LogWarn(fmt::format("{}: at the start {}. Move it up", place(), text));
  for (const std::string& text : internal::ObjectsInside(scene_)) {
    LogWarn(fmt::format("{}: at the start {}, and is pushed out of it. Move one of them", place(),
                        text));
  }
  std::vector<std::string> falling = internal::ObjectsOverNothing(scene_);
  if (start_inspector_) {
    for (const std::string& object : resting_) std::erase(falling, object);
  }
  if (falling.empty()) return;
  LogWarn(
      fmt::format("{}: nothing is under {}, which falls for ever. Set `add_floor: true`, put "
                  "something under it, or set fixed: true",
                  place(), ListNames(falling)));
}

}  // namespace robocell
