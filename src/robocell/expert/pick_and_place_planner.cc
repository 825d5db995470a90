#include "robocell/expert/pick_and_place_planner.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/task/run_arms.h"

namespace robocell {
namespace {

constexpr int kMostPicks = 3;
// An object that moved in the hand by more than this, m and rad, is put down another way, with at
// most this many new plans.
constexpr double kShifted = 0.003, kTurned = 0.05;
constexpr int kMostReplans = 2;
constexpr double kCarrySpeed =
    0.8;  // of the fastest joint with the object in the hand, rad/s (m/s)
constexpr double kLeastCarrySeconds = 0.3, kMostCarrySeconds = 6.0;
constexpr double kLeastLowerSeconds = 0.6, kMostLowerSeconds = 3.0;
constexpr double kLeastRetreatSeconds = 0.5;
// Speed of the distance between the opening fingers, m/s: a finger that leaves the object before
// the other pushes it no farther than this allows.
constexpr double kOpenSpeed = 0.15;
constexpr double kMostReleaseSeconds = 1.5, kRestSeconds = 0.3;

std::shared_ptr<const PickAndPlaceTask> TaskOf(const RunConfig& run, const EpisodeStart& start) {
  auto task = std::dynamic_pointer_cast<const PickAndPlaceTask>(start.task);
  if (task) return task;
  throw SpecError(
      fmt::format("run '{}': expert 'pick_and_place' demonstrates tasks of kind "
                  "pick_and_place, and the task is '{}'",
                  run.run, run.task.kind()));
}

PickPlannerOptions With(PickPlannerOptions options, GraspUse usable) {
  options.usable = std::move(usable);
  return options;
}

}  // namespace

PickAndPlacePlanner::PickAndPlacePlanner(std::string robot, std::string target_object,
                                         std::shared_ptr<const PickAndPlaceTask> task,
                                         SimOptions sim, const PickPlannerOptions& options)
    : PickAndPlacePlanner(std::move(robot), std::move(target_object), PlacePoses(), std::move(sim),
                          options) {
  task_ = std::move(task);
}

PickAndPlacePlanner::PickAndPlacePlanner(std::string robot, std::string target_object,
                                         PlacePoses places, SimOptions sim,
                                         const PickPlannerOptions& options)
    : robot_name_(std::move(robot)),
      target_object_(std::move(target_object)),
      places_(std::move(places)),
      options_(options),
      // It grasps the object so that it can put it down: of several arms the nearest one may reach
      // the object and not the goal.
      pick_(robot_name_, target_object_, std::move(sim),
            With(options, [this](PlanningScene& planning, const GraspMotion& motion) {
              if (options_.usable && !options_.usable(planning, motion)) return false;
              const Pose in_tcp = motion.grasp.tcp_in_world.inverse() * ObjectInWorld();
              PlaceMotions places(planning, in_tcp, GoalsFor(at_rest_), motion.up.back(),
                                  {.above = options_.above, .gap = motion.grasp.width});
              return places.Next().has_value();
            })) {}

PickAndPlacePlanner::PickAndPlacePlanner(const RunConfig& run, const EpisodeStart& start)
    : PickAndPlacePlanner(internal::FirstArmOfRun(run), start.target_object, TaskOf(run, start),
                          run.options, PickPlannerOptionsOf(run)) {}

PickAndPlacePlanner::~PickAndPlacePlanner() = default;

std::vector<std::string> PickAndPlacePlanner::phase_names() const {
  std::vector<std::string> names = pick_.phase_names();
  names.pop_back();  // done
  names.insert(names.end(), {"transfer", "lower", "release", "retreat", "done"});
  return names;
}

// A pick that is done waits at the top, which is part of its lift here.
int PickAndPlacePlanner::phase() const {
  const int lift = static_cast<int>(pick_.phase_names().size()) - 2;
  if (phase_ == Phase::kPick) return std::min(pick_.phase(), lift);
  return lift + static_cast<int>(phase_);
}

void PickAndPlacePlanner::Begin(const Scene& scene, Rng& rng) {
  robot_ = Robot::Of(scene, robot_name_);
  picks_ = 0;
  finished_ = false;
  failure_.clear();
  PickAgain(scene, rng);
}

void PickAndPlacePlanner::PickAgain(const Scene& scene, Rng& rng) {
  ++picks_;
  arm_.reset();
  place_.reset();
  phase_ = Phase::kPick;
  replans_ = 0;
  at_rest_ = ObjectInWorld();
  if (task_)
    rise_ = task_->RiseOverGoal(scene);
  else
    goals_ = places_(scene, rng);
  pick_.Begin(scene, rng);
  if (!pick_.failure().empty()) GiveUp(picks_ > 1 ? "the object slipped" : pick_.failure());
}

Action PickAndPlacePlanner::Act(const Scene& scene, Rng& rng) {
  if (!robot_) {
    throw Error(
        "PickAndPlacePlanner: Act came before Begin; a subclass with its own Begin calls the "
        "planner's first (in Python super().begin(scene, rng))");
  }
  if (phase_ == Phase::kPick && !finished_) {
    Action action = pick_.Act(scene, rng);
    if (!pick_.done()) return action;
    if (!pick_.failure().empty()) {
      GiveUp(pick_.failure());
      return action;
    }
    arm_.emplace(*robot_, options_.tick);
    opening_ = 0;
    if (const std::string why_not = PlanPlace(rng); !why_not.empty()) {
      GiveUp(why_not);
      return action;
    }
    Enter(Phase::kTransfer);
  }
  if (!arm_) return pick_.Act(scene, rng);  // given up: stay
  if (!finished_) Advance(scene, rng);
  if (phase_ == Phase::kPick) return finished_ ? Command() : pick_.Act(scene, rng);
  if (!finished_) {
    arm_->Next();
    if (phase_ == Phase::kRelease) opening_ = std::min(1.0, opening_ + opening_step_);
    ++ticks_;
  }
  return Command();
}

// Plans where to put the object and the path there, with the object's present pose in the hand: as
// upright as it stood, else in its present rotation. Returns "" or the reason why there is no plan.
std::string PickAndPlacePlanner::PlanPlace(Rng& rng) {
  PlanningScene& planning = pick_.planning();
  planning.Update();
  const GripperShape& shape = planning.shape();
  const double range = shape.open_gap() - shape.closed_gap();
  opening_step_ = range > 0 ? kOpenSpeed * options_.tick / range : 1;  // a cup lets go at once
  const Pose object = ObjectInWorld();
  std::string why_not;
  for (const Pose& turned : {at_rest_, object}) {
    PlaceMotions places(planning, robot_->tcp_in_world().inverse() * object, GoalsFor(turned),
                        arm_->target(), {.above = options_.above, .gap = pick_.held_width()});
    why_not = "no way to put the object down";
    for (int i = 0; i < kMostPathSearches; ++i) {
      const std::optional<PlaceMotion> motion = places.Next();
      if (!motion) break;
      why_not = "no free path to the goal";
      std::optional<JointPath> transfer = FindTransfer(motion->down.front(), rng);
      if (!transfer) continue;
      place_ = motion;
      transfer_ = std::move(*transfer);
      object_in_tcp_ = robot_->tcp_in_world().inverse() * object;
      return "";
    }
  }
  return why_not;
}

// Returns the poses for an object that is to be turned, up to the vertical, like `turned`.
std::vector<Pose> PickAndPlacePlanner::GoalsFor(const Pose& turned) const {
  if (task_) {
    return PosesAbout(PlaceOver(task_->GoalInWorld() + rise_ * Eigen::Vector3d::UnitZ()), turned);
  }
  std::vector<Pose> poses;
  for (const Pose& goal : goals_) {
    const Pose tilt(Eigen::Vector3d::Zero(), (at_rest_.inverse() * turned).quaternion());
    poses.emplace_back(PlaceOver(goal.translation()), (goal * tilt).quaternion());
  }
  return poses;
}

std::optional<JointPath> PickAndPlacePlanner::FindTransfer(const JointVector& goal, Rng& rng) {
  PlanningScene& planning = pick_.planning();
  const JointVector start = arm_->target();
  for (const double clearance : kPathClearances) {
    const FreeFunction is_free = [&](const JointVector& q) {
      return planning.IsFree(q, {.gap = pick_.held_width(), .clearance = clearance});
    };
    if (!is_free(start) || !is_free(goal)) continue;
    if (EdgeIsFree(start, goal, is_free)) return JointPath{start, goal};
    return ConnectTrees(start, goal, robot_->joint_limits(), is_free, rng);
  }
  return std::nullopt;
}

void PickAndPlacePlanner::Enter(Phase phase) {
  phase_ = phase;
  ticks_ = 0;
  arm_->Begin();
  switch (phase) {
    case Phase::kTransfer:
      for (size_t i = 1; i < transfer_.size(); ++i) {
        arm_->AddLeg({transfer_[i]}, kCarrySpeed,
                     arm_->GentleSeconds({transfer_[i - 1], transfer_[i]}, kLeastCarrySeconds,
                                         kMostCarrySeconds));
      }
      break;
    case Phase::kLower:
      arm_->AddLeg({place_->down.begin() + 1, place_->down.end()}, options_.line_speed,
                   arm_->GentleSeconds(place_->down, kLeastLowerSeconds, kMostLowerSeconds));
      break;
    case Phase::kRetreat:
      arm_->AddLeg({place_->down.rbegin() + 1, place_->down.rend()}, options_.line_speed,
                   kLeastRetreatSeconds);
      break;
    case Phase::kPick:
    case Phase::kRelease:
    case Phase::kDone:
      break;
  }
}

void PickAndPlacePlanner::Advance(const Scene& scene, Rng& rng) {
  if (arm_->Blocked()) return GiveUp("the arm is blocked");
  switch (phase_) {
    case Phase::kPick:
      return;
    case Phase::kTransfer:
    case Phase::kLower:
      if (pick_.HandIsEmpty()) {
        if (picks_ >= kMostPicks) return GiveUp("the object slipped");
        return PickAgain(scene, rng);
      }
      if (!arm_->Settled()) return;
      if (phase_ == Phase::kLower) return Enter(Phase::kRelease);
      if (!HasMovedInHand() || ++replans_ > kMostReplans) return Enter(Phase::kLower);
      return Enter(PlanPlace(rng).empty() ? Phase::kTransfer : Phase::kLower);
    case Phase::kRelease:
      if (opening_ < 1) return;
      if (robot_->gripper().opening() < PickPlanner::kOpened &&
          ticks_ < arm_->Ticks(kMostReleaseSeconds))
        return;
      return Enter(Phase::kRetreat);
    case Phase::kRetreat:
      if (arm_->Settled()) Enter(Phase::kDone);
      return;
    case Phase::kDone:
      if (ticks_ >= arm_->Ticks(kRestSeconds)) finished_ = true;
      return;
  }
}

void PickAndPlacePlanner::GiveUp(const std::string& why) {
  failure_ = why;
  finished_ = true;
}

Action PickAndPlacePlanner::Command() const {
  RobotAction action;
  action[robot_->arm().name()] =
      GroupCommand::Joints(std::vector<double>(arm_->target().begin(), arm_->target().end()));
  action[robot_->gripper().name()] = GroupCommand::Opening(opening_);
  return {{robot_->name(), std::move(action)}};
}

bool PickAndPlacePlanner::HasMovedInHand() const {
  const Pose now = robot_->tcp_in_world().inverse() * ObjectInWorld();
  return !now.is_close(object_in_tcp_, kTurned, kShifted);
}

Pose PickAndPlacePlanner::ObjectInWorld() const {
  const Scene scene = robot_->scene();
  return scene.body_pose(scene.compiled()->object(target_object_).root_body);
}

}  // namespace robocell
